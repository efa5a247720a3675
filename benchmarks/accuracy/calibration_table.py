#!/usr/bin/python3
"""Table of calibration_work_precision: what every objective ends at, and which optimizers get there first.

    calibration_table.py calibration_work_precision.csv

An objective ends where the median of its searches does; an optimizer has arrived once its error stays within 10 % of that.
"""
import csv
import sys

path = sys.argv[1]
with open(path) as lines:
    bound = float(next(lines).split()[2])
    rows = list(csv.DictReader(lines))

searches = {}
for row in rows:
    key = (row["objective"], row["optimizer"])
    searches.setdefault(key, []).append((float(row["milliseconds"]), float(row["frequency_error"]), row["family"]))
print(f"Cramér–Rao bound of the median error: {bound:.1e}\n")
print("| objective | ends at | / bound | optimizers that arrive | first of them |\n|---|---|---|---|---|")
for objective in dict.fromkeys(row["objective"] for row in rows):
    own = {name: steps for (o, name), steps in searches.items() if o == objective}
    ends = sorted(steps[-1][1] for steps in own.values())
    floor = ends[len(ends) // 2]  # most searches end at the objective's minimum
    arrivals = []
    for name, steps in own.items():
        if not floor / 1.1 <= steps[-1][1] <= 1.1 * floor:
            continue
        after = len(steps)
        while after > 0 and floor / 1.1 <= steps[after - 1][1] <= 1.1 * floor:
            after -= 1
        arrivals.append((steps[after][0], name))
    arrivals.sort()
    first = ", ".join(f"`{name}` {time:.1f} ms" for time, name in arrivals[:3])
    ratio = floor / bound
    print(f"| `{objective}` | {floor:.1e} | {ratio:.{0 if ratio > 10 else 1}f} | {len(arrivals)} of {len(own)} | {first} |")
