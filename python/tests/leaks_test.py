"""Ten thousand calls of everything that is called often leave nothing behind."""
import ctypes
import gc
import unittest

import numpy as np
from cases import CALIBRATE, INVERT, SCENE, main

import modcal

CALLS = 10_000
MOST = 2**20  # 100 bytes a call; the allocator's own pages come and go by some 100 KB


def resident():
    gc.collect()
    ctypes.CDLL(None).malloc_trim(0)
    with open("/proc/self/statm", encoding="ascii") as file:
        return 4096 * int(file.read().split()[1])


class Leaks(unittest.TestCase):
    def check(self, call, calls=CALLS):
        for _ in range(calls // 5):
            call()
        before = resident()
        for _ in range(calls):
            call()
        self.assertLess(resident() - before, MOST)

    @classmethod
    def setUpClass(cls):
        short = {"scene.duration": 0.05, "measurement.sample_rate": 6400}
        cls.problem = modcal.Problem(CALIBRATE, short)
        cls.keys = {**SCENE["string"], "modes": 4}
        cls.samples = np.sin(np.arange(128.0))

    def test_evaluations(self):
        problem, x = self.problem, self.problem.x0
        self.check(lambda: (problem.objective(x), problem.gradient(x), problem.residuals(x), problem.jacobian(x)))

    def test_searches_of_ones_own(self):
        problem = self.problem

        def search(evaluator):
            evaluator.value(evaluator.start)
            evaluator.value_and_gradient(evaluator.start)

        self.check(lambda: problem.minimize(search))
        one = modcal.Variable("a", "1", 0.0, -1.0, 1.0, 1.0)
        self.check(lambda: modcal.minimize(lambda x: float(x @ x), [one], budget={"evaluations": 3}))

    def test_inversions(self):
        inverter = modcal.Inverter(self.keys, "30 mm", samples=128, rate=6400)
        self.check(lambda: inverter(self.samples, self.samples, motion=True))

    def test_models_and_records(self):
        def made():
            model = modcal.Model.string("30 mm", **self.keys)
            model.transfer([100.0, 200.0])
            modcal.Record(rate=6400, left=self.samples, right=self.samples)

        self.check(made)

    def test_mistakes(self):
        def refused():
            try:
                modcal.Model.string("30 mm", lenght=1)
            except modcal.InvalidInput:
                pass
            modcal.validate({**INVERT, "simulater": 1})

        self.check(refused)

    def test_runs(self):
        # Slower by a factor of a hundred, so a tenth of the calls: 1 KB a run.
        self.check(lambda: modcal.run(INVERT, {"scene.duration": 0.02, "scene.string.modes": 4}), CALLS // 10)


main()
