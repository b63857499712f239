#!/usr/bin/env python3
"""The real station flies missions of the simulated machine for a long time; nothing may grow. Called by ./run soak.

Exit code 0 only if every flight ended on the ground, both programs still run, and between the end of the first flight
and the last sample no program's memory, descriptors or threads grew.
"""
import argparse
import pathlib
import sys
import time

from rig import Rig, RigError, arguments_or_end, main_of

# The kernel counts resident pages in batches per processor, so the same memory is shown with a few pages more or less.
PAGES_OF_ACCOUNT_KIB = 256


def sample(process):
    """Resident memory [KiB], open descriptors and threads of a process."""
    proc = pathlib.Path("/proc") / str(process.pid)
    status = dict(line.split(":", 1) for line in (proc / "status").read_text(encoding="utf-8").splitlines())
    return {"rss_kib": int(status["VmRSS"].split()[0]), "descriptors": len(list((proc / "fd").iterdir())),
            "threads": int(status["Threads"])}


def fly_once(rig):
    rig.take_off()
    rig.tautline("navigate", rig.config / "missions" / "square.mission.toml", "--quiet")
    rig.tautline("land", "--quiet")


def grown(first, last):
    return [f"{key} {first[key]} -> {last[key]}" for key in first
            if last[key] > first[key] + (PAGES_OF_ACCOUNT_KIB if key == "rss_kib" else 0)]


def run(minutes, options):
    with Rig(options.bin, options.source) as rig:
        programs = {"tautline-station": rig.station, "tautline-sim": rig.simulator}
        end = time.monotonic() + minutes * 60.0
        first = {}
        flights = 0
        print(f"{'minute':>6} {'flights':>7}  " + "  ".join(f"{name}: RSS KiB, descriptors, threads" for name in programs), flush=True)
        while True:
            fly_once(rig)
            flights += 1
            for name, process in programs.items():
                if process.poll() is not None:
                    raise RigError(f"{name} ended: {rig.said(name)}")
            last = {name: sample(process) for name, process in programs.items()}
            first = first or last
            minute = minutes - (end - time.monotonic()) / 60.0
            print(f"{minute:6.1f} {flights:7d}  " + "  ".join(
                f"{name}: {s['rss_kib']} {s['descriptors']} {s['threads']}" for name, s in last.items()), flush=True)
            if time.monotonic() >= end:
                break
        rig.station.terminate()
        rig.station.wait(10)
        print(rig.said("tautline-station").strip())
        problems = [f"{name}: {growth}" for name in programs for growth in grown(first[name], last[name])]
    for problem in problems:
        print(f"grew: {problem}")
    print(f"{flights} flights in {minute:.1f} minutes, {'nothing grew' if not problems else 'growth'}")
    return 1 if problems else 0


def main():
    parser = argparse.ArgumentParser(description="Fly for a long time; nothing may grow")
    parser.add_argument("minutes", type=float, nargs="?", default=30.0)
    options = arguments_or_end(parser)
    return main_of(lambda: run(options.minutes, options))


if __name__ == "__main__":
    sys.exit(main())
