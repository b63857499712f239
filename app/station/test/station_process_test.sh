#!/usr/bin/env bash
# The real programs over a real pseudo terminal and real LCM: a missing device, a busy one, an unplugged one, a
# killed station.
set -uo pipefail
bin=${TAUTLINE_BIN:?the folder of the programs}
config=${TAUTLINE_SOURCE_DIR:?the source folder}/config
work=$(mktemp -d)
lcm=udpm://239.255.76.67:7679?ttl=0
scene=$config/scenes/open.scene.toml
passed=0
failed=0

cleanup() {
  local pid
  for pid in $(jobs -p); do kill -KILL "$pid" 2>/dev/null; done
  rm -rf "$work"
}
trap cleanup EXIT

tautline() { "$bin/tautline" "$@" --lcm-url "$lcm"; }
check() { # check WHAT COMMAND…
  local what=$1
  shift
  if "$@"; then passed=$((passed + 1)); else failed=$((failed + 1)); echo "FAILED: $what"; tail -n 3 "$work"/*.txt; fi
}
start_sim() {
  "$bin/tautline-sim" --pty "$work/device" --scene "$scene" --seed 4 --config "$config/sim.toml" --lcm-url "$lcm" >"$work/sim.txt" 2>&1 &
  sim=$!
}
start_station() {
  "$bin/tautline-station" --config "$work/station.toml" --device "$work/device" --scene "$scene" --lcm-url "$lcm" >"$work/station.txt" 2>&1 &
  station=$!
}
status_says() { tautline status --json --wait 3 | grep -qE "$1"; }
soon() { # soon SECONDS PATTERN: `tautline status` shows it in time
  local i
  for ((i = 0; i < $1 * 4; i++)); do status_says "$2" && return 0; sleep 0.25; done
  tautline status
  return 1
}
exit_code() { # exit_code WANTED COMMAND…
  local wanted=$1
  shift
  "$@" >"$work/last.txt" 2>&1
  [[ $? == "$wanted" ]]
}

sed 's|^run_mode.*|&\nblack_box = "'"$work"'/box"|' "$config/station.toml" >"$work/station.toml"

tautline status --wait 0.1 >"$work/probe.txt" 2>&1
if grep -q 'cannot be joined' "$work/probe.txt"; then
  echo "SKIPPED: LCM has no multicast route here; ./run test makes one ($(cat "$work/probe.txt"))"
  exit 77
fi

# No device: the station runs, disarmed, and says why it will not arm.
start_station
check "station runs without a device" soon 5 '"mode":"STANDBY"'
check "it names the missing device" grep -q "device" "$work/station.txt"
check "arming is refused with exit code 3" exit_code 3 tautline arm
check "and names the link" grep -q LINK_VEHICLE "$work/last.txt"

check "status names the path that is not there" bash -c "'$bin/tautline' status --lcm-url '$lcm' | grep -q 'link .*the device $work/device is not there'"
# Another program has it: named while the station runs, with the command that finds the program.
python3 -c "
import fcntl, os, pty, sys, time
_, slave = pty.openpty()
fcntl.flock(slave, fcntl.LOCK_EX)
os.symlink(os.ttyname(slave), sys.argv[1])
time.sleep(60)" "$work/device" &
holder=$!
check "a busy device is recognised" soon 8 '"link_fault":"port busy"'
check "and the remedy names it" bash -c "'$bin/tautline' status --lcm-url '$lcm' | grep -q 'fuser -v $work/device'"
kill -KILL "$holder"
wait "$holder" 2>/dev/null
rm "$work/device"

# The device comes, is flown, goes, comes back.
start_sim
check "the link comes up by itself" soon 8 '"arming_blockers":""'
check "arm" tautline arm --quiet
check "take-off" tautline takeoff --quiet
kill -KILL "$sim"
wait "$sim" 2>/dev/null
check "an unplugged device is noticed" soon 4 '"mode":"LAND".*|LINK_VEHICLE'
check "the station still runs" kill -0 "$station"
start_sim
check "a device on the ground ends the landing" soon 12 '"mode":"STANDBY"'
check "the link is back, its loss needs a look" soon 8 '"arming_blockers":"FAULT_LATCHED"'

# Stop is latched; disarm clears it.
check "estop" tautline estop --quiet
check "arming after a stop is refused" exit_code 3 tautline arm
check "disarm" tautline disarm --quiet

# Killed: the black box has the last cycles, a restart comes up disarmed.
check "arm again" tautline arm --quiet
kill -KILL "$station"
wait "$station" 2>/dev/null
cycles=$("$bin/tautline" blackbox "$work/box" | wc -l)
check "the black box survives a kill ($cycles lines)" test "$cycles" -gt 200
start_station
check "a restart comes up disarmed" soon 5 '"mode":"STANDBY"'
kill -TERM "$station"
wait "$station"
check "SIGTERM ends it with exit code 0" test $? == 0

echo "$passed passed, $failed failed"
[[ $failed == 0 ]]
