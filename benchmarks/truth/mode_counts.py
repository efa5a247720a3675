#!/usr/bin/env python3
"""Whether what a calibration prints depends on the number of modes stated.

mode_counts.py BUILD OUT calibrates records of benchmarks/truth with N = 30, 50, 70, ... modes as score.py does (its options hold
here, too) and compares N with N + 20: every number printed with a deviation, f_n that both identify included. In the band of the N
modes (highest_frequency) both see the same data and differ by what the model makes of the modes above; in the band of its own
N + 20 sees more, so that answers move by up to sqrt(sd_N^2 - sd_N+20^2) by right. Differences are in units of the larger deviation.
"""
import json
import math
import sys
from pathlib import Path

import score

COUNTS = (30, 50, 70, 90, 110)


def printed(folder):
    """Number and deviation by name; empty where there is no result."""
    found = sorted(folder.glob("out/**/calibration.json"))
    if not found:
        return {}
    calibration = json.loads(found[0].read_text())
    numbers = {p["name"]: (p["final"], p["sd"]) for p in calibration["parameters"] if p.get("sd") and p["name"][:2] != "f_"}
    for mode in calibration["modes"]:
        if mode.get("source") == "identified":
            numbers[f"f_{mode['n']}"] = (mode["f_hz"], mode["relative_sd"] * mode["f_hz"])
    return numbers


def compared(few, many):
    """Differences in the larger deviation, by name."""
    return {name: (many[name][0] - few[name][0]) / max(few[name][1], many[name][1]) for name in few if name in many}


def task_of(name, action, draw, noise, modes, band, path, truth, a):
    a.modes = modes
    a.lines = score.CALIBRATION
    if band:
        a.lines = a.lines.replace("objective: joint_likelihood",
                                  f"objective: {{type: joint_likelihood, highest_frequency: {band:.6g} Hz}}")
    text = score.configuration(truth, name, "none", noise, draw, a)
    key = f"{name}-{action}-none-{noise:g}-{draw}-{score.digest(a.program, path.name, text)}"
    return (name, action, "none", noise, draw, path, text, key)


def result_of(task, a):
    folder = a.out / "runs" / task[-1]
    if not list(folder.glob("out/**/calibration.json")):
        line = score.calibrated(task, a)
        print(f"{task[-1]} {line.get('failure', 'accepted' if line['accepted'] else 'refused')} {line['wall']:.1f} s", file=sys.stderr)
    return printed(folder)


def shown(differences):
    modes = {name: d for name, d in differences.items() if name.startswith("f_")}
    others = "  ".join(f"{name} {d:+.2f}" for name, d in differences.items() if name not in modes and not name.startswith("zeta"))
    if not modes:
        return others
    worst = max(modes, key=lambda name: abs(modes[name]))
    beyond = sum(abs(d) > 0.3 for d in modes.values())
    return f"{others}  {len(modes)} f_n: largest {modes[worst]:+.2f} ({worst}), {beyond} beyond 0.3"


def main():
    a = score.arguments()
    a.program = score.file_digest(a.build / "modcal")
    truth_digest = score.file_digest(a.build / "benchmarks/truth")
    for name, action in a.pairs:
        path = score.simulated(name, action, "none", a, truth_digest)
        truth = json.loads(Path(f"{path}.json").read_text())
        f = truth["modes"]["f"]
        counts = [n for n in COUNTS if f[n - 1] < 0.4 * a.rate]
        for noise in a.noise:
            for draw in range(a.draws):
                def run(modes, band=None):
                    return result_of(task_of(name, action, draw, noise, modes, band, path, truth, a), a)
                for few, many in zip(counts, counts[1:]):
                    band = 0.96 * 0.5 * (f[few - 2] + f[few - 1])
                    same = compared(run(few, band), run(many, band))
                    own = compared(run(few), run(many))
                    title = f"{name} {action} {100 * noise:g} % draw {draw}, {few} and {many} modes"
                    print(f"{title}\n  same band {shown(same)}\n  own bands {shown(own)}", flush=True)


if __name__ == "__main__":
    main()
