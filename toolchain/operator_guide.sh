#!/usr/bin/env bash
# Puts the tables of `tautline help conditions --markdown` into docs/operator_guide.md;  --check only tells whether they are
# there as they should be (exit code 1 if not).
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
bin=${TAUTLINE_BIN:-$root/build/bin}
guide=$root/docs/operator_guide.md
new=$(mktemp)
trap 'rm -f "$new"' EXIT

{
  sed '/<!-- tables begin -->/q' "$guide"
  echo
  "$bin/tautline" help conditions --markdown
  echo
  sed -n '/<!-- tables end -->/,$p' "$guide"
} >"$new"

if [[ ${1:-} == --check ]]; then
  diff -u "$guide" "$new" >&2 || {
    echo "operator_guide: docs/operator_guide.md is out of date; run toolchain/operator_guide.sh" >&2
    exit 1
  }
else
  cp "$new" "$guide"
fi
