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

# A map of OctoMap's kind is read by reach; the tether by contacts; every search and OMPL's roadmap by plan.
same risk --table "$config/risk/tables/red_path.toml"
same reach --map "$scenes/shaft.scene.toml" --tether-clearance 0.33
same contacts --map "$scenes/shaft.scene.toml" --path "$scenes/shaft_two_contacts.path.txt" --compare
for planner in additive directional tether prm "utility two-stage"; do
  same plan --map "$config/scenes/one_contact.scene.toml" --resolution 0.4 --goal 2.0,1.2,2.0 --planner "$planner" --seed 3
done
exit "$failed"
