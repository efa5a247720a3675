"""Inversions of many records by one prepared model."""
from __future__ import annotations

from typing import Any, Mapping, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from modcal import _core, yaml
from modcal.errors import InvalidInput
from modcal.models import Model, stated
from modcal.records import as_samples

Array = NDArray[np.float64]


class Estimate(NamedTuple):
    """Force [N] and motion at the contact with their standard deviations, numbers or one a sample."""

    side: str  #: "joint", or "1" and "2" for each reaction
    force: Array
    displacement: Array  #: empty where no motion is wanted
    velocity: Array
    force_deviation: float | Array
    velocity_deviation: float | Array
    displacement_deviation: float
    parameter: float  #: of the regularization
    band_limit: float  #: nothing is identified above it [Hz]; NaN: no limit
    warnings: list[str]


class Inverter:
    """The model of a string, prepared for records of one length: called with the reactions of each.

    The library's own inversion: what `invert` judges of a record and draws besides is left out, and the mean is not
    removed. string, position, inversion: as `invert` takes them, but for the number of modes: prepared before there is
    a record, it has 50 where string does not state it, while `invert` takes as many as the record tells. State it for
    the same forces. rate, samples: two periods of the string or more. recorded: a real string has modes above those
    stated.
    """

    def __init__(self, string: Model | Mapping[str, Any], position: float | str | None = None, *, samples: int, rate: float,
                 inversion: Mapping[str, Any] | None = None, recorded: bool = True) -> None:
        if not isinstance(samples, (int, np.integer)) or samples < 1:
            raise InvalidInput(f"samples = {samples!r} is no length of a record; give a whole number of samples, 1 or more")
        if not isinstance(rate, (int, float, np.number)) or not 0.0 < rate < float("inf"):
            raise InvalidInput(f"rate = {rate!r} cannot be a sample rate; give a number of Hz > 0")
        options = {**stated(string, position), "inversion": inversion or {}}
        self.samples = int(samples)
        self.rate = float(rate)
        self._core = _core.Inverter(yaml.flow(options), self.samples, self.rate, recorded)

    def __repr__(self) -> str:
        return f"<modcal.Inverter of records of {self.samples} samples at {self.rate:g} Hz>"

    def __call__(self, left: ArrayLike | None = None, right: ArrayLike | None = None, *,
                 motion: bool = False) -> list[Estimate]:
        """The estimates of one record; motion: displacement and velocity, too."""
        if left is None and right is None:
            raise InvalidInput("a record needs a reaction; give left= or right=")
        found = self._core.estimate(None if left is None else as_samples("left", left),
                                    None if right is None else as_samples("right", right), motion)
        return [Estimate(**told) for told in found]
