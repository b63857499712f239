#!/usr/bin/env bash
# Makes build/sysroot-arm64: the libraries and headers that the Raspberry Pi's programs are built with, from Debian's arm64
# packages. Needs no root. Does nothing if it is there and fits the list. Run by `./run cross`.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=toolchain/lib.sh
source toolchain/lib.sh
# shellcheck source=toolchain/unpack.sh
source toolchain/unpack.sh

read -r -d '' -a packages < <(packages_of "sysroot arm64") || true
unpack_packages arm64 "$PWD/build/sysroot-arm64" all "${packages[@]}"
