"""LCM's packets and event logs in a few lines, independent of the code under test; and the programs of the build."""
import os
import pathlib
import socket
import struct
import subprocess
import sys
import time

BIN = pathlib.Path(os.environ["TAUTLINE_BIN"])
CONFIG = pathlib.Path(os.environ["TAUTLINE_SOURCE_DIR"]) / "config"
GROUP = "239.255.76.67"
SYNC = 0xEDA1DA01
SKIPPED = 77


class Publisher:
    """Sends short messages as LCM does: "LC02", sequence number, channel, 0, data."""

    def __init__(self, port):
        self.address = (GROUP, port)
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        self.sequence = 0

    def send(self, channel, data):
        self.socket.sendto(b"LC02" + struct.pack(">I", self.sequence) + channel.encode() + b"\0" + data, self.address)
        self.sequence += 1


def read_log(path):
    """[(number, time_us, channel, data)] of a log without damage."""
    raw = pathlib.Path(path).read_bytes()
    events, at = [], 0
    while at < len(raw):
        sync, number, utime, channel_size, data_size = struct.unpack_from(">IqqII", raw, at)
        if sync != SYNC:
            raise ValueError(f"{path}: no event at {at}")
        data_at = at + 28 + channel_size
        events.append((number, utime, raw[at + 28:data_at].decode(), raw[data_at:data_at + data_size]))
        at = data_at + data_size
    return events


def tautline(*arguments, **options):
    return subprocess.run([BIN / "tautline", *map(str, arguments)], capture_output=True, text=True, timeout=120, check=False, **options)


def bench_log(path, mission="square", scene="open"):
    """A whole flight, flown on the bench."""
    subprocess.run([BIN / "tautline-bench", "fly", "--mission", CONFIG / f"missions/{mission}.mission.toml", "--scene",
                    CONFIG / f"scenes/{scene}.scene.toml", "--log", path], check=True, capture_output=True, timeout=120)
    return path


def wait_for(condition, seconds=10.0):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.05)
    return False


class Checks:
    """Counts what holds and says what does not."""

    def __init__(self):
        self.passed = self.failed = 0

    def __call__(self, what, holds, detail=""):
        if holds:
            self.passed += 1
        else:
            self.failed += 1
            print(f"FAILED: {what}: {detail}")

    def equal(self, what, got, wanted):
        self(what, got == wanted, f"got {got!r}, wanted {wanted!r}")

    def finish(self):
        print(f"{self.passed} passed, {self.failed} failed")
        sys.exit(1 if self.failed or not self.passed else 0)


def skip_without_multicast():
    probe = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        probe.connect((GROUP, 7667))
    except OSError as error:
        print(f"SKIPPED: LCM has no multicast route here; ./run test makes one ({error})")
        sys.exit(SKIPPED)
