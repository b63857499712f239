#!/usr/bin/env bash
# Bad input, as a user would give it: one clear line that says what, where and what to do, and the right exit code.
set -uo pipefail
bin=${TAUTLINE_BIN:?the folder of the programs}
config=${TAUTLINE_SOURCE_DIR:?the source folder}/config
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
passed=0
failed=0

# expect CODE PATTERN COMMAND…: exit code, one line on stderr that matches.
expect() {
  local code=$1 pattern=$2 got lines
  shift 2
  timeout 20 "$@" >"$work/out" 2>"$work/err"
  got=$?
  lines=$(wc -l <"$work/err")
  if [[ $got == "$code" && $lines == 1 ]] && grep -qE -- "$pattern" "$work/err"; then
    passed=$((passed + 1))
  else
    failed=$((failed + 1))
    echo "FAILED: $*"
    echo "  wanted exit $code and one line like: $pattern"
    echo "  got exit $got and $lines lines: $(cat "$work/err")"
  fi
}

# changed FILE SED: a copy of a shipped mission, damaged by a sed script.
changed() {
  sed -E "$2" "$config/missions/$1.mission.toml" >"$work/bad.mission.toml"
  echo "$work/bad.mission.toml"
}
toml() { # toml TEXT: a config file with that text
  printf '%s\n' "$1" >"$work/bad.toml"
  echo "$work/bad.toml"
}

tautline=$bin/tautline
station=$bin/tautline-station
sim=$bin/tautline-sim
bench=$bin/tautline-bench
open=$config/scenes/open.scene.toml

# Missing files.
expect 5 'nowhere.mission.toml.*(no such file|cannot)' "$tautline" mission check nowhere.mission.toml
expect 5 'nowhere.toml' "$station" --config nowhere.toml
expect 5 'nowhere.scene.toml' "$sim" --pty "$work/pty" --scene nowhere.scene.toml --seed 1 --no-lcm
expect 5 'nowhere' "$bench" fly --mission nowhere --scene "$open"
expect 5 'nowhere.lcm' "$tautline" report nowhere.lcm
expect 5 'nowhere' "$tautline" blackbox nowhere

# A log of another version: it names the channel and the way out.
python3 -c "
import struct, sys
for channel in (b'STATION_INPUT', b'VEHICLE_STATE'):
    message = bytes(range(200))
    sys.stdout.buffer.write(struct.pack('>IqqII', 0xEDA1DA01, 0, 0, len(channel), len(message)) + channel + message)
" >"$work/old.lcm"
expect 5 'old.lcm: STATION_INPUT, VEHICLE_STATE: recorded by another version.*with the programs of the version' "$tautline" report "$work/old.lcm"
expect 5 'old.lcm: STATION_INPUT: recorded by another version.*with the programs of the version' "$bench" replay "$work/old.lcm"
sed 's|^run_mode.*|run_mode = "SIM"|' "$config/station_replay.toml" >"$work/replay.toml"
expect 5 'old.lcm: STATION_INPUT: recorded by another version' "$station" --config "$work/replay.toml" --device "$work/old.lcm"

# Missions: each names its file, line and row.
expect 5 'bad.mission.toml:[0-9]+' "$tautline" mission check "$(changed square 's/^version = 1/version = /')"
expect 5 'bad.mission.toml: version: missing' "$tautline" mission check "$(changed square 's/^version/vresion/')"
expect 5 'bad.mission.toml:[0-9]+: .*waypoints\[0\].*contact' "$tautline" mission check "$(changed square '0,/contact = 0/s//contact = 3/')"
expect 5 'bad.mission.toml:[0-9]+: .*waypoints\[1\].*position_m' "$tautline" mission check "$(changed square 's/0\.8, 1\.2, 1\.2/nan, 1.2, 1.2/')"
expect 5 'bad.mission.toml:[0-9]+: .*waypoints\[0\].*speed_mps' "$tautline" mission check "$(changed square '0,/speed_mps = 0.3/s//speed_mps = -1/')"
expect 5 'bad.mission.toml: waypoints\[0\]: .*mission check' "$tautline" navigate "$(changed square 's/0\.0, 1\.2, 1\.2/0.0, 50.0, 1.2/')"
printf '1 2 three\n' >"$work/legacy.txt"
expect 5 'legacy.txt:1' "$tautline" mission import "$work/legacy.txt" -o "$work/new.mission.toml"
[[ ! -e $work/new.mission.toml ]] && passed=$((passed + 1)) || { failed=$((failed + 1)); echo "FAILED: a refused import left a file"; }

# Configurations.
expect 5 'bad.toml:1: .*loop_rate_hz.*allowed' "$station" --config "$(toml 'loop_rate_hz = 5.0')"
expect 5 'bad.toml:1: .*loop_rate' "$station" --config "$(toml 'loop_rate = 100.0')"
expect 5 'bad.toml:1: .*loop_rate_hz' "$station" --config "$(toml 'loop_rate_hz = "fast"')"
expect 5 'bad.toml:1: .*loop_rate_hz' "$station" --config "$(toml 'loop_rate_hz = nan')"
expect 5 'bad.toml:2: .*law.*composite' "$station" --config "$(toml $'[core.control]\nlaw = "magic"')"
expect 5 'bad.toml:1' "$sim" --config "$(toml 'step_s = 7.0')" --pty "$work/pty" --scene "$open" --seed 1 --no-lcm

# Command lines.
expect 5 'not a black box' "$tautline" blackbox "$open"
expect 3 'real device.*run_mode' "$station" --config "$config/station.toml" --device /dev/null

# No multicast route: a network namespace without any.
if unshare -rn true 2>/dev/null || unshare -n true 2>/dev/null; then
  flags=-n; unshare -n true 2>/dev/null || flags=-rn
  expect 4 'LCM.*ip route add' unshare $flags "$station" --config "$config/station.toml" --device "$work/none"
  expect 4 'LCM.*ip route add' unshare $flags "$tautline" arm
else
  echo "SKIPPED: no network namespaces here, so the missing multicast route cannot be tried"
fi

# Usage errors speak through the command-line library: exit code 2 whatever the text.
for command in "$tautline fly-away" "$tautline navigate" "$station --no-such-option" "$sim --pty" "$bench"; do
  $command >/dev/null 2>&1
  [[ $? == 2 ]] && passed=$((passed + 1)) || { failed=$((failed + 1)); echo "FAILED: exit code 2 wanted: $command"; }
done

echo "$passed passed, $failed failed"
[[ $failed == 0 ]]
