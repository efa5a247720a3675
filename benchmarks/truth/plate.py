#!/usr/bin/env python3
"""Strikes of a plate that modcal's model does not know, and how right its force is.

plate.py BUILD OUT makes a plate of free edges by finite differences (masses, bending by the discrete biharmonic of Ritz, local
dampers: complex modes), steps it exactly in time under a hammer's force (matrix exponential, force linear between steps),
reads accelerations through an anti-alias filter, fits a table to one strike (`modcal fit_modes`) and identifies the force of
another one (`modcal identify_force`) after the plate has changed: stiffness, damping and sensitivities of the sensors are off
by what --change says. With --sessions S no modes are fitted: S sessions of four strikes each, the plate changed by --change
between them, give response functions (H1) with coherence in universal files. With --strikes S modes are fitted to S strikes, the plate
changed by --change between them (with --sessions S: to the S response functions). Prints relative error and the share of the samples that
lie in the 95 % band, all and about the pulse, and how far the poles of the changed plates are off in the table's deviations.
"""
import argparse
import json
import re
import subprocess
from pathlib import Path

import numpy as np
from scipy import linalg, optimize, signal

RATE, STEPS = 4000.0, 8  # of the record [Hz], steps of the integration a sample
COLUMNS, ROWS, SPACING = 9, 7, 0.06  # nodes, [m]
SENSORS = ((0, 0), (8, 1), (2, 5), (6, 6))
CONTACT = (3, 2)


def plate(rng, change):
    """M, C, K of a plate of 1.5 kg on soft supports."""
    n = COLUMNS * ROWS

    def node(i, j):
        return i * ROWS + j

    def row(*terms):
        r = np.zeros(n)
        for (i, j), v in terms:
            r[node(i, j)] += v
        return r

    stiffness = np.zeros((n, n))
    bending = 500.0 * (1 + change * rng.standard_normal())
    for i in range(COLUMNS):  # energy of the curvatures and of the twist
        for j in range(ROWS):
            if 0 < i < COLUMNS - 1:
                r = row(((i - 1, j), 1), ((i, j), -2), ((i + 1, j), 1))
                stiffness += np.outer(r, r)
            if 0 < j < ROWS - 1:
                r = row(((i, j - 1), 1), ((i, j), -2), ((i, j + 1), 1))
                stiffness += 1.1 * np.outer(r, r)
            if i < COLUMNS - 1 and j < ROWS - 1:
                r = row(((i, j), 1), ((i + 1, j), -1), ((i, j + 1), -1), ((i + 1, j + 1), 1))
                stiffness += 1.4 * np.outer(r, r)
    stiffness *= bending / SPACING**2
    mass = np.full(n, 1.5 / n)
    for corner, kg in (((0, 6), 0.05), ((7, 3), 0.08)):
        mass[node(*corner)] += kg * (1 + 5 * change * rng.standard_normal())
    for corner, factor in (((0, 0), 3e4), ((8, 6), 2e4), ((8, 0), 4e4), ((0, 6), 2.5e4)):  # soft supports
        stiffness[node(*corner), node(*corner)] += factor
    damping = 1.5 * np.diag(mass) + 4e-6 * stiffness
    for place, c in (((4, 0), 3.0), ((1, 3), 2.0), ((8, 4), 2.0)):
        damping[node(*place), node(*place)] += c * (1 + 100 * change * rng.standard_normal())
    return mass, damping, stiffness, node


def hammer(rng, count, start, kind):
    """Pulses on a grid of RATE STEPS [N]."""
    t = np.arange(count) / (RATE * STEPS)
    force = np.zeros(count)
    if kind == "strike":
        for at, height, width in ((start, 80.0, 0.0022), (start + 0.031, 25.0, 0.0028)):
            width *= 1 + 0.1 * rng.standard_normal()
            inside = (t > at) & (t < at + width)
            force[inside] += height * np.sin(np.pi * (t[inside] - at) / width) ** 1.5
        return force
    if kind in ("push", "step"):  # 20 N that rise in 50 ms and are let go in 1 ms, or set in and stay
        at = start + 0.25 + 0.1 * rng.random()
        return 20.0 * np.interp(t, *((start, start + 0.05, at, at + 1e-3), (0, 1, 1, 0)) if kind == "push" else
                                ((at, at + 1e-3), (0, 1)))
    noise = rng.standard_normal(count)  # smooth: never stops
    force = signal.sosfilt(signal.butter(2, [15, 300], "bandpass", fs=RATE * STEPS, output="sos"), noise)
    force *= 5.0 / force.std()
    force[t < start] = 0
    return force


def record(rng, change, duration, kind="strike", noise=0.002, own=None):
    mass, damping, stiffness, node = plate(rng, change)
    n, step = mass.size, 1 / (RATE * STEPS)
    system = np.zeros((2 * n + 2, 2 * n + 2))  # state, force, its slope
    system[:n, n:2 * n] = np.eye(n)
    system[n:2 * n, :n] = -stiffness / mass[:, None]
    system[n:2 * n, n:2 * n] = -damping / mass[:, None]
    system[n + node(*CONTACT), 2 * n] = 1 / mass[node(*CONTACT)]
    system[2 * n, 2 * n + 1] = 1
    advance = linalg.expm(system * step)[:2 * n]
    by_state, by_force, by_slope = advance[:, :2 * n], advance[:, 2 * n], advance[:, 2 * n + 1]
    gains = 1 + 10 * change * rng.standard_normal(len(SENSORS)) if own else None
    rng = own or rng
    count = int(duration * RATE) * STEPS
    force = hammer(rng, count + 1, 0.012, kind)
    places = [node(*s) for s in SENSORS]
    rows = system[n:2 * n, :2 * n][places]
    direct = system[n:2 * n, 2 * n][places]
    state, read = np.zeros(2 * n), np.empty((count, len(places)))
    for j in range(count):
        read[j] = rows @ state + direct * force[j]
        state = by_state @ state + by_force * force[j] + by_slope * (force[j + 1] - force[j]) / step
    # The same anti-alias filter on force and responses.
    low_pass = signal.firwin(24 * STEPS + 1, 0.42 * RATE, fs=RATE * STEPS, window=("kaiser", 9.0))
    keep = lambda x: signal.lfilter(low_pass, 1, x, axis=0)[::STEPS]
    responses, force = keep(read), keep(force[:-1])
    responses *= 1 + 10 * change * rng.standard_normal(len(places)) if gains is None else gains
    responses += noise * responses.std(axis=0) * rng.standard_normal(responses.shape)
    force = force + 0.001 * force.std() * rng.standard_normal(force.shape)
    return force, responses


def write(path, force, responses):
    t = np.arange(force.size) / RATE
    header = "t [s],force [N]," + ",".join(f"a{k + 1} [m/s2]" for k in range(responses.shape[1]))
    np.savetxt(path, np.column_stack([t, force, responses]), "%.7g", ",", header=header, comments="")


def functions_of(rng, change, duration, strikes=4, highest=900.0):
    """H1 and coherence of so many strikes on one plate, K x lines from 0 Hz on."""
    seed = rng.integers(1 << 62)
    cross = power = powers = 0
    for strike in range(strikes):
        # The same plate every time, another noise and another hammer.
        force, responses = record(np.random.default_rng(seed), change, duration, own=np.random.default_rng([seed % 997, strike]))
        f, y = np.fft.rfft(force), np.fft.rfft(responses, axis=0)
        cross, power, powers = cross + np.conj(f)[:, None] * y, power + abs(f) ** 2, powers + abs(y) ** 2
    lines = int(highest * duration) + 1
    return (cross / power[:, None]).T[:, :lines], (abs(cross) ** 2 / (power[:, None] * powers)).T[:, :lines]


def write_functions(path, values, coherence, step):
    """Datasets 58: response functions h1, h2, ... and their coherences c1, c2, ..."""
    def axis(code, label, unit):
        return f"{code:10d}{0:5d}{0:5d}{0:5d} {label:20s} {unit:20s}\n"

    with open(path, "w") as out:
        for k, (h, c) in enumerate(zip(values, coherence)):
            for name, kind, ordinate, y in ((f"h{k + 1}", 4, 6, h), (f"c{k + 1}", 6, 4, c)):
                out.write(f"{-1:6d}\n{58:6d}\n{name}\nNONE\nNONE\nNONE\nNONE\n"
                          f"{kind:5d}{0:10d}{0:5d}{0:10d} {'NONE':10s}{k + 2:10d}{3:4d} {'NONE':10s}{1:10d}{3:4d}\n"
                          f"{ordinate:10d}{y.size:10d}{1:10d}{0.0:13.5E}{step:13.5E}{0.0:13.5E}\n")
                out.write(axis(18, "Frequency", "Hz") + axis(12 if kind == 4 else 0, "Response", "m/s2" if kind == 4 else "NONE")
                          + axis(13 if kind == 4 else 0, "Force", "N" if kind == 4 else "NONE") + axis(0, "NONE", "NONE"))
                columns = (y.real, y.imag) if kind == 4 else (y, )
                numbers = np.column_stack(columns).ravel()
                per_line = 4 if kind == 4 else 6
                width = 20 if kind == 4 else 13
                for i in range(0, numbers.size, per_line):
                    out.write("".join(f"{x:{width}.{11 if kind == 4 else 5}E}" for x in numbers[i:i + per_line]) + "\n")
                out.write(f"{-1:6d}\n")


def measure_functions(out, sessions, change, duration=2.0):
    names = []
    for session in range(sessions):
        rng = np.random.default_rng([11, session, int(1e6 * change)])
        names.append(f"functions_{change:g}_{session}.uff")
        if not (out / names[-1]).exists():
            # The first session is of the plate as it is, as the modes are.
            write_functions(out / names[-1], *functions_of(rng, change if session else 0, duration), 1 / duration)
    responses = ", ".join(f"{{channel: h{k + 1}, coherence: c{k + 1}}}" for k in range(len(SENSORS)))
    (out / f"functions_{change:g}.yaml").write_text(
        f"low: 10 Hz\nhigh: 600 Hz\nfunctions:\n  file: {names[0]}\n  sessions: [{', '.join(names[1:])}]\n"
        f"  averages: 4\n  responses: [{responses}]\n")


def true_poles(rng, change):
    """Hz and damping ratios of a plate below 700 Hz."""
    mass, damping, stiffness, _ = plate(rng, change)
    n = mass.size
    system = np.block([[np.zeros((n, n)), np.eye(n)], [-stiffness / mass[:, None], -damping / mass[:, None]]])
    poles = linalg.eigvals(system)
    poles = poles[(poles.imag > 0) & (abs(poles) < 2 * np.pi * 700)]
    return abs(poles) / 2 / np.pi, -poles.real / abs(poles)


def pole_scores(fit, rng, change):
    """|found - true| over the deviation, of ln f and ln zeta of every true mode between 10 and 590 Hz; one that is missed has inf.
    Modes that stand for others, of which modcal warns, are left out; each other one counts for one true mode at most."""
    f, zeta = true_poles(rng, change)
    found = [mode for mode in fit["modes"] if not mode["stands_in"]]
    # Farther off than 5 % is no neighbor: one mode that is none does not shift all others by a place.
    distance = np.minimum([[abs(np.log(mode["f_hz"] / x)) for mode in found] for x in f], 0.05)
    scores = np.full((f.size, 2), np.inf)
    for n, i in zip(*optimize.linear_sum_assignment(distance)):
        if distance[n, i] == 0.05:
            continue
        mode = found[i]
        scores[n] = ((mode["f_hz"] - f[n]) / mode["f_sd_hz"], np.log(mode["zeta"] / zeta[n]) * mode["zeta"] / mode["zeta_sd"])
    return np.abs(scores[(f > 10) & (f < 590)])


def refined_scores(result, fit, rng, change):
    """The same of the modes that the responses refined without the force."""
    modes = [{**mode, "stands_in": fit["modes"][i]["stands_in"]} for i, mode in enumerate(result["refined_modes"])]
    return pole_scores({"modes": modes}, rng, change)


def tell(what, scores):
    z = np.array(scores)
    missed, z = np.isinf(z[:, 0]).sum(), z[np.isfinite(z[:, 0])]
    print(f"{what}: {missed} modes missed; of {len(z)} poles within 1 and 2 deviations: frequencies "
          f"{(z[..., 0] < 1).mean():.2f} {(z[..., 0] < 2).mean():.2f} (most {z[..., 0].max():.1f}), damping ratios "
          f"{(z[..., 1] < 1).mean():.2f} {(z[..., 1] < 2).mean():.2f} (most {z[..., 1].max():.1f})", flush=True)


def yaml(kind, name, **keys):
    lines = [f"kind: {kind}", "record:", f"  file: {name}.csv", "  force: {channel: force}",
             "  responses: [" + ", ".join(f"{{channel: a{k + 1}}}" for k in range(len(SENSORS))) + "]"]
    return "\n".join(lines + [f"{key}: {value}" for key, value in keys.items()]) + "\n"


REJECTED = 6  # exit code of an answer that is not to be trusted


def run(build, file, out):
    """Whether the answer is accepted."""
    done = subprocess.run([build / "modcal", "run", file, "--out", out], capture_output=True, text=True)
    if done.returncode not in (0, REJECTED):
        raise SystemExit(f"{file}: {done.stderr}")
    return done.returncode == 0


def measure_modes(build, out, strikes=1, change=0, drawn=0):
    """Table of modes, OUT/NAME/table.yaml: from one strike of the plate as it is, or from several, before each of which it has changed. Returns NAME."""
    out.mkdir(parents=True, exist_ok=True)
    name = "strike" if strikes == 1 else f"strikes_{change:g}_{strikes}_{drawn}"
    files = ["strike"] if strikes == 1 else [f"strike_{change:g}_{drawn}_{i}" for i in range(strikes)]
    for i, file in enumerate(files):
        if not (out / f"{file}.csv").exists():
            rng = np.random.default_rng([13, drawn, i, int(1e6 * change)] if strikes > 1 else 1)
            write(out / f"{file}.csv", *record(rng, change, 1.5))
    keys = {"other_strikes": "[" + ", ".join(f"{{file: {file}.csv}}" for file in files[1:]) + "]"} if strikes > 1 else {}
    (out / f"{name}.yaml").write_text(yaml("fit_modes", files[0], low="10 Hz", high="600 Hz", **keys))
    if not run(build, out / f"{name}.yaml", out / name):
        raise SystemExit("the table of the plate is rejected")
    return name


def measure_modes_of_functions(build, out, sessions, change):
    """The same from sessions of response functions."""
    name = f"modes_{change:g}_{sessions}"
    text = (out / f"functions_{change:g}.yaml").read_text().replace("  averages: 4\n", "")
    (out / f"{name}.yaml").write_text("kind: fit_modes\n" + re.sub(", coherence: c[0-9]", "", text))
    if not run(build, out / f"{name}.yaml", out / name):
        raise SystemExit("the table of the plate's functions is rejected")
    return name


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("build", type=Path)
    p.add_argument("out", type=Path)
    p.add_argument("--draws", type=int, default=6)
    p.add_argument("--change", nargs="+", type=float, default=[0, 1e-3, 3e-3],
                   help="of the stiffness; sensors ten times, dampers a hundred times as much")
    p.add_argument("--kinds", nargs="+", choices=("strike", "smooth", "push", "step"), default=["strike", "smooth"])
    p.add_argument("--sessions", type=int, default=0, help="of response functions in the place of modes")
    p.add_argument("--strikes", type=int, default=0, help="to which modes are fitted")
    p.add_argument("--sets", type=int, default=1, help="of strikes, whose poles are scored; the force by the first")
    p.add_argument("--noise", type=float, default=0.002, help="of the record whose force is identified, over each response's rms; the table's has 0.002")
    p.add_argument("--keys", default="", help="further keys of identify_force: \"key: value; key: value\"; with change: the refined modes are scored, too")
    a = p.parse_args()
    a.out.mkdir(parents=True, exist_ok=True)
    keys = dict(k.strip().split(": ", 1) for k in a.keys.split(";") if k)
    if not a.sessions:
        measure_modes(a.build, a.out)
        print(json.loads((a.out / "strike/modes_fit.json").read_text())["sensors"])
    for kind in a.kinds:
        for change in a.change:
            fitted = None if a.sessions else "strike"
            if a.sessions:
                measure_functions(a.out, a.sessions, change)
            if a.strikes and a.sessions:
                fitted = measure_modes_of_functions(a.build, a.out, a.sessions, change)
            elif a.strikes > 1:
                fitted = measure_modes(a.build, a.out, a.strikes, change)
            others = [measure_modes(a.build, a.out, a.strikes, change, i) for i in range(1, a.sets)] if a.strikes > 1 and not a.sessions else []
            table = f"{fitted}/table.yaml" if fitted else f"functions_{change:g}.yaml"
            rows, scores, refined, rejected = [], [], [], 0
            for draw in range(a.draws):
                seed = [7, draw, int(1e6 * change)]
                rng = np.random.default_rng(seed)
                for modes in [fitted, *others] if fitted else []:
                    fit = json.loads((a.out / modes / "modes_fit.json").read_text())
                    scores.extend(pole_scores(fit, np.random.default_rng(seed), change))
                name = f"{kind}_{change:g}_{draw}" + (f"_{a.noise:g}" if a.noise != 0.002 else "")
                if not (a.out / f"{name}.csv").exists():
                    write(a.out / f"{name}.csv", *record(rng, change, 1.0, kind, a.noise))
                window = "80 ms" if kind == "strike" else "0.5 s"
                (a.out / f"{name}.yaml").write_text(
                    yaml("identify_force", name, table=table, **{"window": window, **keys}))
                if not run(a.build, a.out / f"{name}.yaml", a.out / name):
                    rejected += 1
                    continue
                found = np.genfromtxt(a.out / name / "identified.csv", delimiter=",", names=True)
                truth = np.genfromtxt(a.out / f"{name}.csv", delimiter=",", names=True)
                f, sd = (found[c] for c in found.dtype.names[1:3])
                ref = truth[truth.dtype.names[1]][:f.size]
                inside = np.abs(f - ref) <= 1.959964 * sd
                loud = np.abs(ref) > 0.1 * np.abs(ref).max()
                result = json.loads((a.out / name / "force.json").read_text())
                if "refined_modes" in result:
                    fit = json.loads((a.out / fitted / "modes_fit.json").read_text())
                    refined.extend(refined_scores(result, fit, np.random.default_rng(seed), change))
                rows.append((np.sqrt(np.mean((f - ref) ** 2) / np.mean(ref**2)), inside.mean(), inside[loud].mean(),
                             1.96 * sd.mean() / np.sqrt(np.mean(ref**2)), result["force"][0]["shape"] == "impacts"))
            if scores:
                tell(f"{kind:7s} change {change:g}", scores)
            if refined:
                tell(f"{kind:7s} change {change:g}: refined without the force", refined)
            if rejected:
                print(f"{kind:7s} change {change:g}: {rejected} rejected")
            if not rows:
                continue
            r = np.array(rows)
            print(f"{kind:7s} change {change:g}: error {np.median(r[:, 0]):.3f} (most {r[:, 0].max():.3f}), in the band "
                  f"{r[:, 1].mean():.3f} (least {r[:, 1].min():.3f}), loud {r[:, 2].mean():.3f}, half width {r[:, 3].mean():.3f}, "
                  f"impacts {int(r[:, 4].sum())} of {len(r)}", flush=True)


if __name__ == "__main__":
    main()
