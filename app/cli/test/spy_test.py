#!/usr/bin/env python3
"""`tautline spy` hears real LCM packets: as JSON, as a table, and on a terminal of 80 by 24 characters."""
import fcntl
import json
import os
import re
import select
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import threading
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from lcm_wire import BIN, Checks, Publisher, bench_log, read_log, skip_without_multicast, tautline  # noqa: E402

PORT = 7691
URL = f"udpm://239.255.76.67:{PORT}?ttl=0"
ROWS, COLUMNS = 24, 80
FOREIGN = bytes.fromhex("0123456789abcdef") + b"\x1b[31mred" * 2  # no type of ours, and not to be trusted by a terminal


class Station(threading.Thread):
    """A recorded flight, sent again and again at 20 Hz a channel, and one channel of a foreign type at 10 Hz."""

    def __init__(self, log):
        super().__init__(daemon=True)
        self.messages = {}
        for _, _, channel, data in log:
            self.messages.setdefault(channel, []).append(data)
        self.messages = {channel: data[len(data) // 2] for channel, data in self.messages.items() if len(data[0]) < 60000}
        self.running = True

    def run(self):
        publisher, tick = Publisher(PORT), time.monotonic()
        for i in range(10**6):
            if not self.running:
                return
            for channel, data in self.messages.items():
                publisher.send(channel, data)
            if i % 2 == 0:
                publisher.send("FOREIGN", FOREIGN)
            tick += 0.05
            time.sleep(max(0.0, tick - time.monotonic()))


def fresh_settings():
    """Those of a pseudo terminal that nobody has touched."""
    master, slave = os.openpty()
    settings = termios.tcgetattr(slave)
    os.close(master)
    os.close(slave)
    return settings


class Screen:
    """What a terminal would show of the few sequences that the program uses."""

    def __init__(self):
        self.clear()
        self.other_screen = self.cursor_hidden = False

    def clear(self):
        self.lines, self.row, self.column = [[" "] * COLUMNS for _ in range(ROWS)], 0, 0

    def feed(self, text):
        for sequence, end, plain in re.findall(r"\x1b\[([?0-9;]*)([A-Za-z])|([^\x1b])", text):
            if plain == "\r":
                self.column = 0
            elif plain == "\n":
                self.row = min(self.row + 1, ROWS - 1)
            elif plain:
                assert self.column < COLUMNS, f"written beyond the right edge: {''.join(self.lines[self.row])}"
                assert " " <= plain <= "~", f"control character {plain!r} reached the terminal"
                self.lines[self.row][self.column] = plain
                self.column += 1
            elif end == "H":
                self.row = self.column = 0
            elif end == "K":
                self.lines[self.row][self.column:] = [" "] * (COLUMNS - self.column)
            elif end == "J":
                for line in range(self.row + 1, ROWS):
                    self.lines[line] = [" "] * COLUMNS
            elif sequence == "?1049":
                self.other_screen = end == "h"
            elif sequence == "?25":
                self.cursor_hidden = end == "l"

    def text(self):
        return "\n".join("".join(line).rstrip() for line in self.lines)


class Session:
    """The program on a pseudo terminal."""

    def __init__(self, *arguments):
        self.fd, self.slave = os.openpty()  # the slave stays open, so that the settings outlive the program
        fcntl.ioctl(self.fd, termios.TIOCSWINSZ, struct.pack("HHHH", ROWS, COLUMNS, 0, 0))
        self.process = subprocess.Popen(
            [BIN / "tautline", "spy", "--lcm-url", URL, *arguments], stdin=self.slave, stdout=self.slave, stderr=self.slave,
            start_new_session=True, preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0))
        self.screen = Screen()

    def settle(self, seconds=0.7):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if select.select([self.fd], [], [], 0.05)[0]:
                try:
                    self.screen.feed(os.read(self.fd, 65536).decode("ascii"))
                except OSError:
                    break
        return self.screen.text()

    def until(self, pattern, seconds=8.0):
        end = time.monotonic() + seconds
        while time.monotonic() < end and not re.search(pattern, self.settle(0.1), re.M):
            pass
        return self.screen.text()

    def type(self, keys):
        os.write(self.fd, keys.encode())
        return self.settle()

    def end(self):
        """Exit code, after the last output was shown."""
        end = time.monotonic() + 5.0
        while self.process.poll() is None and time.monotonic() < end:
            self.settle(0.1)
        self.process.kill()
        self.settle(0.3)
        return self.process.wait()


def try_json(check, log):
    run = tautline("spy", "--json", "--once", "--for", "2", "--lcm-url", URL)
    check.equal("exit code", run.returncode, 0)
    channels = {c["channel"]: c for c in json.loads(run.stdout)["channels"]}
    check.equal("every channel is there", set(channels), {c for _, _, c, _ in log} | {"FOREIGN"})
    for name, channel in channels.items():
        wanted = 10.0 if name == "FOREIGN" else 20.0
        check(f"{name}: rate", abs(channel["rate_hz"] - wanted) < 0.15 * wanted, channel["rate_hz"])
        check(f"{name}: bytes", abs(channel["bytes_per_s"] - wanted * channel["size_bytes"]) < 0.15 * wanted * channel["size_bytes"],
              channel["bytes_per_s"])
        check(f"{name}: age", 0.0 <= channel["age_ms"] < 500.0, channel["age_ms"])
        check(f"{name}: jitter", 0.0 <= channel["jitter_ms"] < 40.0, channel["jitter_ms"])
    check.equal("a foreign type", (channels["FOREIGN"]["type"], channels["FOREIGN"]["size_bytes"], channels["FOREIGN"]["fields"]),
                (None, len(FOREIGN), None))
    check.equal("its fingerprint", channels["FOREIGN"]["fingerprint"], "0123456789abcdef")
    # The packet by hand: fingerprint, utime, run_mode, mode.
    state = channels["STATION_STATE"]["fields"]
    data = station.messages["STATION_STATE"]
    check.equal("STATION_STATE decoded", (state["utime"], state["run_mode"], state["mode"]), struct.unpack_from(">qbb", data, 8))
    check.equal("PARAMS decoded", channels["PARAMS"]["fields"]["program"], "tautline-bench")
    check.equal("ESTIMATE decoded", channels["ESTIMATE"]["fields"]["position_m"],
                list(struct.unpack_from(">3d", station.messages["ESTIMATE"], 8 + 8 + 1 + 1)))
    check("no channel of ours is undecoded", all(c["fields"] for n, c in channels.items() if n != "FOREIGN"))


def try_table(check):
    run = tautline("spy", "--once", "--for", "1", "--filter", "^EST", "--lcm-url", URL)
    check("a filtered table", run.returncode == 0 and re.search(r"^ESTIMATE +estimate_t", run.stdout, re.M)
          and "COMMAND" not in run.stdout, run.stdout + run.stderr)
    run = tautline("spy", "--once", "--for", "0.5", "--lcm-url", "udpm://239.255.76.67:7692?ttl=0")
    check.equal("nothing heard is exit code 4", run.returncode, 4)
    run = tautline("spy", "--once", "--filter", "[", "--lcm-url", URL)
    check("a bad filter", run.returncode == 2 and "regular expression" in run.stderr, run.stderr)
    run = tautline("spy", "--lcm-url", URL, stdin=-3)
    check("no terminal", run.returncode == 2 and "no terminal" in run.stderr, run.stderr)


def try_screen(check):
    session = Session()
    screen = session.until(r"^FOREIGN")
    check("another screen without a cursor", session.screen.other_screen and session.screen.cursor_hidden)
    check("channels with rates", re.search(r"^ESTIMATE +estimate_t +(19|20|21)\.\d\d", session.until(r"^ESTIMATE .* 20\.\d\d"), re.M), screen)
    check("a foreign type with its size", f"unknown, {len(FOREIGN)} B" in screen, screen)
    check("the keys on the last line", screen.split("\n")[-1].startswith("up/down choose"), screen)

    screen = session.type("/FOREIGN|ESTIM\r")
    check("a filter", "COMMAND" not in screen and re.search("^ESTIMATE", screen, re.M) and re.search("^FOREIGN", screen, re.M), screen)
    screen = session.type("/[\r")
    check("a bad filter is said, and can be left", "[_  is none" in screen, screen)
    session.type("\x1b")
    screen = session.type("\r")
    check("fields", re.search(r"position_m\[2\] +-?\d+\.\d+ +p_WD", screen) and "tautline.estimate_t" in screen, screen)
    check("with units and meaning", "0 ok 1 degraded 2 lost" in screen, screen)
    screen = session.type("\x1b[B" * 40)
    check("scrolled to the end", re.search(r"^nis", screen, re.M) and "utime" not in screen, screen)
    session.type("\x1b")
    screen = session.type("j\r")
    check("fields of a foreign type", "not decoded; fingerprint 0123456789abcdef" in screen, screen)
    session.type("\x1b")
    paused = session.type("p")
    check("paused", "PAUSED" in paused and paused == session.settle(1.0), paused)
    check("goes on", "PAUSED" not in session.type("p"))
    session.type("q")
    check.equal("q ends it", session.end(), 0)
    restored(check, "q", session)

    for name, ending in (("Ctrl-C", lambda s: os.write(s.fd, b"\x03")), ("SIGTERM", lambda s: s.process.send_signal(signal.SIGTERM)),
                         ("SIGHUP", lambda s: s.process.send_signal(signal.SIGHUP))):
        session = Session("--filter", "ESTIMATE")
        session.until(r"^ESTIMATE")
        ending(session)
        check.equal(f"{name} ends it", session.end(), 0)
        restored(check, name, session)


def restored(check, how, session):
    check(f"{how}: first screen and cursor are back", not session.screen.other_screen and not session.screen.cursor_hidden)
    check.equal(f"{how}: terminal settings are back", termios.tcgetattr(session.slave), fresh_settings())


skip_without_multicast()
checks = Checks()
with tempfile.TemporaryDirectory() as folder:
    flight = read_log(bench_log(os.path.join(folder, "flight.lcm")))
station = Station(flight)
station.start()
try_json(checks, flight)
try_table(checks)
try_screen(checks)
station.running = False
checks.finish()
