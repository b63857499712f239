# shellcheck shell=bash
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

# packages_of SECTION: the packages of a section of the one list; without a section those that are always needed.
packages_of() {
  awk -v wanted="${1:-}" '
    { sub(/#.*/, "") }
    /^\[/ { section = $0; gsub(/[][]|[[:space:]]+$/, "", section); next }
    section == wanted && NF { print $1 }' toolchain/packages.txt
}

# missing_packages [SECTION…]: those that are not installed.
missing_packages() {
  local section package
  for section in "" "$@"; do
    packages_of "$section" | while read -r package; do
      dpkg-query -W -f='${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed || echo "$package"
    done
  done
}

# install_packages [SECTION…]: what is always needed, and the named sections.
install_packages() {
  local sudo="" missing
  read -r -d '' -a missing < <(missing_packages "$@") || true
  [[ ${#missing[@]} -gt 0 ]] || return 0
  if [[ $(id -u) != 0 ]]; then
    command -v sudo >/dev/null || {
      echo "run: error: missing packages and no right to install them; as root: apt-get install ${missing[*]}" >&2
      exit 1
    }
    sudo=sudo
  fi
  say "installing ${missing[*]}"
  quietly $sudo apt-get update
  quietly $sudo env DEBIAN_FRONTEND=noninteractive \
    apt-get -o DPkg::Lock::Timeout=300 install -y --no-install-recommends "${missing[@]}"
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
