#!/usr/bin/env bash
# tautline-bench scenario and safety, and live faults of tautline-sim, as a user runs them: exit codes and one clear line.
set -uo pipefail
bin=${TAUTLINE_BIN:?the folder of the programs}
cd "${TAUTLINE_SOURCE_DIR:?the source folder}" || exit 1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0

# expect CODE PATTERN COMMAND…: exit code, and a line of output or error that matches.
expect() {
  local code=$1 pattern=$2 got
  shift 2
  timeout 120 "$@" >"$work/out" 2>&1
  got=$?
  if [[ $got != "$code" ]] || ! grep -qE -- "$pattern" "$work/out"; then
    failed=$((failed + 1))
    echo "FAILED: $*"
    echo "  wanted exit $code and a line like: $pattern"
    echo "  got exit $got: $(cat "$work/out")"
  fi
}

bench=$bin/tautline-bench
sim=$bin/tautline-sim
expect 0 '2 passed, 0 failed' "$bench" scenario config/scenarios --case "encoder stale" --iterations 2 --junit "$work/junit.xml" --log "$work"
grep -q 'tests="2" failures="0"' "$work/junit.xml" || { echo "FAILED: $(cat "$work/junit.xml")"; failed=$((failed + 1)); }
[[ -s $work/encoder_stale_2.lcm ]] || { echo "FAILED: no log"; failed=$((failed + 1)); }
expect 1 'no scenario is named "nothing"' "$bench" scenario config/scenarios --case nothing
expect 1 'no case is chosen' "$bench" safety --case nothing
expect 5 'nowhere' "$bench" scenario nowhere.scenario.toml
expect 2 'shard' "$bench" safety --shard 3/2

# A failure is one line with the command that repeats it.
sed 's/end_mode = .*/end_mode = "ESTOP"/; s|"\.\./|"'"$PWD"'/config/|; s|"campaign|"'"$PWD"'/config/scenarios/campaign|' \
  config/scenarios/unplugged.scenario.toml >"$work/bad.scenario.toml"
expect 1 'FAILED unplugged: .*expected to end in ESTOP.*again: tautline-bench scenario .*bad.scenario.toml --seed 1' \
  "$bench" scenario "$work/bad.scenario.toml"

# What has been flown is not flown again.
expect 0 '2 passed, 0 failed' "$bench" safety --case 'fotokite/HOLD/encoder off*' --resume "$work/resume" --jobs 1
expect 0 '^2 cases were flown before' "$bench" safety --case 'fotokite/HOLD/encoder off*' --resume "$work/resume"

expect 0 'encoder +stuck' "$sim" faults
expect 2 'not supported: its video does not pass the device' "$sim" --check-config --fault 'camera off 1'
expect 2 'allowed: ok, off' "$sim" --check-config --fault 'encoder snag 1'
expect 5 'has no such bus' "$sim" --check-config --fault 'bus crc 1'
expect 5 'is not in the machine' "$sim" --check-config --fault 'loop delayed 1'
expect 0 'is right' "$sim" --check-config --fault 'encoder stuck 10 5' --fault 'tether snag 20'
expect 5 'phase "AUTO"' "$sim" --check-config --scenario config/scenarios/encoder_stale.scenario.toml

[[ $failed == 0 ]] && echo "all as expected"
exit $((failed > 0))
