#!/usr/bin/env bash
# LCM types as Java classes in a jar, for lcm-spy (tautline spy --gui).
#
#     toolchain/java_types.sh OUT.jar FILE.lcm…
set -euo pipefail
out=$(realpath -m "$1")
shift
for need in lcm-gen javac jar /usr/share/java/lcm.jar; do
  command -v "$need" >/dev/null || [[ -e $need ]] || {
    echo "java_types: error: $need is missing; as root: apt-get install liblcm-bin liblcm-java default-jdk-headless" >&2
    exit 1
  }
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
lcm-gen -j --jpath "$work/source" "$@"
find "$work/source" -name '*.java' -exec javac -nowarn -cp /usr/share/java/lcm.jar -d "$work/classes" {} +
jar --create --file "$work/types.jar" -C "$work/classes" .
mv "$work/types.jar" "$out"
