#!/usr/bin/env python3
"""A long run of lists: kills, moved folders, full disks, many tasks; memory stays flat, one digest comes out.

soak.py PROGRAM [SECONDS] [REAL] [EMPTY]. REAL tasks (10 000) simulate; they are run again and again for SECONDS (1200),
interrupted in every way in turn: killed, stopped, the folder of results moved away and back, no room for more on the
disk. Then one run of EMPTY tasks (1 000 000, two samples each) tells how memory grows from a quarter of it to its end.
Ends with 1 where a digest differs from that of an undisturbed run, an exit code is wrong or memory grows.
"""
import collections
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SCENE = """kind: simulate
scene:
  string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz, modes: 10}
  bow: {position: 30 mm, velocity: 0.1 m/s, normal_force: 1 N}
  friction: {type: coulomb_exponential, static: 0.4, dynamic: 0.2, decay: 5 s/m}
  duration: DURATION s
simulator: {type: newmark_explicit, time_step: 8 us}
measurement: {sample_rate: 12.5 kHz, noise_level: 1 %}
sweep: {product: {scene.bow.velocity: [VELOCITIES], seed: [SEEDS]}}
"""
# 16 bytes a task for its place and some 50 for its key, which a map keeps in nodes; outcomes stay on the disk.
BYTES_PER_TASK = 200


def text(duration, velocities, seeds):
    return (SCENE.replace("DURATION", str(duration))
            .replace("VELOCITIES", ", ".join(f"{0.1 + 1e-5 * i:.5f}" for i in range(velocities)))
            .replace("SEEDS", ", ".join(str(i) for i in range(1, seeds + 1))))


def no_room(bytes_left):
    """Writes beyond this size of a file fail, as on a disk that is full."""
    def limit():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (bytes_left, resource.RLIM_INFINITY))
    return limit


class Soak:
    def __init__(self, program, folder):
        self.program, self.folder, self.random = program, folder, random.Random(1)
        self.outcomes, self.wrong = collections.Counter(), []

    def start(self, words, before=None):
        return subprocess.Popen([self.program, *words.split()], cwd=self.folder, preexec_fn=before,
                                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

    def digest(self, out):
        done = subprocess.run([self.program, "merge", out], cwd=self.folder, capture_output=True, text=True)
        found = re.search(r"digest (\w+)", done.stdout)
        return found.group(1) if found else f"none: {done.stderr}"

    def disturb(self, seconds):
        """One run in one way; what came of it is counted."""
        way = self.random.choice(("killed", "stopped", "moved", "no room"))
        journal = self.folder / "out/journal/shard-1-of-1.journal"
        size = journal.stat().st_size if journal.exists() else 0
        room = no_room(size + self.random.randrange(1, 400_000)) if way == "no room" else None
        process = self.start("run list.yaml --out out", room)
        try:
            if way != "no room":
                process.wait(self.random.uniform(0.02, seconds))
        except subprocess.TimeoutExpired:
            if way == "moved":
                if (self.folder / "out").exists():
                    os.rename(self.folder / "out", self.folder / "moved")
            else:
                process.send_signal(signal.SIGKILL if way == "killed" else signal.SIGINT)
        said = process.communicate()[1]
        code = process.returncode
        if (self.folder / "moved").exists():
            # A run that had not opened it yet makes one of its own, and is done with it; else what it has
            # made in its place holds nothing of it.
            whole = code == 0 and (self.folder / "out").exists()
            shutil.rmtree(self.folder / ("moved" if whole else "out"), ignore_errors=True)
            if not whole:
                os.rename(self.folder / "moved", self.folder / "out")
        self.outcomes[way, code] += 1
        allowed = {"killed": (-9, 0), "stopped": (130, -2, 0), "moved": (3, 7, 0), "no room": (3, 7, 0)}[way]
        # A signal that comes before the program has begun to listen ends it without a word.
        if code not in allowed or (code not in (0, -9, -2) and not said):
            self.wrong.append(f"{way}: exit {code}: {said[-300:]}")
        return code == 0

    def real(self, seconds, count):
        (self.folder / "list.yaml").write_text(text(0.1, count // 2, 2))
        begin = time.monotonic()
        code = self.start("run list.yaml --out whole").wait()
        alone = time.monotonic() - begin
        digest = self.digest("whole")
        if code != 0 or digest.startswith("none"):
            self.wrong.append(f"undisturbed: exit {code}, digest {digest}")
            return
        rounds = 0
        while time.monotonic() - begin < seconds or rounds == 0:
            shutil.rmtree(self.folder / "out", ignore_errors=True)
            for _ in range(200):
                if self.disturb(0.3 * alone):
                    break
            else:
                code = self.start("run list.yaml --out out").wait()
                if code != 0:
                    self.wrong.append(f"the last run: exit {code}")
            rounds += 1
            found = self.digest("out")
            if found != digest:
                self.wrong.append(f"digest {found} in the place of {digest}")
            if self.wrong:
                break
        told = ", ".join(f"{way} ({code}): {n}" for (way, code), n in sorted(self.outcomes.items()))
        print(f"{count} real tasks, {rounds} times to their end, {alone:.1f} s alone; disturbed: {told}; "
              f"digest {digest}", flush=True)

    def empty(self, count):
        seeds = 1000
        (self.folder / "empty.yaml").write_text(text(0.00016, max(1, count // seeds), min(count, seeds)))
        process = self.start("run empty.yaml --out empty --threads 2")
        journal = self.folder / "empty/journal/shard-1-of-1.journal"
        samples, begin = [], time.monotonic()
        while process.poll() is None:
            time.sleep(0.2)
            try:
                status = Path(f"/proc/{process.pid}/status").read_text()
                samples.append((journal.stat().st_size, 1024 * int(re.search(r"VmRSS:\s*(\d+)", status).group(1))))
            except (OSError, AttributeError):
                pass
        took, largest = time.monotonic() - begin, max((size for size, _ in samples), default=0)
        working = [rss for size, rss in samples if 0.25 * largest < size < largest]
        grown = working[-1] - working[0] if working else 0
        digest = self.digest("empty")
        print(f"{count} empty tasks: {took:.0f} s, {working[0] / 1e6 if working else 0:.0f} MB at a quarter, "
              f"{grown / 1e6:.0f} MB more at the end; digest {digest}", flush=True)
        if process.returncode != 0 or digest.startswith("none"):
            self.wrong.append(f"empty: exit {process.returncode}: {process.stderr.read()[-300:]}; {digest}")
        if grown > BYTES_PER_TASK * count + 16e6:
            self.wrong.append(f"memory grew by {grown} bytes")


def main():
    numbers = [int(word) for word in sys.argv[2:]] + [1200, 10_000, 1_000_000][len(sys.argv) - 2:]
    with tempfile.TemporaryDirectory(prefix="modcal-soak-") as folder:
        soak = Soak(str(Path(sys.argv[1]).resolve()), Path(folder))
        soak.real(numbers[0], numbers[1])
        soak.empty(numbers[2])
    print("\n".join(soak.wrong))
    return 1 if soak.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
