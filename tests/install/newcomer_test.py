#!/usr/bin/env python3
"""What a newcomer does, from a fresh clone to the string with its error bars: newcomer_test.py PROJECT.

Builds the program of the last commit from nothing (about 5 minutes on 2 cores), so it runs where
MODCAL_FRESH_CLONE is set, as .ci/run does; elsewhere it is skipped (exit code 77).
"""
import csv
import json
import math
import os
import subprocess
import sys
import tempfile

RECORD = "examples/bowed_violin_d.csv"
TRUTH = {"f0": 294.0, "B": 1.1e-4, "x_c": 0.041}  # the record's first lines
LENGTH = "0.33 m"
COMMANDS = [
    "make reproduce",
    f'build/release/modcal new calibrate {RECORD} --length "{LENGTH}" --out mine.yaml',
    "build/release/modcal run mine.yaml",
]


def run(command, folder):
    print(f"$ {command}", flush=True)
    subprocess.run(["bash", "-c", command], cwd=folder, check=True)


def check_parameters(folder):
    with open(f"{folder}/out/mine/calibration.json") as file:
        found = {one["name"]: one for one in json.load(file)["parameters"]}
    for name, truth in TRUTH.items():
        deviations = (found[name]["final"] - truth) / found[name]["sd"]
        print(f"{name}: {deviations:+.2f} deviations from the truth")
        assert abs(deviations) < 2.5, name


def check_force(folder):
    """95 % of a band of 95 %, less what neighboring samples share: half a point is twice its sd."""
    with open(f"{folder}/{RECORD}") as file:
        lines = [line for line in file if not line.startswith("#")]
    truth = [float(row["f_c [N]"]) for row in csv.DictReader(lines)]
    with open(f"{folder}/out/mine/identified.csv") as file:
        found = list(csv.DictReader(line for line in file if not line.startswith("#")))
    assert len(found) == len(truth), (len(found), len(truth))
    # The true force has its mean; the identified one as well, so neither loses it.
    pairs = [(float(row["f_c_joint [N]"]), float(row["f_c_joint_deviation [N]"]), true)
             for row, true in zip(found, truth)]
    told = [one for one in pairs if all(map(math.isfinite, one))]
    covered = sum(abs(force - true) < 1.96 * deviation for force, deviation, true in told)
    share = covered / len(told)
    print(f"the band holds the force in {100 * share:.1f} % of {len(told)} samples")
    assert len(told) > len(pairs) // 2 and 0.9 < share < 0.99, share


def main():
    if not os.environ.get("MODCAL_FRESH_CLONE"):
        print("skipped: MODCAL_FRESH_CLONE is not set; this builds the program once more")
        return 77
    project = sys.argv[1]
    with tempfile.TemporaryDirectory() as parent:
        run(f"git clone --quiet {project} modcal", parent)
        folder = f"{parent}/modcal"
        for command in COMMANDS:
            run(command, folder)
        table = f"{folder}/out/table1/report.html"
        assert os.path.getsize(table) > 0, table
        check_parameters(folder)
        check_force(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
