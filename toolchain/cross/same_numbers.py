#!/usr/bin/env python3
"""Compares two LCM logs of one flight, number by number in full precision: the largest difference of each field.

usage: same_numbers.py LCMTYPES_DIR TOLERANCE LOG_A LOG_B
exit code 0 if both have the same messages in the same order and no floating-point field differs by more than TOLERANCE
(in the field's own SI unit; more than 1 in size: relative); fields that are no floating-point numbers must be equal
"""
import pathlib
import re
import struct
import sys

CHANNELS = {"COMMAND": "command_t", "ESTIMATE": "estimate_t", "TETHER_STATE": "tether_state_t", "SIM_TRUTH": "sim_truth_t"}
CODES = {"double": "d", "float": "f", "int64_t": "q", "int32_t": "i", "int16_t": "h", "int8_t": "b", "boolean": "b"}
FIELD = re.compile(r"^\s*(\w+)\s+(\w+)(?:\[(\d+)\])?;")


def fields_of(folder, name):
    """(field, is it a floating-point number, struct code) for each number in a message."""
    out = []
    for line in (folder / f"{name}.lcm").read_text(encoding="utf-8").splitlines():
        match = FIELD.match(line)
        if match and match[1] in CODES:
            out += [(match[2], match[1] in ("double", "float"), CODES[match[1]])] * int(match[3] or 1)
    return out


def messages(path):
    """(channel, payload) of an LCM event log."""
    data = pathlib.Path(path).read_bytes()
    at = 0
    while at + 28 <= len(data):
        sync, _, _, channel_size, size = struct.unpack_from(">IqqII", data, at)
        if sync != 0xEDA1DA01:
            raise SystemExit(f"same_numbers: error: {path}: byte {at} does not begin an event; not an LCM log")
        at += 28
        yield data[at:at + channel_size].decode(), data[at + channel_size:at + channel_size + size]
        at += channel_size + size


def main():
    if len(sys.argv) != 5:
        raise SystemExit(__doc__)
    folder, tolerance = pathlib.Path(sys.argv[1]), float(sys.argv[2])
    layout = {channel: fields_of(folder, name) for channel, name in CHANNELS.items()}
    a, b = ([m for m in messages(log) if m[0] in CHANNELS] for log in sys.argv[3:5])
    if [channel for channel, _ in a] != [channel for channel, _ in b]:
        raise SystemExit(f"same_numbers: error: not the same messages: {len(a)} and {len(b)}")
    if not a:
        raise SystemExit("same_numbers: error: no messages to compare")
    worst, different = {}, {}
    for (channel, left), (_, right) in zip(a, b):
        code = ">8x" + "".join(c for _, _, c in layout[channel])
        for (name, floating, _), x, y in zip(layout[channel], struct.unpack(code, left), struct.unpack(code, right)):
            key = f"{channel}.{name}"
            if floating:
                size = 0.0 if x == y else abs(x - y) / max(1.0, abs(x))
                worst[key] = max(worst.get(key, 0.0), size if size == size else float("inf"))
            elif x != y:
                different[key] = different.get(key, 0) + 1
    largest = sorted(worst.items(), key=lambda item: -item[1])
    print(f"{len(a)} messages; largest differences: " + ", ".join(f"{key} {size:.1e}" for key, size in largest[:4]))
    if different:
        print("different: " + ", ".join(f"{key} in {n} messages" for key, n in different.items()))
    return 1 if different or largest[0][1] > tolerance else 0


if __name__ == "__main__":
    sys.exit(main())
