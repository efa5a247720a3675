#!/usr/bin/python3
"""What a newcomer does, from a fresh clone to the string with its error bars: newcomer_test.py PROJECT.

Builds the program of the last commit from nothing (5 minutes on 2 cores, 18 on slow ones), so it runs
where MODCAL_FRESH_CLONE is set, as .ci/run does: the time, in seconds since 1970, after which it is too
late to begin. Elsewhere, and then, it is skipped (exit code 77).
"""
import csv
import json
import os
import subprocess
import sys
import tempfile
import time

import numpy as np

RECORD = "examples/bowed_violin_d.csv"
RATE = 44100
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


def rows_of(path):
    with open(path) as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def check_force(folder):
    """A band of 95 % holds 90 to 99 % of the samples, which tell a few thousand times, away from the ends.

    It is that of what changes, up to the band limit that the run states.
    """
    (told,) = rows_of(f"{folder}/out/mine/identification.csv")
    truth = np.array([float(row["f_c [N]"]) for row in rows_of(f"{folder}/{RECORD}")])
    found = rows_of(f"{folder}/out/mine/identified.csv")
    force = np.array([float(row["f_c_joint [N]"]) for row in found])
    deviation = np.array([float(row["f_c_joint_deviation [N]"]) for row in found])
    spectrum = np.fft.rfft(truth)
    spectrum[np.fft.rfftfreq(truth.size, 1 / RATE) > float(told["band_limit [Hz]"])] = 0
    inside = slice(truth.size // 20, -(truth.size // 20))
    error = (force - np.fft.irfft(spectrum, truth.size))[inside]
    share = np.mean(np.abs(error - error.mean()) < 1.96 * deviation[inside])
    print(f"the band holds the force in {100 * share:.1f} % of {error.size} samples")
    assert 0.9 < share < 0.99, share
    assert error.std() < 0.02 * np.abs(truth).max()


def main():
    if not os.environ.get("MODCAL_FRESH_CLONE"):
        print("skipped: MODCAL_FRESH_CLONE is not set; this builds the program once more")
        return 77
    if time.time() > float(os.environ["MODCAL_FRESH_CLONE"]):
        print("skipped: this machine is too slow to build the program twice in the time that there is")
        return 77
    project = sys.argv[1]
    if subprocess.run(["git", "-C", project, "rev-parse", "HEAD"], capture_output=True).returncode:
        print("skipped: the project is no repository of this user")
        return 77
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
