#!/usr/bin/env bash
# The dissertation's integrated demonstration (chapter 7): plans the ways to both viewpoints of the staircase, chooses by utility, and flies the
# chosen one with the real programs. Called by `./run demo --scene staircase`. Exit code 0 only if the mission was completed and the drone landed.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=toolchain/lib.sh
source "$root/toolchain/lib.sh"

out=
more=()
while [[ $# -gt 0 ]]; do
  case $1 in
    --out) out=${2:?--out needs a folder}; shift ;;
    --headless) more+=(--headless) ;;
    --seed) more+=(--seed "${2:?--seed needs a number}"); shift ;;
    *) echo "run demo --scene staircase: error: unknown option '$1'; allowed: --headless --out DIR --seed N" >&2; exit 2 ;;
  esac
  shift
done
out=$(realpath -m "${out:-$root/flights/$(date +%Y%m%d-%H%M%S)-staircase}")
plans=$out/plans
mkdir -p "$plans"

bin=$root/build/bin
map=$root/config/scenes/dissertation/staircase.scene.toml
params=$root/config/risk/dissertation.toml
inflation=0.15  # the vehicle's radius, by which the map's obstacles are grown

plan() { # plan NAME GOAL
  "$bin/tautline-plan" plan --map "$map" --params "$params" --planner directional --goal "$2" --json --svg "$plans/$1.svg" \
    --csv "$plans/$1.csv" -o "$plans/$1.mission.toml" >"$plans/$1.json"
}
say "planning to both viewpoints"
plan red 5.0,0.6,4.2
plan green 3.8,2.6,1.4
chosen=$("$root/toolchain/staircase_report.py" choose "$out")

# The world to fly in: the things inside the voxels, and the platform that the drone is parked on.
"$bin/tautline-bench" campaign --map "$map" --params "$params" --mission "$plans/$chosen.mission.toml" --inflation "$inflation" --flights 0 \
  --write-scene "$out/staircase.scene.toml" >/dev/null

flown=0
"$root/toolchain/demo.sh" --out "$out" --mission "$plans/$chosen.mission.toml" --scene "$out/staircase.scene.toml" "${more[@]}" || flown=$?
"$root/toolchain/staircase_report.py" report "$out" "$chosen"
echo "staircase $out/staircase.html"
exit "$flown"
