#!/usr/bin/env python3
"""`tautline log` on real logs and on real LCM: check, recover, info, export, report and replay of damaged logs, record."""
import csv
import json
import os
import pathlib
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from lcm_wire import BIN, CONFIG, Checks, Publisher, bench_log, read_log, skip_without_multicast, tautline, wait_for  # noqa: E402

PORT = 7693
URL = f"udpm://239.255.76.67:{PORT}?ttl=0"
NAME = r"\d{4}-\d\d-\d\dT\d\d-\d\d-\d\dZ"
checks = Checks()
started = []


def damaged_logs(whole, folder):
    """(path, numbers of the events that no byte of the damage touched)."""
    raw, events, at = whole.read_bytes(), [], 0
    for number, _, channel, data in read_log(whole):
        size = 28 + len(channel) + len(data)
        events.append((number, at, at + size))
        at += size
    holes = [(997 * 1000, 997 * 1000 + 8192), (4096 * 300, 4096 * 301), (len(raw) - 100_003, len(raw))]
    for i, (begin, end) in enumerate(holes):
        path = folder / f"damaged_{i}.lcm"
        cut = end == len(raw)
        path.write_bytes(raw[:begin] + (b"" if cut else bytes(end - begin) + raw[end:]))
        yield path, [n for n, first, last in events if last <= begin or first >= end], len(events), cut


def try_check_and_recover(whole, folder):
    original = read_log(whole)
    run = tautline("log", "check", whole)
    checks("a whole log", run.returncode == 0 and f"{len(original)} events whole" in run.stdout and "no damage" in run.stdout,
           run.stdout + run.stderr)
    for path, kept, all_events, cut in damaged_logs(whole, folder):
        run = tautline("log", "check", path, "--json")
        checks.equal(f"{path.name}: check's exit code", run.returncode, 1)
        found = json.loads(run.stdout)
        checks.equal(f"{path.name}: events left", found["events"], len(kept))
        lost = sum(d["events_lost"] for d in found["damage"])
        checks.equal(f"{path.name}: events lost", lost, 1 if cut else all_events - len(kept))
        before = path.read_bytes()
        mended = folder / f"mended_{path.name}"
        run = tautline("log", "recover", path, "-o", mended)
        checks(f"{path.name}: recover says what was lost", run.returncode == 1 and "lost" in run.stdout, run.stdout)
        checks(f"{path.name}: every whole event, and nothing else",
               [e[1:] for e in read_log(mended)] == [original[n][1:] for n in kept])
        checks.equal(f"{path.name}: the mended log is whole", tautline("log", "check", mended).returncode, 0)
        checks(f"{path.name}: the input is as it was", path.read_bytes() == before)
        report = tautline("report", path, "--out", folder / "report")
        checks(f"{path.name}: report says it", report.returncode == 0 and "damaged in 1 place" in report.stdout, report.stdout + report.stderr)
        replay = subprocess.run([BIN / "tautline-bench", "replay", path], capture_output=True, text=True, check=False)
        checks(f"{path.name}: replay says it", "damaged in 1 place" in replay.stdout, replay.stdout + replay.stderr)
        if cut:
            checks.equal("what is left of a cut flight is the same flight", replay.returncode, 0)
    link = folder / "link.lcm"
    link.symlink_to(whole)
    run = tautline("log", "recover", whole, "-o", link)
    checks("recover refuses its input under another name", run.returncode == 5 and len(read_log(whole)) == len(original), run.stderr)
    run = tautline("log", "recover", "/nowhere.lcm", "-o", folder / "none.lcm")
    checks("a missing log leaves no file", run.returncode == 5 and not list(folder.glob("none.lcm*")), run.stderr)
    run = tautline("log", "check", CONFIG / "station.toml")
    checks("what is no log", run.returncode == 5 and "no event" in run.stderr, run.stderr)


def try_info(whole):
    events = read_log(whole)
    info = json.loads(tautline("log", "info", whole, "--json").stdout)
    counts = {}
    for _, _, channel, _ in events:
        counts[channel] = counts.get(channel, 0) + 1
    checks.equal("messages a channel", {c["channel"]: c["messages"] for c in info["channels"]}, counts)
    checks.equal("time", (info["start_utime_us"], info["end_utime_us"]), (min(e[1] for e in events), max(e[1] for e in events)))
    checks.equal("run mode", info["run_modes"], ["HIL"] if "HIL" in info["run_modes"] else ["SIM"])
    modes = []
    for _, _, channel, data in events:
        if channel == "STATION_STATE" and (not modes or modes[-1] != data[17]):
            modes.append(data[17])
    names = ["STANDBY", "ARMED", "TAKEOFF", "HOLD", "TELEOP", "AUTO", "FAILSAFE", "BACKUP", "RETURN", "LAND", "DESCEND", "ESTOP"]
    checks.equal("modes", info["modes"], [names[m] for m in modes])
    checks.equal("one mission", len(info["missions"]), 1)
    text = tautline("log", "info", whole).stdout
    checks("for people", "STANDBY > ARMED > TAKEOFF > HOLD > AUTO" in text and re.search(r"ESTIMATE +tautline.estimate_t", text), text)


def try_export(whole, folder):
    events = [e for e in read_log(whole) if e[2] in ("ESTIMATE", "EVENT")]
    run = tautline("log", "export", whole, "--channel", "^(ESTIMATE|EVENT)$", "--csv", folder / "tables")
    checks.equal("export", run.returncode, 0)
    checks.equal("a table a channel", {p.name for p in (folder / "tables").iterdir()}, {"ESTIMATE.csv", "EVENT.csv"})
    with open(folder / "tables" / "ESTIMATE.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    estimates = [e for e in events if e[2] == "ESTIMATE"]
    checks.equal("a row a message", len(rows), len(estimates))
    checks("the values, exactly", all(
        (int(r["log_time_us"]), int(r["utime"])) == (e[1], struct.unpack_from(">q", e[3], 8)[0])
        and [float(r[f"position_m[{k}]"]) for k in range(3)] == list(struct.unpack_from(">3d", e[3], 18)) for r, e in zip(rows, estimates)))
    with open(folder / "tables" / "EVENT.csv", newline="", encoding="utf-8") as file:
        checks("texts", all(row["text"] and None not in row for row in csv.DictReader(file)))

    run = tautline("log", "export", whole, "--channel", "^(ESTIMATE|EVENT)$", "--jsonl", "-")
    lines = [json.loads(line) for line in run.stdout.splitlines()]
    checks.equal("a JSON line a message", len(lines), len(events))
    checks.equal("its keys", list(lines[0]), ["topic", "sequence", "log_time_ns", "publish_time_ns", "schema", "data"])
    checks("times in ns, types, topics", all(
        (line["topic"], line["sequence"], line["log_time_ns"], line["publish_time_ns"]) ==
        (e[2], e[0], e[1] * 1000, struct.unpack_from(">q", e[3], 8)[0] * 1000) and line["schema"] == f"tautline.{e[2].lower()}_t"
        for line, e in zip(lines, events)))
    checks.equal("neither table nor lines", tautline("log", "export", whole).returncode, 2)


class Recorder:
    """`tautline log record`, and what it says."""

    def __init__(self, folder, quota="1GB"):
        self.output = folder.parent / f"{folder.name}.txt"
        with open(self.output, "w", encoding="utf-8") as out:
            self.process = subprocess.Popen([BIN / "tautline", "log", "record", "--dir", folder, "--quota", quota, "--lcm-url", URL],
                                            stdout=out, stderr=out, start_new_session=True)
        started.append(self.process)
        wait_for(lambda: "waiting" in self.said())

    def said(self):
        return self.output.read_text(encoding="utf-8")

    def end(self, number=signal.SIGTERM):
        self.process.send_signal(number)
        return self.process.wait(10)


def fly(log, speed, until=None, publisher=None):
    """Sends a flight to LCM, so many times faster than it was flown; returns what was sent."""
    publisher = publisher or Publisher(PORT)
    begin, first, sent = time.monotonic(), log[0][1], []
    for event in log:
        if until and (event[1] - first) * 1e-6 > until:
            break
        time.sleep(max(0.0, (event[1] - first) * 1e-6 / speed - (time.monotonic() - begin)))
        if len(event[3]) < 60000:
            publisher.send(event[2], event[3])
            sent.append(event)
    return sent


def mode_of(event):
    return event[3][17] if event[2] == "STATION_STATE" else None


def try_record(whole, folder):
    log = read_log(whole)
    armed = next(i for i, e in enumerate(log) if mode_of(e))
    # One and a half seconds of STANDBY, the flight ten times as fast, and STANDBY for longer than the recorder waits.
    start = next(i for i, e in enumerate(log) if log[armed][1] - e[1] < 15_000_000)
    flight = log[start:]
    target = folder / "recorded"
    recorder = Recorder(target)
    publisher = Publisher(PORT)
    sent = fly(flight, 10, publisher=publisher)
    standby = [e for e in flight if mode_of(e) == 0][-1]
    for _ in range(25):
        publisher.send("STATION_STATE", standby[3])
        time.sleep(0.1)
    wait_for(lambda: "closed" in recorder.said())
    mission = json.loads(tautline("log", "info", whole, "--json").stdout)["missions"][0]
    files = list(target.iterdir())
    checks("one log, named by mission and run mode", len(files) == 1 and re.fullmatch(rf"{NAME}_{mission[:8]}_(SIM|HIL)\.lcm", files[0].name),
           files)
    recorded = [e for e in read_log(files[0]) if e[2] != "LOG_STATUS"]  # which is the recorder's own
    checks.equal("every message of the flight, in order", [e[2:] for e in recorded][:len(sent)], [e[2:] for e in sent][:len(recorded)])
    checks("to the end", len(recorded) >= len(sent), f"{len(recorded)} of {len(sent)}")
    checks.equal("it is whole", tautline("log", "check", files[0]).returncode, 0)
    checks("the report of it is that of a flight", json.loads(tautline(
        "report", files[0], "--json", "--out", folder / "recorded_report").stdout)["mission_completed"])

    # SIGTERM in flight.
    fly(flight, 10, until=10.0, publisher=publisher)
    checks("a silent station is said", wait_for(lambda: "the station is silent in flight; recording goes on" in recorder.said()), recorder.said())
    checks.equal("SIGTERM ends it", recorder.end(), 0)
    files = sorted(target.iterdir())
    checks.equal("two logs", len(files), 2)
    checks("the second is whole", all(tautline("log", "check", f).returncode == 0 for f in files), recorder.said())

    # kill -9 in flight: all but the last second is there.
    recorder = Recorder(folder / "killed")
    fly(flight, 4, until=20.0, publisher=publisher)
    recorder.end(signal.SIGKILL)
    (killed,) = (folder / "killed").iterdir()
    run = tautline("log", "check", killed, "--json")
    checks("after kill -9 the log is there up to the last second", json.loads(run.stdout)["events"] > 300, run.stdout)


def try_full_disk(whole, folder):
    """A small disk of our own (a mount namespace); it fills up in flight and gets room again."""
    if os.geteuid() != 0 or subprocess.run(["unshare", "-m", "true"], capture_output=True, check=False).returncode != 0:
        print("SKIPPED: no mount namespaces here, so a full disk cannot be tried")
        return
    log = read_log(whole)
    armed = next(i for i, e in enumerate(log) if mode_of(e))
    flight = log[armed:]
    disk = folder / "disk"
    disk.mkdir()
    script = f"""set -e; mount -t tmpfs -o size=2500k tmpfs {disk}; head -c 2000k /dev/zero > {disk}/other
        {BIN}/tautline log record --dir {disk} --quota 1GB --lcm-url '{URL}' & recorder=$!
        read -r _; rm {disk}/other; read -r _; kill -TERM $recorder; wait $recorder; cp {disk}/*.lcm {folder}/full.lcm"""
    with open(folder / "full.txt", "w", encoding="utf-8") as out:
        process = subprocess.Popen(["unshare", "-m", "bash", "-c", script], stdin=subprocess.PIPE, stdout=out, stderr=out, text=True,
                                   start_new_session=True)
    started.append(process)

    def said():
        return (folder / "full.txt").read_text(encoding="utf-8")

    wait_for(lambda: "waiting" in said())
    publisher = Publisher(PORT)
    sent = fly(flight, 10, until=15.0, publisher=publisher)
    checks("a full disk is said", wait_for(lambda: "No space left" in said()), said())
    process.stdin.write("\n")
    process.stdin.flush()
    fly(flight[len(sent):], 5, publisher=publisher)
    checks("so is room", wait_for(lambda: "room on the disk again" in said()), said())
    process.stdin.write("\n")
    process.stdin.flush()
    checks.equal("it went on to the end", process.wait(20), 0)
    run = tautline("log", "check", folder / "full.lcm", "--json")
    found = json.loads(run.stdout)
    lost = int(re.search(r"closed .* (\d+) lost", said()).group(1))
    checks("the log's own numbers tell how many events are lost", lost > 0 and
           [d["bytes"] for d in found["damage"]] == [0] * len(found["damage"]) and sum(d["events_lost"] for d in found["damage"]) == lost,
           f"{lost} {found['damage']}")


skip_without_multicast()
work = pathlib.Path(tempfile.mkdtemp())
try:
    flown = bench_log(work / "flight.lcm")
    try_check_and_recover(flown, work)
    try_info(flown)
    try_export(flown, work)
    try_record(flown, work)
    try_full_disk(flown, work)
finally:
    for program in started:  # what a failed check left behind
        if program.poll() is None:
            os.killpg(program.pid, signal.SIGKILL)
    shutil.rmtree(work, ignore_errors=True)
checks.finish()
