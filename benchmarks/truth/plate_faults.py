#!/usr/bin/env python3
"""What identify_force says of spoilt records of a plate that modcal's model does not know.

plate_faults.py BUILD OUT spoils a strike and a smooth force of plate.py's plate in every way below, in all channels or in one
of four, and identifies the force by a table that `modcal fit_modes` has made of another strike. Prints of each: refused (exit
code 2 or 3), rejected (6) or accepted, relative error of the force, share of its samples that lie in the 95 % band, the sensor
that was left out, and what is said. Wrong is what is accepted and has less than 85 % in the band, or an error above 0.4 and
less than 95 %; what all channels have alike and no record can tell, a sign, gain, delay or rate, is counted apart. Ends with
exit code 1 where anything is wrong without a warning that the sensors contradict each other.

With --refine "frequency: 0.5 %, damping: 30 %, residue: 5 %" the modes are refined by the same records first (`change:`). Prints
the share of the plate's frequencies, by its eigenvalues, within two deviations and the largest error in them, too. Wrong is then
also what is accepted without a warning about sensors or change and holds less than 80 % of them, or one by more than 6 deviations.

With --automatic the window is not stated: modcal finds when the force is over.
"""
import argparse
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import plate

ALL, TWO = slice(2, 6), 3  # columns: time, force, a1 ... a4; the one that is spoilt alone: a2


def changed(columns, function):
    def spoil(d):
        d = d.copy()
        d[:, columns] = function(d[:, columns], d[:, 0])
        return d
    return spoil


def late(columns, samples):
    def spoil(d):
        d = d.copy()
        d[samples:, columns] = d[:-samples, columns]
        return d
    return spoil


def dropped(columns, first):
    """Three samples are missing, what follows comes early."""
    def spoil(d):
        d = d.copy()
        d[first:-3, columns] = d[first + 3:, columns]
        return d
    return spoil


def rounded(bits):
    def to_bits(y, t):
        step = np.abs(y).max(0) / 2 ** (bits - 1)
        return step * np.round(y / step)
    return changed(ALL, to_bits)


def clipped(columns, share):
    return changed(columns, lambda y, t: np.clip(y, -share * np.abs(y).max(0), share * np.abs(y).max(0)))


def hum(level, hertz):
    return changed(ALL, lambda y, t: y + level * np.sqrt(2) * y.std(0) * np.sin(2 * np.pi * hertz * t + 1)[:, None])


def noisy(level):
    return changed(ALL, lambda y, t: y + level * y.std(0) * np.random.default_rng(4).standard_normal(y.shape))


def one_value(value):
    def spoil(d):
        d = d.copy()
        d[100, TWO] = value
        return d
    return spoil


FAULTS = {
    "none": lambda d: d,
    "not a number": one_value(np.nan), "infinite": one_value(np.inf), "1e300": changed(ALL, lambda y, t: 1e300 * y),
    "1e-30": changed(ALL, lambda y, t: 1e-30 * y), "one sample": lambda d: d[:1], "four samples": lambda d: d[:4],
    "all zero": changed(ALL, lambda y, t: 0 * y), "constant": changed(ALL, lambda y, t: 0 * y + 0.5),
    "one silent": changed(TWO, lambda y, t: 0 * y), "clipped at half": clipped(ALL, 0.5),
    "one clipped at .8": clipped(TWO, 0.8), "one clipped at half": clipped(TWO, 0.5),
    "saturating": changed(ALL, lambda y, t: np.tanh(y / np.abs(y).max(0)) * np.abs(y).max(0)),
    "4 bit": rounded(4), "8 bit": rounded(8), "two exchanged": lambda d: d[:, [0, 1, 3, 2, 4, 5]],
    "one reversed in sign": changed(TWO, lambda y, t: -y), "all reversed in sign": changed(ALL, lambda y, t: -y),
    "gain of one 1.1": changed(TWO, lambda y, t: 1.1 * y), "gain of one 2": changed(TWO, lambda y, t: 2 * y),
    "gain of all 1.1": changed(ALL, lambda y, t: 1.1 * y), "one late by a sample": late(TWO, 1),
    "one late by three": late(TWO, 3), "all late by a sample": late(ALL, 1),
    "drift": changed(ALL, lambda y, t: y + 0.3 * y.std(0) * (t / t[-1])[:, None]),
    "three dropped": dropped(slice(1, 6), 150), "three dropped in one": dropped(TWO, 150),
    "three dropped in one, late": dropped(TWO, 1500),
    "zeros in the middle": changed(ALL, lambda y, t: y * ((t < 0.03) | (t > 0.036))[:, None]),
    "zeros in the middle of one": changed(TWO, lambda y, t: y * ((t < 0.03) | (t > 0.036))),
    "zeros to the end": changed(ALL, lambda y, t: y * (t < 0.06)[:, None]),
    "reversed in time": lambda d: np.column_stack([d[:, 0], d[::-1, 1:]]),
    "hum of 5 %, 50 Hz": hum(0.05, 50), "hum of 30 %, 50 Hz": hum(0.3, 50), "hum of 5 %, 200 Hz": hum(0.05, 200),
    "rate 1 % off": lambda d: d * [1.01, 1, 1, 1, 1, 1], "rate 0.1 % off": lambda d: d * [1.001, 1, 1, 1, 1, 1],
    "two of the same": lambda d: d[:, [0, 1, 2, 2, 4, 5]], "all of the same": lambda d: d[:, [0, 1, 2, 2, 2, 2]],
    "noise of 10 %": noisy(0.1), "noise of 100 %": noisy(1), "noise of 1000 %": noisy(10),
}
MOVED = ("three dropped", "reversed in time")  # whose force is that of the spoilt record
ALIKE = ("all reversed in sign", "gain of all 1.1", "1e-30", "all late by a sample", "rate 1 % off", "rate 0.1 % off")


def outcome(a, name, kind, fault, clean):
    build, out, change, refine = a.build, a.out, a.change, a.refine
    spoilt = FAULTS[fault](clean)
    header = "t [s],force [N]," + ",".join(f"a{k + 1} [m/s2]" for k in range(4))
    np.savetxt(out / f"{name}.csv", spoilt, "%.9g", ",", header=header, comments="")
    window = "automatic" if a.automatic else "80 ms" if kind == "strike" else "0.5 s"
    text = plate.yaml("identify_force", name, table="strike/table.yaml", window=window, **({"change": "{" + refine + "}"} if refine else {}))
    (out / f"{name}.yaml").write_text(text.replace("  force: {channel: force}\n", ""))
    found = out / name
    done = subprocess.run([build / "modcal", "run", out / f"{name}.yaml", "--out", found], capture_output=True, text=True)
    lines = (done.stdout + done.stderr).splitlines()
    words = ("error", "rejected", "contradict", "warning")
    says = next((line for word in words for line in lines if word in line), "")
    if done.returncode not in (0, 6):
        return "refused", None, None, "", says, None
    identified = np.genfromtxt(found / "identified.csv", delimiter=",", names=True)
    force, deviation = (identified[c] for c in identified.dtype.names[1:3])
    truth = (spoilt if fault in MOVED else clean)[:force.size, 1]
    error = np.sqrt(np.mean((force - truth) ** 2) / np.mean(truth ** 2))
    inside = np.mean(np.abs(force - truth) <= 1.959964 * deviation)
    result = json.loads((found / "force.json").read_text())
    z = None
    if refine:
        fit = json.loads((out / "strike/modes_fit.json").read_text())
        z = plate.refined_scores(result, fit, np.random.default_rng(seed_of(change)), change)[:, 0]
    return ("rejected" if done.returncode else "accepted"), error, inside, result.get("left_out") or "", says, z


def seed_of(change):
    return [7, 0, int(1e6 * change)]


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("build", type=Path)
    p.add_argument("out", type=Path)
    p.add_argument("--change", type=float, default=1e-3, help="of the plate since it was measured (plate.py)")
    p.add_argument("--kinds", nargs="+", default=["strike", "smooth"])
    p.add_argument("--refine", default="", help="how far the modes may have changed, the keys of change:")
    p.add_argument("--automatic", action="store_true", help="state no window")
    p.add_argument("--faults", nargs="+", choices=FAULTS, default=list(FAULTS), metavar="NAME", help=", ".join(FAULTS).replace("%", "%%"))
    a = p.parse_args()
    a.build, a.out = a.build.resolve(), a.out.resolve()
    plate.measure_modes(a.build, a.out)
    counts = dict.fromkeys(("accepted", "rejected", "refused", "wrong", "wrong with a warning", "alike in all"), 0)
    for kind in a.kinds:
        rng = np.random.default_rng(seed_of(a.change))
        plate.write(a.out / f"{kind}.whole.csv", *plate.record(rng, a.change, 1.0, kind))
        clean = np.genfromtxt(a.out / f"{kind}.whole.csv", delimiter=",", skip_header=1)
        for number, fault in enumerate(a.faults):
            what, error, inside, left_out, says, z = outcome(a, f"{kind}_{number}", kind, fault, clean)
            counts[what] += 1
            verdict = ""
            off = z is not None and ((z < 2).mean() < 0.8 or z.max() > 6)
            if what == "accepted" and (off or inside < 0.85 or (error > 0.4 and inside < 0.95)):
                verdict = "alike in all" if fault in ALIKE else "wrong with a warning" if "contradict" in says else "wrong"
                counts[verdict] += 1
            figures = "" if error is None else f"error {error:.3f}, in the band {100 * inside:.0f} %"
            if z is not None:
                figures += f", f_n in two sd {100 * (z < 2).mean():.0f} %, most {z.max():.1f} "
            print(f"{kind:7s}{fault:28s}{what:9s} {figures:30s}{left_out:4}{verdict:22}| {says[:120]}", flush=True)
    print(", ".join(f"{count} {what}" for what, count in counts.items()))
    return 1 if counts["wrong"] else 0


if __name__ == "__main__":
    sys.exit(main())
