#!/usr/bin/env bash
# The quota of /var/log/tautline on a folder of our own: the oldest go first, the newest never, other files are left alone.
set -euo pipefail
quota=${TAUTLINE_SOURCE_DIR:?the source folder}/toolchain/packaging/log-quota
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0

expect() { # expect WHAT WANTED: the names that are left
  local left
  left=$(cd "$work" && find . -type f -printf '%f\n' | sort | tr '\n' ' ')
  [[ $left == "$2" ]] || { echo "FAILED: $1: wanted '$2', got '$left'"; failed=1; }
}
fill() { # fill: five logs of 1 MB, the first the oldest, one with a space in its name, and a file that is no log
  local i=0 name
  rm -f "$work"/*
  for name in a.lcm "b c.lcm" d.lcm.00 e.lcm f.lcm; do
    head -c 1048576 /dev/urandom >"$work/$name"
    touch -d "2026-01-01 00:0$i" "$work/$name"
    i=$((i + 1))
  done
  head -c 3145728 /dev/urandom >"$work/notes.txt"
}

fill
LOG_QUOTA_MB=7 LOG_SPLIT_MB=1 "$quota" "$work" >/dev/null
expect "all fit" "a.lcm b c.lcm d.lcm.00 e.lcm f.lcm notes.txt "
LOG_QUOTA_MB=4 LOG_SPLIT_MB=1 "$quota" "$work" >"$work/notes.txt"
expect "the two oldest make room" "d.lcm.00 e.lcm f.lcm notes.txt "
grep -q 'deleting .*/b c.lcm' "$work/notes.txt" || { echo "FAILED: it does not say what it deletes"; failed=1; }
LOG_QUOTA_MB=1 LOG_SPLIT_MB=8 "$quota" "$work" >/dev/null
expect "the newest stays, whatever the quota" "f.lcm notes.txt "
fill
sleep 60 9>>"$work/a.lcm" & writer=$!
touch -d "2026-01-01 00:00" "$work/a.lcm"
LOG_QUOTA_MB=1 LOG_SPLIT_MB=8 "$quota" "$work" >/dev/null
kill $writer
expect "a log that is open stays, however old it looks" "a.lcm f.lcm notes.txt "
"$quota" "$work/nowhere"
rm -f "$work"/*
"$quota" "$work"
expect "an empty folder" ""
exit $failed
