#!/usr/bin/env bash
# `tautline spy --gui` on a display without a screen, hearing a recorded flight; a picture of it. Called by ./run spy --screenshot.
# Exit code 0 only if the list of channels and the fields of one of them were there.
set -euo pipefail
bin=$1
picture=$(realpath -m "$2")
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
work=$(mktemp -d)
pids=()
clean_up() {
  local pid
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
  rm -rf "$work"
}
trap clean_up EXIT
fail() { echo "spy_screenshot: error: $1" >&2; tail -n 5 "$work"/*.txt >&2; exit 1; }

"$bin/tautline-bench" fly --mission "$source/config/missions/square.mission.toml" --scene "$source/config/scenes/open.scene.toml" \
  --log "$work/flight.lcm" >"$work/bench.txt"
Xvfb -displayfd 3 -screen 0 1480x620x24 3>"$work/display" 2>"$work/xvfb.txt" & pids+=($!)
for _ in $(seq 100); do [[ -s $work/display ]] && break; sleep 0.1; done
[[ -s $work/display ]] || fail "Xvfb did not start"
DISPLAY=:$(cat "$work/display")
export DISPLAY
"$bin/tautline" spy --gui >"$work/spy.txt" 2>&1 & pids+=($!)
window=$(timeout 60 xdotool search --sync --onlyvisible --name '^LCM Spy' | head -n 1) || fail "no window of lcm-spy"
lcm-logplayer "$work/flight.lcm" >"$work/player.txt" 2>&1 & pids+=($!)
# The fields of a channel open with a double click on its row, once that is there; the window gets a place beside the list.
fields=
for _ in $(seq 15); do
  sleep 2
  xdotool mousemove --window "$window" 60 60 click --repeat 2 --delay 100 1
  fields=$(xdotool search --onlyvisible --name '^(COMMAND|COMMAND_ACK|ESTIMATE|EVENT)$' | head -n 1) || true
  [[ -z $fields ]] || break
done
[[ -n $fields ]] || fail "no window with fields"
xdotool windowmove "$fields" 820 0
sleep 2
import -window root "$picture"
if grep -qi exception "$work/spy.txt"; then fail "lcm-spy complains"; fi
echo "$picture: lcm-spy with the fields of $(xdotool getwindowname "$fields")"
