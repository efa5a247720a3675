#!/usr/bin/python3
"""What Python costs beside the engine: overhead.py BUILD. Ratios of runs in turn, processor time, the best of several."""
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

BUILD = Path(sys.argv[1]).resolve()
sys.path.insert(0, str(BUILD / "python"))
import numpy as np  # noqa: E402

import modcal  # noqa: E402

STRING = {"length": 0.33, "linear_density": 3.1e-3, "fundamental": 196, "modes": 50}
SAMPLES, RATE, ROUNDS, REPEATS = 51200, 51200, 5, 20


def stroke():
    scene = {"string": STRING, "bow": {"position": 0.03}, "duration": SAMPLES / RATE}
    found = modcal.simulate(scene=scene, simulator={"type": "modal_event"},
                            measurement={"sample_rate": RATE, "noise_level": 0.01})
    return found.R1, found.R2


def of_peer(record):
    """Processor time of each of REPEATS inversions by the library from C++."""
    said = subprocess.run([BUILD / "benchmarks/invert_peer", record, str(REPEATS)], check=True, capture_output=True, text=True)
    return min(float(line) for line in said.stdout.split())


def timed(call, clock=time.process_time):
    begin = clock()
    call()
    return clock() - begin


def inversions(left, right):
    inverter = modcal.Inverter(STRING, 0.03, samples=SAMPLES, rate=RATE)
    with tempfile.TemporaryDirectory() as folder:
        record = Path(folder) / "record"
        record.write_bytes(np.concatenate([left, right]).tobytes())
        theirs, ours = [], []
        for _ in range(ROUNDS):
            theirs.append(of_peer(record))
            ours.append(min(timed(lambda: inverter(left, right)) for _ in range(REPEATS)))
        force = np.frombuffer(Path(f"{record}.force").read_bytes())
    same = np.array_equal(force, inverter(left, right)[0].force)
    print(f"Inverter, {SAMPLES} samples: C++ {1e3 * min(theirs):.2f} ms, Python {1e3 * min(ours):.2f} ms, "
          f"ratio {min(ours) / min(theirs):.3f}; {'the same bits' if same else 'OTHER BITS'}")


def experiment(left, right):
    def share():
        begin = time.perf_counter()
        found = modcal.invert(modcal.Record(rate=RATE, left=left, right=right), STRING, 0.03)
        return (time.perf_counter() - begin) / found.seconds, found.seconds

    shares = [share() for _ in range(7)]
    print(f"invert(), {SAMPLES} samples: the experiment in C++ {min(one[1] for one in shares):.3f} s, "
          f"from Python {min(one[0] for one in shares):.3f} of that")


def evaluations(calls=100_000):
    # A record so short that an evaluation costs next to nothing.
    experiment = {"kind": "calibrate", "simulator": {"type": "modal_event"},
                  "scene": {"string": {**STRING, "modes": 12}, "bow": {"position": 0.03}, "duration": 0.02},
                  "measurement": {"sample_rate": 12800, "noise_level": 0.01}, "model_error": {"contact": 4e-4},
                  "calibration": {"parameters": {"frequencies": "none", "law": False, "contact": True},
                                  "objective": "contact_location", "optimizer": "nlopt"}}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        problem = modcal.Problem(experiment)

    def own(evaluator):
        z = evaluator.start
        for _ in range(calls):
            evaluator.value(z)

    def cost(optimizer):
        begin = time.process_time()
        found = problem.minimize(optimizer, budget={"evaluations": calls + 1})
        return (time.process_time() - begin) / found.evaluations

    engine, ours = (min(costs) for costs in zip(*((cost({"type": "grid", "points": calls}), cost(own)) for _ in range(ROUNDS))))
    x = problem.x0
    called = min(timed(lambda: [problem.objective(x) for _ in range(calls // 10)]) for _ in range(ROUNDS)) / (calls // 10)
    print(f"{calls} evaluations: {1e6 * engine:.2f} µs each by an optimizer in C++, {1e6 * (ours - engine):.2f} µs more by one "
          f"in Python; problem.objective(x) {1e6 * (called - engine):.2f} µs more")


def main():
    left, right = stroke()
    inversions(left, right)
    experiment(left, right)
    evaluations()


main()
