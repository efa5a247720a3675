#!/usr/bin/env python3
"""Every call of the system that a command makes on its files fails once, one after the other.

enumerate.py SHIM PROGRAM [EVERY] runs commands of PROGRAM with SHIM (fail_one.c) before it; EVERY 11
takes each eleventh call. Whatever call fails:
  exit 0 only with every file as it is without the failure, and everything said; where gnuplot
  failed, a figure may be missing that the command names;
  otherwise no file that differs from both the one before the command and the one after it, but for
  journals, to which a line more or less belongs;
  the same command again, without a failure, ends well with the same results.
"""
import concurrent.futures
import collections
import json
import math
import os
import random
import re
import shutil
import sqlite3
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

SCENE = """scene:
  string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz, modes: 10}
  bow: {position: 30 mm, velocity: 0.1 m/s, normal_force: 1 N}
  friction: {type: coulomb_exponential, static: 0.4, dynamic: 0.2, decay: 5 s/m}
  duration: 0.02 s
simulator: {type: newmark_explicit, time_step: 8 us}
measurement: {sample_rate: 12.5 kHz, noise_level: 1 %}
"""
LIST = "kind: simulate\n" + SCENE + "sweep: {product: {seed: [1, 2]}}\n"
RECORD = """kind: invert
record: {file: record.FORMAT, left: {channel: R1}}
string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz, modes: 5}
bow: {position: 30 mm}
inversion: {estimator: one_sided, regularizer: water_level}
"""
SINGLE = "kind: simulate\n" + SCENE + "record: record.FORMAT\n"


def prepare(program, folder):
    """Records in both formats and a finished list, by the program itself."""
    (folder / "list.yaml").write_text(LIST)
    for form in ("csv", "wav"):
        (folder / f"{form}.yaml").write_text(RECORD.replace("FORMAT", form))
    def end(i, sign):
        return sum(sign ** n * math.exp(-9 * i / 8000) / n * math.sin(1231.5 * n * i / 8000 + n * n)
                   for n in range(1, 8)) + random.Random(2 * i + sign).gauss(0, 0.01)
    signals = [(end(i, 1), end(i, -1)) for i in range(512)]
    rows = "".join(f"{i / 8000},{x},{y}\n" for i, (x, y) in enumerate(signals))
    (folder / "record.csv").write_text("t [s],R1 [N],R2 [N]\n" + rows)
    # The calibration of a sound file's channels stands in its comment.
    comment = b'{"modcal":{"full_scale":1.0,"channels":[["R1","N"],["R2","N"]]}}\0'
    data = b"".join(struct.pack("<dd", x, y) for x, y in signals)

    def chunk(name, content):
        return name + struct.pack("<I", len(content)) + content + b"\0" * (len(content) % 2)
    form = struct.pack("<HHIIHH", 3, 2, 8000, 128000, 16, 64)
    info = chunk(b"LIST", b"INFO" + chunk(b"ICMT", comment))
    (folder / "record.wav").write_bytes(
        chunk(b"RIFF", b"WAVE" + chunk(b"fmt ", form) + info + chunk(b"data", data)))
    done = subprocess.run([program, "run", "list.yaml", "--threads", "1", "--out", "done"], cwd=folder,
                          capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"the preparation fails: {done.stderr}")


COMMANDS = {
    "run": "run list.yaml --threads 1 --out new",
    "resume": "run list.yaml --threads 1 --out done",
    "merge": "merge done",
    "report": "report done",
    "status": "status done",
    "replay": "replay done 1",
    "csv": "run csv.yaml --out csv",
    "wav": "run wav.yaml --out wav",
    "validate": "validate csv.yaml",
    "inspect": "inspect record.csv",
    "inspect_wav": "inspect record.wav",
}


def content(path):
    """What of a file must be equal: times and what depends on them are left out."""
    if path.suffix == ".sqlite":
        try:
            base = sqlite3.connect(f"file:{path}?mode=ro", uri=True)
            return repr(base.execute("select * from tasks order by task").fetchall())
        except sqlite3.Error as error:
            return f"broken: {error}"
    data = path.read_bytes()
    if path.name == "provenance.json":
        try:  # names that were announced and not written do no harm
            known = {k: v for k, v in json.loads(data).items() if k not in ("files", "time_utc")}
            return json.dumps(known).encode()
        except ValueError as error:
            return f"broken: {error}"
    if path.suffix == ".journal":
        lines = [re.sub(rb"^\w+ (\w+ \d+) \S+ ", rb"\1 ", line) for line in data.split(b"\n")]
        return repr(sorted(line for line in lines if b" modcal-journal " not in line and line))
    data = re.sub(rb"/CreationDate \(\S+\)", b"DATE", data)
    data = re.sub(rb"20\d\d-\d\d-\d\dT\d\d:\d\d:\d\dZ", b"TIME", data)
    data = re.sub(rb"\d+(\.\d+)?(e-\d+)? ?(ms|s)\b", b"SECONDS", data)
    return data


def state(folder):
    files = {}
    for path in sorted(folder.rglob("*")):
        name = str(path.relative_to(folder))
        if path.is_file() and not name.endswith((".part", ".lock")) and name not in (".log", ".err"):
            files[name] = content(path)
    return files


class Enumeration:
    def __init__(self, shim, program, every, root):
        self.shim, self.program, self.every, self.root = shim, program, every, root
        self.base = root / "base"
        self.base.mkdir()
        prepare(program, self.base)

    def run(self, folder, command, call):
        """Exit code, and the call that failed; "" where there are fewer."""
        log = folder / ".log"
        environment = dict(os.environ, LD_PRELOAD=str(self.shim), FAIL_FOLDER=str(folder) + "/",
                           FAIL_CALL=str(call), FAIL_LOG=str(log))
        with open(folder / ".out", "wb") as out, open(folder / ".err", "wb") as err:
            code = subprocess.run([self.program, *command.split()], cwd=folder, env=environment,
                                  stdout=out, stderr=err, timeout=60).returncode
        return code, log.read_text().strip() if log.exists() else ""

    def folder(self, name):
        """A copy at a place of the same length each time: paths stand in the results."""
        folder = self.root / name
        shutil.copytree(self.base, folder)
        for provenance in folder.glob("*/provenance.json"):
            provenance.write_text(provenance.read_text().replace(str(self.base), str(folder)))
        return folder

    def without(self, command):
        folder = self.folder("0" * 12)
        before = state(folder)
        code, _ = self.run(folder, command, 0)
        after = state(folder)
        shutil.rmtree(folder)
        if code != 0:
            sys.exit(f"{command}: exit {code} without a failure")
        return before, after

    def attempt(self, name, call, before, after):
        """(class of outcome, what failed, what is wrong)."""
        folder = self.folder(f"{name[:6]:_<6}{call:06d}")
        here, there = str(folder).encode(), str(self.root / ("0" * 12)).encode()

        def same(found, wanted):
            if isinstance(found, bytes):
                return isinstance(wanted, bytes) and found.replace(here, there) == wanted
            return isinstance(wanted, str) and found == wanted
        try:
            code, failed = self.run(folder, COMMANDS[name], call)
            if not failed:
                return None
            failed = failed.replace(str(folder), "")
            now, wrong = state(folder), []
            outcome = f"exit {code}"
            if code == 0:
                told = re.findall(r"not drawn: (.*)\. It said", (folder / ".err").read_text())
                not_drawn = ", ".join(told).split(", ") if told else []
                if not_drawn:
                    outcome += " with a figure named as not drawn"
                wrong += [f"exit 0 without {f}" for f in after
                          if f not in now and Path(f).name not in not_drawn]
                wrong += [f"exit 0 with another {f}" for f in after
                          if f in now and not same(now[f], after[f])
                          and not (not_drawn and f.endswith("report.html"))]
            else:
                wrong += [f"exit {code} leaves a broken {f}" for f in now
                          if f != ".out" and not f.endswith(".journal")
                          and not same(now[f], after.get(f)) and not same(now[f], before.get(f))]
            if code < 0 or code == 1:
                wrong.append(f"exit {code}")
            # An inspection that finds a fault says so where it says all else.
            told = b"A run would refuse this file" in (folder / ".out").read_bytes()
            if code != 0 and not told and not (folder / ".err").read_text() and "/.err" not in failed:
                wrong.append(f"exit {code} without a word")
            again, _ = self.run(folder, COMMANDS[name], 0)
            last = state(folder)
            if again != 0:
                wrong.append(f"the same command again: exit {again}")
            wrong += [f"the same command again: another {f}" for f in after
                      if f != ".out" and not same(last.get(f), after[f])]
            if wrong:
                wrong.append((folder / ".err").read_text().split("\n")[0][:300])
            return outcome, failed, wrong
        finally:
            shutil.rmtree(folder)

    def all_of(self, name, pool):
        before, after = self.without(COMMANDS[name])
        calls, outcomes, wrong = 0, collections.Counter(), []
        step, more = os.cpu_count() or 1, True  # what follows the last call is a run without a failure
        while more:
            numbers = [1 + (calls + i) * self.every for i in range(step)]
            for number, result in zip(numbers, pool.map(
                    lambda call: self.attempt(name, call, before, after), numbers)):
                if result is None:
                    more = False
                    break
                outcome, failed, problems = result
                calls += 1
                outcomes[outcome] += 1
                wrong += [f"{name}, call {number} ({failed}): {p}" for p in problems]
        told = ", ".join(f"{outcome}: {count}" for outcome, count in sorted(outcomes.items()))
        print(f"{name}: {calls} calls failed; {told}; wrong: {len(wrong)}", flush=True)
        return calls, wrong


def main():
    shim, program = Path(sys.argv[1]).resolve(), str(Path(sys.argv[2]).resolve())
    every = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    names = sys.argv[4:] or list(COMMANDS)
    with tempfile.TemporaryDirectory(prefix="modcal-faults-") as root, \
            concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        enumeration = Enumeration(shim, program, every, Path(root))
        results = [enumeration.all_of(name, pool) for name in names]
    wrong = [line for _, lines in results for line in lines]
    print("\n".join(wrong))
    print(f"{sum(calls for calls, _ in results)} calls failed, {len(wrong)} wrong")
    return 1 if wrong or not all(calls for calls, _ in results) else 0


if __name__ == "__main__":
    sys.exit(main())
