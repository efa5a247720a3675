#!/usr/bin/env python3
"""Force and velocity that `modcal` inverts from records that it has not made, against their truth.

invert_score.py BUILD OUT adds noise to records of benchmarks/truth as score.py does (its options hold here, too; by default the
violin D string under exponential and thermal friction, 0, 1 and 5 %, one draw), inverts each with the true string by every
estimator of --estimators and prints, between a tenth of the record and 95 % of it and without the means, which sensors do not give:
the relative rms error of the force below 9 kHz and the share of true samples within the 95 % bands of force and velocity. A band
is compared with what it is of: the truth below the limit of the band that the estimate states. --sides R1 R2 both inverts one
reaction, too, --start 0.2 the record from there on. What is finished stays in OUT.
"""
import cmath
import csv
import itertools
import json
import math
import subprocess
import sys
import time
from functools import lru_cache
from pathlib import Path

import score

CUT = 9000.0
# Lines of the experiment, and the side in identified.csv.
ESTIMATORS = {
    "joint": ("inversion: {{estimator: {{type: joint{keys}}}}}\n", "joint"),
    "model_based": ("inversion: {{estimator: joint}}\nmodel_based: {{{keys}}}\n", "model"),
    "auto": ("inversion: {{estimator: {{type: auto{keys}}}}}\n", "auto"),
}


@lru_cache(maxsize=None)
def twiddles(n):
    return [cmath.exp(-2j * math.pi * k / n) for k in range(n)]


def fft(x):
    """Mixed radix by the smallest factor."""
    n = len(x)
    p = next((q for q in range(2, math.isqrt(n) + 1) if n % q == 0), n)
    if n == 1:
        return list(x)
    parts, m, w = [fft(x[r::p]) for r in range(p)], n // p, twiddles(n)
    if p == 2:
        odd = [w[k] * v for k, v in enumerate(parts[1])]
        return [a + b for a, b in zip(parts[0], odd)] + [a - b for a, b in zip(parts[0], odd)]
    return [sum(parts[r][k % m] * w[r * k % n] for r in range(p)) for k in range(n)]


def below(x, rate, cut):
    """The part below a frequency [Hz]."""
    n = len(x)
    if cut >= 0.5 * rate:
        return x
    spectrum = fft(x)
    kept = [v if min(k, n - k) * rate / n <= cut else 0.0 for k, v in enumerate(spectrum)]
    return [v.real / n for v in fft([v.conjugate() for v in kept])]


@lru_cache(maxsize=None)
def missing_compliance(truth_path):
    """What modes beyond the grid, and those that interpolation weakens, would add to y/f [m/N] (truth.hpp: the rest is exact)."""
    truth = json.loads(Path(f"{truth_path}.json").read_text())
    string, scheme = truth["string"], truth["scheme"]
    place, mass = truth["x_c"] / string["L"], 0.5 * string["rho_L"] * string["L"]
    stiffness = mass * (2.0 * math.pi * string["f0"]) ** 2
    whole = sum(math.sin(n * math.pi * place) ** 2 / (n * n * (1.0 + string["B"] * n * n)) for n in range(1, 20001)) / stiffness
    points, at = 2 * scheme["half_width"], place * scheme["intervals"]
    first = math.floor(at) + 1 - points // 2
    weights = [math.prod((at - first - j) / (i - j) for j in range(points) if j != i) for i in range(points)]
    grid = 0.0
    for n, f in enumerate(truth["modes"]["f"], 1):
        shape = sum(w * math.sin(n * math.pi * (first + i) / scheme["intervals"]) for i, w in enumerate(weights))
        grid += shape * shape / (mass * (2.0 * math.pi * f) ** 2)
    return whole - grid


def slope(x, rate):
    """Its derivative, by that of its Fourier series."""
    n = len(x)
    turned = [2j * math.pi * (k if 2 * k < n else k - n) * rate / n * v for k, v in enumerate(fft(x))]
    return [v.real / n for v in fft([v.conjugate() for v in turned])]


def inner(x):
    x = x[len(x) // 10:int(0.95 * len(x))]
    mean = sum(x) / len(x)
    return [v - mean for v in x]


def rms(x):
    return math.sqrt(sum(v * v for v in x) / len(x))


def columns(path):
    rows = csv.reader(line for line in path.read_text().splitlines() if not line.startswith("#"))
    names = [name.split(" ")[0] for name in next(rows)]
    return dict(zip(names, map(list, zip(*([float(v) for v in row] for row in rows)))))


def first_number(path, *keys):
    """Of the first row of a table written as CSV; NaN where it is not there."""
    if not path.exists():
        return math.nan
    rows = list(csv.DictReader(line for line in path.read_text().splitlines() if not line.startswith("#")))
    name = next((k for k in rows[0] if k.split(" [")[0] in keys), None) if rows else None
    return float(rows[0][name] or "nan") if name else math.nan


def held(found, true, deviation):
    """Share of the truth within 1.96 deviations."""
    off = inner([a - b for a, b in zip(found, true)])
    sd = deviation[len(deviation) // 10:int(0.95 * len(deviation))]
    return sum(abs(d) <= 1.96 * s for d, s in zip(off, sd)) / len(off)


def judged(folder, side, truth_path, rate, start):
    found = columns(folder / "out/identified.csv")
    true = columns(Path(f"{truth_path}.csv"))
    missing = missing_compliance(truth_path)
    true["v"] = [v + missing * d for v, d in zip(true["v"], slope(true["f_c"], rate))]
    true = {name: values[round(start * rate):] for name, values in true.items()}
    force = found.get(f"f_c_{side}_unaliased", found[f"f_c_{side}"])
    exact = inner(below(true["f_c"], rate, CUT))
    off = inner(below([a - b for a, b in zip(force, true["f_c"])], rate, CUT))
    line = {"error": rms(off) / rms(exact)}
    limit = first_number(folder / "out/identification.csv", "band_limit", "identified up to") if side != "model" else math.nan
    line["band_limit"] = limit
    for name, signal in (("f_c", force), ("v", found.get(f"v_{side}"))):
        deviation = found.get(f"{name}_{side}_deviation")
        if deviation is None and side != "model":
            key = {"f_c": "force_deviation", "v": "velocity_deviation"}[name]
            deviation = [first_number(folder / "out/identification.csv", key)] * len(force)
        if deviation is None or signal is None:
            continue
        exact = true[name] if math.isnan(limit) else below(true[name], rate, limit)
        line[f"held_{name}"] = held(signal, exact, deviation)
        line[f"sd_{name}"] = sum(deviation) / len(deviation)
        line[f"off_{name}"] = rms(inner([a - b for a, b in zip(signal, exact)]))
    return line


def configuration(truth, name, noise, sides, estimator, keys, a):
    text = score.configuration(truth, name, "none", noise, 0, a)
    damping = text.split("damping: ")[1].split("\nbow")[0]
    string = truth["string"]
    if keys and estimator != "model_based":
        keys = ", " + keys
    ends = {"both": "left: {channel: R1}, right: {channel: R2}", "R1": "left: {channel: R1}", "R2": "right: {channel: R2}"}[sides]
    return (f"kind: invert\nrecord: {{file: record.csv, {ends}, start: {a.start:g} s}}\n"
            f"string: {{length: {string['L']} m, linear_density: {string['rho_L']} kg/m, fundamental: {string['f0']:.9g} Hz, "
            f"inharmonicity: {string['B']:.6g}, damping: {damping}\nbow: {{position: {1e3 * truth['x_c']:.9g} mm}}\n"
            + ESTIMATORS[estimator][0].format(keys=keys) + "write_signals: true\n")


def inverted(path, name, noise, draw, sides, estimator, keys, a):
    truth = json.loads(Path(f"{path}.json").read_text())
    text = configuration(truth, name, noise, sides, estimator, keys, a)
    folder = a.out / "runs" / f"{path.name}-{noise:g}-{draw}-{estimator}-{score.digest(a.program, text)}"
    if (folder / "score.json").exists():
        return json.loads((folder / "score.json").read_text())
    folder.mkdir(parents=True, exist_ok=True)
    score.with_noise(path, noise, draw, {}, folder)
    (folder / "invert.yaml").write_text(text)
    begin = time.monotonic()
    done = subprocess.run([a.build / "modcal", "run", "invert.yaml", "--out", "out"], cwd=folder,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    (folder / "said.txt").write_text(done.stdout)
    line = {"seconds": time.monotonic() - begin, "exit": done.returncode, "said": done.stdout[-600:]}
    if done.returncode == 0:
        line |= judged(folder, ESTIMATORS[estimator][1], path, a.rate, a.start)
    (folder / "score.json").write_text(json.dumps(line))
    return line


def options():
    """Those of score.py, with defaults of our own, and four more."""
    more = {"--estimators": ["joint", "model_based"], "--keys": [""], "--sides": ["both"], "--start": ["0"]}
    rest, given, name = [], {}, None
    for word in sys.argv[1:]:
        name = word if word.startswith("--") else name
        if name in more:
            given.setdefault(name, [])
            given[name] += [word] if word != name else []
        else:
            rest.append(word)
    for name, default in (("--strings", ["violin_d"]), ("--actions", ["exponential", "thermal"]), ("--noise", ["0", "0.01", "0.05"]),
                          ("--draws", ["1"])):
        rest += [] if name in rest else [name, *default]
    sys.argv[1:] = rest
    a = score.arguments()
    a.estimators = given.get("--estimators", more["--estimators"])
    a.keys = " ".join(given.get("--keys", more["--keys"]))
    a.sides = given.get("--sides", more["--sides"])
    a.start = float(given.get("--start", more["--start"])[0])
    return a


def main():
    a = options()
    a.program = score.file_digest(a.build / "modcal")
    truth_digest = score.file_digest(a.build / "benchmarks/truth")
    for name, action in a.pairs:
        path = score.simulated(name, action, "none", a, truth_digest)
        for noise in a.noise:
            for draw in range(a.draws):
                for sides, estimator in itertools.product(a.sides, a.estimators):
                    line = inverted(path, name, noise, draw, sides, estimator, "" if estimator == "joint" else a.keys, a)
                    text = "  ".join(f"{k} {v:.4g}" for k, v in line.items() if k not in ("said", "exit"))
                    print(f"{name} {action} {100 * noise:g} % {sides:4} {estimator:11} "
                          + (text if line["exit"] == 0 else f"exit {line['exit']} {line['said']}"), flush=True)


if __name__ == "__main__":
    main()
