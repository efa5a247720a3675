#!/usr/bin/python3
"""Times whole commands: minimum, median and maximum of wall time, and peak memory.

usage: whole_process.py [-n RUNS] -- COMMAND [ARG ...]
"""
import os
import statistics
import subprocess
import sys
import time


def run_once(command):
    start = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    seconds = time.perf_counter() - start
    code = os.waitstatus_to_exitcode(status)
    if code != 0:
        sys.exit(f"{' '.join(command)}: exit code {code}")
    return seconds, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024.0


def main(arguments):
    runs = 5
    if arguments[:1] == ["-n"]:
        runs = int(arguments[1])
        arguments = arguments[2:]
    if arguments[:1] != ["--"] or len(arguments) < 2:
        sys.exit(__doc__)
    command = arguments[1:]
    run_once(command)  # warm-up
    results = [run_once(command) for _ in range(runs)]
    wall = [r[0] for r in results]
    cpu = [r[1] for r in results]
    print(f"{' '.join(command)}\n  wall s: min {min(wall):.3f} median {statistics.median(wall):.3f} "
          f"max {max(wall):.3f}   cpu s: median {statistics.median(cpu):.3f}   "
          f"peak memory MB: {max(r[2] for r in results):.0f}   runs: {runs}")


if __name__ == "__main__":
    main(sys.argv[1:])
