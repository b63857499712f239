#!/usr/bin/env bash
# The same lock-step flight by the native programs and by the cross-built ones: the numbers must agree. Run by ctest of the
# cross-build (./run cross).
#
# usage: same_flight.sh MISSION SCENE -- CROSS_BENCH_COMMAND…
# exit code: 0 equal within the tolerance, 1 not, 77 without a native tautline-bench
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
# What differs are the last bits of the C library's sine, cosine and the like. The stiff tether (1e4 N) makes them largest in
# the tension, 1.3e-9 N (docs/cross_build.md); a wrong sign, rounding or conversion would be seen at once.
tolerance=1e-7
native=$root/build/bin/tautline-bench
mission=$root/config/missions/$1.mission.toml
scene=$root/config/scenes/$2.scene.toml
shift 3
[[ -x $native ]] || {
  echo "SKIPPED: no native tautline-bench to compare with; ./run cross builds it" >&2
  exit 77
}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fly() { # fly LOG BENCH_COMMAND…
  local log=$1
  shift
  "$@" fly --mission "$mission" --scene "$scene" --seed 1 --log "$log" \
    --station-config "$root/config/station.toml" --sim-config "$root/config/sim.toml"
}
fly "$work/native.lcm" "$native"
fly "$work/cross.lcm" "$@"
python3 -B "$root/toolchain/cross/same_numbers.py" "$root/lcmtypes" "$tolerance" "$work/native.lcm" "$work/cross.lcm"
