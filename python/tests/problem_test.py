"""Calibrations as functions, and searches of one's own."""
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from cases import CALIBRATE, SIMULATE, Folder, main

import modcal
from modcal import Variable


class Functions(Folder):
    @classmethod
    def setUpClass(cls):
        cls.problem = modcal.Problem(CALIBRATE)

    def test_variables(self):
        problem = self.problem
        self.assertEqual(problem.parameters.names, ["f0", "B", "x_c"])
        self.assertEqual([one.unit for one in problem.parameters], ["Hz", "1", "m"])
        np.testing.assert_allclose(problem.truth, [196, 1e-4, 0.03], rtol=1e-9)
        self.assertAlmostEqual(problem.x0[2], 0.0304)
        for (low, high), start in zip(problem.parameters.bounds, problem.x0):
            self.assertTrue(low < start < high)

    def test_bound_is_that_of_the_truth(self):
        problem = modcal.Problem(CALIBRATE, {"calibration.objective": "joint_likelihood"})
        jacobian = problem.jacobian(problem.truth)
        deviations = np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian)))
        # J holds the noise of the record, which counts as information, and its level as it is read off the record.
        np.testing.assert_allclose(problem.bound, deviations, rtol=0.2)
        np.testing.assert_array_equal(self.problem.bound, problem.bound)

    def test_model_at_a_point(self):
        problem = modcal.Problem(CALIBRATE)
        model = problem.model(problem.truth)
        n = np.arange(1, 13)
        np.testing.assert_allclose(model.frequencies, 196 * n * np.sqrt(1 + 1e-4 * n**2), rtol=1e-12)
        self.assertEqual(list(model.sensors), ["R1", "R2", "y"])

    def test_slopes_are_those_of_the_value(self):
        problem, x = self.problem, self.problem.x0
        residuals, jacobian = problem.residuals(x), problem.jacobian(x)
        self.assertEqual(jacobian.shape, (residuals.size, 3))
        self.assertAlmostEqual(0.5 * residuals @ residuals, problem.objective(x), delta=1e-9 * problem.objective(x))
        np.testing.assert_allclose(problem.gradient(x), jacobian.T @ residuals, rtol=1e-9)
        for i, variable in enumerate(problem.parameters):
            step = np.zeros(3)
            step[i] = 1e-4 * variable.scale
            slope = (problem.objective(x + step) - problem.objective(x - step)) / (2 * step[i])
            self.assertAlmostEqual(problem.gradient(x)[i] / slope, 1.0, delta=1e-3)

    def test_objective_without_slopes(self):
        problem = modcal.Problem(CALIBRATE, {"calibration.objective": "innovation_misfit",
                                             "calibration.parameters.law": False,
                                             "calibration.optimizer": "nlopt"})
        self.assertFalse(problem.capabilities["gradient"])
        x, step = problem.x0, 6e-6 * problem.parameters[0].scale
        slope = (problem.objective(x + step) - problem.objective(x - step)) / (2 * step)
        self.assertAlmostEqual(problem.gradient(x)[0] / slope, 1.0, delta=0.2)

    def test_scipy_finds_what_the_program_finds(self):
        from scipy.optimize import least_squares

        problem = self.problem
        scale = problem.parameters.scales
        low, high = np.transpose(problem.parameters.bounds)
        theirs = least_squares(problem.residuals, problem.x0, problem.jacobian, bounds=(low, high), x_scale=scale,
                               xtol=1e-12, ftol=1e-12, gtol=1e-12)
        ours = {one["name"]: one["final"] for one in modcal.run(CALIBRATE).parameters}
        np.testing.assert_allclose(theirs.x, [ours[name] for name in problem.parameters.names], rtol=1e-3)

    def test_optimizers_of_modcal(self):
        found = self.problem.minimize({"type": "gsl", "algorithm": "dogleg"})
        ours = {one["name"]: one["final"] for one in modcal.run(CALIBRATE).parameters}
        np.testing.assert_array_equal(found.x, [ours[name] for name in self.problem.parameters.names])
        self.assertLess(found.value, found.initial_value)
        self.assertTrue(np.all(np.diff(found.trace["value"]) < 0))
        few = self.problem.minimize("nlopt", budget={"evaluations": 5})
        self.assertEqual((few.stop, few.evaluations), ("evaluation_budget", 5))

    def test_four_problems_in_four_threads(self):
        def found(seed):
            search = modcal.Problem(CALIBRATE, {"seed": seed}).minimize({"type": "gsl", "algorithm": "dogleg"})
            return *search.x, search.value

        alone = [found(seed) for seed in range(1, 5)]
        with ThreadPoolExecutor(4) as pool:
            self.assertEqual(list(pool.map(found, range(1, 5))), alone)
        self.assertEqual(len(set(alone)), 4)

    def test_refusals(self):
        with self.assertRaisesRegex(modcal.InvalidInput, "2 values: the problem has 3 variables"):
            self.problem.objective([1.0, 2.0])
        with self.assertRaisesRegex(modcal.InvalidInput, "searches nothing"):
            modcal.Problem(SIMULATE)
        with self.assertRaisesRegex(modcal.InvalidInput, "unknown optimizer"):
            self.problem.minimize("nloptt")
        with self.assertRaisesRegex(modcal.InvalidInput, "<options>"):
            self.problem.minimize({"type": "nlopt", "algorthm": "sbplx"})


class OwnOptimizer(Folder):
    def test_budget_bounds_and_trace(self):
        problem = modcal.Problem(CALIBRATE)

        def compass(evaluator):
            z, best, step = evaluator.start, evaluator.value(evaluator.start), 1.0
            while step > 1e-4:
                better = False
                for i in range(evaluator.dimension):
                    for sign in (1, -1):
                        trial = z.copy()
                        trial[i] += sign * step
                        trial = np.clip(trial, evaluator.lower, evaluator.upper)
                        value = evaluator.value(trial)
                        if value < best:
                            z, best, better = trial, value, True
                step *= 1.0 if better else 0.5
            return "small_step"

        found = problem.minimize(compass)
        self.assertEqual(found.stop, "small_step")
        ours = problem.minimize({"type": "gsl", "algorithm": "dogleg"})
        self.assertAlmostEqual(found.x[2], ours.x[2], delta=1e-5)
        self.assertEqual(found.value, problem.objective(found.x))
        few = problem.minimize(compass, budget={"evaluations": 10})
        self.assertEqual((few.stop, few.evaluations), ("evaluation_budget", 10))

    def test_its_errors_come_out(self):
        problem = modcal.Problem(CALIBRATE)
        kept = []

        def wrong(evaluator):
            kept.append(evaluator)
            raise LookupError("mine")

        with self.assertRaisesRegex(LookupError, "mine"):
            problem.minimize(wrong)
        with self.assertRaisesRegex(modcal.InvalidInput, "search of this evaluator is over"):
            kept[0].value([0, 0, 0])
        with self.assertRaisesRegex(modcal.InvalidInput, "unknown reason"):
            problem.minimize(lambda evaluator: "why not")


class Registered(Folder):
    """Plug-ins of Python that experiments choose by their names."""

    def test_optimizer(self):
        def halving(evaluator):
            z, best, step = evaluator.start, evaluator.value(evaluator.start), 1.0
            while abs(step) > 1e-3:
                value = evaluator.value(z + step)
                if value < best:
                    z, best = z + step, value
                else:
                    step *= -0.5
            return "small_step"

        modcal.add_optimizer("halving", halving, "a step that turns and halves")
        contact = {"calibration.parameters.law": False, "calibration.optimizer": "halving"}
        found = modcal.run(CALIBRATE, contact)
        problem = modcal.Problem(CALIBRATE, {"calibration.parameters.law": False})
        self.assertEqual(found.parameters[0]["final"], problem.minimize(halving).x[0])
        self.assertEqual(problem.minimize("halving").evaluations, problem.minimize(halving).evaluations)
        few = modcal.run(CALIBRATE, {**contact, "calibration.budget.evaluations": 5})
        self.assertIn("5 evaluations", few.summary)
        with self.assertRaisesRegex(modcal.InvalidInput, "is there already"):
            modcal.add_optimizer("nlopt", halving)
        for arguments, words in ((("o2", 3), 'search of the optimizer "o2" is a int; give what can be called'),
                                 ((3, halving), "the name of the optimizer is a int; give a text"),
                                 (("", halving), "the name of the optimizer is empty: give it one")):
            with self.assertRaisesRegex(modcal.InvalidInput, words):
                modcal.add_optimizer(*arguments)
        with self.assertRaisesRegex(modcal.InvalidInput, 'bind of the objective "o2" is a int'):
            modcal.add_objective("o2", 3)

    def test_optimizer_that_fails(self):
        def wrong(evaluator):
            raise LookupError("mine")

        modcal.add_optimizer("wrong", wrong)
        with self.assertRaisesRegex(modcal.InvalidInput, '"wrong", written in Python, has failed: LookupError: mine'):
            modcal.run(CALIBRATE, {"calibration.optimizer": "wrong"})

    def test_objective(self):
        seen = []

        def bind(record):
            seen.append(record)
            true = record.model(record.x0)["contact"] - 0.4e-3
            return lambda x: float((1e3 * (record.model(x)["contact"] - true)) ** 2)

        modcal.add_objective("distance", bind)
        found = modcal.run(CALIBRATE, {"calibration.objective": "distance", "calibration.parameters.law": False,
                                       "calibration.optimizer": {"type": "nlopt", "algorithm": "LN_BOBYQA"}})
        # The minimum of a parabola is found to the root of the digits of its values: 1e-8 of 1 mm or so.
        self.assertAlmostEqual(found.parameters[0]["final"], 0.03, delta=1e-8)
        record = seen[0]
        self.assertEqual((record.rate, record.names), (12800, ["x_c"]))
        self.assertEqual(record.left.shape, (record.samples // 2 + 1,))
        self.assertEqual(record.model([0.03])["frequencies"].shape, (12,))

    def test_slopes_of_ones_own(self):
        asked = []

        class Distance:
            def __init__(self, record):
                self.true = record.model(record.x0)["contact"] - 0.4e-3

            def residuals(self, x):
                asked.append("residuals")
                return [1e3 * (x[0] - self.true)]

            def jacobian(self, x):
                asked.append("jacobian")
                return [[1e3]]

        modcal.add_objective("with_jacobian", Distance, provides=["residuals", "jacobian"])
        own = {"calibration.objective": "with_jacobian", "calibration.parameters.law": False}
        found = modcal.run(CALIBRATE, own)  # GSL's dogleg takes nothing less
        # One step of Gauss and Newton is exact for a residual that is linear; x has 16 digits.
        self.assertAlmostEqual(found.parameters[0]["final"], 0.03, delta=1e-12)
        self.assertEqual(set(asked), {"residuals", "jacobian"})

        class Parabola(Distance):
            def value(self, x):
                return 0.5 * (1e3 * (x[0] - self.true)) ** 2

            def gradient(self, x):
                return [1e6 * (x[0] - self.true)]

        modcal.add_objective("with_gradient", Parabola, provides=["gradient"])
        by_gradient = {**own, "calibration.objective": "with_gradient",
                       "calibration.optimizer": {"type": "nlopt", "algorithm": "LD_LBFGS"}}
        found = modcal.run(CALIBRATE, by_gradient)
        self.assertAlmostEqual(found.parameters[0]["final"], 0.03, delta=1e-8)
        for provides, words in ((["slope"], "provides some of"), (["jacobian"], "that of residuals"),
                                (["gradient", "gradient"], "each once")):
            with self.assertRaisesRegex(modcal.InvalidInput, words):
                modcal.add_objective("wrong", Parabola, provides=provides)
        with self.assertRaisesRegex(modcal.InvalidInput, r'provides is the text "gradient"; give a list of words'):
            modcal.add_objective("wrong", Parabola, provides="gradient")
        # A name that no short string holds.
        modcal.add_objective("with_residuals_and_jacobian", Distance, provides=["residuals", "jacobian"])
        named = modcal.Problem(CALIBRATE, {**own, "calibration.objective": "with_residuals_and_jacobian"})
        self.assertIn("with_residuals_and_jacobian", repr(named))
        modcal.add_objective("without", lambda record: object(), provides=["residuals"])
        with self.assertRaisesRegex(modcal.InvalidInput, "no attribute 'residuals'"):
            modcal.run(CALIBRATE, {**own, "calibration.objective": "without", "calibration.optimizer": "nlopt"})


class OwnObjective(Folder):
    def test_its_name_in_a_refusal(self):
        with self.assertRaisesRegex(modcal.InvalidInput, "own"):
            modcal.minimize(lambda x: 0.0, self.VARIABLES, optimizer={"type": "ceres"})

    VARIABLES = [Variable("a", "", -1.0, -5.0, 5.0), Variable("b", "m", 1.0, -5.0, 5.0)]

    def test_value(self):
        found = modcal.minimize(lambda x: float((x[0] - 1) ** 2 + 10 * (x[1] + 2) ** 2), self.VARIABLES)
        np.testing.assert_allclose(found.x, [1, -2], atol=1e-3)

    def test_residuals(self):
        found = modcal.minimize(
            None, self.VARIABLES, residuals=lambda x: [x[0] - 1, 10 * (x[1] - x[0] ** 2)],
            jacobian=lambda x: [[1, 0], [-20 * x[0], 10]], optimizer={"type": "gsl", "algorithm": "dogleg"})
        np.testing.assert_allclose(found.x, [1, 1], atol=1e-6)

    def test_its_errors_come_out(self):
        def wrong(x):
            raise LookupError("mine")

        with self.assertRaisesRegex(LookupError, "mine"):
            modcal.minimize(wrong, self.VARIABLES)
        with self.assertRaisesRegex(modcal.InvalidInput, "nothing to minimize"):
            modcal.minimize(None, self.VARIABLES)


class Counting(Folder):
    def test_evaluations_are_counted(self):
        count = []

        def cheap(x):
            count.append(None)
            return float(x @ x)

        back = modcal.minimize(cheap, [Variable("a", "", 1, -2, 2), Variable("b", "", 1, -2, 2)])
        self.assertEqual(back.evaluations, len(count))


if __name__ == "__main__":
    main()
