"""The real station and the simulated machine over a pseudo terminal, for measurements of the whole program.

    with Rig(build_bin, source, loop_rate_hz=1000) as rig:
        rig.take_off()
        rig.tautline("land")
"""
import csv
import io
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time


class RigError(RuntimeError):
    """One line: what did not work, with the last words of the program."""


class Rig:
    def __init__(self, binaries, source, loop_rate_hz=100.0, scene="open"):
        self.binaries = pathlib.Path(binaries)
        self.config = pathlib.Path(source) / "config"
        self.scene = self.config / "scenes" / f"{scene}.scene.toml"
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="tautline_rig_"))
        # In memory, as on a vehicle: a disk would make the loop wait.
        self.black_box = pathlib.Path("/dev/shm") / f"{self.folder.name}.blackbox"
        self.rate_hz = loop_rate_hz
        self.simulator = self.station = None

    def __enter__(self):
        try:
            self._start()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for program in (self.station, self.simulator):
            if program and program.poll() is None:
                program.terminate()
                try:
                    program.wait(10)
                except subprocess.TimeoutExpired:
                    program.kill()
                    program.wait()
        shutil.rmtree(self.folder, ignore_errors=True)
        for path in self.black_box.parent.glob(self.black_box.name + "*"):
            path.unlink()

    def _start(self):
        link = self.folder / "device"
        sim = self._edited("sim.toml", {}, "[vehicle]", "battery_life_s = 1e6\n")
        station = self._edited("station.toml", {"loop_rate_hz": f"{self.rate_hz:.1f}"}, "[serial]",
                               "", f'black_box = "{self.black_box}"\n')
        self.simulator = self._launch("tautline-sim", "--pty", link, "--scene", self.scene, "--seed", "1", "--config", sim)
        self._until(link.exists, "tautline-sim")
        self.station = self._launch("tautline-station", "--config", station, "--device", link, "--scene", self.scene)
        self.tautline("status", "--wait", "10")

    def _edited(self, name, values, section, in_section, before_sections=""):
        """A copy of a shipped config with other values, and lines put into a section or before the first one."""
        text = (self.config / name).read_text(encoding="utf-8")
        for key, value in values.items():
            text = re.sub(rf"(?m)^{key} = .*$", f"{key} = {value}", text)
        text = text.replace(f"{section}\n", f"{section}\n{in_section}", 1)
        first = re.search(r"(?m)^\[", text).start()
        path = self.folder / name
        path.write_text(text[:first] + before_sections + text[first:], encoding="utf-8")
        return path

    def _launch(self, program, *arguments):
        with open(self.folder / f"{program}.txt", "w", encoding="utf-8") as log:
            return subprocess.Popen([self.binaries / program, *map(str, arguments)], stdout=log, stderr=log)

    def _until(self, condition, program, seconds=10.0):
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                raise RigError(f"{program} did not start: {self.said(program)}")
            time.sleep(0.05)

    def said(self, program):
        return " ".join((self.folder / f"{program}.txt").read_text(encoding="utf-8").split("\n")[-3:])

    def tautline(self, *arguments, check=True):
        """Runs the operator's command line; its exit code."""
        run = subprocess.run([self.binaries / "tautline", *map(str, arguments)], capture_output=True, text=True)
        if check and run.returncode != 0:
            raise RigError(f"tautline {arguments[0]}: exit code {run.returncode}: {run.stderr.strip()} {self.said('tautline-station')}")
        return run.returncode

    def take_off(self):
        """Arms as soon as the station lets itself be armed, and goes to the hover point."""
        end = time.monotonic() + 15.0
        while self.tautline("arm", "--quiet", check=False) != 0:
            if time.monotonic() > end:
                self.tautline("arm")
            time.sleep(0.5)
        self.tautline("takeoff", "--quiet")

    def cycles(self, begin_s, end_s):
        """(lateness, work) [us] of every cycle between two times of the monotonic clock, from the black box."""
        run = subprocess.run([self.binaries / "tautline", "blackbox", self.black_box], capture_output=True, text=True, check=True)
        rows = csv.DictReader(io.StringIO(run.stdout))
        return [(float(r["lateness_us"]), float(r["work_us"])) for r in rows if begin_s <= float(r["now_s"]) <= end_s]


def quantile(values, share):
    """Smallest value that is not exceeded by that share of the values (nearest rank)."""
    ordered = sorted(values)
    return ordered[max(0, -(-int(share * 1000) * len(ordered) // 1000) - 1)]


def arguments_or_end(parser):
    """--bin and --source, which ./run gives, beside the parser's own."""
    parser.add_argument("--bin", required=True, help="folder of the programs")
    parser.add_argument("--source", required=True, help="folder of the sources")
    return parser.parse_args()


def main_of(run):
    """Runs `run`; a RigError is one line on stderr and exit code 1."""
    try:
        return run()
    except RigError as error:
        print(f"run: error: {error}", file=sys.stderr)
        return 1
