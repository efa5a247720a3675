"""Calibrations as functions to be minimized."""
from __future__ import annotations

from typing import Any, Callable, Mapping, NamedTuple, Sequence, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from modcal import _core, yaml
from modcal.errors import InvalidInput
from modcal.experiments import Progress, Source, _told, open_experiment
from modcal.models import Model

Evaluator = _core.Evaluator

Array = NDArray[np.float64]


class Variable(NamedTuple):
    """A number that a search may change, in the unit of a reader."""

    name: str
    unit: str
    initial: float
    lower: float
    upper: float
    scale: float = 1.0  #: searches see (x - initial)/scale


class Parameters(Tuple[Variable, ...]):
    """The free parameters of a search, in the order of x."""

    @property
    def names(self) -> list[str]:
        return [one.name for one in self]

    @property
    def start(self) -> Array:
        return np.array([one.initial for one in self])

    @property
    def scales(self) -> Array:
        """Of which searches take steps."""
        return np.array([one.scale for one in self])

    @property
    def bounds(self) -> list[tuple[float, float]]:
        """As scipy.optimize takes them."""
        return [(one.lower, one.upper) for one in self]


class Search(NamedTuple):
    """What a search found."""

    x: Array
    value: float
    stop: str  #: why it ended: "converged", "evaluation_budget", …
    message: str
    initial_value: float
    evaluations: int
    seconds: float
    trace: dict[str, Array]  #: evaluations, seconds and value of every better point


def _search(told: Mapping[str, Any]) -> Search:
    return Search(**{key: told[key] for key in Search._fields})


def _options(optimizer: str | Mapping[str, Any] | None, budget: Mapping[str, Any] | None) -> str:
    stated: dict[str, Any] = {}
    if optimizer is not None:
        stated["optimizer"] = {"type": optimizer} if isinstance(optimizer, str) else optimizer
    if budget is not None:
        stated["budget"] = budget
    return yaml.flow(stated)


class Problem:
    """What an experiment of kind: calibrate minimizes, with its records made or read.

    Of several records it is the likelihood of all: what each has for itself stands in x with its number, "x_c 2". Where
    the optimizer is staged, what the file states beforehand joins it: priors, and the scatter of f_n about the law.

    x holds the free parameters in the units of `parameters`. The functions may be called from several
    threads.
    """

    def __init__(self, source: Source, overrides: Mapping[str, Any] | None = None, *,
                 progress: Progress = None) -> None:
        self._core = open_experiment(source, overrides).search(_told(progress))
        self.parameters = Parameters(Variable(**one) for one in self._core.variables)

    @property
    def x0(self) -> Array:
        """The start."""
        return self.parameters.start

    @property
    def truth(self) -> Array | None:
        """Of a simulated string: x where its model is right; None of a record."""
        truth = self._core.truth
        return truth if truth.size else None

    @property
    def bound(self) -> Array | None:
        """Standard deviations that no unbiased estimate from these records goes below, whatever its objective.

        The Cramér–Rao bound at the truth, the force unknown and all else known; with the priors of the file where
        the optimizer is staged. One that knows more, such as the law of the friction, may go below. 0 where the
        records have no noise, infinite for what they do not tell; None of a record, whose truth is not known.
        """
        bound = self._core.bound
        return bound if bound.size else None

    @property
    def capabilities(self) -> dict[str, bool]:
        """Whether the objective itself gives a gradient, residuals and their Jacobian."""
        return dict(self._core.capabilities)

    def objective(self, x: ArrayLike) -> float:
        return self._core.value(x)

    def gradient(self, x: ArrayLike) -> Array:
        """By differences where the objective gives none."""
        return self._core.gradient(x)

    def residuals(self, x: ArrayLike) -> Array:
        """r with objective = r·r/2."""
        return self._core.residuals(x)

    def jacobian(self, x: ArrayLike) -> Array:
        """dr_j/dx_i, a row for each residual."""
        return self._core.jacobian(x)

    def model(self, x: ArrayLike) -> Model:
        """The string with these parameters: its modes and its transfer functions."""
        return Model(self._core.model(x), {})

    def minimize(self, optimizer: str | Mapping[str, Any] | Callable[[_core.Evaluator], str | None] = "nlopt", *,
                 budget: Mapping[str, Any] | None = None, progress: Progress = None) -> Search:
        """Searches by one of modcal's optimizers, {"type": "nlopt", ...}, or by one of your own.

        Your own is called with an evaluator, which scales, bounds, counts, traces and ends the search:
        evaluator.value(z) from evaluator.start within evaluator.lower and evaluator.upper. It may return
        why it ended, such as "converged".
        """
        if callable(optimizer):
            return _search(_core.search(self._core, optimizer, _options(None, budget), _told(progress)))
        return _search(self._core.minimize(_options(optimizer, budget), _told(progress)))

    def __repr__(self) -> str:
        return f"<modcal.Problem {self._core.objective} of {', '.join(self.parameters.names)}>"


def _require_own(kind: str, name: str, summary: str, what: str, called: Any) -> None:
    for word, text in (("name", name), ("summary", summary)):
        if not isinstance(text, str):
            raise InvalidInput(f"the {word} of the {kind} is a {type(text).__name__}; give a text")
    if not callable(called):
        raise InvalidInput(f"{what} of the {kind} \"{name}\" is a {type(called).__name__}; give what can be called")


def _require_typed(variable: Variable) -> None:
    """What C++ would refuse without a word of what is wrong."""
    for word, text in (("name", variable.name), ("unit", variable.unit)):
        if not isinstance(text, str):
            raise InvalidInput(f"{word} = {text!r} of a variable is a {type(text).__name__}; give a text")
    for word, number in zip(variable._fields[2:], variable[2:]):
        if np.ndim(number) > 0 or np.asarray(number).dtype.kind not in "fiu":
            raise InvalidInput(f"{word} = {number!r} of \"{variable.name}\" is a {type(number).__name__}; give a number")


def add_optimizer(name: str, search: Callable[[_core.Evaluator], str | None], summary: str = "in Python") -> None:
    """Makes an optimizer of your own one that experiments choose by its name, until Python ends.

    search: as Problem.minimize() takes it. Every kind of experiment may then say `optimizer: NAME`.
    """
    _require_own("optimizer", name, summary, "search", search)
    _core.add_optimizer(name, search, summary)


def add_objective(name: str, bind: Callable[[Any], Any], summary: str = "in Python", *,
                  provides: Sequence[str] = ()) -> None:
    """Makes an objective of your own one that experiments choose by its name, until Python ends.

    bind(record) returns the objective as a function of x. record has the spectra of the reactions, left and
    right, their rate and number of samples, the names of x, x0, and model(x): frequencies [Hz],
    damping_ratios and contact [m] there.
    provides: some of "gradient", "residuals" and "jacobian". What bind returns then has these functions of x as
    attributes, and value(x); of residuals alone the value is half their sum of squares.
    """
    _require_own("objective", name, summary, "bind", bind)
    if isinstance(provides, str):
        raise InvalidInput(f"provides is the text \"{provides}\"; give a list of words, [\"{provides}\"]")
    if not all(isinstance(word, str) for word in provides):
        raise InvalidInput(f"provides = {provides!r} is no list of words; give some of \"gradient\", \"residuals\", \"jacobian\"")
    _core.add_objective(name, bind, summary, list(provides))


def minimize(objective: Callable[[Array], float] | None, variables: Sequence[Variable], *,
             optimizer: str | Mapping[str, Any] = "nlopt", budget: Mapping[str, Any] | None = None,
             gradient: Callable[[Array], ArrayLike] | None = None,
             residuals: Callable[[Array], ArrayLike] | None = None,
             jacobian: Callable[[Array], ArrayLike] | None = None, progress: Progress = None) -> Search:
    """Minimizes a function of your own by one of modcal's optimizers.

    objective: of x; None where it is half the sum of squares of the residuals. gradient: a number for each variable.
    residuals: a row of numbers, as many at every x. jacobian: a row for each of them, with a number for each variable.
    They are called from another thread; Ctrl-C waits until they return.
    """
    if not variables or not all(isinstance(one, Variable) for one in variables):
        raise InvalidInput("the variables are no list of modcal.Variable(name, unit, initial, lower, upper); give one or more")
    if objective is None and residuals is None:
        raise InvalidInput("nothing to minimize; give an objective or residuals")
    callables = {"value": objective, "gradient": gradient, "residuals": residuals, "jacobian": jacobian}
    for one in variables:
        _require_typed(one)
    for name, called in callables.items():
        if called is not None and not callable(called):
            raise InvalidInput(f"{'objective' if name == 'value' else name} is a {type(called).__name__}; give a function of x")
    stated = [one._asdict() for one in variables]
    return _search(_core.minimize(callables, stated, _options(optimizer, budget), _told(progress)))
