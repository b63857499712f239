# Shared by ./run, toolchain/demo.sh and .ci/run. Sourced, never run.

say() { printf '\033[1m== %s\033[0m\n' "$*"; }

# Runs a command; shows its output only if it fails.
quietly() {
  local log
  log=$(mktemp)
  if ! "$@" >"$log" 2>&1; then
    cat "$log" >&2
    rm -f "$log"
    return 1
  fi
  rm -f "$log"
}

# Every package of the one list that is not installed.
missing_packages() {
  local package
  sed -e 's/#.*//' -e '/^[[:space:]]*$/d' toolchain/packages.txt | while read -r package; do
    dpkg-query -W -f='${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed || echo "$package"
  done
}

install_packages() {
  local missing sudo=
  missing=$(missing_packages)
  [[ -n $missing ]] || return 0
  if [[ $(id -u) != 0 ]]; then
    command -v sudo >/dev/null || {
      echo "run: error: missing packages and no right to install them; as root: apt-get install" $missing >&2
      exit 1
    }
    sudo=sudo
  fi
  say "installing" $missing
  quietly $sudo apt-get update
  # shellcheck disable=SC2086
  quietly $sudo env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends $missing
}

# cached_option NAME DEFAULT: value of a CMake option in the release tree, so that `demo` does not undo what `test` built.
cached_option() {
  local value
  value=$(sed -n "s/^$1:BOOL=//p" build/release/CMakeCache.txt 2>/dev/null || true)
  echo "${value:-$2}"
}

# Runs a command in a network namespace of its own with a multicast route on its loopback, so that LCM works without
# touching the machine and parallel runs do not hear each other. Where namespaces are forbidden, runs it as it is.
in_network_namespace() {
  local set_up='ip link set lo up multicast on && ip route add 224.0.0.0/4 dev lo && exec "$@"'
  local flags
  for flags in -n -rn; do
    if unshare $flags true 2>/dev/null; then
      unshare $flags bash -c "$set_up" bash "$@"
      return
    fi
  done
  echo "run: note: network namespaces are not allowed here; using the machine's own loopback" >&2
  "$@"
}
