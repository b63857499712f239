#!/usr/bin/env python3
"""Compares two JSON documents: the same keys, texts and counts, and numbers that differ by TOLERANCE at most.

usage: same_json.py TOLERANCE FILE_A FILE_B
exit code 0 if they agree; a number above 1 is compared relatively. Left out: how long it took (keys that end with _ms)
"""
import json
import sys


def differences(a, b, where="$"):
    """(place, size) of every pair of numbers; size is infinite for anything else that is not equal."""
    if isinstance(a, dict) and isinstance(b, dict) and a.keys() == b.keys():
        for key in a:
            if not key.endswith("_ms"):
                yield from differences(a[key], b[key], f"{where}.{key}")
    elif isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        for i, (x, y) in enumerate(zip(a, b)):
            yield from differences(x, y, f"{where}[{i}]")
    elif isinstance(a, float) and isinstance(b, float):
        yield where, abs(a - b) / max(1.0, abs(a))
    else:
        yield where, 0.0 if a == b else float("inf")


def main():
    if len(sys.argv) != 4:
        raise SystemExit(__doc__)
    tolerance = float(sys.argv[1])
    documents = []
    for path in sys.argv[2:]:
        with open(path, encoding="utf-8") as file:
            documents.append(json.load(file))
    found = list(differences(*documents))
    place, size = max(found, key=lambda item: item[1])
    print(f"{len(found)} values; largest difference {size:.1e} at {place}")
    return 1 if not size <= tolerance else 0


if __name__ == "__main__":
    sys.exit(main())
