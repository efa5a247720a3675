#!/usr/bin/python3
"""Coverage of the error bars of `kind: identify` on plucks that modcal has not made.

pluck_score.py BUILD OUT lets go strings of BUILD/benchmarks/truth (--action pluck), adds what each row of ROWS states, identifies
every record with BUILD/modcal from an f0 that is off by up to 1 %, and prints a line per row and noise: records, accepted (exit code
0), refused; of the accepted how many of the frequencies and damping ratios lie within 1.96 of their deviations (a Gaussian: 95 %)
and the largest |z|. Then every answer that is accepted though one of its modes is off by more than 5 deviations, and every refusal
with its reason. A record holds the string at rest for up to .3 s before it is let go; that, its noise and all else that is drawn
come from numpy's default_rng((DRAW, STRING, NOISE)), the same in all rows. What is finished stays in OUT: the same command goes on
where it stopped.
"""
import argparse
import concurrent.futures
import json
import math
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import score

HELD, DECAY = 0.3, 1.5  # [s]
# What is done to a record before and after its noise: factors of f0, then shares of both reactions' standard deviations in the decay.
ROWS = {
    "none": {},
    **{f"hum_{h:g}": {"hum": h} for h in (0.001, 0.01, 0.05)},
    "hum_60hz_0.01": {"hum": 0.01, "mains": 60.0},
    # Amplitude and phase change by a fifth and half a radian over the record.
    "hum_changing_0.01": {"hum": 0.01, "changing": True},
    # The string is tuned to the mains: a line stands within some tenths of a hertz of its first mode.
    "hum_in_tune_0.01": {"hum": 0.01, "in_tune": True},
    "in_tune": {"in_tune": True},
    "second_plane": {"plane": (2e-3, 0.1)},
    "8_bit": {"bits": 8},
    "8_bit_half": {"bits": 8, "used": 0.5},
    "8_bit_third": {"bits": 8, "used": 0.3},
    "8_bit_fifth": {"bits": 8, "used": 0.2},
    "8_bit_low": {"bits": 8, "used": 0.1},
    "10_bit_low": {"bits": 10, "used": 0.1},
    "12_bit": {"bits": 12},
    "gain_1.5": {"gain": 1.5},
    "clipped": {"clipped": 0.6},
}


def arguments():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("build", type=Path, help="build folder: modcal and benchmarks/truth")
    p.add_argument("out", type=Path, help="folder of records and results")
    p.add_argument("--truth", type=Path, help="build folder of truth, if it is another one")
    p.add_argument("--jobs", type=int, default=1)
    p.add_argument("--strings", nargs="+", choices=score.STRINGS, default=["violin_d", "violin_g", "cello_d"])
    p.add_argument("--noise", nargs="+", type=float, default=[0.001, 0.01, 0.05])
    p.add_argument("--draws", type=int, default=2, help="of each string, noise and row")
    p.add_argument("--rows", nargs="+", choices=ROWS, default=list(ROWS), metavar="NAME", help=", ".join(ROWS))
    p.add_argument("--rate", type=float, default=51200.0)
    p.add_argument("--timeout", type=float, default=120.0, help="of one identification [s]")
    a = p.parse_args()
    a.build, a.out = a.build.resolve(), a.out.resolve()
    a.program = score.file_digest(a.build / "modcal")
    if a.truth:
        a.simulator = score.file_digest(a.truth / "benchmarks/truth")
    else:
        a.simulator = score.file_digest(a.build / "benchmarks/truth")
    return a


def fundamental_of(name, row):
    """f0 of the string; in tune with the mains its first mode, f0 sqrt(1 + B), is a multiple of 50 Hz."""
    f0, B = score.STRINGS[name][:2]
    if "in_tune" in ROWS[row]:
        f0 = 50.0 * round(f0 / 50.0) / math.sqrt(1.0 + B)
    return f0


def record_of(name, f0, a):
    """Path of a clean record's files without their endings, of a string of this f0."""
    _, B, L, rho, x, _, s0, s1 = score.STRINGS[name]
    command = ["--action", "pluck", "--f0", f"{f0:.12g}", "--B", B, "--length", L, "--density", rho, "--x", x, "--loss", s0,
               "--diffusion", s1, "--rate", a.rate, "--start", -HELD, "--duration", HELD + DECAY]
    where = argparse.Namespace(out=a.out, build=(a.truth or a.build).resolve())
    path = score.made(f"{name}-pluck", list(map(str, command)), where, a.simulator)
    if not path.with_suffix(".npy").exists():
        np.save(path.with_suffix(".npy"), np.loadtxt(f"{path}.csv", delimiter=",", skiprows=1, usecols=(1, 2)).T)
    return path


def hum_of(how, draws, rate, count):
    """Of both reactions, for one of standard deviation 1: eight harmonics of amplitudes 1/h, F off by up to .1 Hz."""
    mains = how.get("mains", 50.0) + draws.uniform(-0.1, 0.1)
    t = np.arange(count) / rate
    phases = draws.uniform(0.0, 2.0 * math.pi, (2, 8))
    result = np.zeros((2, count))
    place = t / t[-1] - 0.5 if how.get("changing") else 0.0 * t
    for h in range(1, 9):
        for r in range(2):
            result[r] += (1.0 + 0.2 * place) / h * np.cos(2.0 * math.pi * h * mains * t + phases[r, h - 1] + 0.5 * place)
    return how["hum"] * result


def spoiled(name, row, noise, draw, a):
    """Both reactions with what the row states, and the truth of them."""
    how, f0 = ROWS[row], fundamental_of(name, row)
    path = record_of(name, f0, a)
    x = np.load(path.with_suffix(".npy"))
    if "plane" in how:
        detuning, share = how["plane"]
        x = x + share * np.load(record_of(name, f0 * (1.0 + detuning), a).with_suffix(".npy"))
    draws = np.random.default_rng((draw, list(score.STRINGS).index(name), round(1e6 * noise)))
    begin = int(draws.uniform(0.0, HELD - 0.02) * a.rate)
    off = draws.uniform(-0.01, 0.01)
    sigma = x[:, int(HELD * a.rate):].std(axis=1)[:, None]
    x = x[:, begin:]
    x = x + noise * sigma * draws.standard_normal(x.shape)
    if "hum" in how:
        x = x + sigma * hum_of(how, draws, a.rate, x.shape[1])
    x[1] *= how.get("gain", 1.0)
    if "clipped" in how:
        most = how["clipped"] * np.abs(x).max(axis=1)[:, None]
        x = np.clip(x, -most, most)
    if "bits" in how:
        step = 2.0 * np.abs(x).max(axis=1)[:, None] / 2 ** how["bits"] / how.get("used", 1.0)
        x = step * np.round(x / step)
    return x, json.loads(path.with_suffix(".json").read_text()), f0 * (1.0 + off)


def judged(found, truth):
    """(n, z of f, z of zeta, f found, f true) of every mode; the truth has every number."""
    true = truth["modes"]
    return [(m["n"], (m["f_hz"] - true["f"][m["n"] - 1]) / m["f_sd_hz"], (m["zeta"] - true["zeta"][m["n"] - 1]) / m["zeta_sd"],
             m["f_hz"], true["f"][m["n"] - 1]) for m in found["modes"] if m["f_sd_hz"] and m["zeta_sd"]]


def identified(task, a):
    """Runs one identification: a line of the results."""
    name, row, noise, draw, key = task
    folder = a.out / "runs" / key
    folder.mkdir(parents=True, exist_ok=True)
    x, truth, fundamental = spoiled(name, row, noise, draw, a)
    t = np.arange(x.shape[1]) / a.rate
    np.savetxt(folder / "pluck.csv", np.column_stack([t, *x]), delimiter=",", fmt="%.12g", header="t [s],R1 [N],R2 [N]", comments="")
    (folder / "identify.yaml").write_text("kind: identify\nrecord: {file: pluck.csv, left: {channel: R1}, right: {channel: R2}}\n"
                                          f"fundamental: {fundamental:.6g} Hz\n")
    line = {"key": key, "string": name, "row": row, "noise": noise, "draw": draw, "modes": []}
    begin = time.monotonic()
    try:
        done = subprocess.run([a.build / "modcal", "run", "identify.yaml", "--out", "out", "--threads", "1"], cwd=folder,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=a.timeout)
        line |= {"exit": done.returncode, "accepted": done.returncode == 0, "said": done.stdout.strip()[-600:]}
        found = folder / "out/identification.json"
        if found.exists():
            line["modes"] = judged(json.loads(found.read_text()), truth)
    except subprocess.TimeoutExpired:
        line |= {"exit": None, "accepted": False, "said": f"longer than {a.timeout:g} s"}
    line["wall"] = time.monotonic() - begin
    shutil.rmtree(folder)
    return line


def farthest(line):
    """The mode that is off most: (z, what, mode)."""
    return max(((abs(z), what, m) for m in line["modes"] for what, z in (("f", m[1]), ("zeta", m[2]))), default=(0.0, "", None))


def share(z):
    return f"{100.0 * np.mean(np.abs(z) <= 1.96):5.1f} % {np.abs(z).max():8.1f}" if len(z) else "    –        –"


def summary(lines, a):
    print(f"{'row':18} {'noise':>6} {'n':>3} {'acc.':>5} {'ref.':>5} {'wrong':>5}  modes  f in 95 %, largest |z|  zeta in 95 %, largest |z|")
    for row in a.rows:
        for noise in a.noise:
            chosen = [line for line in lines if (line["row"], line["noise"]) == (row, noise)]
            accepted = [line for line in chosen if line["accepted"]]
            modes = [m for line in accepted for m in line["modes"]]
            wrong = sum(farthest(line)[0] > 5.0 for line in accepted)
            print(f"{row:18} {100 * noise:4g} % {len(chosen):3} {len(accepted):5} {len(chosen) - len(accepted):5} {wrong:5}  {len(modes):5}"
                  f"  {share([m[1] for m in modes]):>22}  {share([m[2] for m in modes]):>25}")
    print()
    for line in lines:
        z, what, m = farthest(line)
        label = f"{line['row']}, {line['string']}, noise {100 * line['noise']:g} %, draw {line['draw']}"
        if line["accepted"] and z > 5.0:
            print(f"WRONG  {label}: {what} of mode {m[0]} by {z:.1f} deviations, {m[3]:.6g} Hz for {m[4]:.6g} Hz")
        if not line["accepted"]:
            right = f"right (largest |z| {z:.1f})" if m and z <= 5.0 else f"off by {z:.1f} deviations" if m else "without modes"
            said = next((t for t in line["said"].split("\n") if "rejected" in t or "error" in t), line["said"].split("\n")[-1])
            print(f"refused  {label}, {right}: {said[:260]}")


def main():
    a = arguments()
    tasks = []
    for row in a.rows:
        for name in a.strings:
            record_of(name, fundamental_of(name, row), a)
            for noise in a.noise:
                for draw in range(a.draws):
                    key = f"{name}-{row}-{noise:g}-{draw}-{score.digest(a.program, a.simulator, a.rate, ROWS[row])}"
                    tasks.append((name, row, noise, draw, key))
    a.out.mkdir(parents=True, exist_ok=True)
    done = score.finished(a.out, {task[-1] for task in tasks})
    todo = [task for task in tasks if task[-1] not in done]
    print(f"{len(tasks)} identifications, {len(done)} of them done before", flush=True)
    with concurrent.futures.ThreadPoolExecutor(a.jobs) as pool, open(a.out / "results.jsonl", "a") as results:
        for line in pool.map(lambda task: identified(task, a), todo):
            results.write(json.dumps(line) + "\n")
            results.flush()
            done[line["key"]] = line
            print(f"{len(done)}/{len(tasks)} {line['key']} {'accepted' if line['accepted'] else 'refused'}", file=sys.stderr, flush=True)
    summary([done[task[-1]] for task in tasks], a)


if __name__ == "__main__":
    main()
