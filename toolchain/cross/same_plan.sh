#!/usr/bin/env bash
# The same plans by the native tautline-plan and by the cross-built one: the answers must agree, number by number. Run by ctest
# of the cross-build (./run cross).
#
# usage: same_plan.sh CROSS_PLAN_COMMAND…
# exit code: 0 equal within the tolerance, 1 not, 77 without a native tautline-plan
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
tolerance=1e-9  # last bits of the C library's functions (docs/cross_build.md)
native=$root/build/bin/tautline-plan
config=$root/config
scenes=$config/scenes/dissertation
[[ -x $native ]] || {
  echo "SKIPPED: no native tautline-plan to compare with; ./run cross builds it" >&2
  exit 77
}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
same() { # same PLAN_ARGUMENTS…
  "$native" "$@" --json >"$work/native.json" 2>/dev/null
  "${cross[@]}" "$@" --json >"$work/cross.json" 2>/dev/null
  python3 -B "$root/toolchain/cross/same_json.py" "$tolerance" "$work/native.json" "$work/cross.json" || failed=1
}
cross=("$@")

room=$work/room.scene.toml
cat >"$room" <<'EOF'
version = 1
name = "room"
min_m = [0.0, 0.0, 0.0]
max_m = [4.0, 2.0, 4.0]
resolution_m = 0.4
reel_m = [0.6, 0.6, 0.6]
start_m = [1.0, 1.0, 1.0]

[[boxes]]
name = "pillar"
min_m = [1.6, 0.0, 1.6]
max_m = [2.4, 2.0, 2.4]

[[rewards]]
position_m = [3.4, 1.0, 3.4]
value = 1.0
EOF

same risk --table "$config/risk/tables/red_path.toml"
same reach --map "$scenes/shaft.scene.toml" --tether-clearance 0.33
same contacts --map "$scenes/shaft.scene.toml" --path "$scenes/shaft_two_contacts.path.txt" --compare
same_path() { # same_path PLAN_ARGUMENTS…: of more than one state; no limit of time may cut it on a busy machine
  same plan --map "$room" --seed 3 --time-limit-s 3600 "$@"
  python3 -c 'import json, sys; sys.exit(len(json.load(open(sys.argv[1]))["path"]) < 2)' "$work/native.json" || {
    echo "no path to compare: $*"
    failed=1
  }
}
for planner in additive directional tether prm; do
  same_path --planner "$planner" --goal 3.4,1.0,1.0
done
same_path --planner "utility two-stage"
exit "$failed"
