"""modcal: modal models of bowed strings and the force of the bow, from the reactions at the ends.

    import modcal
    found = modcal.run("mine.yaml")
    found.parameters, found.f_c_joint, found.plot()
"""
from modcal.errors import InvalidInput, Mistake, SearchOver
from modcal.experiments import (ask, calibrate, describe, fit_modes, identify, invert, limit, load, new, plugins, run,
                                schema, simulate, validate)
from modcal.inverter import Estimate, Inverter
from modcal.models import Model
from modcal.problem import (Evaluator, Parameters, Problem, Search, Variable, add_objective, add_optimizer,
                            minimize)
from modcal.records import Record
from modcal.results import Result, Table

__all__ = [
    "Estimate", "Evaluator", "InvalidInput", "Inverter", "Mistake", "Model", "Parameters", "Problem", "Record", "Result",
    "Search", "SearchOver", "Table", "Variable", "add_objective", "add_optimizer", "ask", "calibrate", "describe",
    "fit_modes", "identify", "invert", "limit", "load", "minimize", "new", "plugins", "run", "schema", "simulate", "validate",
]
