#!/usr/bin/env bash
# Runs the SocketCAN tests (label vm) of a build tree in a kernel that has SocketCAN: user-mode Linux, an ordinary program
# that needs no root. The host's file system is its root, so the tests run from where they were built.
# Called by `./run vcan` and `./run test`.
#
# usage: vcan.sh BUILD_TREE [ctest options]
# exit code: ctest's own; 1 as well if a test was skipped in there; 4 if that kernel did not start or took too long;
#            77 if it cannot be had on this machine
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
cd "$root"
# shellcheck source=toolchain/lib.sh
source toolchain/lib.sh
# shellcheck source=toolchain/unpack.sh
source toolchain/unpack.sh

limit_s=${TAUTLINE_VCAN_LIMIT_S:-600}
tree=$(realpath "${1:?usage: vcan.sh BUILD_TREE [ctest options]}")
shift

unavailable() {
  echo "run: note: SKIPPED: the SocketCAN tests cannot run here: $1" >&2
  exit 77
}
[[ $(uname -m) == x86_64 ]] || unavailable "Debian has user-mode Linux for amd64 only"
uml=$root/build/uml
read -r -d '' -a packages < <(packages_of vcan) || true
unpack_packages amd64 "$uml" only "${packages[@]}" || unavailable "no package user-mode-linux to be had (see above)"

job=$(mktemp -d "$root/build/vcan.XXXXXX")
kernel=
clean_up() {
  # By force, with the processes that it runs inside: after an ordinary power-off none is left.
  [[ -z $kernel ]] || kill -KILL -- "-$kernel" 2>/dev/null || true
  rm -rf "$job"
}
trap clean_up EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

preload=
if grep -qw amx_tile /proc/cpuinfo; then
  preload=$root/build/uml/xstate_preload.so
  gcc -shared -fPIC -O2 -Wall -Wextra -o "$preload" toolchain/vcan/xstate_preload.c
fi

{
  printf 'cd %q || exit\n' "$root"
  echo 'export TAUTLINE_VCAN=vcan0'
  printf 'ctest --test-dir %q --output-on-failure --no-tests=error -L vm' "$tree"
  [[ $# -eq 0 ]] || printf ' %q' "$@"
  echo
} >"$job/command.sh"

# A process group of its own (setsid), so that nothing of it can be left behind.
LD_PRELOAD=$preload setsid "$uml/usr/bin/linux.uml" mem=512M rootfstype=hostfs rootflags=/ rw \
  init="$root/toolchain/vcan/init.sh" TAUTLINE_JOB="$job" TAUTLINE_UML="$uml" uml_dir="$job" umid=vcan \
  quiet con=null ssl=null con0=null,fd:1 </dev/null >"$job/console" 2>&1 &
kernel=$!
SECONDS=0
while kill -0 "$kernel" 2>/dev/null; do
  ((SECONDS < limit_s)) || break
  sleep 0.1
done
cat "$job/output" 2>/dev/null || true
if [[ ! -e $job/output ]] && ! kill -0 "$kernel" 2>/dev/null; then
  tail -n 20 "$job/console" >&2
  unavailable "user-mode Linux does not start on this machine (ptrace forbidden?); its last words are above"
fi
if [[ ! -s $job/exit_code ]]; then
  tail -n 20 "$job/console" >&2
  echo "run: error: the kernel with SocketCAN did not finish (started $SECONDS s ago, limit $limit_s s); its last words are above" >&2
  exit 4
fi
code=$(<"$job/exit_code")
if ((code == 0)) && grep -q '\*\*\*Skipped' "$job/output"; then
  echo "run: error: a test was skipped in a kernel that has SocketCAN; run it by name: ./run vcan -R NAME -V" >&2
  exit 1
fi
exit "$code"
