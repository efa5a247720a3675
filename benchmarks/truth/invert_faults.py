#!/usr/bin/env python3
"""What `modcal` inverts from records with a fault that no sample shows: a table of faults and estimators.

invert_faults.py BUILD OUT spoils records of benchmarks/truth as bad_records.py does (--only, the rows of its list BAD), inverts
each with the true string by every estimator of --estimators and prints a line each: exit code; relative error of the force below
9 kHz; the share of the true force and velocity within the 95 % bands, and the bands' standard deviation over the rms error they
should hold (1: as wide as it should be), judged as invert_score.py does; the first message. FALSE: exit code 0 and less than
90 % of the force held. Options of score.py hold (--strings, --actions, --noise, --jobs). What is finished stays in OUT.
"""
import concurrent.futures
import json
import math
import subprocess
import sys
from pathlib import Path

import bad_records
import invert_score
import score

FAULTS = ["good", "ramp_1_R1", "ramp_1_both", "ramp_0.1_R1", "ramp_1_R2", "drift_R1", "drift_both", "tanh_1", "tanh_4", "hum_0.05",
          "cut_R1", "cut_both", "cut_late_R2", "late_start_R1", "late_start_both", "late_start_30ms_R1", "offset_1e3", "swapped",
          "sign_R1"]
# A run of the observer writes the joint estimate, too.
RUNS = {"joint": ["joint"], "model_based": ["joint", "model"], "auto": ["auto"]}


def options():
    more = {"--estimators": list(RUNS), "--only": FAULTS}
    rest, given, name = [], {}, None
    for word in sys.argv[1:]:
        name = word if word.startswith("--") else name
        if name not in more:
            rest.append(word)
        elif word != name:
            given.setdefault(name, []).append(word)
    for key, default in (("--strings", ["violin_g"]), ("--actions", ["exponential", "thermal"])):
        rest += [] if key in rest else [key, *default]
    sys.argv[1:] = rest
    a = score.arguments()
    a.estimators, a.only = (given.get(key, default) for key, default in more.items())
    a.start = 0.0
    a.program = score.file_digest(a.build / "modcal")
    return a


def inverted(task, a):
    path, name, noise, fault, estimator = task
    truth = json.loads(Path(f"{path}.json").read_text())
    text = invert_score.configuration(truth, name, noise, "both", estimator, "", a)
    folder = a.out / "runs" / f"{path.name}-{noise:g}-{fault}-{estimator}-{score.digest(a.program, text)}"
    if (folder / "score.json").exists():
        return json.loads((folder / "score.json").read_text())
    folder.mkdir(parents=True, exist_ok=True)
    rows = [[float(v) for v in row] for row in score.columns_of(path)]
    record = bad_records.Record(rows, a.rate, path.name, noise)
    bad_records.BAD[fault](record)
    record.write(folder / "record.csv")
    (folder / "invert.yaml").write_text(text.replace("file: record.csv", "file: record.csv" + record.keys))
    done = subprocess.run([a.build / "modcal", "run", "invert.yaml", "--out", "out", "--threads", "1"], cwd=folder,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    said = [line for line in done.stdout.splitlines() if "error" in line.lower() or "warning" in line.lower()]
    lines = [{"exit": done.returncode, "side": side, "said": " | ".join(said)[:300]} for side in RUNS[estimator]]
    if done.returncode == 0:
        for line in lines:
            line |= invert_score.judged(folder, line["side"], path, a.rate, 0.0)
    for leftover in [folder / "record.csv", *folder.glob("out/identified*")]:
        leftover.unlink(missing_ok=True)
    (folder / "score.json").write_text(json.dumps(lines))
    return lines


def main():
    a = options()
    digest = score.file_digest(a.build / "benchmarks/truth")
    tasks = [(score.simulated(name, action, "none", a, digest), name, noise, fault, estimator)
             for name, action in a.pairs for fault in a.only for noise in a.noise for estimator in a.estimators]
    wrong = count = 0
    with concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
        for (path, _, noise, fault, _), lines in zip(tasks, pool.map(lambda task: inverted(task, a), tasks)):
            for line in lines:
                count += 1
                head = f"{'-'.join(path.name.split('-')[:2]):22} {fault:18} {100 * noise:4g} % {line['side']:6} exit {line['exit']}"
                if "held_f_c" in line:
                    false = line["held_f_c"] < 0.9
                    wrong += false
                    head += f"  error {line['error']:.4f}"
                    for signal in ("f_c", "v"):
                        held, sd, off = (line.get(f"{key}_{signal}", math.nan) for key in ("held", "sd", "off"))
                        head += f"  {signal} held {100 * held:5.1f} % sd/rms {sd / off:5.2f}"
                    head += "  FALSE" if false else ""
                print(head + "  " + line["said"][:200], flush=True)
    print(f"{count} estimates, {wrong} accepted though less than 90 % of the force is held")


if __name__ == "__main__":
    main()
