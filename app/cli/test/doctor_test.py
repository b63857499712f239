#!/usr/bin/env python3
"""Findings of `tautline doctor`, each provoked on the real machine: namespaces, limits, rights, small disks, held ports.

Most need root for that; without it they are left out, loudly. Every finding must carry value, limit and the command that mends it;
where that command can be run here, it is, and the finding must go away.
"""
import ctypes
import fcntl
import json
import os
import pathlib
import shlex
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from lcm_wire import BIN, CONFIG, Checks, skip_without_multicast, tautline, wait_for  # noqa: E402

URL = "udpm://239.255.76.67:7695?ttl=0"
ROOT = os.geteuid() == 0
checks = Checks()
work = pathlib.Path(tempfile.mkdtemp())
# As another user nothing below a private home can be started.
program = work / "tautline"
shutil.copy(BIN / "tautline", program)
work.chmod(0o755)


def config(device, name="fotokite", section="serial", key="device", run_mode="HIL"):
    path = work / f"{name}.toml"
    path.write_text(f'run_mode = "{run_mode}"\ndevice = "{name}"\nblack_box = "/dev/shm/tautline-doctor-test.blackbox"\n[{section}]\n{key} = "{device}"\n',
                    encoding="utf-8")
    return path


def doctor(*arguments, prefix=(), after=(), log_folder=work):
    """Findings by name, and the exit code; `prefix` starts the program, `after` is run by the same shell first."""
    command = [program, "doctor", "--json", "--seconds", "0.1", "--lcm-url", URL, "--log-dir", log_folder, *arguments]
    text = " ".join(shlex.quote(str(c)) for c in command)
    script = " && ".join([*after, text]) if after else text
    run = subprocess.run([*prefix, "bash", "-c", script], capture_output=True, text=True, timeout=60, check=False)
    try:
        answer = json.loads(run.stdout)
    except ValueError:
        sys.exit(f"doctor said no JSON: {run.stdout} {run.stderr}")
    checks.equal("exit code and verdict agree", run.returncode, 0 if answer["ok"] else 1)
    return {f["check"]: f for f in answer["findings"]}


def bad(name, finding, measured, remedy, status="problem"):
    f = finding[name]
    checks(name, f["status"] == status and measured in f["measured"] and remedy in f["remedy"] and f["wanted"], f)


def good(name, finding, measured=""):
    checks(name, finding[name]["status"] == "ok" and measured in finding[name]["measured"], finding[name])


def without_sudo(command):
    return command.replace("sudo ", "")


def try_config():
    broken = work / "broken.toml"
    broken.write_text('run_mode = "HIL"\nloop_rate_hz = 5.0\n', encoding="utf-8")
    found = doctor("--config", broken)
    bad("CONFIG", found, "broken.toml:2: loop_rate_hz", "--check-config")
    bad("CONFIG", doctor("--config", work / "nowhere.toml"), "nowhere.toml", "editor")
    good("CONFIG", doctor("--config", CONFIG / "station.toml"))
    good("CONFIG", doctor(), "no readable config" if not os.path.exists("/etc/tautline/station.toml") else "")


def try_serial():
    bad("SERIAL_PORT", doctor("--config", config(work / "none")), "no such device", "/dev/serial/by-id")
    link = work / "device"
    simulator = subprocess.Popen([BIN / "tautline-sim", "--pty", link, "--no-lcm", "--config", CONFIG / "sim.toml"],
                                 stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        wait_for(link.exists)
        port = config(link)
        good("SERIAL_PORT", doctor("--config", port), "opens at")
        with open(link, "rb", buffering=0, opener=lambda path, flags: os.open(path, flags | os.O_NOCTTY)) as held:
            fcntl.flock(held, fcntl.LOCK_EX)
            bad("SERIAL_PORT", doctor("--config", port), "in use by", f"fuser --kill -TERM {link}")
        if ROOT:
            os.chmod(os.path.realpath(link), 0o600)
            bad("SERIAL_PORT", doctor("--config", port, prefix=NOBODY), "permission denied", f"chmod g+rw {link}")
            shutil.chown(os.path.realpath(link), group="dialout")
            os.chmod(os.path.realpath(link), 0o660)
            bad("SERIAL_PORT", doctor("--config", port, prefix=NOBODY), "permission denied", "usermod --append --groups dialout")
            good("SERIAL_PORT", doctor("--config", port, prefix=[*NOBODY[:-1], "--groups=dialout"]), "opens at")
        bad("SERIAL_PORT", doctor("--config", config(CONFIG / "station.toml", run_mode="REAL")), "not a serial device", "serial.device")
    finally:
        simulator.terminate()
        simulator.wait(10)
    good("SERIAL_PORT", doctor("--config", config("can9", "tautline-can", "can", "interface")), "uses no serial port")


def try_can():
    has_can = os.path.exists("/proc/net/can")
    bad("CAN", doctor("--config", config("can9", "tautline-can", "can", "interface")),
        "no such interface" if has_can else "no CAN", "ip -brief link show" if has_can else "modprobe can-raw")
    good("CAN", doctor("--config", config(work / "none")), "uses no CAN")


def try_network():
    good("MULTICAST", doctor())
    if subprocess.run(["unshare", "-n", "true"], capture_output=True, check=False).returncode != 0:
        print("SKIPPED: no network namespaces here, so the missing route cannot be tried")
        return
    alone = ["unshare", "-n"]
    found = doctor(prefix=alone)
    bad("MULTICAST", found, "no route for " + URL, "ip route add 224.0.0.0/4 dev lo")
    good("STATION", found, "not listened for")
    good("MULTICAST", doctor(prefix=alone, after=[without_sudo(found["MULTICAST"]["remedy"])]))


def try_station():
    good("STATION", doctor(), "none heard")
    station = subprocess.Popen([BIN / "tautline-station", "--config", config(work / "none"), "--lcm-url", URL],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        checks("a station is heard", wait_for(lambda: "heard, run mode HIL, mode STANDBY" in doctor()["STATION"]["measured"]))
    finally:
        station.terminate()
        station.wait(10)


def try_disks():
    alone = ["unshare", "-m"]
    if not ROOT or subprocess.run([*alone, "true"], capture_output=True, check=False).returncode != 0:
        print("SKIPPED: no mount namespaces here, so full disks cannot be tried")
        return
    disk = work / "disk"
    disk.mkdir()
    small = [f"mount -t tmpfs -o size=1m tmpfs {disk}", "mount -t tmpfs -o size=1m tmpfs /dev/shm"]
    found = doctor(log_folder=disk, prefix=alone, after=small)
    bad("LOG_DISK", found, f"1 MiB free in {disk}", "journalctl --vacuum-size")
    bad("BLACK_BOX_DISK", found, "1 MiB free in /dev/shm", "mount -o remount,size=")
    good("BLACK_BOX_DISK", doctor(prefix=alone, after=[*small, without_sudo(found["BLACK_BOX_DISK"]["remedy"])]))
    found = doctor(log_folder=work / "nowhere")
    bad("LOG_DISK", found, "No such file", f"install -d -o tautline -g tautline {work}/nowhere")
    good("LOG_DISK", doctor(log_folder=disk, prefix=alone, after=[f"mount -t tmpfs -o size=600m tmpfs {disk}"]))


def try_rights():
    if not ROOT:
        print("SKIPPED: not root, so limits cannot be set")
        return
    found = doctor(prefix=["prlimit", "--rtprio=0:0", "--memlock=65536:65536", *NOBODY])
    bad("RT_PRIORITY", found, "up to 0", "usermod --append --groups tautline")
    bad("MEMLOCK", found, "64 KiB", "usermod --append --groups tautline")
    if subprocess.run(["prlimit", "--rtprio=98:98", "--memlock=unlimited:unlimited", "true"], capture_output=True, check=False).returncode == 0:
        found = doctor(prefix=["prlimit", "--rtprio=98:98", "--memlock=unlimited:unlimited", *NOBODY])
        good("RT_PRIORITY", found, "up to 98")
        good("MEMLOCK", found, "unlimited")


def try_clock():
    """Nobody may unset a shared machine's clock for a test: the finding must be what the kernel says, whichever that is."""
    buffer = ctypes.create_string_buffer(512)  # struct timex, modes = 0: read only
    state = ctypes.CDLL(None).adjtimex(buffer)
    status = ctypes.c_int.from_buffer(buffer, 8 * 5).value  # behind modes and four longs
    unsynchronized = state < 0 or bool(status & 0x40)  # STA_UNSYNC
    found = doctor()["CLOCK_SYNC"]
    checks("CLOCK_SYNC", (found["status"] == "advice" and "timedatectl" in found["remedy"]) if unsynchronized else found["status"] == "ok", found)


skip_without_multicast()
NOBODY = ["setpriv", "--reuid=nobody", "--regid=nogroup", "--inh-caps=-all", "--ambient-caps=-all", "--bounding-set=-all", "--clear-groups"]
try:
    try_config()
    try_serial()
    try_can()
    try_network()
    try_station()
    try_disks()
    try_rights()
    try_clock()
    run = tautline("doctor", "--seconds", "0.1", "--config", config(work / "none"), "--lcm-url", URL)
    checks("words for people", "remedy: ls /dev/serial/by-id" in run.stdout and run.returncode == 1, run.stdout)
finally:
    shutil.rmtree(work, ignore_errors=True)
checks.finish()
