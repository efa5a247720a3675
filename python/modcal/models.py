"""Modal models: a string by its keys, any structure by its table."""
from __future__ import annotations

import os
import shutil
import tempfile
import weakref
from pathlib import Path
from typing import Any, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from modcal import _core, yaml
from modcal.errors import InvalidInput
from modcal.records import as_samples, require_responses
from modcal.results import Result

Array = NDArray[np.float64]


def stated(string: Model | Mapping[str, Any], position: float | str | None) -> dict[str, Any]:
    """The keys of a string and its contact: of a model, or as given."""
    if isinstance(string, Model):
        if position is not None:
            raise InvalidInput("the model has its contact already; leave position out")
        return string.section("string", "bow")
    if position is None:
        raise InvalidInput("where the force acts is not said; give position, in m, or a Model.string()")
    return {"string": string, "bow": {"position": position}}


def _require_level(name: str, response: NDArray[np.complex128]) -> None:
    """What is not finite is refused with its frequency when it is fitted."""
    finite = response[np.isfinite(response)]
    with np.errstate(over="ignore"):
        largest = float(np.max(np.abs(finite), initial=0.0))
        squares = np.float64(largest) ** 2 * max(1, finite.size)
    if finite.size == response.size > 0 and largest == 0.0:
        raise InvalidInput(f"the response of {name} is zero at every frequency of the band; check its channel, or leave it out")
    if not np.isfinite(squares):
        raise InvalidInput(f"the response of {name} reaches {largest:g}, whose square is outside the range of double "
                           "precision; repair it, or give it in another unit")


class Model:
    """What a force at the contact does to the sensors:

    H_k(s) = s^p [Σ_n A_kn/D_n(s) + static terms], D_n = s² + 2 ζ_n ω_n s + ω_n², p = 1 for a velocity, 2 for
    an acceleration. Made by Model.string(), Model.table() or Model.response(); invert, calibrate, identify and Inverter take it.
    """

    def __init__(self, core: _core.ModalModel, keys: Mapping[str, Any]) -> None:
        self._core = core
        self._keys = dict(keys)

    @classmethod
    def string(cls, position: float | str, *, recorded: bool = True, **keys: Any) -> Model:
        """A string bowed at x_c [m]. Its sensors: the reactions R1, R2 [N] and the displacement y [m] at x_c.

        keys: length, linear_density, fundamental, ..., as the section `string` of an experiment. Without modes the
        model itself, and an Inverter by it, has 50; invert and calibrate then take as many as their record tells.
        recorded: a real string has modes above those stated.
        """
        section = {"string": keys, "bow": {"position": position}}
        return cls(_core.ModalModel.of_string(yaml.flow(section), recorded), section)

    @classmethod
    def table(cls, source: str | os.PathLike[str] | Result) -> Model:
        """Modes as fit_modes leaves them: their file, or what fit_modes() returned."""
        if not isinstance(source, Result):
            path = os.path.abspath(source)
            return cls(_core.ModalModel.of_table(path), {"table": path})
        if "table.yaml" not in source.texts:
            raise InvalidInput("this result has no table of modes; give that of fit_modes()")
        if source.status != "ok":
            raise InvalidInput("; ".join(source.warnings) or "this fit was not accepted; fit again")
        return cls._of_text(source.texts["table.yaml"])

    @classmethod
    def _of_text(cls, table: str) -> Model:
        folder = tempfile.mkdtemp(prefix="modcal-")
        path = os.path.join(folder, "table.yaml")
        Path(path).write_text(table, encoding="utf-8")
        model = cls(_core.ModalModel.of_table(path), {"table": path})
        weakref.finalize(model, shutil.rmtree, folder, True)
        return model

    @classmethod
    def response(cls, frequencies: ArrayLike, responses: Mapping[str, ArrayLike], *, low: float, high: float,
                 kinds: str | Mapping[str, str] = "acceleration", most_modes: int = 60) -> Model:
        """Modes fitted to measured frequency response functions between low and high [Hz].

        frequencies: even, a multiple of their step each [Hz]. responses: H_k there by the names of the sensors
        [sensor's unit/N]. kinds: as Record takes them. The number of modes is chosen by BIC; modes that leave
        more than half of a response are refused. Such a model knows no pulse of a hammer: what identify() finds
        with it is told within the band, and its error bar is wide beyond.
        """
        f = as_samples("frequencies", frequencies, "numbers")
        step = (f[-1] - f[0]) / max(1, f.size - 1)
        if f.size < 3 or not step > 0.0 or not np.all(np.abs(f - step * np.rint(f / step)) < 1e-3 * step):
            raise InvalidInput("the frequencies are no multiples of an even step; interpolate the responses")
        if not isinstance(most_modes, (int, np.integer)) or most_modes < 1:
            raise InvalidInput(f"most_modes = {most_modes!r} is no number of modes; give a whole number, 1 or more")
        require_responses(kinds, responses)
        below = int(np.rint(f[0] / step))
        rows = []
        if not responses:
            raise InvalidInput("there is no response to fit; give one or more by the names of the sensors")
        for name, given in responses.items():
            spectrum = np.asarray(given)
            if spectrum.shape != f.shape or spectrum.dtype.kind not in "fiuc":
                raise InvalidInput(f"the response of {name} is no row of {f.size} numbers, one for each frequency")
            rows.append(np.concatenate([np.zeros(below, complex), spectrum]))
        if not (f[0] <= low < high <= f[-1]):
            raise InvalidInput(f"the band of {low:g} to {high:g} Hz is not within the frequencies, {f[0]:g} to "
                               f"{f[-1]:g} Hz")
        band = (f >= low) & (f <= high)
        for name, spectrum in zip(responses, rows):
            _require_level(name, spectrum[below:][band])
        told = [kinds if isinstance(kinds, str) else kinds.get(name, "acceleration") for name in responses]
        return cls._of_text(_core.fit_response(step, np.array(rows), list(responses), told, low, high,
                                                int(most_modes)))

    @property
    def frequencies(self) -> Array:
        """f_n [Hz]."""
        return self._core.frequencies

    @property
    def damping_ratios(self) -> Array:
        """ζ_n [1]."""
        return self._core.damping_ratios

    @property
    def sensors(self) -> dict[str, str]:
        """What every sensor reads, by its name."""
        return dict(zip(self._core.sensors, self._core.kinds))

    @property
    def constants(self) -> NDArray[np.complex128]:
        """A_kn, a row for each sensor [sensor's unit/(N s²)]."""
        return self._core.constants

    def transfer(self, frequencies: ArrayLike) -> NDArray[np.complex128]:
        """H_k at frequencies [Hz], a row for each sensor [sensor's unit/N]."""
        return self._core.transfer(as_samples("frequencies", frequencies, "numbers"))

    def section(self, *names: str) -> dict[str, Any]:
        """The keys of an experiment that state it. A table's are those of a structure, not of a string."""
        missing = [name for name in names if name not in self._keys]
        if missing:
            kind = ("a table of modes" if "table" in self._keys else "a string" if self._keys else
                    "a point of a calibration")
            raise InvalidInput(f"the model is {kind}: it has no {missing[0]}; make it by "
                               f"Model.{'table' if missing[0] == 'table' else 'string'}()")
        return {name: self._keys[name] for name in names}

    def __repr__(self) -> str:
        low, high = self.frequencies[0], self.frequencies[-1]
        return f"<modcal.Model of {len(self.frequencies)} modes, {low:.4g} to {high:.4g} Hz: {', '.join(self.sensors)}>"
