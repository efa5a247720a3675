"""Figures with matplotlib, in the style of the report's."""
from __future__ import annotations

import re
from typing import Any

import numpy as np

from modcal.errors import InvalidInput

_BAND = 1.96  # deviations of a 95 % band
_SHOWN = "identified_force"  # some periods of it, beside the measured one
_INK = "#0072b2"  # the first of the report's
_GRID = "#dcdcdc"
_SYMBOL = re.compile(r"(?<![A-Za-z])([A-Za-zζωφε])_([A-Za-z0-9]+)")


def _pyplot() -> Any:
    from matplotlib.figure import Figure  # type: ignore[import]

    return Figure


def _text(words: str) -> str:
    """With indices as indices."""
    return _SYMBOL.sub(r"$\1_{\2}$", words)


def _bare(axes: Any) -> None:
    """Two axes on a light grid."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(True, color=_GRID, linewidth=0.6)
    axes.set_axisbelow(True)


def _legend(axes: Any) -> None:
    """Above the axes, where it stands over no curve."""
    labels = axes.get_legend_handles_labels()[1]
    if labels:
        axes.legend(frameon=False, fontsize="small", loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=len(labels),
                    borderaxespad=0.1)


def plot(result: Any, name: str | None) -> Any:
    if name is None:
        return _drawn(result.figures[_SHOWN]) if _SHOWN in result.figures else _force(result)
    if name not in result.figures:
        raise InvalidInput(f"there is no figure {name}; there are {', '.join(result.figures) or 'none'}")
    return _drawn(result.figures[name])


def _drawn(described: dict[str, Any]) -> Any:
    panels = described["panels"]
    columns = described["columns"]
    rows = -(-len(panels) // columns)
    figure = _pyplot()(figsize=(6.4 * columns, 3.2 * rows), layout="constrained")
    figure.suptitle(_text(described["title"]), x=0.01, ha="left", fontsize="medium", fontweight="bold")
    for place, panel in enumerate(panels):
        axes = figure.add_subplot(rows, columns, place + 1)
        _bare(axes)
        axes.set_title(_text(panel["title"]), loc="left", fontsize="small")
        for axis, told in (("x", panel["x"]), ("y", panel["y"])):
            axes.set(**{f"{axis}label": _text(told["text"])})
            if told["logarithmic"]:
                axes.set(**{f"{axis}scale": "log"})
            if told["range"] is not None:
                axes.set(**{f"{axis}lim": tuple(told["range"])})
        for series in panel["series"]:
            _series(axes, series)
        for marker in panel["markers"]:
            line = axes.axvline if marker["vertical"] else axes.axhline
            line(marker["value"], color=marker["color"], linestyle=":", linewidth=1)
        _legend(axes)
    return figure


def _series(axes: Any, series: dict[str, Any]) -> None:
    color = series["color"]
    style = "--" if series["dashed"] else "-" if series["line"] else ""
    points = "o" if series["points"] else ""
    banded = len(series["y_low"]) > 0
    if banded and series["line"]:
        axes.fill_between(series["x"], series["y_low"], series["y_high"], color=color, alpha=0.25, linewidth=0)
    elif banded:
        axes.vlines(series["x"], series["y_low"], series["y_high"], color=color, linewidth=0.8)
    axes.plot(series["x"], series["y"], linestyle=style, marker=points, markersize=3, linewidth=1, color=color,
              label=_text(series["label"]) or None)


def _force(result: Any) -> Any:
    names = [name for name in result.signals if name.startswith("f_c") and not name.endswith(("_deviation", "_unaliased"))]
    if not names:
        names = [name for name in result.signals if not name.endswith("_deviation")]
    if not names:
        raise InvalidInput(f"a result of kind {result.kind} holds no signals; name a figure: "
                           f"{', '.join(result.figures) or 'there is none'}")
    figure = _pyplot()(figsize=(8, 3), layout="constrained")
    axes = figure.add_subplot()
    _bare(axes)
    time = result.time
    for name in names:
        signal = result.signals[name]
        color = _INK if len(names) == 1 else None
        line, = axes.plot(time, signal, linewidth=1, color=color, label=_text(name))
        deviation = result.signals.get(f"{name}_deviation")
        if deviation is not None:
            band = _BAND * np.asarray(deviation)
            axes.fill_between(time, signal - band, signal + band, color=line.get_color(), alpha=0.25, linewidth=0)
    axes.set_title(result.title, loc="left", fontsize="small", fontweight="bold")
    axes.set(xlabel="$t$ [s]", ylabel=f"force [{result.units.get(names[0], '')}]"
             if names[0].startswith("f_c") else "")
    _legend(axes)
    return figure
