"""Every calibration of configs/ as a function: bounds, start, truth, bound; what is no point of it; Ctrl-C within it."""
import _thread
import threading
import time
import unittest

import numpy as np
from cases import CALIBRATE, ROOT, Folder, main

import modcal

SEVERAL = {"further_strokes": {"contacts": ["31 mm"]},
           "plucks": [{"initial": {"type": "pluck", "position": "43 mm", "displacement": "1 mm", "width": "3 mm"},
                       "duration": 0.2, "sample_rate": 12800}]}
LIKELIHOOD = {"calibration.objective": "joint_likelihood", "calibration.optimizer": "staged"}


def calibrations():
    return [file for file in sorted((ROOT / "configs").rglob("*.yaml"))
            if "\nkind: calibrate\n" in (text := "\n" + file.read_text(encoding="utf-8")) and "\nstructure:" not in text]


class Configs(unittest.TestCase):
    def test_every_one_is_a_problem(self):
        files = calibrations()
        self.assertGreaterEqual(len(files), 16)
        for file in files:
            with self.subTest(file=file.name):
                problem = modcal.Problem(file)
                low, high = np.transpose(problem.parameters.bounds)
                self.assertEqual(problem.truth.shape, problem.x0.shape)
                self.assertEqual(problem.bound.shape, problem.x0.shape)
                for x in (problem.x0, problem.truth):
                    self.assertTrue(np.all((low <= x) & (x <= high)), problem.parameters.names)
                    self.assertTrue(np.isfinite(problem.objective(x)))
                self.assertTrue(np.all(problem.bound >= 0.0))
                self.assertFalse(np.any(np.isnan(problem.bound)))
                if "joint_likelihood" in repr(problem):
                    # Half of χ², whose deviation is 1 % of it for 20 000 residuals; noise levels are read off the records.
                    chi2 = 2 * problem.objective(problem.truth) / problem.residuals(problem.truth).size
                    self.assertAlmostEqual(chi2, 1.0, delta=0.05)

    def test_modes_of_a_structure_are_searched_by_its_own_search(self):
        with self.assertRaisesRegex(modcal.InvalidInput, "takes no other optimizer: run the file"):
            modcal.Problem(ROOT / "configs/structures/calibrate_plate.yaml")


class Several(Folder):
    def test_slopes_and_residuals(self):
        problem = modcal.Problem({**CALIBRATE, **SEVERAL}, LIKELIHOOD)
        self.assertEqual(problem.parameters.names, ["f0", "B", "x_c", "x_c 2"])
        np.testing.assert_allclose(problem.truth, [196, 1e-4, 0.03, 0.031], rtol=1e-9)
        x = problem.x0
        residuals, jacobian = problem.residuals(x), problem.jacobian(x)
        self.assertAlmostEqual(0.5 * residuals @ residuals / problem.objective(x), 1.0, delta=1e-9)
        # Products of far modes are sums over the nodes of a block, here far from the optimum.
        np.testing.assert_allclose(problem.gradient(x), jacobian.T @ residuals, rtol=5e-3)
        self.assertLess(problem.objective(problem.truth), problem.objective(x))

    def test_search_finds_the_truth_within_the_bound(self):
        from scipy.optimize import least_squares

        problem = modcal.Problem({**CALIBRATE, **SEVERAL}, LIKELIHOOD)
        scale = problem.parameters.scales
        found = least_squares(problem.residuals, problem.truth, problem.jacobian, x_scale=scale, xtol=1e-12, ftol=1e-14)
        # Four numbers within 4.5 deviations, which noise exceeds once in 30 000.
        self.assertLess(np.max(np.abs(found.x - problem.truth) / problem.bound), 4.5)
        self.assertGreater(np.max(np.abs(found.x - problem.truth) / problem.bound), 0.05)

    def test_bound_is_that_of_the_program(self):
        told = modcal.limit(self.file({**CALIBRATE, **SEVERAL}), LIKELIHOOD)
        law = {one["name"]: one["sd"] for one in told["parameters"]}
        problem = modcal.Problem({**CALIBRATE, **SEVERAL}, LIKELIHOOD)
        for name, bound in zip(problem.parameters.names, problem.bound):
            # Two ways to the same information, whose condition is 1e8 in these units.
            self.assertAlmostEqual(bound / law[name], 1.0, delta=1e-5, msg=name)

    def test_truth_of_the_damping(self):
        problem = modcal.Problem({**CALIBRATE, "model_error": {"damping": "10 %"}},
                                 {**LIKELIHOOD, "calibration.parameters.damping": "factor"})
        truth = dict(zip(problem.parameters.names, problem.truth))
        np.testing.assert_allclose(problem.model(problem.truth).damping_ratios, 3e-3, rtol=1e-12)
        self.assertNotAlmostEqual(truth["damping"], 1.0, delta=0.05)

    def test_fixed_and_known(self):
        stated = {**LIKELIHOOD, "calibration.parameters.fixed": "[{parameter: x_c, value: 30 mm}]",
                  "calibration.parameters.priors": "[{parameter: f0, mean: 196 Hz, deviation: 1e-3 Hz}]"}
        held = modcal.Problem(CALIBRATE, stated)
        self.assertEqual(held.parameters.names, ["f0", "B"])
        self.assertLess(held.bound[0], 1e-3)
        free = modcal.Problem(CALIBRATE, {key: stated[key] for key in LIKELIHOOD})
        self.assertLess(held.bound[0], free.bound[0])
        x = held.truth.copy()
        at_truth = held.objective(x)
        x[0] += 0.1  # a hundred deviations: half their square
        self.assertGreater(held.objective(x) - at_truth, 4000)


class Points(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.problem = modcal.Problem(CALIBRATE)

    def test_layouts(self):
        problem, x = self.problem, self.problem.x0
        frozen = x.copy()
        frozen.setflags(write=False)
        for same in (list(x), tuple(x), np.repeat(x, 2)[::2], frozen, x.astype(">f8"), x.astype(np.longdouble)):
            self.assertEqual(problem.objective(same), problem.objective(x))
            np.testing.assert_array_equal(problem.gradient(same), problem.gradient(x))
        self.assertTrue(np.isfinite(problem.objective(x.astype(np.float32))))

    def test_refused(self):
        problem, x = self.problem, self.problem.x0
        nan = x.copy()
        nan[1] = np.nan
        wrong = ((x[:2], "x has 2 values: the problem has 3 variables, give one for each", "give one for each"),
                 (nan, r"x\[1\] \(B\) is nan; give a finite number", "give a finite number"),
                 (x.reshape(1, 3), r"x has the shape \(1, 3\); give one row of numbers", "give one row of numbers"),
                 (x * 1j, "x is an array of complex128, not of real numbers", "convert it with astype"),
                 (["a", "b", "c"], "x is an array of <U1, not of real numbers", "convert it with astype"),
                 (np.array([None, 1, 2], dtype=object), "x is an array of object", "convert it with astype"),
                 ([], "x is empty; give one row of numbers", "give one row"), (None, "x is an array of object", "convert"),
                 ([[1.0], [2.0, 3.0]], "x is no array", "give one row"), (3.0, r"x has the shape \(\)", "give one row"),
                 (np.ma.masked_greater(x, 1.0), "x has masked numbers", "fill them"))
        for point, words, remedy in wrong:
            for call in (problem.objective, problem.gradient, problem.residuals, problem.jacobian, problem.model):
                with self.assertRaisesRegex(modcal.InvalidInput, words) as caught:
                    call(point)
                self.assertIn(remedy, caught.exception.remedy)

    def test_points_of_an_optimizer(self):
        for point, words in (([1.0], "z has 1 values"), ("abc", "z is an array of <U3"), (None, "z is an array of object")):
            with self.assertRaisesRegex(modcal.InvalidInput, words):
                self.problem.minimize(lambda evaluator, point=point: evaluator.value(point))
        found = self.problem.minimize(lambda evaluator: evaluator.value(list(evaluator.start)) and None)
        self.assertEqual(found.evaluations, 2)


class Functions(unittest.TestCase):
    """What functions of one's own return."""

    def test_refused(self):
        one = [modcal.Variable("a", "", 0.0, -1.0, 1.0)]
        slopes = {"type": "nlopt", "algorithm": "LD_LBFGS"}
        for words, call in (
            ("returned 'a' of type str in the place of a number", lambda: modcal.minimize(lambda x: "a", one)),
            ("the gradient of the objective|the gradient returned 'b'", lambda: modcal.minimize(
                lambda x: 0.0, one, gradient=lambda x: "b", optimizer=slopes)),
            ("no list of modcal.Variable", lambda: modcal.minimize(lambda x: 0.0, [])),
            ("no list of modcal.Variable", lambda: modcal.minimize(lambda x: 0.0, [(0.0, 1.0)])),
        ):
            with self.assertRaisesRegex(modcal.InvalidInput, words):
                call()

    def test_what_is_no_experiment(self):
        for source in ("", {}):
            with self.assertRaisesRegex(modcal.InvalidInput, "the experiment is empty"):
                modcal.run(source)
        with self.assertRaisesRegex(modcal.InvalidInput, "the overrides are a int"):
            modcal.run(CALIBRATE, 3)
        for threads in ("2", -1, 1.5):
            with self.assertRaisesRegex(modcal.InvalidInput, "is no number of threads; give a whole number, 0 for all"):
                modcal.run(CALIBRATE, threads=threads)
        with self.assertRaisesRegex(modcal.InvalidInput, r"make it by modcal.Record\("):
            modcal.invert([1.0, 2.0], CALIBRATE["scene"]["string"], 0.03)
        for keys in ({"samples": 0}, {"samples": 1.5}, {"rate": "x"}, {"rate": float("nan")}):
            with self.assertRaisesRegex(modcal.InvalidInput, "; give a"):
                modcal.Inverter(CALIBRATE["scene"]["string"], 0.03, **{"samples": 100, "rate": 12800, **keys})


class Interrupt(unittest.TestCase):
    """Ctrl-C, not waited for longer than a slow machine needs: an evaluation below takes 20 times as long."""

    def test_within_an_evaluation(self):
        longer = {"scene.duration": 2, "measurement.sample_rate": "51.2 kHz"}
        problem = modcal.Problem(ROOT / "configs/beyond/simulator_in_the_loop.yaml", longer)
        for _ in range(2):

            def press():
                time.sleep(0.3)
                _thread.interrupt_main()

            thread = threading.Thread(target=press)
            thread.start()
            with self.assertRaises(KeyboardInterrupt):
                problem.objective(problem.x0)
                time.sleep(10)  # it had ended before
            thread.join()

    def test_an_inversion_of_millions(self):
        noise = np.random.default_rng(1).normal(0, 1, 2_000_000)
        inverter = modcal.Inverter({"length": 0.33, "linear_density": 3.1e-3, "fundamental": 196}, 0.03,
                                   samples=noise.size, rate=51200)

        def press():
            time.sleep(0.1)
            _thread.interrupt_main()

        thread = threading.Thread(target=press)
        thread.start()
        with self.assertRaises(KeyboardInterrupt):
            for _ in range(100):
                inverter(noise, noise)
        thread.join()
        short = modcal.Inverter({"length": 0.33, "linear_density": 3.1e-3, "fundamental": 196}, 0.03, samples=1024, rate=51200)
        self.assertEqual(short(noise[:1024], noise[:1024])[0].force.size, 1024)  # the wish is forgotten


if __name__ == "__main__":
    main()
