#!/usr/bin/env python3
"""What `modcal fit_modes` makes of two modes that stand 2 to 5 half-widths apart.

close_modes.py BUILD OUT draws structures of 2 to 6 modes of which one has a neighbor, 1 to 4 sensors and .1 to 5 % of noise, strikes
each for 3 s at most and fits its modes with default settings. One line for each: how many of the two are in the table, and the largest
distance of a mode from the nearest pole, in its own deviations. At the end: pairs that were parted, and of all frequencies and damping
ratios in the band the rms of these distances, how many are beyond 4, the largest.
"""
import argparse
import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np

import structures

LOW, HIGH, RATE = 20.0, 300.0, 1200.0


def draw(seed):
    """A structure and its sensors; the last two modes in the band are the pair."""
    rng = np.random.default_rng(seed)
    count, sensors = int(rng.integers(2, 7)), int(rng.integers(1, 5))
    while True:
        f, zeta = np.sort(rng.uniform(1.3 * LOW, 0.9 * HIGH, count)), rng.uniform(0.004, 0.02, count)
        if np.all(np.diff(f) > 8 * (f * zeta)[:-1]):
            break
    k = count // 2
    apart = rng.uniform(2, 5)
    order = np.append(np.delete(np.arange(count), k), k)
    f, zeta = f[order], zeta[order]
    f, zeta = np.append(f, f[-1] * (1 + apart * zeta[-1])), np.append(zeta, zeta[-1] * rng.uniform(0.7, 1.4))
    omega, ratios = 2 * np.pi * np.append(f, HIGH * 1.8), np.append(zeta, 0.02)
    n = omega.size
    system = np.block([[np.zeros((n, n)), np.eye(n)], [-np.diag(omega**2), -np.diag(2 * ratios * omega)]])
    kinds = [str(kind) for kind in rng.choice(structures.KINDS[:3], sensors)]
    return SimpleNamespace(rng=rng, system=system, contact=np.sign(rng.standard_normal(n)) * rng.uniform(0.5, 1.5, n),
                           shapes=rng.standard_normal((sensors, n)), kinds=kinds, rate=RATE, low=LOW, high=HIGH,
                           noise=float(np.exp(rng.uniform(np.log(0.001), np.log(0.05)))), width=1 / HIGH, apart=apart,
                           duration=float(np.clip(6 / (zeta * f * 2 * np.pi).min(), 0.5, 3)), pair=f[-2:])


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("build", type=Path)
    p.add_argument("out", type=Path)
    p.add_argument("--seeds", nargs=2, type=int, default=(0, 100), metavar=("FIRST", "END"))
    a = p.parse_args()
    distances, parted, runs = [], 0, 0
    for seed in range(*a.seeds):
        s, folder = draw(seed), a.out / str(seed)
        folder.mkdir(parents=True, exist_ok=True)
        structures.measure(s, lambda t: structures.pulse(t, 0.05, s.width, 50), folder / "fit.csv")
        sensors = ", ".join(f"{{channel: s{k + 1}, kind: {kind}}}" for k, kind in enumerate(s.kinds))
        if structures.run(a.build, folder / "fit.yaml", folder / "fit",
                          ["kind: fit_modes", f"low: {LOW} Hz", f"high: {HIGH} Hz", "record:", "  file: fit.csv",
                           "  force: {channel: force}", f"  responses: [{sensors}]"]):
            continue
        frequencies, ratios = structures.poles_of(s)
        own, near = [0.0], set()
        for mode in json.loads((folder / "fit/modes_fit.json").read_text())["modes"]:
            if mode["stands_in"] or not LOW < mode["f_hz"] < HIGH:
                continue
            k = np.argmin(abs(frequencies - mode["f_hz"]))
            own += [abs(frequencies[k] - mode["f_hz"]) / mode["f_sd_hz"], abs(ratios[k] - mode["zeta"]) / mode["zeta_sd"]]
            near |= {k} & {int(np.argmin(abs(frequencies - f))) for f in s.pair}
        runs += 1
        parted += len(near) == 2
        distances += own[1:]
        print(f"{seed}: {s.apart:.1f} half-widths, {len(s.kinds)} sensors, noise {s.noise:.3f}: {len(near)} of 2, {max(own):.1f}", flush=True)
    z = np.array(distances)
    print(f"{parted} of {runs} pairs parted; {z.size} numbers: rms {np.sqrt(np.mean(z**2)):.2f}, {np.sum(z > 4)} beyond 4, largest {z.max():.1f}")


if __name__ == "__main__":
    main()
