#!/usr/bin/python3
"""What `kind: identify` tells of free decays of structures that numpy has made: sums of damped sinusoids and noise.

decay_score.py BUILD OUT draws what each row of ROWS states, identifies every record with BUILD/modcal and prints a line per row:
records, accepted (exit code 0); of those accepted in how many hum is seen, a mode is lost (none within three half-widths of it), a
mode is there that is none (2 % and 3 Hz from all), a warning tells one shape at one place; then frequencies and damping ratios more
than 4 deviations off the nearest mode, and the largest, by the deviations alone and with f_unseen_hz and zeta_unseen beside them.
`planes` are strings whose two reactions hold two planes, each with frequencies and damping of its own, `glides` strings of one plane whose
frequencies fall with the amplitude: what is accepted of those has no right numbers.
All that is drawn comes from numpy's default_rng((ROW, DRAW)). What is finished stays in OUT: the same command goes on there.
"""
import argparse
import concurrent.futures
import json
import subprocess
import zlib
from pathlib import Path

import numpy as np

# modes: how many; apart: half-widths between two; hum: over the rms of the decay; glide: relative, of the frequency at first.
ROWS = {
    "modes": {"modes": (1, 8), "sensors": (1, 5)},
    "near_mains": {"modes": (1, 4), "sensors": (1, 5), "beside_mains": True},
    "hum": {"modes": (1, 5), "sensors": (1, 5), "hum": (0.01, 0.2)},
    "pair": {"modes": (2, 2), "sensors": (1, 4), "apart": (0.05, 0.6)},
    "glide": {"modes": (1, 1), "sensors": (2, 4), "glide": (3e-4, 3e-2)},
    "planes": {"planes": True},
    "glides": {"planes": False},
}


def between(rng, low, high):
    return np.exp(rng.uniform(np.log(low), np.log(high)))


class Decay:
    """One record and its truth."""

    def __init__(self, name, row, draw):
        rng = np.random.default_rng((zlib.crc32(name.encode()), draw))
        modes, sensors = (int(rng.integers(low, high + 1)) for low, high in (row["modes"], row["sensors"]))
        self.rate, duration = float(rng.choice([2000, 4000, 8000])), rng.uniform(0.4, 1.5)
        f, self.zeta = [], np.array([between(rng, 5e-4, 2e-2) for _ in range(modes)])
        while len(f) < modes:  # 6 % apart
            new = between(rng, 30, 700)
            if all(abs(new - other) > 0.06 * other for other in f):
                f.append(new)
        if row.get("beside_mains"):
            f[0], self.zeta[0] = rng.choice([50, 60, 100, 120]) * rng.uniform(0.97, 1.03), between(rng, 1e-3, 5e-3)
        if "apart" in row:
            f[1] = f[0] * (1 + between(rng, *row["apart"]) * self.zeta[0])
            self.zeta[1] = self.zeta[0] * rng.uniform(0.7, 1.4)
        self.f, t = np.array(f), np.arange(int(duration * self.rate)) / self.rate
        omega, glide = 2 * np.pi * self.f, between(rng, *row["glide"]) if "glide" in row else 0.0
        decay = self.zeta * omega
        # The frequency is higher by glide times the square of the amplitude. f is that without damping, as modcal states it.
        phase = (omega * np.sqrt(1 - self.zeta**2))[:, None] * (t + glide * (1 - np.exp(-2 * decay[:, None] * t)) / (2 * decay[:, None]))
        amplitudes = rng.uniform(0.2, 1.0, (sensors, modes)) * rng.choice([-1, 1], (sensors, modes))
        self.channels = amplitudes @ (np.exp(-decay[:, None] * t) * np.cos(phase))
        rms = self.channels.std(axis=1, keepdims=True)
        if "hum" in row:
            mains = rng.choice([50.0, 59.98])
            self.channels += between(rng, *row["hum"]) * rms * np.sqrt(2) * np.sin(2 * np.pi * mains * t + 1)
        self.channels += between(rng, 1e-3, 0.1) * rms * rng.standard_normal(self.channels.shape)

    def write(self, folder):
        np.savetxt(folder / "decay.csv", self.channels.T, fmt="%.9g", delimiter=",", header=self.head(), comments="")
        (folder / "identify.yaml").write_text(self.experiment())

    def head(self):
        return f"# sample_rate: {self.rate:g} Hz\n" + ",".join(f"a{k + 1} [m/s2]" for k in range(len(self.channels)))

    def experiment(self):
        responses = ", ".join(f"{{channel: a{k + 1}}}" for k in range(len(self.channels)))
        return (f"kind: identify\nstructure: {{record: {{file: decay.csv, responses: [{responses}]}}}}\n"
                "identification: {lowest_frequency: 20 Hz, highest_frequency: 800 Hz}\n")


class StringDecay(Decay):
    """Both reactions of a string that is let go, in two planes or with a tension that falls."""

    def __init__(self, name, row, draw):
        rng = np.random.default_rng((zlib.crc32(name.encode()), draw))
        f0, stiffness, self.rate = between(rng, 80, 450), between(rng, 1e-5, 1e-3), 12000.0
        n = np.arange(1, 1 + int(2250 / f0))
        t = np.arange(int(rng.uniform(0.5, 2.0) * self.rate)) / self.rate
        f = n * f0 * np.sqrt(1 + stiffness * n**2)
        zeta = between(rng, 3e-4, 2e-3) * rng.uniform(0.7, 1.4, n.size)
        shape = np.sin(n * np.pi * rng.uniform(0.08, 0.45)) / n
        share, apart, damping = between(rng, 0.1, 1.0), between(rng, 2e-4, 4e-3) * rng.choice([-1, 1]), rng.uniform(0.5, 1.8)
        seconds = f * (1 + apart * rng.uniform(0.7, 1.3, n.size)), zeta * damping * rng.uniform(0.8, 1.25, n.size)
        glide = 0.0 if row["planes"] else between(rng, 3e-4, 3e-3)
        falls = t + glide * (1 - np.exp(-4 * np.pi * zeta[0] * f[0] * t)) / (4 * np.pi * zeta[0] * f[0])
        self.channels = np.zeros((2, t.size))
        for frequencies, ratios, size in ((f, zeta, 1.0), (*seconds, share if row["planes"] else 0.0)):
            for k in range(n.size):
                omega = 2 * np.pi * frequencies[k]
                signal = size * shape[k] * np.exp(-ratios[k] * omega * t) * np.cos(omega * np.sqrt(1 - ratios[k] ** 2) * falls)
                self.channels += np.array([[1.0], [(-1.0) ** k]]) * signal
        self.channels += between(rng, 1e-3, 0.05) * self.channels.std(axis=1, keepdims=True) * rng.standard_normal(self.channels.shape)
        self.f, self.zeta = (np.concatenate(pair) if row["planes"] else pair[0] for pair in zip((f, zeta), seconds))
        self.fundamental = f0 * (1 + rng.uniform(-0.005, 0.005))

    def head(self):
        return f"# sample_rate: {self.rate:g} Hz\nR1 [N],R2 [N]"

    def experiment(self):
        return ("kind: identify\nrecord: {file: decay.csv, left: {channel: R1}, right: {channel: R2}}\n"
                f"fundamental: {self.fundamental:.6g} Hz\n")


def identified(task):
    build, out, name, draw = task
    folder = out / f"{name}_{draw}"
    folder.mkdir(parents=True, exist_ok=True)
    decay = (StringDecay if "planes" in ROWS[name] else Decay)(name, ROWS[name], draw)
    if not (folder / "said").exists():
        decay.write(folder)
        done = subprocess.run([build / "modcal", "run", folder / "identify.yaml", "--out", folder / "out"], capture_output=True, text=True)
        (folder / "said").write_text(f"{done.returncode}\n{done.stdout}{done.stderr}")
    code, said = (folder / "said").read_text().split("\n", 1)
    result = {"accepted": code == "0", "alike": "one shape" in said, "z": []}
    if code != "0":
        return result
    found = json.loads((folder / "out/identification.json").read_text())
    told = np.array([mode["f_hz"] for mode in found["modes"]])
    width = decay.zeta * decay.f
    result["hum"] = bool(found["mains_lines_hz"])
    result["lost"] = any(np.min(abs(told - f)) > 3 * w + 1 for f, w in zip(decay.f, width))
    result["none"] = any(np.min(abs(decay.f - f)) > 3 + 0.02 * f for f in told)
    for mode in found["modes"]:
        near = abs(decay.f - mode["f_hz"]) < 3 * width
        if not near.any() or mode["zeta"] < 3 * mode["zeta_sd"]:
            continue  # a warning names those without a decay
        for key, truth, unseen in (("f", decay.f, "f_unseen_hz"), ("zeta", decay.zeta, "zeta_unseen")):
            value, deviation = (mode["f_hz"], mode["f_sd_hz"]) if key == "f" else (mode["zeta"], mode["zeta_sd"])
            off = np.min(abs(truth[near] - value))
            result["z"].append((off / deviation, off / np.hypot(deviation, mode.get(unseen) or 0.0)))
    return result


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("build", type=Path)
    p.add_argument("out", type=Path)
    p.add_argument("--rows", nargs="+", choices=ROWS, default=list(ROWS))
    p.add_argument("--draws", type=int, default=60)
    p.add_argument("--jobs", type=int, default=1)
    a = p.parse_args()
    print("row         records accepted   hum  lost  none alike     f, zeta  >4  largest  with unseen: >4  largest")
    for name in a.rows:
        tasks = [(a.build.resolve(), a.out.resolve(), name, draw) for draw in range(a.draws)]
        with concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
            results = list(pool.map(identified, tasks))
        good = [r for r in results if r["accepted"]]
        z = np.array([pair for r in good for pair in r["z"]]).reshape(-1, 2)
        counts = " ".join(f"{sum(r[key] for r in good):5d}" for key in ("hum", "lost", "none", "alike"))
        most = z.max(axis=0) if len(z) else (np.nan, np.nan)
        print(f"{name:11s} {len(results):7d} {len(good):8d} {counts} {len(z):11d} {sum(z[:, 0] > 4):3d} {most[0]:8.1f}"
              f" {sum(z[:, 1] > 4):16d} {most[1]:8.1f}", flush=True)


if __name__ == "__main__":
    main()
