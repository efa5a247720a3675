#!/usr/bin/env python3
"""Commands on one list of tasks, killed (SIGKILL) at random instants.

kills.py PROGRAM [KILLS] [SEED]. `run`, `merge`, `report`, `replay` and `submit` are begun on a folder of results and
killed before they end, until KILLS of them were. After each kill every file under its final name is whole; whenever a
run has come to its end, its tables are those of a run that nobody killed, byte for byte, the digest that `merge` tells
is the same, and no part of a file is left.
"""
import collections
import json
import os
import random
import re
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
from pathlib import Path

LIST = """kind: simulate
scene:
  string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz, modes: 10}
  bow: {position: 30 mm, velocity: 0.1 m/s, normal_force: 1 N}
  friction: {type: coulomb_exponential, static: 0.4, dynamic: 0.2, decay: 5 s/m}
  duration: 0.2 s
simulator: {type: newmark_explicit, time_step: 1 us}
measurement: {sample_rate: 12.5 kHz, noise_level: 1 %}
sweep: {product: {scene.bow.velocity: [VELOCITIES], seed: [1, 2]}}
"""
TASKS = 60
COMMANDS = {
    "run": "run list.yaml --out out",
    "merge": "merge out",
    "report": "report out",
    "replay": "replay out 3",
    "submit": "submit list.yaml --slurm --dry-run --out out",
}
WEIGHTS = {"run": 6, "merge": 2, "report": 2, "replay": 2, "submit": 2}


def tables(folder):
    """What a finished run leaves that holds no times, by name."""
    return {path.name: path.read_bytes() for path in sorted((folder / "out").glob("*"))
            if path.suffix in (".csv", ".json") and path.name != "provenance.json"}


class Kills:
    def __init__(self, program, folder, seed):
        self.program, self.folder, self.random = program, folder, random.Random(seed)
        velocities = ", ".join(f"{0.1 + 0.001 * i:.3f}" for i in range(TASKS // 2))
        (folder / "list.yaml").write_text(LIST.replace("VELOCITIES", velocities))
        self.killed, self.ended, self.rounds = collections.Counter(), collections.Counter(), 0
        self.seconds, self.wrong = {}, []
        for name in COMMANDS:  # without a kill; submit finds nothing to do after a run
            start = time.monotonic()
            self.command(name)
            self.seconds[name] = time.monotonic() - start
        self.digest, self.tables = self.digest_now(), tables(folder)
        self.clear()

    def clear(self):
        shutil.rmtree(self.folder / "out", ignore_errors=True)

    def command(self, name):
        return subprocess.run([self.program, *COMMANDS[name].split()], cwd=self.folder,
                              capture_output=True, text=True)

    def digest_now(self):
        done = self.command("merge")
        found = re.search(r"digest (\w+)", done.stdout)
        return found.group(1) if done.returncode == 0 and found else f"none: {done.stderr}"

    def kill_one(self, name):
        process = subprocess.Popen([self.program, *COMMANDS[name].split()], cwd=self.folder,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                   start_new_session=True)
        try:
            process.wait(timeout=self.random.uniform(0.0, self.seconds[name]))
            self.ended[name, process.returncode] += 1
            # A folder without a run in it, or a task that is not done: told, with exit code 3.
            if process.returncode not in (0, 3):
                self.wrong.append(f"{name} ended with {process.returncode}")
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            self.killed[name] += 1

    def check_files(self):
        for path in (self.folder / "out").rglob("*"):
            try:
                if path.suffix == ".json":
                    json.loads(path.read_text())
                if path.name == "report.html" and not path.read_text().rstrip().endswith("</html>"):
                    self.wrong.append(f"{path}: half a page")
                if path.suffix == ".sqlite":
                    base = sqlite3.connect(f"file:{path}?mode=ro", uri=True)
                    if base.execute("pragma integrity_check").fetchone() != ("ok",):
                        self.wrong.append(f"{path}: broken")
            except (ValueError, sqlite3.Error) as error:
                self.wrong.append(f"{path}: {error}")
            if path.suffix == ".csv" and path.parent.name == "out" and \
                    self.tables.get(path.name) not in (None, path.read_bytes()) and \
                    path.read_bytes().count(b"\n") >= self.tables[path.name].count(b"\n"):
                self.wrong.append(f"{path}: another table")

    def finish(self):
        """To the end, without a kill."""
        self.rounds += 1
        time.sleep(2.1)  # younger parts may be about to be locked by somebody
        for name in ("run", "report"):
            done = self.command(name)
            if done.returncode != 0:
                self.wrong.append(f"{name} after kills: exit {done.returncode}: {done.stderr}")
        if tables(self.folder) != self.tables:
            self.wrong.append("other tables than without a kill")
        digest = self.digest_now()
        if digest != self.digest:
            self.wrong.append(f"digest {digest} in the place of {self.digest}")
        self.command("replay")
        self.wrong += [f"left: {path}" for path in (self.folder / "out").rglob("*.part")]
        self.clear()

    def until(self, kills):
        names, weights = zip(*WEIGHTS.items())
        while self.killed.total() < kills:
            for _ in range(self.random.randrange(5, 30)):
                self.kill_one(self.random.choices(names, weights)[0])
                self.check_files()
            self.finish()
            if self.wrong:
                break
        told = ", ".join(f"{count} of {name}" for name, count in sorted(self.killed.items()))
        print(f"{self.killed.total()} kills ({told}), {self.rounds} runs brought to their end, "
              f"{self.ended.total()} commands ended first; digest {self.digest}; wrong: {len(self.wrong)}")
        print("\n".join(self.wrong))
        return 1 if self.wrong else 0


def main():
    kills = int(sys.argv[2]) if len(sys.argv) > 2 else 1000
    seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    with tempfile.TemporaryDirectory(prefix="modcal-kills-") as folder:
        return Kills(str(Path(sys.argv[1]).resolve()), Path(folder), seed).until(kills)


if __name__ == "__main__":
    sys.exit(main())
