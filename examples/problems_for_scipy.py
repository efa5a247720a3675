"""Calibrations as problems for optimizers in any language: here SciPy's, through the C library.

    python3 problems_for_scipy.py libmodcal_problems.so calibrate.yaml [key=value ...]
"""
import ctypes
import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

library = ctypes.CDLL(sys.argv[1])
numbers = np.ctypeslib.ndpointer(dtype=np.float64, flags="C_CONTIGUOUS")
handle, count = ctypes.c_void_p, ctypes.c_size_t
library.modcal_problem_open.restype = handle
library.modcal_problem_open.argtypes = [ctypes.c_char_p, ctypes.POINTER(ctypes.c_char_p), count]
library.modcal_problem_message.restype = ctypes.c_char_p
library.modcal_problem_name.restype = ctypes.c_char_p
library.modcal_problem_name.argtypes = [handle, count]
library.modcal_problem_dimension.restype = count
functions: dict[str, list[Any]] = {
    "dimension": [], "start": [numbers], "scale": [numbers], "truth": [numbers], "bound": [numbers],
    "bounds": [numbers, numbers], "value": [numbers, numbers], "gradient": [numbers, numbers], "close": []}
for name, arguments in functions.items():
    getattr(library, f"modcal_problem_{name}").argtypes = [handle, *arguments]


def checked(failed: bool) -> None:
    if failed:
        raise ValueError(library.modcal_problem_message().decode())


assignments = [word.encode() for word in sys.argv[3:]]
texts = (ctypes.c_char_p * len(assignments))(*assignments)
problem = library.modcal_problem_open(sys.argv[2].encode(), texts, len(assignments))
checked(problem is None)
d = library.modcal_problem_dimension(problem)
start, scale, truth, bound, lower, upper = np.empty((6, d))
library.modcal_problem_start(problem, start)
library.modcal_problem_scale(problem, scale)
library.modcal_problem_bounds(problem, lower, upper)
checked(library.modcal_problem_truth(problem, truth))
checked(library.modcal_problem_bound(problem, bound))


def value_and_gradient(z: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
    x, value, gradient = np.ascontiguousarray(start + scale * z), np.empty(1), np.empty(d)
    checked(library.modcal_problem_value(problem, x, value) or library.modcal_problem_gradient(problem, x, gradient))
    return value[0], gradient * scale


found = minimize(value_and_gradient, np.zeros(d), jac=True, method="L-BFGS-B",
                 bounds=list(zip((lower - start) / scale, (upper - start) / scale)))
for i in range(d):
    x = start[i] + scale[i] * found.x[i]
    print(f"{library.modcal_problem_name(problem, i).decode()} = {x:.9g}, "
          f"{(x - truth[i]) / bound[i]:.2f} deviations from the truth")
library.modcal_problem_close(problem)
