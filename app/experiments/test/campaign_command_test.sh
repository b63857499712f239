#!/usr/bin/env bash
# tautline-bench campaign and calibrate, as a user runs them: exit codes, one clear line, shards, resuming.
set -uo pipefail
bin=${TAUTLINE_BIN:?the folder of the programs}
cd "${TAUTLINE_SOURCE_DIR:?the source folder}" || exit 1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0

# expect CODE PATTERN COMMAND…: exit code, and a line of output or error that matches.
expect() {
  local code=$1 pattern=$2 got
  shift 2
  timeout 120 "$@" >"$work/out" 2>&1
  got=$?
  if [[ $got != "$code" ]] || ! grep -qE -- "$pattern" "$work/out"; then
    failed=$((failed + 1))
    echo "FAILED: $*"
    echo "  wanted exit $code and a line like: $pattern"
    echo "  got exit $got: $(cat "$work/out")"
  fi
}
same() { # same WHAT A B
  [[ $2 == "$3" ]] || { failed=$((failed + 1)); echo "FAILED: $1: '$2' is not '$3'"; }
}
value() { # value KEY: of the JSON that was printed last
  python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))[sys.argv[2]])' "$work/out" "$1"
}

map=config/scenes/dissertation/staircase.scene.toml
params=config/risk/dissertation.toml
mission=$work/green.mission.toml
expect 0 'risk 0.575' "$bin/tautline-plan" plan --map "$map" --params "$params" --planner directional --goal 3.8,2.6,1.4 -o "$mission"
campaign=("$bin/tautline-bench" campaign --map "$map" --params "$params" --mission "$mission" --inflation 0.15)

expect 0 '^predicted: risk 0.575' "${campaign[@]}" --flights 2 --jobs 2
expect 0 'Clopper-Pearson' "${campaign[@]}" --flights 4 --seed 3 --json --out "$work/kept"
whole=$(value failed)
same flights 4 "$(value flights)"
same 'sum of the kinds' "$whole" "$(python3 -c 'import json, sys; print(sum(json.load(open(sys.argv[1]))["failures_by_kind"].values()))' "$work/out")"
cp "$work/out" "$work/first"

# What has been flown is not flown again, and comes out the same.
lines=$(wc -l <"$work/kept/results.txt")
expect 0 'failed' "${campaign[@]}" --flights 4 --seed 3 --json --out "$work/kept"
same 'kept results' "$lines" "$(wc -l <"$work/kept/results.txt")"
same 'resumed campaign' "$(cat "$work/first")" "$(cat "$work/out")"
# An interrupted campaign goes on: half a line is flown again.
head -c -20 "$work/kept/results.txt" >"$work/cut" && mv "$work/cut" "$work/kept/results.txt"
expect 0 'failed' "${campaign[@]}" --flights 4 --seed 3 --json --out "$work/kept"
same 'campaign after a cut' "$(cat "$work/first")" "$(cat "$work/out")"

# Shards in one folder, and together they are the whole.
sum=0
for shard in 1/2 2/2; do
  expect 0 'failed' "${campaign[@]}" --flights 4 --seed 3 --json --shard "$shard"
  same "flights of $shard" 2 "$(value flights)"
  sum=$((sum + $(value failed)))
done
same 'failures of both shards' "$whole" "$sum"

expect 0 'risk' "${campaign[@]}" --flights 0 --write-scene "$work/world.scene.toml"

expect 2 'shard' "${campaign[@]}" --shard 3/2
expect 2 '--mission is required' "$bin/tautline-bench" campaign --map "$map"
expect 5 'nowhere' "$bin/tautline-bench" campaign --map nowhere.bt --mission "$mission"
expect 5 'nowhere' "$bin/tautline-bench" campaign --map "$map" --mission nowhere.mission.toml
expect 5 'reel' "$bin/tautline-bench" campaign --map "$map" --mission config/missions/square.mission.toml
expect 2 '--inflation' "${campaign[@]}" --flights 1 --inflation 0.2
expect 2 '--inflation' "${campaign[@]}" --flights 1 --inflation nan
expect 5 'station.toml|no_such' "${campaign[@]}" --flights 1 --station-config no_such.toml

calibrate=("$bin/tautline-bench" calibrate --station-config config/experiments/as_published.toml --sim-config config/experiments/plant.toml)
expect 2 '--output is required' "${calibrate[@]}"
expect 5 'nowhere' "${calibrate[@]}" --params nowhere.toml -o "$work/fitted.toml"
expect 2 'maps' "${calibrate[@]}" --maps 1 -o "$work/fitted.toml"
expect 0 '"after"' "${calibrate[@]}" --maps 4 --goals 1 --flights 3 --json --out "$work/paths" -o "$work/fitted.toml"
cp "$work/out" "$work/first"
expect 0 'written: .*again' "${calibrate[@]}" --maps 4 --goals 1 --flights 3 --out "$work/paths" -o "$work/again.toml"
cmp -s "$work/fitted.toml" "$work/again.toml" || { failed=$((failed + 1)); echo "FAILED: calibrate is not the same twice"; }
expect 0 'risk 0\.' "$bin/tautline-plan" plan --map "$map" --params "$work/fitted.toml" --planner directional --goal 3.8,2.6,1.4

[[ $failed == 0 ]] && echo "all as expected"
exit $((failed > 0))
