#!/usr/bin/env bash
# Tries the packages of ./run package in a fresh Debian 12 of their own: install, services verified by systemd, upgrade that
# keeps a changed config, removal, purge; and the services running under a systemd of their own (systemd-nspawn). Needs root;
# takes some minutes; uses this machine's own package sources.
#
#     sudo toolchain/packaging/try_packages.sh [FOLDER_OF_PACKAGES]
# shellcheck disable=SC2016  # what stands in single quotes is for apt or for a shell inside
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
# shellcheck source=toolchain/lib.sh
source "$root/toolchain/lib.sh"
packages=$(realpath "${1:-$root/build/package}")
[[ $(id -u) == 0 ]] || { echo "try_packages: error: a chroot needs root" >&2; exit 1; }
arch=$(dpkg --print-architecture)
compgen -G "$packages/tautline-station_*_$arch.deb" >/dev/null || {
  echo "try_packages: error: no packages for $arch in $packages; ./run package makes them" >&2
  exit 5
}

work=$(mktemp -d)
jail=$work/debian
clean_up() {
  local mount
  for mount in proc sys; do umount "$jail/$mount" 2>/dev/null || true; done
  rm -rf --one-file-system "$work"
}
trap clean_up EXIT
passed=0
failed=0
check() { # check WHAT COMMAND…
  local what=$1
  shift
  if "$@" >"$work/last.txt" 2>&1; then
    passed=$((passed + 1))
    echo "ok      $what"
  else
    failed=$((failed + 1))
    echo "FAILED  $what"
    tail -n 15 "$work/last.txt"
  fi
}
inside() { chroot "$jail" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C DEBIAN_FRONTEND=noninteractive "$@"; }
absent() { [[ ! -e $jail/$1 ]]; }
not() { ! "$@"; }

mount_kernel() {
  mount -t proc proc "$jail/proc"
  mount -t sysfs -o ro sysfs "$jail/sys"
}

make_jail() {
  local mirror
  mirror=$(apt-get indextargets --format '$(CODENAME) $(LABEL) $(REPO_URI)' 'Created-By: Packages' |
    awk '$1 == "bookworm" && $2 == "Debian" { print $3; exit }')
  [[ -n $mirror ]] || { echo "try_packages: error: this machine knows no mirror of Debian 12" >&2; exit 1; }
  say "a fresh Debian 12"
  quietly debootstrap --variant=minbase --include=systemd,systemd-sysv,udev,dbus bookworm "$jail" "$mirror"
  cp /etc/resolv.conf /etc/hosts "$jail/etc/"
  mount_kernel
  printf '#!/bin/sh\nexit 101\n' >"$jail/usr/sbin/policy-rc.d"
  chmod +x "$jail/usr/sbin/policy-rc.d"
  quietly inside apt-get update
}

# The same packages with a higher version.
make_next_version() {
  mkdir -p "$work/next" "$jail/packages" "$jail/next"
  local deb tree version
  for deb in "$packages"/tautline-*_"$arch".deb; do
    tree=$work/tree
    rm -rf "$tree"
    dpkg-deb --raw-extract "$deb" "$tree"
    version=$(dpkg-deb --field "$deb" Version)+next
    sed -i "s/^Version: .*/Version: $version/" "$tree/DEBIAN/control"
    [[ ! -d $tree/etc/tautline ]] || echo "# a new default" >>"$tree/etc/tautline/logger.conf"
    quietly dpkg-deb --root-owner-group --build "$tree" "$work/next"
    cp "$deb" "$jail/packages/"
  done
  cp "$work/next"/*.deb "$jail/next/"
}

# Boots the jail with the installed packages and lets service_probe.sh look at the services.
try_services() {
  install -m 755 "$root/toolchain/packaging/service_probe.sh" "$jail/usr/local/bin/service_probe"
  cat >"$jail/etc/systemd/system/probe.service" <<'UNIT'
[Unit]
After=basic.target
[Service]
Type=oneshot
ExecStart=/usr/local/bin/service_probe
[Install]
WantedBy=multi-user.target
UNIT
  # Where this machine may not raise limits (a container), the rights come as capabilities.
  if ! prlimit --memlock=unlimited:unlimited true 2>/dev/null; then
    echo "note    limits cannot be raised here; the station gets CAP_SYS_NICE and CAP_IPC_LOCK instead"
    mkdir -p "$jail/etc/systemd/system/tautline-station.service.d"
    printf '[Service]\nAmbientCapabilities=CAP_SYS_NICE CAP_IPC_LOCK\n' >"$jail/etc/systemd/system/tautline-station.service.d/rights.conf"
  fi
  quietly inside systemctl enable probe.service
  umount "$jail/proc" "$jail/sys"
  cp "$jail/etc/tautline/station.toml" "$work/station.toml"
  timeout 240 systemd-nspawn --quiet --directory="$jail" --register=no --keep-unit --private-network --capability=all --boot \
    >"$work/boot.log" 2>&1 || true
  cp "$work/station.toml" "$jail/etc/tautline/station.toml"
  mount_kernel
  inside systemctl disable probe.service >/dev/null 2>&1
  rm -rf "$jail"/etc/systemd/system/{probe.service,tautline-station.service.d}
  [[ -s $jail/probe.txt ]] || tail -n 20 "$work/boot.log"
  cat "$jail/probe.txt" || true
  passed=$((passed + $(grep -c '^ok' "$jail/probe.txt")))
  failed=$((failed + $(grep -c '^FAILED' "$jail/probe.txt" || true)))
  # The last line is there only if all of them were asked.
  check "all services were tried" grep -q "no unit failed" "$jail/probe.txt"
  ! grep -q '^FAILED' "$jail/probe.txt" || tail -n 60 "$jail/probe.log"
}

make_jail
make_next_version
install_all() { inside sh -c "apt-get install -y --no-install-recommends -o Dpkg::Options::=--force-confold /$1/*.deb"; }

say "install"
check "install, dependencies from Debian" install_all packages
for program in tautline-station tautline tautline-sim tautline-plan; do
  check "$program runs" inside "$program" --version
done
check "shipped config is right" inside tautline-station --config /etc/tautline/station.toml --check-config
check "simulator's config is right" inside tautline-sim --config /usr/share/tautline/sim.toml --scene /usr/share/tautline/scenes/one_contact.scene.toml --check-config
check "a shipped mission is right" inside tautline mission check /usr/share/tautline/missions/square.mission.toml
check "systemd-analyze verify" inside sh -c '
  out=$(systemd-analyze verify --man=no /lib/systemd/system/tautline-*.service tautline-can@can0.service 2>&1 | grep tautline)
  echo "$out"; [ -z "$out" ]'
check "udev rules are syntactically right" inside sh -c '
  out=$(udevadm test --action=add /devices/virtual/tty/tty0 2>&1 | grep "60-tautline.rules:[0-9]"); echo "$out"; [ -z "$out" ]'
check "user and group" inside sh -c 'id tautline && getent group tautline'
check "logs belong to it" inside sh -c '[ "$(stat -c %U:%G /var/log/tautline)" = tautline:tautline ]'
check "nothing is enabled by itself" inside sh -c '! ls /etc/systemd/system/*.wants/tautline* 2>/dev/null'

say "services"
try_services
check "services can be enabled" inside systemctl enable tautline-station tautline-logger tautline-governor

say "upgrade"
echo "# mine" >>"$jail/etc/tautline/logger.conf"
touch "$jail/var/log/tautline/flight.lcm"
check "upgrade" install_all next
check "a changed config stays" grep -q '^# mine$' "$jail/etc/tautline/logger.conf"
check "the new default is beside it" grep -q 'a new default' "$jail/etc/tautline/logger.conf.dpkg-dist"
check "services stay enabled" inside systemctl is-enabled tautline-station tautline-logger
check "logs stay" test -e "$jail/var/log/tautline/flight.lcm"

say "remove and purge"
check "remove" inside apt-get remove -y tautline-station
check "config stays" test -e "$jail/etc/tautline/station.toml"
check "logs stay" test -e "$jail/var/log/tautline/flight.lcm"
check "the service is not enabled any more" inside sh -c '! ls /etc/systemd/system/*.wants/tautline* 2>/dev/null'
check "install again over kept config" install_all next
check "purge" inside sh -c 'apt-get purge -y "tautline-*"'
for path in etc/tautline var/log/tautline usr/bin/tautline-station lib/systemd/system/tautline-station.service \
  lib/udev/rules.d/60-tautline.rules etc/security/limits.d/tautline.conf usr/share/tautline; do
  check "gone: /$path" absent "$path"
done
check "dpkg knows nothing of it" not inside sh -c 'dpkg-query -W "tautline-*" 2>/dev/null | grep -q .'
echo "$passed passed, $failed failed"
[[ $failed == 0 ]]
