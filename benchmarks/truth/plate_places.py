#!/usr/bin/env python3
"""Where does a force act that nobody measured? Strikes of the plate of plate.py at neighboring places: plate_places.py BUILD OUT

A table for each of six nodes 60 mm apart (`modcal fit_modes`), then strikes at each node on a plate that has changed. Prints how
often `identify_force` with the tables of all places (`other_places`) names the right one, how often its 95 % set holds it, and how
many places the set has.
"""
import argparse
import json
from pathlib import Path

import numpy as np
import plate

NODES = ((3, 2), (2, 2), (4, 2), (3, 1), (3, 3), (4, 3))


def strike(path, node, seed, change, duration):
    plate.CONTACT = node
    if not path.exists():
        plate.write(path, *plate.record(np.random.default_rng(seed), change, duration))


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("build", type=Path)
    p.add_argument("out", type=Path)
    p.add_argument("--draws", type=int, default=4)
    p.add_argument("--change", nargs="+", type=float, default=[0, 1e-3, 3e-3])
    p.add_argument("--window", default="80 ms", help="how long the force acts, or automatic")
    a = p.parse_args()
    a.out.mkdir(parents=True, exist_ok=True)
    for i, node in enumerate(NODES):
        strike(a.out / f"place{i}.csv", node, [1, i], 0, 1.5)
        (a.out / f"place{i}.yaml").write_text(plate.yaml("fit_modes", f"place{i}", low="10 Hz", high="600 Hz"))
        plate.run(a.build, a.out / f"place{i}.yaml", a.out / f"place{i}")
    tables = [f"place{i}/table.yaml" for i in range(len(NODES))]
    for change in a.change:
        right, held, sizes, claimed = [], [], [], []
        for i, node in enumerate(NODES):
            for draw in range(a.draws):
                name = f"strike{i}_{change:g}_{draw}"
                strike(a.out / f"{name}.csv", node, [9, i, draw, int(1e6 * change)], change, 1.0)
                (a.out / f"{name}.yaml").write_text(plate.yaml(
                    "identify_force", name, table=tables[0], other_places="[" + ", ".join(tables[1:]) + "]", window=a.window))
                plate.run(a.build, a.out / f"{name}.yaml", a.out / name)
                rows = json.loads((a.out / name / "places.json").read_text())
                best = max(range(len(rows)), key=lambda k: rows[k]["probability"])
                right.append(best == i)
                held.append(rows[i]["in_set"])
                sizes.append(sum(row["in_set"] for row in rows))
                claimed.append(rows[best]["probability"])
        print(f"change {change:g}: right {np.mean(right):.3f} of {len(right)}, set holds it {np.mean(held):.3f}, "
              f"places in the set {np.mean(sizes):.2f}, probability of the best {np.mean(claimed):.3f}", flush=True)


if __name__ == "__main__":
    main()
