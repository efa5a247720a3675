"""A string with a force sensor at both ends for force_from_table.py: records, table of modes and modcal's inversion of a string.

BUILD/benchmarks/truth (finite differences, no code of modcal's libraries; benchmarks/truth/README.md) makes the records: violin
D, 294 Hz, 0.33 m, contact at 41 mm, 0.1 s at 20 kHz from 5 ms before the force on, with noise of 1 % of each reaction's rms.
`blow` is a triangular pulse of 2 N and .5 to .7 ms, `stroke` a bow of 1 N at 0.08 to 0.12 m/s with exponential friction. The
table is written from what is true of the string: f_n and damping ratios of all modes below 10 kHz, residues
-T n pi/L sin(n pi x_c/L) 2/(rho L) of R1 (R2: times (-1)^(n+1)), and the static sum of all modes above. Its band is 0.1 Hz to
9 kHz.
"""
import json
import subprocess

import numpy as np

RATE, DURATION, START, HIGH, NOISE, CONTACT = 20000, 0.1, 0.005, 9000, 0.01, 0.041


def columns(path):
    """Of a CSV file, by their names."""
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    return np.genfromtxt(lines, delimiter=",", names=True)


def records(build, folder, kind, draws):
    """Writes so many records, FOLDER/string_KIND_DRAW.csv, and the table of the string."""
    files = [folder / f"string_{kind}_{draw}.csv" for draw in range(draws)]
    for draw, file in enumerate(files):
        share = draw / max(draws - 1, 1)
        half = 0.25e-3 + 0.1e-3 * share
        act = (["force", "--force", f"0:0,{half:g}:2,{2 * half:g}:0"] if kind == "blow" else
               ["exponential", "--normal-force", "1", "--velocity", f"{0.08 + 0.04 * share:g}"])
        options = {"x": CONTACT, "rate": RATE, "duration": DURATION, "start": -START, "noise": NOISE, "seed": draw + 1}
        subprocess.run([build / "benchmarks/truth", file.with_suffix(""), *(f"--{key}={value}" for key, value in options.items()),
                        "--action", *act], check=True, capture_output=True)
    table = folder / f"string_{kind}_table.yaml"
    table.write_text(json.dumps(table_of(json.loads(files[0].with_suffix(".json").read_text()), files[0]), indent=1))
    return files, table


def table_of(truth, file):
    string, share = truth["string"], truth["x_c"] / truth["string"]["L"]
    f, zeta = (np.array(truth["modes"][key]) for key in ("f", "zeta"))
    count, n = int(np.sum(f < RATE / 2)), np.arange(1, 100001)
    omega = 2 * np.pi * string["f0"] * n * np.sqrt(1 + string["B"] * n**2)
    one = -string["T"] * n * np.pi / string["L"] * np.sin(n * np.pi * share) * 2 / (string["rho_L"] * string["L"])
    residues = np.array([one, -(-1.0) ** n * one])
    static = (residues / omega**2)[:, count:].sum(axis=1)
    read = columns(file)
    rms = [read["R1_N"].std(), read["R2_N"].std()]
    return {
        "low": 0.1, "high": HIGH,
        "sensors": [{"name": f"R{k + 1}", "kind": "force", "constant": static[k], "scatter": 0, "noise": NOISE * rms[k]}
                    for k in (0, 1)],
        "modes": [{"frequency": f[i], "damping_ratio": zeta[i], "constants": list(residues[:, i])} for i in range(count)],
    }


def by_invert(build, out, record):
    """Force and deviation of `kind: invert` by both ends, of the whole record; the string is the true one. None: refused."""
    truth = json.loads(record.with_suffix(".json").read_text())
    string, modes = truth["string"], truth["modes"]
    known = [(f, zeta) for f, zeta in zip(modes["f"], modes["zeta"]) if f < RATE / 2]
    out.mkdir(parents=True, exist_ok=True)
    file = out / "invert.yaml"
    file.write_text(
        f"kind: invert\nrecord: {{file: {record.resolve()}, left: {{channel: R1}}, right: {{channel: R2}}}}\n"
        f"string: {{length: {string['L']} m, linear_density: {string['rho_L']}, fundamental: {string['f0']} Hz, "
        f"inharmonicity: {string['B']}, modes: {len(known)}, "
        f"damping: {{type: table, frequencies: [{', '.join(f'{f:.9g} Hz' for f, _ in known)}], "
        f"ratios: [{', '.join(f'{zeta:.9g}' for _, zeta in known)}]}}}}\n"
        f"bow: {{position: {truth['x_c']} m}}\ninversion: {{estimator: joint}}\nwrite_signals: true\n")
    done = subprocess.run([build / "modcal", "run", file, "--out", out / "run"], capture_output=True, text=True)
    if done.returncode:
        print(f"invert refuses {record.stem}: {done.stderr.splitlines()[0]}")
        return None
    found = columns(out / "run/identified.csv")
    return [found[name] for name in ("f_c_joint_N", "f_c_joint_deviation_N")]
