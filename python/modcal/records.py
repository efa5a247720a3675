"""Recorded forces as arrays."""
from __future__ import annotations

import itertools
from typing import Any, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from modcal import _core
from modcal.errors import InvalidInput

_numbers = itertools.count(1)


def as_samples(what: str, given: ArrayLike, of: str = "samples") -> NDArray[np.float64]:
    """A row of double precision; a view where it is one already. of: what it is a row of."""
    if np.any(getattr(given, "mask", False)):
        raise InvalidInput(f"{what} has masked {of}; fill them, or leave them out")
    try:
        array = np.asarray(given)
    except ValueError as error:
        raise InvalidInput(f"{what} is no array: {error}; give one row of {of}") from None
    if array.dtype.kind not in "fiub":
        raise InvalidInput(f"{what} is an array of {array.dtype}, not of real numbers; convert it with "
                           "astype(float)")
    if array.ndim != 1:
        raise InvalidInput(f"{what} has the shape {array.shape}; give one row of {of}")
    if array.size == 0:
        raise InvalidInput(f"{what} is empty; give one row of {of}")
    return np.ascontiguousarray(array, dtype=np.float64)


def _rate(time: ArrayLike) -> float:
    t = as_samples("time", time)
    steps = np.diff(t)
    if t.size < 2 or not np.all(np.isfinite(t)) or not np.all(steps > 0.0):
        raise InvalidInput("time does not rise from sample to sample; give instants in seconds, or rate=")
    rate = (t.size - 1) / (t[-1] - t[0])
    if np.max(np.abs(t - (t[0] + np.arange(t.size) / rate))) > 0.1 / rate:
        raise InvalidInput("the instants of time are not evenly spaced; resample the record")
    return float(rate)


def require_responses(kinds: str | Mapping[str, str], responses: Mapping[str, ArrayLike] | None) -> None:
    """Whether kinds by name are those of responses."""
    unknown = [] if isinstance(kinds, str) else sorted(set(kinds) - set(responses or {}))
    if unknown:
        raise InvalidInput(f"kinds names {', '.join(unknown)}, which is no response; name some of "
                           f"{', '.join(responses)}" if responses else
                           f"kinds names {', '.join(unknown)}, which is no response; leave kinds out")


class Record:
    """What sensors read, rows of one length.

    rate: samples a second [Hz]; or time: the instant of every sample [s].
    Of a string: left, the reaction at x = 0 [N], and right, at x = L. One is enough to invert, a calibration
    takes both. Of any structure: responses by the names of their sensors, in the order of its table; kinds:
    what they read, "acceleration" [m/s²], "velocity" [m/s], "displacement" [m], "force" [N] or "strain", one
    for all or by name.
    force: at the contact where it was measured [N]; identified forces are only compared with it.
    """

    def __init__(self, *, rate: float | None = None, time: ArrayLike | None = None,
                 left: ArrayLike | None = None, right: ArrayLike | None = None,
                 force: ArrayLike | None = None, responses: Mapping[str, ArrayLike] | None = None,
                 kinds: str | Mapping[str, str] = "acceleration") -> None:
        if (rate is None) == (time is None):
            raise InvalidInput("a record needs either rate= or time=; state one of them")
        if isinstance(rate, str):
            raise InvalidInput(f"rate = \"{rate}\" is a text; give samples a second as a number")
        if rate is not None and np.ndim(rate) > 0:
            raise InvalidInput(f"rate = {rate!r} is no number; give samples a second as one number")
        self.rate = float(rate) if rate is not None else _rate(time)  # type: ignore[arg-type]
        if not (self.rate > 0.0 and np.isfinite(self.rate)):
            raise InvalidInput(f"rate = {self.rate} Hz cannot be a sample rate; it is > 0")
        ends = {"R1": left, "R2": right}
        if responses is not None and any(held is not None for held in ends.values()):
            raise InvalidInput("a record is of a string's reactions or of a structure's responses; give one of them")
        if responses is not None and "f_c" in responses:
            raise InvalidInput("a response cannot be named f_c, as the force at the contact is; give it as force=")
        require_responses(kinds, responses)
        given: dict[str, ArrayLike | None] = dict(ends) if responses is None else {}
        given.update(responses or {})
        self._kinds = {name: "force" if responses is None else kinds if isinstance(kinds, str) else
                       kinds.get(name, "acceleration") for name in given}
        words = {"R1": "left", "R2": "right", "f_c": "force"} if responses is None else {}
        self._channels = {name: as_samples(words.get(name, name), held)
                          for name, held in {**given, "f_c": force}.items() if held is not None}
        if not set(given) & set(self._channels):
            raise InvalidInput("a record needs a reaction; give left= or right=, or responses=")
        sizes = {words.get(name, name): held.size for name, held in self._channels.items()}
        if time is not None:
            sizes["time"] = np.asarray(time).size
        if len(set(sizes.values())) > 1:
            told = ", ".join(f"{name} {size}" for name, size in sizes.items())
            raise InvalidInput(f"the channels of a record differ in length ({told}); cut them to one")
        self.name = f"<array {next(_numbers)}>"
        self._given = _core.GivenRecording(
            self.name, self.rate,
            [(name, self._kinds.get(name, "force"), held) for name, held in self._channels.items()])
        self._of_string = responses is None

    def __len__(self) -> int:
        return int(next(iter(self._channels.values())).size)

    def __repr__(self) -> str:
        return f"<modcal.Record of {len(self)} samples at {self.rate:g} Hz: {', '.join(self._channels)}>"

    def section(self) -> dict[str, Any]:
        """The section `record` of an experiment. The record has to live while that runs."""
        channels = {name: {"channel": name} for name in self._channels}
        if self._of_string:
            roles = {"R1": "left", "R2": "right", "f_c": "reference"}
            return {"file": self.name, **{roles[name]: channel for name, channel in channels.items()}}
        force = {"force": channels.pop("f_c")} if "f_c" in channels else {}
        responses = [{**channel, "kind": self._kinds[name]} for name, channel in channels.items()]
        return {"file": self.name, "responses": responses, **force}
