#!/usr/bin/env python3
"""What `modcal` makes of bad records: NaN, clipping, gaps, copies, swapped ends, wrong rates.

bad_records.py BUILD OUT makes two good records with BUILD/benchmarks/truth (violin_d, exponential; violin_g, thermal; 1 % of
noise), spoils them in every way of the list BAD, runs `kind: calibrate` with default settings and `kind: invert` (estimator
joint) on them and prints one line each: exit code; calibrate: largest |z| of f0, B, x_c and of the f_n identified, and their
deviations over those of the good record; invert: relative error of the force and the share of it that its band explains; the
first line of the message. WRONG: exit code 0 with f0, B or x_c beyond 4 deviations or an f_n beyond 5, or a force whose error is
more than twice the good record's and what the estimate says of itself. `--check` ends with 1 where there is such a line that is
not one of UNSEEN.
"""
import argparse
import concurrent.futures
import csv
import json
import math
import random
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import score

CASES = (("violin_d", "exponential"), ("violin_g", "thermal"))
NOISE = 0.01
# What one record of one clock and two sensors cannot tell, and what is then wrong.
UNSEEN = {
    "rate_1e-4_file": "f0 in the units of the file's clock",
    "rate_1pct_file": "f0 in the units of the file's clock",
    "rate_1e-4_stated": "a stated rate is taken, with a warning",
    "sign_both": "the sign of the force",
}


class Record:
    """Columns of a file: R1, R2, f_c and a time column (None: left out), lines before them, keys of `record:`."""

    def __init__(self, rows, rate, noise_key, noise=NOISE):
        self.rate, self.noise = rate, noise
        self.t = [i / rate for i in range(len(rows))]
        self.x = {"R1": [r[1] for r in rows], "R2": [r[2] for r in rows], "f_c": [r[3] for r in rows]}
        self.gauss = random.Random(noise_key).gauss
        self.clean = {k: list(self.x[k]) for k in ("R1", "R2")}
        for k in ("R1", "R2"):
            self.x[k] = self.noisy(self.x[k])
        self.preamble, self.keys, self.swapped = [], "", False

    def noisy(self, x):
        s = self.noise * spread(x)
        return [v + s * self.gauss(0.0, 1.0) for v in x]

    def cell(self, channel, share, value):
        self.x[channel][int(share * len(self.t))] = value

    def at(self, share, seconds):
        first = int(share * len(self.t))
        return range(first, first + max(1, round(seconds * self.rate)))

    def write(self, path):
        columns = ([("t [s]", self.t)] if self.t else []) + [(f"{k} [N]", v) for k, v in self.x.items()]
        with path.open("w") as f:
            f.writelines(f"{line}\n" for line in self.preamble)
            f.write(",".join(name for name, _ in columns) + "\n")
            for row in zip(*(v for _, v in columns)):
                f.write(",".join(v if isinstance(v, str) else f"{v:.12g}" for v in row) + "\n")


def spread(x):
    mean = sum(x) / len(x)
    return math.sqrt(sum((v - mean) ** 2 for v in x) / len(x))


REACTIONS = ("R1", "R2")


def cells(value, channel="R1"):
    return lambda r: r.cell(channel, 0.4, value)


def each(change, channels=REACTIONS):
    def apply(r):
        for k in channels:
            r.x[k] = change(r.x[k])
    return apply


def clip(share, channels):
    def apply(r):
        for k in channels:
            top = share * max(map(abs, r.x[k]))
            r.x[k] = [min(top, max(-top, v)) for v in r.x[k]]
    return apply


def gap(seconds, how, channels=REACTIONS):
    def apply(r):
        lost = r.at(0.4, seconds)
        if how in ("zeros", "held"):
            for k in channels:
                for i in lost:
                    r.x[k][i] = 0.0 if how == "zeros" else r.x[k][lost[0] - 1]
            return
        for k in r.x:
            del r.x[k][lost[0]:lost[-1] + 1]
        if how == "jump":
            del r.t[lost[0]:lost[-1] + 1]
        else:
            del r.t[-len(lost):]
            if how == "rate":
                r.preamble, r.t = [f"# sample_rate: {r.rate:.9g} Hz"], None
    return apply


def rate(factor, told):
    def apply(r):
        if told == "file":
            r.t = [factor * t for t in r.t]
        elif told == "stated":
            r.keys = f", sample_rate: {r.rate / factor:.9g} Hz"
        else:
            r.preamble = [f"# sample_rate: {r.rate / factor:.9g} Hz"]
    return apply


def copy(gain, noise=False):
    def apply(r):
        r.x["R2"] = [gain * v for v in (r.noisy(r.clean["R1"]) if noise else r.x["R1"])]
    return apply


def crosstalk(share):
    def apply(r):
        a, b = r.x["R1"], r.x["R2"]
        r.x["R2"] = [y + share * x for x, y in zip(a, b)]
    return apply


def noise_only(channel):
    def apply(r):
        s = r.noise * spread(r.x[channel])
        r.x[channel] = [r.gauss(0.0, s) for _ in r.x[channel]]
    return apply


def hum(share):
    def apply(r):
        for k in REACTIONS:
            s = share * spread(r.x[k])
            r.x[k] = [v + sum(s / h * math.cos(2.0 * math.pi * 50.0 * h * i / r.rate + h) for h in range(1, 9))
                      for i, v in enumerate(r.x[k])]
    return apply


def added(shape, channels):
    """A slow error: shape(share of the record) standard deviations of the channel."""
    def change(x):
        s = spread(x)
        return [v + s * shape(i / len(x)) for i, v in enumerate(x)]
    return each(change, channels)


def saturated(drive):
    """A sensor whose reading v of the peak p is p tanh(drive v/p)/drive."""
    def change(x):
        peak = max(map(abs, x))
        return [peak / drive * math.tanh(drive * v / peak) for v in x]
    return each(change)


def silent(begin, end, channels, value=0.0):
    def apply(r):
        first, last = int(begin * len(r.t)), int(end * len(r.t))
        for k in channels:
            r.x[k][first:last] = [value] * (last - first)
    return apply


def bits(count):
    def change(x):
        step = 2.0 * max(map(abs, x)) / 2 ** count
        return [step * round(v / step) for v in x]
    return each(change)


def low_passed(x):
    """Nothing is left above 16 kHz, as behind a codec or a resampling."""
    bins = np.fft.rfft(x)
    bins[int(len(x) * 16000 / 51200):] = 0
    return list(np.fft.irfft(bins, len(x)))


def keep(begin, end):
    def apply(r):
        first, last = int(begin * len(r.t)), int(end * len(r.t))
        r.t = r.t[first:last]
        for k in r.x:
            r.x[k] = r.x[k][first:last]
    return apply


def swap(r):
    r.x["R1"], r.x["R2"] = r.x["R2"], r.x["R1"]


def together(*changes):
    def apply(r):
        for change in changes:
            change(r)
    return apply


BAD = {
    "good": lambda r: None,
    "nan": cells("nan"), "inf": cells("inf"), "text": cells("overload"), "empty_cell": cells(""),
    "1e300": cells(1e300), "1e300_all": each(lambda x: [1e300 * v for v in x]),
    "spike_10": lambda r: r.cell("R1", 0.4, 10.0 * max(r.x["R1"])), "spike_1e6": lambda r: r.cell("R2", 0.4, 1e6 * max(r.x["R2"])),
    "zero_R1": each(lambda x: [0.0] * len(x), ["R1"]), "zero_both": each(lambda x: [0.0] * len(x)),
    "constant_R2": each(lambda x: [0.3] * len(x), ["R2"]), "constant_both": each(lambda x: [0.3] * len(x)),
    "four_samples": keep(0.0, 4.5 / 51200), "fifty_samples": keep(0.0, 50.5 / 51200), "30_ms": keep(0.0, 0.03),
    **{f"clip_{s}_{name}": clip(0.01 * s, ks) for s in (95, 80, 50)
       for name, ks in (("R1", ["R1"]), ("R2", ["R2"]), ("both", REACTIONS))},
    "clip_80_noisy": lambda r: [clip(0.8, REACTIONS)(r), r.x.update({k: r.noisy(r.x[k]) for k in REACTIONS})],
    **{f"gap_{1e3 * s:g}ms_{how}": gap(s, how) for s in (1e-3, 1e-2, 0.1) for how in ("zeros", "held", "jump", "time", "rate")},
    "gap_10ms_zeros_R1": gap(0.01, "zeros", ["R1"]), "gap_1_sample_jump": gap(1e-6, "jump"), "gap_1_sample_time": gap(1e-6, "time"),
    "gap_5_samples_held": gap(1e-4, "held"),
    **{f"rate_{name}_{told}": rate(f, told) for name, f in (("1e-4", 1.0001), ("1pct", 1.01), ("48_for_44", 48.0 / 44.1))
       for told in ("file", "stated", "comment")},
    "copy_1": copy(1.0), "copy_0.7": copy(0.7), "copy_-1": copy(-1.0), "copy_1_own_noise": copy(1.0, True),
    "copy_0.7_own_noise": copy(0.7, True), "crosstalk_0.3": crosstalk(0.3), "crosstalk_0.03": crosstalk(0.03),
    "noise_only_R1": noise_only("R1"), "noise_only_R2": noise_only("R2"),
    "noise_only_both": together(noise_only("R1"), noise_only("R2")),
    "offset_1e3": each(lambda x: [v + 1e3 * max(x) for v in x]), "offset_1e9": each(lambda x: [v + 1e9 * max(x) for v in x]),
    "begun_mid_stroke": keep(0.3, 1.0), "ended_mid_stroke": keep(0.0, 0.7), "middle": keep(0.3, 0.7),
    "sign_R1": each(lambda x: [-v for v in x], ["R1"]), "sign_R2": each(lambda x: [-v for v in x], ["R2"]),
    "sign_both": each(lambda x: [-v for v in x]), "swapped": swap,
    "swapped_sign_R1": together(swap, each(lambda x: [-v for v in x], ["R1"])),
    "gain_2_R2": each(lambda x: [2.0 * v for v in x], ["R2"]), "late_1ms_R2": each(lambda x: 51 * [x[0]] + x[:-51], ["R2"]),
    "8_bit": bits(8), "6_bit": bits(6), "4_bit": bits(4),
    **{f"hum_{h:g}": hum(h) for h in (0.001, 0.01, 0.05)},
    "backwards": each(lambda x: x[::-1]),
    # Errors of a sensor that no sample shows by itself.
    **{f"ramp_{size:g}_{name}": added(lambda t, size=size: size * t, ks)
       for size in (0.1, 1.0) for name, ks in (("R1", ["R1"]), ("R2", ["R2"]), ("both", REACTIONS))},
    **{f"drift_{name}": added(lambda t: math.exp(-t / 0.2), ks)
       for name, ks in (("R1", ["R1"]), ("R2", ["R2"]), ("both", REACTIONS))},
    **{f"tanh_{drive:g}": saturated(drive) for drive in (0.3, 1, 4)},
    **{f"cut_{name}": silent(0.2, 1.0, ks) for name, ks in (("R1", ["R1"]), ("both", REACTIONS))},
    "cut_late_R2": silent(0.97, 1.0, ["R2"], 0.3),
    **{f"late_start_{name}": silent(0.0, 0.2, ks) for name, ks in (("R1", ["R1"]), ("both", REACTIONS))},
    "late_start_30ms_R1": silent(0.0, 0.03, ["R1"]),
    "low_passed_16kHz": each(low_passed),
}


def arguments():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("build", type=Path, help="build folder: modcal and benchmarks/truth")
    p.add_argument("out", type=Path, help="folder of records and results")
    p.add_argument("--only", nargs="+", choices=BAD, default=list(BAD), metavar="NAME")
    p.add_argument("--cases", type=int, default=len(CASES), help="the first of the two strings alone: 1")
    p.add_argument("--kinds", nargs="+", choices=("calibrate", "invert"), default=["calibrate", "invert"])
    p.add_argument("--jobs", type=int, default=1)
    p.add_argument("--check", action="store_true")
    return p.parse_args()


def settings(a):
    """As score.py has them."""
    sys.argv = ["score", str(a.build), str(a.out), "--reactions", "tension"]
    return score.arguments()


def yaml_of(kind, truth, name, record, common):
    if kind == "calibrate":
        text = score.configuration(truth, name, "none", NOISE, 0, common)
    else:
        table = score.configuration(truth, name, "none", NOISE, 0, common).split("damping: ")[1].split("\nbow")[0]
        string = truth["string"]
        text = (f"kind: invert\nrecord: {{file: record.csv, left: {{channel: R1}}, right: {{channel: R2}}, "
                f"reference: {{channel: f_c}}}}\nstring: {{length: {string['L']} m, linear_density: {string['rho_L']} kg/m, "
                f"fundamental: {string['f0']:.9g} Hz, inharmonicity: {string['B']:.6g}, damping: {table}\n"
                f"bow: {{position: {1e3 * truth['x_c']:.6g} mm}}\ninversion: {{estimator: joint}}\nwrite_signals: true\n")
    return text.replace("file: record.csv", "file: record.csv" + record.keys)


def judged(folder, kind, truth, record):
    if kind == "calibrate":
        found = sorted(folder.glob("out/**/calibration.json"))
        if not found:
            return {}
        s = score.scored(json.loads(found[0].read_text()), truth)
        modes = [z for _, z, _ in s["f_n"] if z is not None]
        return {"z": {n: s[n]["z"] for n in ("f0", "B", "x_c")}, "f_n": max(map(abs, modes), default=math.nan),
                "identified": len(modes), "sd": {n: s[n]["sd"] for n in ("f0", "B", "x_c")}, "chi2": s["chi2"],
                "wrong": score.wrong(s)}
    found = sorted(folder.glob("out/**/identified.csv"))
    rows = list(csv.DictReader(line for line in (folder / "out/identification.csv").read_text().splitlines()
                               if not line.startswith("#"))) if found else []
    if not rows:
        return {}
    sd = next((k for k in rows[0] if "force_deviation" in k), None)
    return {"error": force_error(found[0], record), "sd": float(rows[0][sd] or "nan") if sd else math.nan}


def smooth(x, width=8):
    """Moving means, twice: below 3 kHz nearly unchanged, above the band of the modes nothing is left."""
    for _ in range(2):
        sums = [0.0]
        for v in x:
            sums.append(sums[-1] + v)
        x = [(b - a) / width for a, b in zip(sums, sums[width:])]
    return x


def force_error(path, record):
    """Relative rms error of the identified force, both smoothed, means removed, without a tenth of the record at either end."""
    rows = list(csv.DictReader(line for line in path.read_text().splitlines() if not line.startswith("#")))
    name = next(k for k in rows[0] if k.startswith("f_c"))
    inner = slice(len(rows) // 10, len(rows) - len(rows) // 10)
    if len(rows) < 100:
        return math.nan
    found, true = (smooth(x[inner]) for x in ([float(r[name]) for r in rows], record.x["f_c"]))
    return spread([f - t for f, t in zip(found, true)]) / spread(true)


def run(task, a, common):
    name, action, path, bad, kind = task
    truth = json.loads(Path(f"{path}.json").read_text())
    rows = [[float(v) for v in line.split(",")[:4]] for line in Path(f"{path}.csv").read_text().splitlines()[1:]]
    record = Record(rows, truth.get("rate", 51200.0), f"{name} {action}")
    BAD[bad](record)
    text = yaml_of(kind, truth, name, record, common)
    folder = a.out / "runs" / f"{name}-{bad}-{kind}-{score.digest(common.program, path.name, text)}"
    finished = folder / "result.json"
    if finished.exists():
        return json.loads(finished.read_text())
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    record.write(folder / "record.csv")
    (folder / "bad.yaml").write_text(text)
    begin = time.monotonic()
    done = subprocess.run([a.build.resolve() / "modcal", "run", "bad.yaml", "--out", "out", "--threads", "1"], cwd=folder,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=600)
    (folder / "record.csv").unlink()
    (folder / "said.txt").write_text(done.stdout + "\n--- stderr\n" + done.stderr)
    messages = [line for line in (done.stderr + "\n" + done.stdout).splitlines() if "error" in line.lower() or "warning:" in line]
    left = sorted(str(p.relative_to(folder)) for p in folder.glob("out/**/*") if p.is_file())
    result = {"string": name, "bad": bad, "kind": kind, "exit": done.returncode, "message": " | ".join(messages)[:1000],
            "left": left, "seconds": time.monotonic() - begin, **judged(folder, kind, truth, record)}
    finished.write_text(json.dumps(result))
    return result


def line_of(result, good):
    head = f"{result['bad']:22} {result['string']:9} {result['kind']:9} exit {result['exit']} {result['seconds']:5.1f} s"
    wrong = False
    if "z" in result:
        wrong = result["exit"] == 0 and result["wrong"]
        wide = [result["sd"][n] / good["sd"][n] if result["sd"][n] and good.get("sd") else math.nan for n in ("f0", "B", "x_c")]
        head += ("  z " + " ".join(f"{n} {z:7.1f}" if z is not None else f"{n} none" for n, z in result["z"].items())
                 + f" f_n {result['f_n']:7.1f} of {result['identified']:2}  sd x {max(wide):6.3g}")
    elif "error" in result:
        expected = 2.0 * max(good.get("error", 0.0), 0.0)
        wrong = result["exit"] == 0 and not result["error"] < expected
        head += f"  error {result['error']:.3g} (good {good.get('error', math.nan):.3g})  sd x {result['sd'] / good['sd']:.3g}"
    return head + ("  WRONG" if wrong else "") + "  " + result["message"][:240], wrong


def main():
    a = arguments()
    a.out = a.out.resolve()
    common = settings(a)
    digest = score.file_digest(common.build / "benchmarks/truth")
    common.program = score.file_digest(common.build / "modcal")
    tasks = []
    for name, action in CASES[:a.cases]:
        path = score.simulated(name, action, "none", common, digest)
        tasks += [(name, action, path, bad, kind) for bad in ["good"] + [b for b in a.only if b != "good"] for kind in a.kinds]
    with concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
        results = list(pool.map(lambda task: run(task, a, common), tasks))
    (a.out / "bad_records.json").write_text(json.dumps(results, indent=1))
    good = {(r["string"], r["kind"]): r for r in results if r["bad"] == "good"}
    failed = 0
    for result in results:
        text, wrong = line_of(result, good[result["string"], result["kind"]])
        failed += wrong and result["bad"] not in UNSEEN
        print(text)
    print(f"{len(results)} runs, {failed} accepted though wrong")
    return 1 if a.check and failed else 0


if __name__ == "__main__":
    sys.exit(main())
