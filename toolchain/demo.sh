#!/usr/bin/env bash
# Flies one mission with the real programs: simulator, station, logger, operator command line. Called by `./run demo`.
# Exit code 0 only if the mission was completed and the drone landed.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=toolchain/lib.sh
source "$root/toolchain/lib.sh"

# `--scene staircase` is more than a flight.
arguments=("$@")
for ((i = 0; i + 1 < ${#arguments[@]}; i++)); do
  if [[ ${arguments[i]} == --scene && ${arguments[i + 1]} == staircase ]]; then
    unset 'arguments[i]' 'arguments[i + 1]'
    exec "$root/toolchain/staircase_demo.sh" "${arguments[@]}"
  fi
done

headless=false
out=
mission=$root/config/missions/one_contact.mission.toml
scene=
seed=1
while [[ $# -gt 0 ]]; do
  case $1 in
    --headless) headless=true ;;
    --out) out=${2:?--out needs a folder}; shift ;;
    --mission) mission=${2:?--mission needs a file}; shift ;;
    --scene) scene=${2:?--scene needs a file}; shift ;;
    --seed) seed=${2:?--seed needs a number}; shift ;;
    *) echo "run demo: error: unknown option '$1'; allowed: --headless --out DIR --mission FILE --scene FILE|staircase --seed N" >&2; exit 2 ;;
  esac
  shift
done
name=$(basename "$mission" .mission.toml)
[[ -f $mission ]] || { echo "run demo: error: $mission: no such mission file; see config/missions" >&2; exit 5; }
if [[ -z $scene ]]; then
  scene=$root/config/scenes/$name.scene.toml
  [[ -f $scene ]] || scene=$root/config/scenes/open.scene.toml
fi
out=$(realpath -m "${out:-$root/flights/$(date +%Y%m%d-%H%M%S)-$name}")
mkdir -p "$out"

# Everything below runs in a network namespace of its own, so that LCM works on any machine and demos do not meet.
if [[ -z ${TAUTLINE_DEMO_INSIDE:-} ]]; then
  export TAUTLINE_DEMO_INSIDE=1
  args=(--out "$out" --mission "$mission" --scene "$scene" --seed "$seed")
  $headless && args+=(--headless)
  in_network_namespace "$0" "${args[@]}"
  exit
fi

bin=$root/build/bin
link=$out/fotokite
pids=()
stop() { # stop SIGNAL PID: ends a program, by force after five seconds, and waits for it
  local i
  kill -"$1" "$2" 2>/dev/null || true
  for ((i = 0; i < 50; i++)); do
    kill -0 "$2" 2>/dev/null || break
    sleep 0.1
  done
  kill -KILL "$2" 2>/dev/null || true
  wait "$2" 2>/dev/null || true
}
clean_up() {
  local pid
  for pid in "${pids[@]}"; do stop KILL "$pid"; done
}
trap clean_up EXIT
fail() {
  echo "run demo: error: $1" >&2
  for log in "$out"/*.txt; do echo "--- $log" >&2; tail -n 5 "$log" >&2; done
  exit 1
}

say "flying $name (seed $seed) with the real programs; log and pictures go to $out"
rm -f "$out"/{flight.lcm,report.json,report.html,series.csv,*.svg,*.txt}
lcm-logger --quiet --lcm-url="udpm://239.255.76.67:7667?ttl=0" "$out/flight.lcm" >"$out/logger.txt" 2>&1 &
logger=$!; pids+=("$logger")
"$bin/tautline-sim" --pty "$link" --scene "$scene" --seed "$seed" --config "$root/config/sim.toml" >"$out/sim.txt" 2>&1 &
sim=$!; pids+=("$sim")
for _ in $(seq 50); do [[ -e $link ]] && break; sleep 0.1; done
[[ -e $link ]] || fail "the simulator did not start"
"$bin/tautline-station" --config "$root/config/station.toml" --device "$link" --scene "$scene" >"$out/station.txt" 2>&1 &
station=$!; pids+=("$station")

tautline() { "$bin/tautline" "$@"; }
flown=true
tautline status --wait 10 || fail "the station did not start"
# The station needs a moment of telemetry before it lets itself be armed.
armed=false
for _ in $(seq 20); do
  if tautline arm --quiet 2>/dev/null; then armed=true; break; fi
  sleep 0.5
done
$armed || { tautline arm || true; fail "the station refuses to arm"; }
tautline takeoff && tautline navigate "$mission" || flown=false
tautline land || flown=false
sleep 2  # the log's last seconds show the drone on the ground, rotors still

stop INT "$logger"
stop TERM "$station"
stop TERM "$sim"
pids=()

verdict=0
tautline report "$out/flight.lcm" --out "$out" --scene "$scene" --require-success || verdict=1
$flown || verdict=1
say "report $out/report.html"
echo "pictures  $out/*.svg"
echo "log       $out/flight.lcm"
if ! $headless && [[ -n ${DISPLAY:-}${WAYLAND_DISPLAY:-} ]] && command -v xdg-open >/dev/null; then
  xdg-open "$out/report.html" >/dev/null 2>&1 || true
fi
exit $verdict
