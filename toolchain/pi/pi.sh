#!/usr/bin/env bash
# The emulated-Pi bench: Debian's arm64 kernel on an emulated machine, the cross-built station inside, the simulator outside
# at the other end of the emulated UART; flies a mission to its end. Called by `./run pi`; docs/emulated_pi.md.
# Exit code 0 only if the mission was completed and the drone landed inside the emulated machine.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
cd "$root"
# shellcheck source=toolchain/lib.sh
source toolchain/lib.sh
# shellcheck source=toolchain/unpack.sh
source toolchain/unpack.sh

usage='allowed: --rt --raspi3b --can --vcan --headless --out DIR --mission FILE --scene FILE --seed N --limit SECONDS'
error() { # error EXIT_CODE TEXT
  echo "run pi: error: $2" >&2
  exit "$1"
}

kernel_packages="machine arm64"
board=virt
can=false
vcan=false
headless=false
out=
mission=$root/config/missions/one_contact.mission.toml
scene=
seed=1
limit_s=900
while [[ $# -gt 0 ]]; do
  case $1 in
    --rt) kernel_packages="machine-rt arm64" ;;
    --raspi3b) board=raspi3b ;;
    --can) can=true ;;
    --vcan) vcan=true ;;
    --headless) headless=true ;;
    --out) out=${2:?--out needs a folder}; shift ;;
    --mission) mission=${2:?--mission needs a file}; shift ;;
    --scene) scene=${2:?--scene needs a file}; shift ;;
    --seed) seed=${2:?--seed needs a number}; shift ;;
    --limit) limit_s=${2:?--limit needs seconds}; shift ;;
    *) error 2 "unknown option '$1'; $usage" ;;
  esac
  shift
done
name=$(basename "$mission" .mission.toml)
[[ -f $mission ]] || error 5 "$mission: no such mission file; see config/missions"
if [[ -z $scene ]]; then
  scene=$root/config/scenes/$name.scene.toml
  [[ -f $scene ]] || scene=$root/config/scenes/open.scene.toml
fi
[[ -f $scene ]] || error 5 "$scene: no such scene file; see config/scenes"
[[ $limit_s =~ ^[0-9]+$ ]] || error 2 "--limit $limit_s: not a number of seconds"
out=$(realpath -m "${out:-$root/flights/$(date +%Y%m%d-%H%M%S)-pi-$name}")
mkdir -p "$out"
rm -f "$out"/{flight.lcm,report.json,report.html,series.csv,*.svg,*.txt}

pi=$root/build/rpi-arm64
sysroot=$root/build/sysroot-arm64
base=$root/build/machine-arm64
read -r -d '' -a packages < <(packages_of "machine arm64") || true
unpack_packages arm64 "$base" only "${packages[@]}"
machine=$base
if [[ $kernel_packages != "machine arm64" ]]; then
  machine=$root/build/${kernel_packages/ /-}
  read -r -d '' -a packages < <(packages_of "$kernel_packages") || true
  unpack_packages arm64 "$machine" only "${packages[@]}"
fi
linux=("$machine"/boot/vmlinuz-*)
[[ -f ${linux[0]} ]] || error 1 "no kernel in $machine/boot; remove that folder and run this again"

work=$(mktemp -d "$root/build/pi.XXXXXX")
pids=()
stop() { # stop SIGNAL PID: ends a program, by force after five seconds, and waits for it
  local i
  kill -"$1" "$2" 2>/dev/null || true
  for ((i = 0; i < 50; i++)); do
    kill -0 "$2" 2>/dev/null || break
    sleep 0.1
  done
  kill -KILL "$2" 2>/dev/null || true
  wait "$2" 2>/dev/null || true
}
clean_up() {
  local pid
  for pid in "${pids[@]}"; do stop TERM "$pid"; done
  rm -rf "$work"
}
trap clean_up EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

# libraries_of FILE…: the shared libraries that they need, also indirectly, as paths in the sysroot.
libraries_of() {
  local -A seen=()
  local queue=("$@") file library path
  while [[ ${#queue[@]} -gt 0 ]]; do
    file=${queue[0]}
    queue=("${queue[@]:1}")
    while read -r library; do
      [[ -z ${seen[$library]:-} ]] || continue
      seen[$library]=1
      for path in "$sysroot"/{lib,usr/lib}/aarch64-linux-gnu/"$library" "$sysroot/lib/$library"; do
        [[ -e $path ]] || continue
        echo "$path"
        queue+=("$path")
        break
      done
    done < <(aarch64-linux-gnu-objdump -p "$file" | awk '$1 == "NEEDED" { print $2 }')
  done
}

# The initial RAM file system holds all that runs inside: busybox, kernel modules, the programs, their libraries, config.
make_initramfs() {
  local tree=$work/initramfs programs program module file
  mkdir -p "$tree"/{bin,lib/aarch64-linux-gnu,modules,opt/tautline/bin,proc,sys,dev}
  cp "$base/bin/busybox" "$tree/bin/"
  cp toolchain/pi/init.sh "$tree/init"
  programs=("$pi/bin/tautline-station" "$pi/bin/tautline" "$sysroot/usr/bin/lcm-logger")
  ! $can || programs+=("$base/usr/bin/slcand")
  ! $vcan || programs+=("$pi/test/drivers_vcan_test")
  for program in "${programs[@]}"; do
    aarch64-linux-gnu-strip -o "$tree/opt/tautline/bin/$(basename "$program")" "$program"
  done
  while read -r file; do cp -L "$file" "$tree/lib/aarch64-linux-gnu/"; done < <(libraries_of "${programs[@]}")
  cp -L "$sysroot/lib/ld-linux-aarch64.so.1" "$tree/lib/"
  mkdir -p "$tree/opt/tautline/config"
  cp -r config/missions config/scenes "$tree/opt/tautline/config/"
  {
    ! $can || echo 'device = "tautline-can"'
    cat config/station_emulated_pi.toml
  } >"$tree/opt/tautline/config/station.toml"
  cp "$mission" "$tree/opt/tautline/config/missions/"
  cp "$scene" "$tree/opt/tautline/config/scenes/"
  # In this order; those that a board does not have are left out inside.
  for module in virtio_pci_legacy_dev virtio_pci_modern_dev virtio_pci netfs fscache 9pnet 9pnet_virtio 9p \
    bcm2835 mmc_block can can-raw can-dev vcan slcan; do
    file=$(find "$machine/lib/modules" -path '*/kernel/*' ! -path '*/staging/*' -name "$module.ko" | head -n 1)
    [[ -n $file ]] || continue
    cp "$file" "$tree/modules/"
    echo "$module" >>"$tree/modules/order"
  done
  cat >"$tree/job" <<EOF
mission='$(basename "$mission")'
scene='$(basename "$scene")'
collect=$([[ $board == virt ]] && echo 9p || echo sd)
device=/dev/ttyAMA0
slcan=$($can && echo can0 || true)
vcan_test=$($vcan && echo drivers_vcan_test || true)
started_at=$(date +%s)
limit_s=$limit_s
EOF
  (cd "$tree" && find . | cpio --quiet -o -H newc -R 0:0) | zstd -q -1 >"$work/initramfs.zst"
}

what="flying $name (seed $seed)"
! $can || what+=" over SLCAN"
! $vcan || what="SocketCAN tests"
say "$what on an emulated ${board/virt/Cortex-A72}; log and pictures go to $out"
make_initramfs
# Both ends run against the wall clock: where that is allowed, they come before the host's ordinary processes.
prefer() { # prefer PRIORITY PID
  chrt --all-tasks --rr --pid "$1" "$2" 2>/dev/null || true
}
link=$work/uart
build/bin/tautline-sim "$($can && echo --slcan || echo --pty)" "$link" --scene "$scene" --seed "$seed" --config config/sim.toml --no-lcm >"$out/sim.txt" 2>&1 &
sim=$!; pids+=("$sim")
prefer 21 "$sim"
for _ in $(seq 100); do [[ -e $link ]] && break; sleep 0.1; done
[[ -e $link ]] || error 1 "the simulator did not start: $(tail -n 1 "$out/sim.txt")"

# The station's UART is the PL011, as on the board; the console is another port. The PL011 is the machine's first serial port.
arguments=(-display none -monitor none -no-reboot -kernel "${linux[0]}" -initrd "$work/initramfs.zst"
  -chardev "serial,id=uart,path=$(readlink "$link")" -serial chardev:uart
  -chardev "file,id=console,path=$out/console.txt")
append="quiet loglevel=3 panic=-1 tautline.emulated_uart"
if [[ $board == virt ]]; then
  arguments+=(-M virt -cpu cortex-a72 -smp 1 -m 512 -net none
    -device "pci-serial,chardev=console"
    -virtfs "local,path=$out,mount_tag=out,security_model=none")
  append+=" console=ttyS0"
else
  # The board's Bluetooth would claim the PL011.
  cp "$base"/usr/lib/linux-image-*/broadcom/bcm2837-rpi-3-b.dtb "$work/board.dtb"
  fdtput -r "$work/board.dtb" /soc/serial@7e201000/bluetooth
  truncate -s 64M "$work/card"
  arguments+=(-M raspi3b -dtb "$work/board.dtb" -serial chardev:console -drive "if=sd,format=raw,file=$work/card")
  append+=" console=ttyS1,115200"
fi
qemu-system-aarch64 "${arguments[@]}" -append "$append" >"$out/qemu.txt" 2>&1 </dev/null &
qemu=$!; pids+=("$qemu")
[[ $board != virt ]] || prefer 20 "$qemu"  # the four processors of raspi3b spin while it boots
SECONDS=0

# Shows the lines that the machine has for us, and waits for its last one, its end, or the limit.
shown=0
code=
while [[ -z $code ]]; do
  sleep 0.5
  alive=true
  kill -0 "$qemu" 2>/dev/null || alive=false
  # Whole lines only: the last one may still be being written.
  touch "$out/console.txt"
  mapfile -t lines < <(head -n "$(wc -l <"$out/console.txt")" "$out/console.txt" | tr -d '\r' | sed -n 's/^pi: //p')
  for line in "${lines[@]:shown}"; do
    if [[ $line == "exit "* ]]; then code=${line#exit }; else $headless || echo "  $line"; fi
    [[ $line != "booted in"* ]] || prefer 20 "$qemu"
  done
  shown=${#lines[@]}
  [[ -z $code ]] || break
  $alive || code=4
  if ((SECONDS >= limit_s)); then
    echo "run pi: error: not done within $limit_s s; --limit gives it longer" >&2
    code=4
  fi
done
wall_s=$SECONDS
for _ in $(seq 50); do kill -0 "$qemu" 2>/dev/null || break; sleep 0.1; done
stop TERM "$qemu"
stop TERM "$sim"
pids=()
[[ $board == virt ]] || tar -x -f "$work/card" -C "$out" 2>/dev/null || true
if $vcan && ((code == 0)); then
  sed -n 's/^pi: \(kernel\|architecture\|booted in\) /\1 /p' "$out/console.txt" | tr -d '\r'
  tail -n 2 "$out/vcan.txt"
  echo "log         $out/vcan.txt"
  exit 0
fi
if ((code != 0)) || [[ ! -s $out/flight.lcm ]]; then
  for log in "$out"/{qemu,console,station,operator,sim}.txt; do
    [[ -s $log ]] && { echo "--- $log" >&2; tail -n 5 "$log" >&2; }
  done
  ((code != 0)) || code=1
  error "$code" "the mission was not flown to its end on the emulated machine ($wall_s s); logs are in $out"
fi

verdict=0
build/bin/tautline report "$out/flight.lcm" --out "$out" --scene "$scene" --require-success || verdict=1
sed -n 's/^pi: \(kernel\|architecture\|booted in\) /\1 /p' "$out/console.txt" | tr -d '\r'
python3 - "$out/report.json" <<'EOF'
import json, sys
loop = json.load(open(sys.argv[1]))["loop"]
print("loop        ", ", ".join(f"{key} {value:.6g}" if isinstance(value, float) else f"{key} {value}" for key, value in loop.items()))
EOF
say "report $out/report.html"
echo "log         $out/flight.lcm"
exit $verdict
