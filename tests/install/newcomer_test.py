#!/usr/bin/python3
"""What a newcomer does once the program is built: Table 1, a string with its error bars, the force on a plate.

newcomer_test.py PROJECT MODCAL. `make reproduce` on the machine as it is comes before: .ci/run begins with it.
"""
import csv
import json
import os
import subprocess
import sys
import tempfile

import numpy as np

RECORD = "examples/bowed_violin_d.csv"
RATE = 44100
TRUTH = {"f0": 294.0, "B": 1.1e-4, "x_c": 0.041}  # the record's first lines
LENGTH = "0.33 m"


def run(folder, *command):
    print("$", *command, flush=True)
    subprocess.run(command, cwd=folder, check=True)


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


def check_force(out, project, most):
    """A band of 95 % holds 90 to 99 % of the samples, which tell a few thousand times, away from the ends.

    It is that of what changes, up to the band limit that the run states. Where nobody says what the ends feel, it holds more.
    """
    (told,) = rows_of(f"{out}/identification.csv")
    truth = np.array([float(row["f_c [N]"]) for row in rows_of(f"{project}/{RECORD}")])
    found = rows_of(f"{out}/identified.csv")
    force = np.array([float(row["f_c_joint [N]"]) for row in found])
    deviation = np.array([float(row["f_c_joint_deviation [N]"]) for row in found])
    spectrum = np.fft.rfft(truth)
    spectrum[np.fft.rfftfreq(truth.size, 1 / RATE) > float(told["band_limit [Hz]"])] = 0
    inside = slice(truth.size // 20, -(truth.size // 20))
    error = (force - np.fft.irfft(spectrum, truth.size))[inside]
    share = np.mean(np.abs(error - error.mean()) < 1.96 * deviation[inside])
    print(f"the band holds the force in {100 * share:.1f} % of {error.size} samples")
    assert 0.9 < share <= most, share
    assert error.std() < 0.02 * np.abs(truth).max()


def check_structure(folder, project, modcal):
    """From the file of a strike to the force of another one, by what `inspect` proposes."""
    structures = f"{project}/configs/structures"
    told = subprocess.run([modcal, "inspect", f"{structures}/plate_strike.csv", "--json"], capture_output=True, check=True)
    stanza = json.loads(told.stdout)["stanza"]
    lines = [line for line in stanza.splitlines() if not line.startswith(("low:", "high:"))]
    assert len(lines) == len(stanza.splitlines()) - 2, stanza
    with open(f"{folder}/plate.yaml", "w") as file:
        file.write("\n".join([*lines, "low: 10 Hz", "high: 600 Hz"]) + "\n")
    run(folder, modcal, "run", "plate.yaml")
    with open(f"{folder}/force.yaml", "w") as file:
        responses = [line for line in lines if "kind: acceleration" in line]
        assert len(responses) == 4, stanza
        file.write("\n".join(["kind: identify_force", "table: out/plate/table.yaml", "record:",
                              f"  file: {structures}/plate_other_strike.csv", "  force: {channel: force}", "  responses:",
                              *responses]) + "\n")
    run(folder, modcal, "run", "force.yaml")
    with open(f"{folder}/out/force/force.json") as file:
        (force,) = json.load(file)["force"]
    print(f"force of the plate: off by {force['relative_error']:.3f}, {force['coverage']:.3f} in the band")
    assert force["relative_error"] < 0.1 and force["coverage"] > 0.9, force


def main():
    project, modcal = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        run(folder, modcal, "reproduce", "table1")
        run(folder, modcal, "new", "calibrate", f"{project}/{RECORD}", "--length", LENGTH, "--out", "mine.yaml")
        run(folder, modcal, "run", "mine.yaml")
        table = f"{folder}/out/table1/report.html"
        assert os.path.getsize(table) > 0, table
        check_parameters(folder)
        check_force(f"{folder}/out/mine", project, 1.0)
        run(folder, modcal, "run", "mine.yaml", "--set", "calibration.reaction=tension", "--out", "out/told")
        check_force(f"{folder}/out/told", project, 0.99)
        check_structure(folder, project, modcal)


if __name__ == "__main__":
    main()
