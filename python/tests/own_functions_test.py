"""What functions of one's own return, and of what variables: shapes and types."""
import unittest

import numpy as np
from cases import main

import modcal
from modcal import Variable


class OwnFunctions(unittest.TestCase):
    VARIABLES = [Variable("a", "", -1.0, -5.0, 5.0), Variable("b", "m", 1.0, -5.0, 5.0)]

    def test_shapes(self):
        three = {"residuals": lambda x: [x[0], x[1], 1.0], "optimizer": {"type": "gsl", "algorithm": "dogleg"}}
        for jacobian, has in ((np.zeros((2, 3)), r"\(2, 3\)"), (np.zeros(6), r"\(6\)"), (np.zeros((3, 2, 1)), r"\(3, 2, 1\)")):
            with self.assertRaisesRegex(modcal.InvalidInput, f"Jacobian of the objective has the shape {has} in the place of "
                                                             r"\(3, 2\); return a row for each residual"):
                modcal.minimize(None, self.VARIABLES, jacobian=lambda x, held=jacobian: held, **three)
        for gradient, has in (([0, 0, 0], r"\(3\)"), (np.zeros((2, 1)), r"\(2, 1\)"), (0.0, r"\(\)")):
            with self.assertRaisesRegex(modcal.InvalidInput, f"gradient of the objective has the shape {has} in the place of "
                                                             r"\(2\); return a number for each variable"):
                modcal.minimize(lambda x: 0.0, self.VARIABLES, gradient=lambda x, held=gradient: held,
                                optimizer={"type": "nlopt", "algorithm": "LD_LBFGS"})
        lengths = iter((3, 3, 2))
        with self.assertRaisesRegex(modcal.InvalidInput, "as many at every x"):
            modcal.minimize(None, self.VARIABLES, residuals=lambda x: np.ones(next(lengths, 2)))

    def test_complex_numbers(self):
        for value in (1j, np.complex128(1), np.complex64(1), np.array(1j)):
            with self.assertRaisesRegex(modcal.InvalidInput, "in the place of a (real )?number"):
                modcal.minimize(lambda x, held=value: held, self.VARIABLES)
        for keys in ({"residuals": lambda x: x + 0j}, {"residuals": lambda x: x, "jacobian": lambda x: np.eye(2) + 0j}):
            with self.assertRaisesRegex(modcal.InvalidInput, "in the place of an array of real numbers"):
                modcal.minimize(None, self.VARIABLES, optimizer={"type": "gsl", "algorithm": "dogleg"}, **keys)

    def test_no_residuals(self):
        for optimizer in ("nlopt", "gsl", "ceres"):
            for nothing, words in (([], "the residuals are empty; return one or more"),
                                   (1.0, "the residuals returned 1.0 of type float in the place of a row of numbers"),
                                   (np.ones((2, 2)), "in the place of a row of numbers")):
                with self.assertRaisesRegex(modcal.InvalidInput, words):
                    modcal.minimize(None, self.VARIABLES, residuals=lambda x, held=nothing: held, optimizer=optimizer)

    def test_variables_of_other_types(self):
        for one, words in ((Variable(3, "", 1.0, 0.0, 2.0), "name = 3 of a variable is a int; give a text"),
                           (Variable("a", None, 1.0, 0.0, 2.0), "unit = None of a variable is a NoneType; give a text"),
                           (Variable("a", "", "1", 0.0, 2.0), "initial = '1' of \"a\" is a str; give a number"),
                           (Variable("a", "", 1.0, [0.0], 2.0), "lower = .* of \"a\" is a list; give a number")):
            with self.assertRaisesRegex(modcal.InvalidInput, words):
                modcal.minimize(lambda x: 0.0, [one])
        with self.assertRaisesRegex(modcal.InvalidInput, "gradient is a list; give a function of x"):
            modcal.minimize(lambda x: 0.0, self.VARIABLES, gradient=[0.0, 0.0])
        with self.assertRaisesRegex(modcal.InvalidInput, 'initial value 3 of "a" must lie'):
            modcal.minimize(lambda x: 0.0, [Variable("a", "", 3.0, 0.0, 2.0)])
        with self.assertRaisesRegex(modcal.InvalidInput, 'initial value 3 m of "a" must lie'):
            modcal.minimize(lambda x: 0.0, [Variable("a", "m", 3.0, 0.0, 2.0)])
        with self.assertRaisesRegex(modcal.InvalidInput, "bounds 1 and 1: leave"):
            modcal.minimize(lambda x: 0.0, [Variable("a", "", 1.0, 1.0, 1.0)])


if __name__ == "__main__":
    main()
