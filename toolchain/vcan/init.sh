#!/bin/sh
# First process of the user-mode Linux of `./run vcan`: SocketCAN, a virtual bus, the job, power off. The kernel's command
# line gives it TAUTLINE_JOB, the folder with command.sh, and TAUTLINE_UML, the unpacked packages. Everything else is the
# host's file system.
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
box=$TAUTLINE_UML/bin/busybox
modules=$TAUTLINE_UML/usr/lib/uml/modules/$(uname -r)/kernel

set_up() {
  "$box" mount -t proc proc /proc &&
    "$box" mount -t sysfs sysfs /sys &&
    "$box" mkdir -p /dev/pts /dev/shm &&
    "$box" mount -t devpts devpts /dev/pts &&
    "$box" mount -t tmpfs tmpfs /dev/shm || return
  for module in net/can/can net/can/can-raw drivers/net/can/dev/can-dev drivers/net/can/vcan drivers/net/can/slcan/slcan; do
    "$box" insmod "$modules/$module.ko" || return
  done
  ip link set lo up && ip link add vcan0 type vcan && ip link set vcan0 up
}

if set_up >"$TAUTLINE_JOB/output" 2>&1; then
  /bin/bash "$TAUTLINE_JOB/command.sh" </dev/null >>"$TAUTLINE_JOB/output" 2>&1
  echo $? >"$TAUTLINE_JOB/exit_code"
fi
sync
"$box" poweroff -f
