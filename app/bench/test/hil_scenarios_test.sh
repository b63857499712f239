#!/usr/bin/env bash
# tautline-bench scenario --hil: a few different scenarios with the real programs on the wall clock, what it says of those that
# it cannot fly or that fail, and that no process and no file is left behind.
set -uo pipefail
bin=${TAUTLINE_BIN:?the folder of the programs}
cd "${TAUTLINE_SOURCE_DIR:?the source folder}" || exit 1
work=$(mktemp -d -p /dev/shm 2>/dev/null || mktemp -d)
export TMPDIR=$work
failed=0

cleanup() {
  local pid
  for pid in $(jobs -p); do kill -TERM "$pid" 2>/dev/null; done
  wait
  rm -rf "$work"
}
trap cleanup EXIT

fail() { failed=$((failed + 1)); echo "FAILED: $*"; }
# check NAME CODE PATTERN: what the run `fly NAME …` came to.
check() {
  local got
  got=$(cat "$work/$1.code")
  [[ $got == "$2" ]] && grep -qE -- "$3" "$work/$1.out" || fail "$1: wanted exit $2 and a line like: $3, got exit $got: $(cat "$work/$1.out")"
}
fly() { # fly NAME ARGUMENTS…
  local name=$1
  shift
  timeout 300 "$bin/tautline-bench" scenario --hil "$@" >"$work/$name.out" 2>&1
  echo $? >"$work/$name.code"
}

fly probe config/scenarios --case "clock jump"
if grep -q 'cannot be joined' "$work/probe.out"; then
  echo "SKIPPED: LCM has no multicast route here; ./run test makes one ($(cat "$work/probe.out"))"
  exit 77
fi
check probe 1 'only in lock-step clock jump seed 1: loop wrong: .'
check probe 1 '^0 passed, 0 failed, 1 only in lock-step'

# A sensor of the Fotokite, the operator's link, a flag on the bus, the cable.
sed 's|station_config = .*|station_config = "'"$PWD"'/config/station_tautline_serial.toml"|; s|"\.\./|"'"$PWD"'/config/|
  s|"campaign\.m|"'"$PWD"'/config/scenarios/campaign.m|; s|name = ".*|name = "bus fault"|' \
  config/scenarios/vehicle_fault.scenario.toml >"$work/bus.scenario.toml"
(fly sensor config/scenarios --case "encoder stale" --junit "$work/junit.xml" --log "$work/logs"; fly cable config/scenarios --case unplugged) &
(fly operator config/scenarios --case "operator lost in TELEOP"; fly bus "$work/bus.scenario.toml") &
wait
for name in sensor operator bus cable; do check "$name" 0 '^1 passed, 0 failed$'; done
grep -q 'tests="1" failures="0" skipped="0"' "$work/junit.xml" || fail "$(cat "$work/junit.xml")"
"$bin/tautline" log info "$work"/logs/encoder_stale_1.lcm 2>&1 | grep -q STATION_INPUT || fail "the log has no flight in it"

# A failure is one line with the command that repeats it.
printf 'version = 1\nname = "impossible"\nscene = "%s/config/scenes/open.scene.toml"\n[[expect]]\nwithin_s = 0.5\nmode = "AUTO"\n' "$PWD" >"$work/bad.scenario.toml"
fly bad "$work/bad.scenario.toml"
check bad 1 'FAILED impossible: at 0\.[0-9]+ s: expected AUTO within 0.5 s: in STANDBY.*again: tautline-bench scenario .*bad.scenario.toml --seed 1 --hil'

# A program that dies is a failed case, with its last words.
printf 'version = 1\nname = "dies"\nscene = "%s/config/scenes/open.scene.toml"\n[station]\nrealtime_cpu = 1000\nrealtime_policy = "enforce"\n' "$PWD" >"$work/dies.scenario.toml"
fly dies "$work/dies.scenario.toml"
check dies 1 'FAILED dies: tautline-station ended with code 1: .*not '

# Interrupted in the midst of a flight, and its bench killed: in both cases everything is gone soon.
for signal in INT KILL; do
  # A shell ignores SIGINT for what it puts in the background.
  env --default-signal=INT "$bin/tautline-bench" scenario config/scenarios/operator_script.scenario.toml --hil >"$work/cut.out" 2>&1 &
  bench=$!
  for _ in $(seq 100); do pgrep -f "$work/tautline-hil.*station.toml" >/dev/null && break; sleep 0.1; done
  pgrep -f "$work/tautline-hil.*station.toml" >/dev/null || fail "no station came up"
  kill -$signal "$bench"
  wait "$bench" 2>/dev/null
  for _ in $(seq 100); do pgrep -f "$work/tautline-hil" >/dev/null || compgen -G "$work/tautline-hil*" >/dev/null || break; sleep 0.1; done
done
left=$(pgrep -af "$work/tautline-hil"; ls -d "$work"/tautline-hil* 2>/dev/null)
[[ -z $left ]] || fail "left behind: $left"

[[ $failed == 0 ]] && echo "all as expected"
exit $((failed > 0))
