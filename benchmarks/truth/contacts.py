#!/usr/bin/env python3
"""What `modcal` makes of forces at several contacts at once, on the random structures of structures.py.

contacts.py BUILD OUT fits modes to one strike at each of two or three contacts, drives all of them at once and identifies the forces
together, with default settings, from --more sensors than contacts. One line for each record: exit code, and of each contact the error
of the force over its rms, the share of its samples in the 95 % band, and the same where the force exceeds a tenth of its peak. At the
end: answers accepted, forces of these that hold less than 80 % of their loud samples, and the median error.
"""
import argparse
import csv
import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import yaml

import structures

REJECTED = structures.REJECTED


def contacts_of(seed, count, sensors):
    """The structure of a seed with as many sensors as are asked for, driven at each of so many contacts."""
    s = structures.draw(seed)
    own = np.random.default_rng(seed + 1000)
    n = s.contact.size
    kinds = [s.kinds[k % len(s.kinds)] for k in range(sensors)]
    shapes = own.standard_normal((sensors, n))
    return [SimpleNamespace(**{**vars(s), "kinds": kinds, "shapes": shapes, "contact": own.standard_normal(n)}) for _ in range(count)]


def measured_together(driven, forces_at, path):
    """The sum of what every force does, in the noise of a record. Returns t and the forces without noise."""
    first = driven[0]
    noise = first.noise
    whole, truths, t = None, [], None
    for s, force_at in zip(driven, forces_at):
        quiet = SimpleNamespace(**{**vars(s), "noise": 0.0})
        t, force = structures.measure(quiet, force_at, path)
        part = np.loadtxt(path, delimiter=",", skiprows=1)[:, 2:]
        whole = part if whole is None else whole + part
        truths.append(force)
    whole += noise * np.sqrt(np.mean(whole**2, axis=0)) * first.rng.standard_normal(whole.shape)
    header = "t [s]," + ",".join(f"s{k + 1} [{structures.UNITS[kind]}]" for k, kind in enumerate(first.kinds))
    np.savetxt(path, np.column_stack([t, whole]), "%.10g", ",", header=header, comments="")
    return t, truths


def without_a_mode(table):
    told = yaml.safe_load(table.read_text())
    del told["modes"][len(told["modes"]) // 2]
    table.write_text(yaml.safe_dump(told))


def spoil(fault, record):
    """Gives a record what it should not have."""
    with open(record) as file:
        header = file.readline().rstrip()
    data = np.loadtxt(record, delimiter=",", skiprows=1)
    y = data[:, 1:]
    if fault in ("gain", "unit"):
        y[:, 1] *= 1.05 if fault == "gain" else 1.2
    elif fault == "late":
        y[1:, 1] = y[:-1, 1].copy()
    elif fault == "hum":
        y += 0.05 * np.sqrt(2 * np.mean(y**2, axis=0)) * np.sin(2 * np.pi * 50 * data[:, :1])
    np.savetxt(record, data, "%.10g", ",", header=header, comments="")


def compare(path, t, truths):
    with open(path) as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))[1:]
    columns = np.array([[float(x or "nan") for x in row] for row in rows]).T
    result = []
    for p, force in enumerate(truths):
        found, deviation = columns[1 + 2 * p], columns[2 + 2 * p]
        truth = np.interp(columns[0], t, force)
        inside, loud = abs(found - truth) <= 1.959964 * deviation, abs(truth) > 0.1 * abs(truth).max()
        result.append((np.sqrt(np.mean((found - truth) ** 2) / np.mean(truth**2)), inside.mean(), inside[loud].mean()))
    return result


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("build", type=Path)
    p.add_argument("out", type=Path)
    p.add_argument("--seeds", nargs=2, type=int, default=(0, 12), metavar=("FIRST", "END"))
    p.add_argument("--kinds", nargs="+", choices=("strike", "smooth", "jumps"), default=["strike", "smooth"])
    p.add_argument("--contacts", type=int, default=2)
    p.add_argument("--more", type=int, default=2, help="sensors than contacts")
    p.add_argument("--change", type=float, default=0, help="of the frequencies between the tables and the record; dampers and sensors by more")
    p.add_argument("--fault", choices=("gain", "unit", "late", "hum", "mode"),
                   help="the second sensor reads 5 or 20 %% too much or comes a sample late, 5 %% of hum, or tables that lack their middle mode")
    p.add_argument("--elsewhere", action="store_true", help="the last force acts where no table knows of: what is accepted is wrong")
    a = p.parse_args()
    answers, wrong, forces, errors = 0, 0, 0, []
    accepted = 0
    for seed in range(*a.seeds):
        driven, folder = contacts_of(seed, a.contacts + a.elsewhere, a.contacts + a.more), a.out / str(seed)
        folder.mkdir(parents=True, exist_ok=True)
        s = driven[0]
        sensors = "  responses: [" + ", ".join(f"{{channel: s{k + 1}, kind: {kind}}}" for k, kind in enumerate(s.kinds)) + "]"
        print(f"{seed}: {s.contact.size - 3} modes, {s.rate:g} Hz, {s.duration:.2f} s, noise {s.noise:g}, {len(s.kinds)} x {s.kinds[0]}", flush=True)
        codes = []
        for i, one in enumerate(driven[:a.contacts]):
            structures.measure(one, lambda t: structures.pulse(t, s.quiet, s.width, 100), folder / f"fit{i}.csv")
            codes.append(structures.run(a.build, folder / f"fit{i}.yaml", folder / f"fit{i}",
                                        ["kind: fit_modes", f"low: {s.low:.4f} Hz", f"high: {s.high:.4f} Hz", "record:", f"  file: fit{i}.csv",
                                         "  force: {channel: force}", sensors]))
        if any(codes):
            continue
        if a.fault == "mode":
            for i in range(a.contacts):
                without_a_mode(folder / f"fit{i}/table.yaml")
        others = ", ".join(f"fit{i}/table.yaml" for i in range(1, a.contacts))
        for kind in a.kinds:
            acting = driven[:a.contacts - 1] + driven[a.contacts:] if a.elsewhere else driven
            acting = [structures.changed(one, a.change) for one in acting]
            forces_at = [structures.force_of(kind, one, seed + 100 * i, 0) for i, one in enumerate(acting)]
            if kind != "smooth":  # not all at the same instant
                forces_at = [lambda t, f=f, i=i: f(t - 0.02 * i * s.duration) for i, f in enumerate(forces_at)]
            t, truths = measured_together(acting, forces_at, folder / f"{kind}.csv")
            if a.fault and a.fault != "mode":
                spoil(a.fault, folder / f"{kind}.csv")
            code = structures.run(a.build, folder / f"{kind}.yaml", folder / kind,
                                  ["kind: identify_force", "table: fit0/table.yaml", f"other_contacts: [{others}]", "record:",
                                   f"  file: {kind}.csv", sensors])
            if code not in (0, REJECTED):
                continue
            shapes = [f["shape"] for f in json.loads((folder / kind / "force.json").read_text())["force"]]
            scores = compare(folder / kind / "identified.csv", t, truths)
            answers, accepted = answers + 1, accepted + (code == 0)
            if code == 0:
                forces += len(scores)
                wrong += sum(loud < 0.8 for _, _, loud in scores)
                errors += [error for error, _, _ in scores]
            told = "; ".join(f"{shape} error {e:.3f}, in the band {b:.3f}, loud {l:.3f}" for shape, (e, b, l) in zip(shapes, scores))
            print(f"  {kind:6s} exit {code}  {told}", flush=True)
    print(f"{accepted} of {answers} accepted; {wrong} of {forces} forces of these hold less than 80 % of their loud samples; median error "
          f"{np.median(errors) if errors else float('nan'):.3f}")


if __name__ == "__main__":
    main()
