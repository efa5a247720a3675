#!/usr/bin/env python3
"""What `modcal` makes of random structures: their modes, and the force of blows, of noise, of jumps and of pushes.

structures.py BUILD OUT draws structures of 2 to 25 modes with damping that couples them, 1 to 6 sensors of any kind and 1 to 51.2 kHz
(exact at eight times that rate with the force linear between, then decimated), fits modes to one strike and identifies the force of
other records by them, with default settings. One line for each: exit code, error of the force over its rms, share of its samples in
the 95 % band, the same where the force exceeds a tenth of its peak. At the end: modes in the band that are the structure's and that
are none, of both those without a warning; answers accepted, and how many of these hold less than 80 % of the samples.
"""
import argparse
import csv
import json
import subprocess
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from scipy import signal

STEPS = 8  # of a sample
KINDS = ("acceleration", "velocity", "displacement", "strain")
UNITS = dict(zip(KINDS, ("m/s2", "m/s", "m", "1")))
REJECTED = 6  # exit code of an answer that is not to be trusted


def draw(seed):
    """A structure, its sensors and what is measured of it."""
    rng = np.random.default_rng(seed)
    count, rate = int(rng.integers(2, 26)), float(rng.choice([1000, 2000, 4096, 10000, 20000, 51200]))
    sensors, noise = int(rng.integers(1, 7)), float(rng.choice([0.0003, 0.001, 0.003, 0.01, 0.03]))
    coupling, close = float(rng.choice([0, 0.3, 0.6])), bool(rng.random() < 0.3)
    damping = str(rng.choice(["light", "mid", "heavy"]))
    high = 0.3 * rate * rng.uniform(0.4, 1)
    low = high / rng.uniform(20, 80)
    f = np.sort(rng.uniform(1.5 * low, 1.2 * high, count))
    if close and count > 3:
        k = rng.integers(0, count - 1)
        f[k + 1] = f[k] * (1 + rng.uniform(0.001, 0.01))
    zeta = rng.uniform(*{"light": (0.0005, 0.004), "mid": (0.005, 0.02), "heavy": (0.03, 0.1)}[damping], count)
    omega = 2 * np.pi * np.append(f, high * np.array([1.6, 2.5, 4]))
    ratios = np.append(zeta, 3 * [0.02])
    same = rng.random() < 0.7
    kinds = sensors * [str(rng.choice(KINDS))] if same else [str(k) for k in rng.choice(KINDS, sensors)]
    contact, shapes = rng.standard_normal(omega.size), rng.standard_normal((sensors, omega.size))
    damper = np.diag(2 * ratios * omega)
    if coupling > 0:
        v = rng.standard_normal((omega.size, 2))
        full = v @ v.T / np.mean(np.sum(v**2, axis=1))
        damper = (1 - coupling) * damper + coupling * np.sqrt(np.outer(np.diag(damper), np.diag(damper))) * full
    duration = float(np.clip(rng.choice([3, 6, 12]) / (zeta * f * 2 * np.pi).min(), 20 / f[0], min(3, 60000 / rate)))
    system = np.block([[np.zeros((omega.size, omega.size)), np.eye(omega.size)], [-np.diag(omega**2), -damper]])
    return SimpleNamespace(rng=rng, system=system, contact=contact, shapes=shapes, kinds=kinds, rate=rate, low=low, high=high, noise=noise,
                           duration=duration, width=rng.uniform(0.5, 1.2) / high, quiet=max(0.02 * duration, 60 / rate))


def changed(s, share):
    """The structure later: each stiffness off by 2 SHARE, dampers by 100 SHARE, the shapes at the sensors by 10 SHARE (deviations)."""
    if not share:
        return s
    own, n, later = np.random.default_rng(s.contact.size), s.contact.size, SimpleNamespace(**vars(s))
    later.system = s.system.copy()
    later.system[n:, :n] *= 1 + 2 * share * own.standard_normal(n)[:, None]
    root = np.exp(50 * share * own.standard_normal(n))
    later.system[n:, n:] *= np.outer(root, root)
    later.shapes = s.shapes * (1 + 10 * share * own.standard_normal(s.shapes.shape))
    return later


def poles_of(s):
    poles = np.linalg.eigvals(s.system)
    poles = poles[poles.imag > 0]
    return abs(poles) / 2 / np.pi, -poles.real / abs(poles)


def responses_to(s, force, step):
    """Mode by mode, exact for a force that is linear between the samples."""
    n = s.contact.size
    poles, vectors = np.linalg.eig(s.system)
    driven = np.linalg.solve(vectors, np.append(np.zeros(n), s.contact))
    result = np.zeros((len(s.kinds), force.size))
    for i in np.flatnonzero(poles.imag > -1e-9):
        grown, z = np.exp(poles[i] * step), poles[i] * step
        new = step * (grown - 1 - z) / z**2
        old = step * (grown - 1) / z - new
        push = np.append(0, driven[i] * (old * force[:-1] + new * force[1:]))
        state = (2 if poles[i].imag > 1e-9 else 1) * signal.lfilter([1], [1, -grown], push)
        for k, kind in enumerate(s.kinds):
            of_speed = vectors[n:, i] * (poles[i] if kind == "acceleration" else 1)
            result[k] += ((s.shapes[k] @ (vectors[:n, i] if kind in ("displacement", "strain") else of_speed)) * state).real
    for k, kind in enumerate(s.kinds):
        if kind == "acceleration":
            result[k] += (s.shapes[k] @ s.contact) * force
    return result


def measure(s, force_at, path):
    """Record in PATH. Returns t and the force as it was decimated, without noise."""
    count = int(round(s.duration * s.rate))
    force = force_at(np.arange((count + 80) * STEPS) / (s.rate * STEPS))
    low_pass = signal.firwin(64 * STEPS + 1, 0.84 / STEPS, window=("kaiser", 9))
    half = low_pass.size // 2
    keep = lambda x: signal.fftconvolve(x, low_pass)[half:half + x.size:STEPS][:count]
    responses = np.array([keep(x) for x in responses_to(s, force, 1 / (s.rate * STEPS))])
    force, t = keep(force), np.arange(count) / s.rate
    responses += np.array([s.noise * np.sqrt(np.mean(x**2)) * s.rng.standard_normal(count) for x in responses])
    noisy = force + 0.1 * s.noise * abs(force).max() * s.rng.standard_normal(count)
    header = "t [s],force [N]," + ",".join(f"s{k + 1} [{UNITS[kind]}]" for k, kind in enumerate(s.kinds))
    np.savetxt(path, np.column_stack([t, noisy, *responses]), "%.10g", ",", header=header, comments="")
    return t, force


def pulse(t, at, width, height):
    x = (t - at) / width
    return np.where((x > 0) & (x < 1), height * np.sin(np.pi * np.clip(x, 0, 1)), 0.0)


def force_of(kind, s, seed, longer):
    """The force of a record as a function of time; blows are longer than that of the table by a factor, 0: by .8 to 1.25."""
    own = np.random.default_rng(seed + 7)
    if kind == "strike":  # and a rebound with every second one
        drawn = s.rng.uniform(0.8, 1.25)
        width, again = s.width * (longer or drawn), own.random() < 0.5
        return lambda t: pulse(t, 1.3 * s.quiet, width, 60) + again * pulse(t, 1.3 * s.quiet + 0.03 * s.duration, width, 25)
    if kind == "push":  # rises in a twentieth of the record, is let go after a fourth
        at = s.quiet + 0.25 * s.duration
        return lambda t: 20 * np.interp(t, (s.quiet, s.quiet + 0.05 * s.duration, at, at + s.width), (0, 1, 1, 0))
    if kind == "jumps":  # a sawtooth of three harmonics in the band, as of what sticks and slips
        return lambda t: 10 * (t * s.high / 3.5 % 1 - 0.5) * np.clip((t - s.quiet) / (0.05 * s.duration), 0, 1)
    if kind == "step":  # sets in and stays
        return lambda t: 20 * np.interp(t, (s.quiet, s.quiet + s.width), (0, 1))

    def noise(t):
        bins, f = np.fft.rfft(own.standard_normal(t.size)), np.fft.rfftfreq(t.size, t[1] - t[0])
        x = np.fft.irfft(bins * np.exp(-((f / (0.7 * s.high)) ** 8)) * (f > 1.5 * s.low), t.size)
        return 5 * x / x.std() * np.clip((t - s.quiet) / (0.05 * s.duration), 0, 1)
    return noise


def run(build, file, out, lines):
    file.write_text("\n".join(lines) + "\n")
    done = subprocess.run([build / "modcal", "run", file, "--out", out, "--threads", "1"], capture_output=True, text=True)
    if done.returncode not in (0, REJECTED):
        print(f"  {file}: exit {done.returncode}: {done.stderr.strip()[:200]}")
    return done.returncode


def count_modes(s, fit):
    """(true, none) x (all, without a warning) of the modes in the band."""
    frequencies, ratios = poles_of(s)
    counts = np.zeros((2, 2), int)
    for mode in fit["modes"]:
        if not s.low < mode["f_hz"] < s.high:
            continue
        k = np.argmin(abs(frequencies - mode["f_hz"]))
        off = abs(frequencies[k] / mode["f_hz"] - 1)
        own = (off < max(5 * mode["f_sd_hz"] / mode["f_hz"], 0.5 * ratios[k]) and off < 3 * ratios[k]
               and abs(mode["zeta"] / ratios[k] - 1) < max(5 * mode["zeta_sd"] / mode["zeta"], 0.5))
        counts[0 if own else 1] += (1, not mode["stands_in"])
    return counts


def compare(path, t, force):
    with open(path) as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))[1:]
    times, found, deviation = np.array([[float(x or "nan") for x in row[:3]] for row in rows]).T
    truth = np.interp(times, t, force)
    inside = abs(found - truth) <= 1.959964 * deviation
    loud = abs(truth) > 0.1 * abs(truth).max()
    return np.sqrt(np.mean((found - truth) ** 2) / np.mean(truth**2)), inside.mean(), inside[loud].mean()


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("build", type=Path)
    p.add_argument("out", type=Path)
    p.add_argument("--seeds", nargs=2, type=int, default=(0, 16), metavar=("FIRST", "END"))
    p.add_argument("--kinds", nargs="+", choices=("strike", "smooth", "jumps", "push", "step"), default=["strike", "push", "step"])
    p.add_argument("--sensors", type=int, default=6, help="no more than these")
    p.add_argument("--longer", type=float, default=0, help="than that of the table every blow is, by a factor")
    p.add_argument("--change", type=float, default=0, help="of the frequencies between the table and the record; dampers and sensors by more")
    p.add_argument("--keys", default="", help='further keys of identify_force, "key: value; key: value"; change: of two sensors and more alone')
    a = p.parse_args()
    keys = [key.strip() for key in a.keys.split(";") if key.strip()]
    modes, answers = np.zeros((2, 2), int), {kind: np.zeros(3, int) for kind in a.kinds}
    for seed in range(*a.seeds):
        s, folder = draw(seed), a.out / str(seed)
        s.kinds, s.shapes = s.kinds[:a.sensors], s.shapes[:a.sensors]
        if "change:" in a.keys and len(s.kinds) < 2:
            continue
        folder.mkdir(parents=True, exist_ok=True)
        measure(s, lambda t: pulse(t, s.quiet, s.width, 100), folder / "fit.csv")
        sensors = "  responses: [" + ", ".join(f"{{channel: s{k + 1}, kind: {kind}}}" for k, kind in enumerate(s.kinds)) + "]"
        print(f"{seed}: {s.contact.size - 3} modes, {s.rate:g} Hz, {s.duration:.2f} s, noise {s.noise:g}, {len(s.kinds)} x {s.kinds[0]}", flush=True)
        if run(a.build, folder / "fit.yaml", folder / "fit", ["kind: fit_modes", f"low: {s.low:.4f} Hz", f"high: {s.high:.4f} Hz", "record:",
                                                              "  file: fit.csv", "  force: {channel: force}", sensors]):
            continue
        modes += count_modes(s, json.loads((folder / "fit/modes_fit.json").read_text()))
        for kind in a.kinds:
            t, force = measure(changed(s, a.change), force_of(kind, s, seed, a.longer), folder / f"{kind}.csv")
            code = run(a.build, folder / f"{kind}.yaml", folder / kind,
                       ["kind: identify_force", "table: fit/table.yaml", "record:", f"  file: {kind}.csv", sensors, *keys])
            if code not in (0, REJECTED):
                continue
            found = json.loads((folder / kind / "force.json").read_text())
            error, inside, loud = compare(folder / kind / "identified.csv", t, force)
            answers[kind] += (1, code == 0, code == 0 and inside < 0.8)
            print(f"  {kind:6s} exit {code} {found['force'][0]['shape']:7s} push_odds {found['push_odds'] or float('nan'):8.1f} rise "
                  f"{found['rise'] or float('nan'):8.3g}  error {error:.3f}, in the band {inside:.3f}, loud {loud:.3f}", flush=True)
    print(f"modes in the band: {modes[0, 0]} true, {modes[0, 1]} of them without a warning; {modes[1, 0]} are none, {modes[1, 1]} without a warning")
    for kind, (count, accepted, wrong) in answers.items():
        print(f"{kind}: {accepted} of {count} accepted, {wrong} of these hold less than 80 %")


if __name__ == "__main__":
    main()
