#!/usr/bin/env python3
"""Numbers that two programs leave of the same experiments.

golden.py record PROGRAM CONFIGS OUT [--full]   runs every file of CONFIGS at the small size of
    tests/experiments/kinds/configs_test.cpp, or with --full those of CONFIGS/paper as they are
golden.py compare OLD NEW                       lists what differs by more than 1e-9, relative

A program reads its own version of CONFIGS. Times and provenance are left out. Needs python3-yaml.
"""
import csv
import json
import math
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import yaml

LEFT_OUT = re.compile(r"seconds|wall|version|commit|command|program|host|^file$|elapsed")


def small_size(path, experiment):
    """Assignments that make one experiment small."""
    kind, assignments = experiment.get("kind"), []
    simulates = kind not in ("fit_modes", "identify_force")
    if simulates and (experiment.get("simulator") or {}).get("type") != "modal_event":
        assignments.append("simulator.time_step=4 us")
    if kind == "schelleng":
        assignments += ["positions.count=4", "forces.count=4"]
    if kind == "calibration_limit":
        assignments += ["seeds=1", f"noise_levels=[{experiment['noise_levels'][0]}]"]
    if "simulator_in_the_loop" in path.name:
        assignments.append("calibration.budget.evaluations=20")
    if kind == "pluck_then_bow":
        assignments += ["scene.string.modes=14", "refinement.optimizer.loops=1"]
    if "model_based" in experiment:
        assignments += ["scene.duration=0.06 s", "score.windows=[0.04 s]", "model_based.rounds=0",
                        "scene.string.damping.ratio=1.5e-2"]
        if "whole" in (experiment.get("score") or {}):
            assignments.append("score.whole=[0.01 s, 0.057 s]")
    return assignments


def record(program, configs, out, full):
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "configs"
        shutil.copytree(configs, copy)
        for path in sorted(copy.rglob("*.yaml")):
            name = path.relative_to(copy).with_suffix("")
            if full and name.parts[0] != "paper":
                continue
            experiment = yaml.safe_load(path.read_text())
            assignments = [] if full else small_size(path, experiment)
            axes = (experiment.get("sweep") or {}).get("product")
            if axes and not full:
                experiment["sweep"] = {"product": {key: values[:1] for key, values in axes.items()}}
                path.write_text(yaml.safe_dump(experiment, sort_keys=False))
            command = [program, "run", str(path), "--out", str(Path(out) / name)]
            for assignment in assignments:
                command += ["--set", assignment]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            print(f"{name}: exit code {done.returncode}", flush=True)
            if done.returncode not in (0, 5):  # 5: acceptance missed, as a small size may
                print(done.stderr.strip())


def add_json(value, place, numbers):
    if isinstance(value, dict):
        for key, member in value.items():
            if not LEFT_OUT.search(key):
                add_json(member, f"{place}.{key}", numbers)
    elif isinstance(value, list):
        for i, member in enumerate(value):
            add_json(member, f"{place}[{i}]", numbers)
    else:
        numbers[place] = value


def add_csv(path, place, numbers):
    rows = list(csv.reader(line for line in path.open() if not line.startswith("#")))
    for i, row in enumerate(rows[1:], 1):
        for heading, cell in zip(rows[0], row):
            if not LEFT_OUT.search(heading):
                numbers[f"{place}[{i}].{heading}"] = cell


def numbers_of(folder):
    numbers = {}
    for path in sorted(folder.rglob("*")):
        place = str(path.relative_to(folder))
        if path.suffix == ".json" and path.name != "provenance.json":
            add_json(json.loads(path.read_text()), place, numbers)
        elif path.suffix == ".csv":
            add_csv(path, place, numbers)
    return numbers


def difference(old, new):
    """Relative difference of two numbers, infinite for other texts."""
    try:
        a, b = float(old), float(new)
    except (TypeError, ValueError):
        return 0.0 if old == new else math.inf
    if a == b or (math.isnan(a) and math.isnan(b)):
        return 0.0
    return abs(a - b) / max(abs(a), abs(b))


def compare(old, new):
    for experiment in sorted({path.parent for path in Path(old).rglob("resolved.yaml")}):
        name = experiment.relative_to(old)
        before, after = numbers_of(experiment), numbers_of(Path(new) / name)
        gone = [place for place in before if place not in after]
        changed = {place: difference(value, after[place]) for place, value in before.items()
                   if place in after}
        changed = {place: d for place, d in changed.items() if not d <= 1e-9}
        if not changed and not gone:
            continue
        print(f"{name}: {len(changed)} of {len(before)} changed, {len(gone)} gone")
        for place in sorted(changed, key=changed.get, reverse=True)[:3]:
            print(f"    {place}: {before[place]} -> {after[place]}")
        for place in gone[:3]:
            print(f"    {place} is gone")


if __name__ == "__main__":
    words = [word for word in sys.argv[1:] if word != "--full"]
    if len(words) == 4 and words[0] == "record":
        record(*words[1:], full="--full" in sys.argv)
    elif len(words) == 3 and words[0] == "compare":
        compare(*words[1:])
    else:
        sys.exit(__doc__)
