#!/bin/busybox sh
# shellcheck shell=dash
# First process of the emulated Raspberry Pi of `./run pi` (toolchain/pi/pi.sh, docs/emulated_pi.md): brings the machine up,
# flies one mission with the programs of /opt/tautline, hands the results out, ends. Lines that begin with "pi: " on the
# console are for the host; the last one is "pi: exit CODE".
/bin/busybox mkdir -p /proc /sys /dev /tmp /mnt /usr/bin /usr/sbin /sbin
/bin/busybox --install -s
export PATH=/opt/tautline/bin:/usr/sbin:/usr/bin:/sbin:/bin
mission='' scene='' collect='' device='' slcan='' vcan_test='' started_at='' limit_s=''
# shellcheck source=/dev/null
. /job

tell() { printf '\npi: %s\n' "$*" >/dev/console; }
finish() { # finish CODE [WHY]
  [ -z "${2:-}" ] || tell "error: $2"
  hand_out
  tell "exit $1"
  sync
  poweroff -f
  sleep 3600  # a board that cannot switch itself off is ended by the host
}

hand_out() {
  dmesg >/flight/dmesg.txt
  case $collect in
    9p) cp /flight/* /mnt/ && sync && umount /mnt ;;
    sd) (cd /flight && tar -c -- *) | dd of=/dev/mmcblk0 bs=64k 2>/dev/null && sync ;;
  esac || tell "error: the results could not be handed out"
}

mount -t proc proc /proc
mount -t sysfs sysfs /sys
mount -t devtmpfs devtmpfs /dev
mkdir -p /dev/pts /dev/shm /flight
mount -t devpts devpts /dev/pts
mount -t tmpfs tmpfs /dev/shm
mount -t tmpfs tmpfs /flight
exec </dev/null >/dev/console 2>&1
while read -r module; do [ ! -f "/modules/$module.ko" ] || insmod "/modules/$module.ko"; done </modules/order
date -s "@$started_at" >/dev/null
# As the system's unit for the station does it: memory and priority for the loop, a multicast route for LCM.
ulimit -l unlimited
ip link set lo up
ifconfig lo multicast
ip route add 224.0.0.0/4 dev lo

tell "kernel       $(uname -r) $(uname -v)"
tell "architecture $(uname -m), $(tr -d '\0' </proc/device-tree/model), $(grep -c ^processor /proc/cpuinfo) processor(s), CPU part $(sed -n 's/^CPU part.*: //p' /proc/cpuinfo | head -n 1)"
if [ "$collect" = 9p ]; then
  mount -t 9p -o trans=virtio,version=9p2000.L,msize=262144 out /mnt || finish 4 "the host's folder cannot be mounted"
fi
i=0
until [ -c "$device" ]; do
  i=$((i + 1)); [ $i -lt 50 ] || finish 4 "no serial port $device"
  sleep 0.2
done
tell "booted in    $(cut -d' ' -f1 /proc/uptime) s"

if [ -n "$vcan_test" ]; then
  ip link add vcan0 type vcan && ip link set vcan0 up || finish 1 "no vcan in this kernel"
  "$vcan_test" >/flight/vcan.txt 2>&1
  code=$?
  tell "$(grep -c '^\[       OK' /flight/vcan.txt) SocketCAN tests passed, $(grep -c '^\[  FAILED  \] [A-Z].*(' /flight/vcan.txt) failed, $(grep -c '^\[  SKIPPED \] [A-Z].*(' /flight/vcan.txt) skipped"
  finish $code
fi
if [ -n "$slcan" ]; then
  # The kernel's line discipline makes a CAN interface of the serial line: 500 kbit/s (-s6), opened (-o).
  slcand -o -s6 "$device" "$slcan" || finish 4 "the serial port cannot be made a CAN adapter"
  ip link set "$slcan" up || finish 4 "the CAN interface $slcan cannot be brought up"
  device=$slcan
fi

lcm-logger --quiet --lcm-url="udpm://239.255.76.67:7667?ttl=0" /flight/flight.lcm >/flight/logger.txt 2>&1 &
logger=$!
tautline-station --config /opt/tautline/config/station.toml --device "$device" \
  --scene "/opt/tautline/config/scenes/$scene" >/flight/station.txt 2>&1 &
station=$!

# Result of a command in /flight/operator.txt, and on the console.
operator() {
  tautline "$@" >/flight/said 2>&1
  operator_code=$?
  cat /flight/said >>/flight/operator.txt
  tell "$(tail -n 1 /flight/said)"
  return $operator_code
}
# again TIMES COMMAND…: until it succeeds. An emulated processor that the host lets stand still for a second makes the
# sensors stale, and the station rightly refuses or holds; then the operator asks again, as one would.
again() {
  left=$1
  shift
  until "$@"; do
    left=$((left - 1)); [ $left -gt 0 ] || return 1
    sleep 2
  done
}
get_airborne() { operator arm && operator takeoff --timeout 120; }
fly() {
  tautline status --wait 60 >>/flight/operator.txt 2>&1 ||
    { tell "error: the station did not start: $(tail -n 1 /flight/station.txt)"; return 4; }
  for flight in 1 2 3; do
    [ $flight = 1 ] || tell "flight $flight"
    # A flight that was broken off leaves its faults to be looked at; to disarm says that they were.
    [ $flight = 1 ] || again 10 operator disarm
    again 10 get_airborne || return 3
    operator navigate "/opt/tautline/config/missions/$mission" --timeout "$limit_s"
    navigated=$?
    again 3 operator land --timeout 180 && [ $navigated = 0 ] && return 0
  done
  return 1
}
fly
code=$?
sleep 2  # the log's last seconds show the drone on the ground, rotors still
kill -TERM $station; wait $station
kill -INT $logger; wait $logger
rm -f /flight/said
tell "flown in     $(cut -d' ' -f1 /proc/uptime) s since power-on"
finish $code
