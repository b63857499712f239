#!/usr/bin/env python3
"""Drives `tautline teleop` through a pseudo terminal as fingers would. Usage: teleop_terminal.py TAUTLINE LCM_URL

Prints "all passed" and ends with 0, or says what went wrong and ends with 1.
"""
import os
import pty
import select
import subprocess
import sys
import termios
import time

TAUTLINE, URL = sys.argv[1:3]


class Session:
    """`tautline teleop` with a terminal of its own."""

    def __init__(self):
        self.master, self.slave = pty.openpty()
        self.before = termios.tcgetattr(self.slave)
        self.process = subprocess.Popen([TAUTLINE, "teleop", "--lcm-url", URL], stdin=self.slave, stdout=self.slave,
                                        stderr=self.slave, start_new_session=True)
        self.text = ""

    def read_for(self, seconds):
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            if select.select([self.master], [], [], left)[0]:
                self.text += os.read(self.master, 4096).decode(errors="replace")

    def wait_for(self, words, seconds):
        end = time.monotonic() + seconds
        while words not in self.text:
            if time.monotonic() > end:
                sys.exit(f"not seen in {seconds} s: {words!r}; the last was: {self.text[-300:]!r}")
            self.read_for(0.05)

    def press(self, keys):
        self.text = ""
        os.write(self.master, keys.encode())

    def hold_space(self, seconds):
        for _ in range(int(seconds / 0.033)):
            os.write(self.master, b" ")
            self.read_for(0.033)

    def ends_with(self, code, seconds):
        end = time.monotonic() + seconds
        while self.process.poll() is None:
            if time.monotonic() > end:
                sys.exit("teleop does not end")
            self.read_for(0.05)
        if self.process.returncode != code:
            sys.exit(f"exit code {self.process.returncode}, wanted {code}: {self.text[-300:]!r}")

    def terminal_is_as_before(self):
        if termios.tcgetattr(self.slave) != self.before:
            sys.exit("the terminal is not as it was before")


def main():
    s = Session()
    s.wait_for("TELEOP", 10)
    if termios.tcgetattr(s.slave)[3] & termios.ECHO:
        sys.exit("keys are echoed")
    s.press("w")
    s.wait_for("elevation +0.05", 2)
    s.wait_for("space?", 2)
    s.press("")
    s.hold_space(1.0)
    s.wait_for("FLYING", 2)
    s.press("")
    s.wait_for("space?", 2)  # released
    s.wait_for("elevation +0.00", 2)
    s.press("\x03")
    s.ends_with(0, 10)
    s.wait_for("holding", 1)
    s.terminal_is_as_before()

    # The terminal is lost: the station has to hear of it.
    s = Session()
    s.wait_for("TELEOP", 10)
    os.close(s.slave)
    os.close(s.master)
    s.process.wait(10)
    state = subprocess.run([TAUTLINE, "status", "--json", "--lcm-url", URL], capture_output=True, text=True).stdout
    if '"mode":"HOLD"' not in state:
        sys.exit(f"a lost terminal did not end in HOLD: {state}")
    print("all passed")


main()
