#!/usr/bin/env bash
# Runs inside the Debian that try_packages.sh boots: the installed services against the installed simulator. One line for each
# check in /probe.txt, then power-off.
set -uo pipefail
exec >/probe.txt 2>/probe.log
set -x
check() { # check WHAT COMMAND…
  local what=$1
  shift
  if "$@" >&2; then echo "ok      $what"; else echo "FAILED  $what"; fi
}
soon() { # soon COMMAND…: within ten seconds
  local i
  for ((i = 0; i < 20; i++)); do "$@" >&2 && return 0; sleep 0.5; done
  return 1
}
property() { systemctl show --property "$1" --value tautline-station; }
mode_is() { tautline status --json --wait 2 | grep -q "\"mode\":\"$1\""; }
restarted() { [[ $(property NRestarts) -ge $1 && $(property ActiveState) == active ]]; }
scheduling() { chrt --pid "$1" | head -n 1 | sed 's/.*: //'; }
only_the_loop_is_fifo() {
  local task pid
  pid=$(property MainPID)
  for task in /proc/"$pid"/task/*; do
    case ${task##*/} in
      "$pid") [[ $(scheduling "${task##*/}") == SCHED_FIFO ]] || return 1 ;;
      *) [[ $(scheduling "${task##*/}") == SCHED_OTHER ]] || return 1 ;;
    esac
  done
}
memory_is_locked() { [[ $(awk '/VmLck/ { print $2 }' "/proc/$(property MainPID)/status") -gt 1000 ]]; }
killed_comes_back_disarmed() { # killed_comes_back_disarmed SIGNAL RESTARTS
  soon tautline arm && mode_is ARMED || return 1
  kill -"$1" "$(property MainPID)"
  sleep 4
  soon restarted "$2" && soon mode_is STANDBY
}

# Real-time rights are enforced, so a station that runs has them.
sed 's/^run_mode.*/&\nrealtime_policy = "enforce"/' /usr/share/tautline/station.toml >/etc/tautline/station.toml
runuser -u tautline -- tautline-sim --pty /tmp/tautline-fotokite --no-lcm >&2 &
sleep 1
check "the station starts and says that it is ready" systemctl start tautline-station
check "its status is the loop's" test "$(property StatusText)" = "The loop is running"
check "it brought the multicast route" sh -c 'ip route | grep -q "^224.0.0.0/4 dev lo"'
check "SCHED_FIFO for the loop, and for nothing else of it" only_the_loop_is_fifo
check "its memory is locked" memory_is_locked
check "the logger starts" systemctl start tautline-logger
check "a station that hangs is ended by the watchdog and comes back disarmed" killed_comes_back_disarmed STOP 1
check "a station that is killed comes back disarmed" killed_comes_back_disarmed KILL 2
check "it can be armed again" soon tautline arm
check "it stops by itself when it is told" systemctl stop tautline-station
check "and that is no failure" test "$(property Result)" = success
check "the logger stops" systemctl stop tautline-logger
check "a log was written" sh -c 'find /var/log/tautline -name "*.lcm" -size +10k | grep -q .'
check "no unit failed" sh -c '! systemctl --failed --no-legend | grep tautline'
journalctl --no-pager --unit 'tautline-*' >&2
systemctl poweroff
