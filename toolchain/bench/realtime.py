#!/usr/bin/env python3
"""Lateness and cost of the station's cycles beside cyclictest in the same run, idle and under load. Called by ./run rt.

The real station flies the simulated machine; cyclictest runs at the same rate and priority at the same time, each on a
processor of its own, which they swap after half of the time. What is printed is measured, not judged: exit code 1 only
if a program fails. Every figure is in microseconds.
"""
import argparse
import json
import os
import subprocess
import sys
import time

from rig import Rig, RigError, arguments_or_end, main_of, quantile

PRIORITY = 50          # the station's own default
HISTOGRAM_US = 100000  # of cyclictest; beyond it counts as this
SHARES = {"p50": 0.5, "p99": 0.99, "p99.9": 0.999, "max": 1.0}


def cyclictest(rate_hz, seconds, cpu, path):
    return subprocess.Popen(["cyclictest", "--quiet", "--mlockall", "--threads=1", f"--priority={PRIORITY}", f"--affinity={cpu}",
                             f"--interval={1000000 // rate_hz}", f"--duration={seconds}", f"--histogram={HISTOGRAM_US}",
                             f"--histfile={path}"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)


def lateness_of(path):
    """Every wake-up that cyclictest counted, from its histogram."""
    values = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.startswith("#"):
            if line.startswith("# Histogram Overflows:"):
                values += [float(HISTOGRAM_US)] * int(line.split(":")[1])
            continue
        words = line.split()
        if len(words) == 2:
            values += [float(words[0])] * int(words[1])
    return values


def load(seconds):
    """Processor, memory and disk load for a bounded time."""
    return subprocess.Popen(["stress-ng", "--quiet", "--cpu", str(os.cpu_count()), "--vm", "1", "--vm-bytes", "64M", "--hdd", "1",
                             "--hdd-bytes", "64M", "--temp-path", "/tmp", "--timeout", f"{seconds}s"], stdout=subprocess.DEVNULL)


def measure(rig, rate_hz, seconds, loaded):
    """Station's cycles and cyclictest's wake-ups of the same `seconds`, half of them on each processor."""
    cpus = sorted(os.sched_getaffinity(0))[:2]
    cycles, wake_ups = [], []
    for mine, other in ((cpus[0], cpus[-1]), (cpus[-1], cpus[0])):
        os.sched_setaffinity(rig.station.pid, {mine})  # the loop is the main thread
        background = load(seconds // 2 + 2) if loaded else None
        time.sleep(1.0)
        path = rig.folder / "cyclictest.hist"
        begin = time.monotonic()
        beside = cyclictest(rate_hz, seconds // 2, other, path)
        _, complaint = beside.communicate()
        end = time.monotonic()
        if beside.returncode != 0:
            raise RigError(f"cyclictest: {complaint.strip()}; needs the right to SCHED_FIFO: tautline doctor --rt")
        if background:
            background.wait()
        wake_ups += lateness_of(path)
        cycles += rig.cycles(begin, end)
    if not cycles or not wake_ups:
        raise RigError(f"nothing was measured: {rig.said('tautline-station')}")
    station = {name: quantile([late for late, _ in cycles], share) for name, share in SHARES.items()}
    cost = {name: quantile([work for _, work in cycles], share) for name, share in SHARES.items()}
    cost["mean"] = sum(work for _, work in cycles) / len(cycles)
    reference = {name: quantile(wake_ups, share) for name, share in SHARES.items()}
    period_us = 1e6 / rate_hz
    return {"rate_hz": rate_hz, "load": loaded, "cycles": len(cycles), "station_lateness_us": station, "cyclictest_lateness_us": reference,
            "cycle_cost_us": cost, "p99_ratio": station["p99"] / max(reference["p99"], 1.0),
            "late_by_a_period": sum(late > period_us for late, _ in cycles)}


def row(r):
    def four(figures):
        return " ".join(f"{figures[name]:7.0f}" for name in SHARES)
    return (f"{r['rate_hz']:5d} {'load' if r['load'] else 'idle':4} {r['cycles']:6d} | {four(r['station_lateness_us'])} |"
            f" {four(r['cyclictest_lateness_us'])} | {r['p99_ratio']:6.2f} | {r['cycle_cost_us']['mean']:6.0f} {four(r['cycle_cost_us'])}")


def run(options):
    head = " ".join(f"{name:>7}" for name in SHARES)
    print(f"load of this machine before: {os.getloadavg()[0]:.2f} on {os.cpu_count()} processors; all figures in us, SCHED_FIFO {PRIORITY}")
    print(f"{'':17} | {'station lateness':31} | {'cyclictest lateness':31} | {'p99':6} | cost of a cycle")
    print(f"{'Hz':>5} {'':4} {'cycles':>6} | {head} | {head} | {'ratio':>6} | {'mean':>6} {head}", flush=True)
    results = []
    for rate_hz in (100, 1000):
        with Rig(options.bin, options.source, loop_rate_hz=rate_hz) as rig:
            rig.take_off()
            for loaded in (False, True):
                results.append(measure(rig, rate_hz, options.seconds, loaded))
                print(row(results[-1]), flush=True)
    close = sum(r["p99_ratio"] <= 1.2 for r in results)
    cheap = sum(r["cycle_cost_us"]["mean"] <= 50.0 for r in results)
    print(f"goals: p99 lateness within 1.2 x cyclictest's in {close} of {len(results)} rows, mean cost within 50 us in {cheap} of {len(results)}")
    if options.json:
        with open(options.json, "w", encoding="utf-8") as file:
            json.dump(results, file, indent=1)
    return 0


def main():
    parser = argparse.ArgumentParser(description="Lateness of the station beside cyclictest")
    parser.add_argument("--seconds", type=int, default=24, help="of each row; at most 30, what the black box holds at 1 kHz (default 24)")
    parser.add_argument("--json", help="also write the figures to this file")
    options = arguments_or_end(parser)
    if not 2 <= options.seconds <= 30:
        parser.error("--seconds must be 2 to 30")
    return main_of(lambda: run(options))


if __name__ == "__main__":
    sys.exit(main())
