#!/usr/bin/env bash
# clang-format over every C++ source of the project; --check only tells and exits 1 where something would change.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
mode=-i
[[ ${1:-} == --check ]] && mode="--dry-run -Werror"
git ls-files -z --cached --others --exclude-standard '*.h' '*.cpp' | xargs -0 clang-format $mode --style=file
