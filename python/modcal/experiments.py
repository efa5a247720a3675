"""Experiments: files, texts and dictionaries that run and come back as data."""
from __future__ import annotations

import json
import os
import sys
import warnings
from pathlib import Path
from typing import Any, Callable, Mapping, Union

import numpy as np

from modcal import _core, results, yaml
from modcal.errors import InvalidInput, Mistake
from modcal.models import Model, stated
from modcal.records import Record
from modcal.results import Result, Table

#: A file, the text of one, or its content as a dictionary.
Source = Union[str, "os.PathLike[str]", Mapping[str, Any]]
#: Called with the share done; True shows a line, in a notebook a bar; None nothing.
Progress = Union[Callable[[float], None], bool, None]

_REFUSED = (1, 2, 3, 7)  # exit codes of what has no result


def _is_text(source: Source) -> bool:
    return isinstance(source, str) and ("\n" in source or source.lstrip().startswith("{"))


def _told(progress: Progress) -> Callable[[float], None] | None:
    if progress is None or progress is False:
        return None
    if progress is not True:
        return progress

    if "ipykernel" in sys.modules:
        return _bar()

    def show(share: float) -> None:
        print(f"\r{100 * share:3.0f} %", end="", file=sys.stderr, flush=True)

    return show


def _bar() -> Callable[[float], None]:
    """A bar in a notebook."""
    from IPython.display import ProgressBar  # type: ignore[import]

    bar = ProgressBar(1000)
    bar.display()

    def show(share: float) -> None:
        bar.progress = round(1000 * share)

    return show


def open_experiment(source: Source, overrides: Mapping[str, Any] | None = None,
                    with_records: bool = False) -> _core.Experiment:
    """The experiment without mistakes; InvalidInput holds all that there are. with_records: in recorded files, too."""
    if not source:
        raise InvalidInput("the experiment is empty; give a file, the text of one, or its content as a dictionary")
    if isinstance(source, Mapping):
        source = yaml.block(source)
    opened = _core.open(os.fspath(source), _is_text(source), yaml.assignments(overrides), with_records)
    for text in opened.warnings:
        warnings.warn(text, stacklevel=3)
    return opened


def _words(source: Source, overrides: Mapping[str, Any] | None) -> list[str]:
    return [os.fspath(source), *(word for one in yaml.assignments(overrides) for word in ("--set", one))]  # type: ignore[arg-type]


def ask(*words: str, progress: Progress = None) -> Any:
    """The answer of a command of the program as data, as `modcal WORDS --json` prints it.

    ask("status", "out/mine"), ask("inspect", "record.csv"), ask("plan", "mine.yaml").
    """
    code, said = _core.ask([os.fspath(word) for word in words], _told(progress))
    answer = json.loads(said) if said else {}
    if code in _REFUSED:
        _refuse(answer)
    return answer


def _refuse(answer: Mapping[str, Any]) -> None:
    error = answer.get("error", {})
    place = error.get("place") or {}
    if error.get("kind") == "output_lost":
        raise OSError(error["message"])
    mistakes = [Mistake(one["text"], one["place"], one["line"], one["column"], one["severity"] == "warning")
                for one in answer.get("mistakes", [])]
    if error.get("kind") == "internal":
        raise RuntimeError(error["message"])
    text = error.get("message", "refused")
    path = place.get("file") or place.get("option")
    prefix = ":".join(str(place[key]) for key in ("file", "option", "line", "column") if key in place)
    if prefix and text.startswith(prefix + ": "):
        text = text[len(prefix) + 2:]
    raise InvalidInput(mistakes or [Mistake(text, path, place.get("line"), place.get("column"))])


def run(source: Source, overrides: Mapping[str, Any] | None = None, *,
        out: str | os.PathLike[str] | None = None, threads: int = 0, progress: Progress = None) -> Result:
    """Runs an experiment and returns what it found.

    source: a file, the text of one, or its content as a dictionary.
    overrides: {"scene.bow.position": "30 mm"}, as --set of the program.
    out: the folder that `modcal run` would write, with report and figures. A list of tasks goes on
    where it ended there. Without it nothing is written.
    threads: 0, all.
    """
    if not isinstance(threads, (int, np.integer)) or threads < 0:
        raise InvalidInput(f"threads = {threads!r} is no number of threads; give a whole number, 0 for all")
    threads = int(threads)
    if out is not None:
        return _run_into(Path(out), source, overrides, threads, progress)
    opened = open_experiment(source, overrides)
    return results.of_outcome(opened.kind, opened.title, opened.run(_told(progress), threads))


def _run_into(out: Path, source: Source, overrides: Mapping[str, Any] | None, threads: int,
              progress: Progress) -> Result:
    if isinstance(source, Mapping) or _is_text(source):
        raise InvalidInput("a text has no file that its results could name; write it to one, and run that with out=")
    words = ["run", *_words(source, overrides), "--out", os.fspath(out)]
    if threads > 0:
        words += ["--threads", str(threads)]
    answer = ask(*words, progress=progress)
    result = load(answer.get("out", out))
    result.warnings = answer.get("warnings", [])
    return result


def load(folder: str | os.PathLike[str]) -> Result:
    """What a run has left in its folder: its numbers, its signals, and what it said.

    Of a run that still works there, what is finished: the tasks of a list, and their numbers. status is "running"
    then; "unfinished" where nobody works on what is left.
    """
    place = Path(folder)
    result = results.of_folder(place)
    if (place / "journal").is_dir():
        counts = ask("status", os.fspath(place))
        result.tables["tasks"] = _tasks(place)
        if counts["pending"] or counts["running"]:
            result.answer = ""
            result.summary = f"{counts['done']} of {counts['tasks']} tasks done, {counts['failed']} failed"
            result.status = "running" if counts["running"] else "unfinished"
    return result


def _tasks(folder: Path) -> Table:
    """The finished tasks with their axes and the numbers they left."""
    rows = []
    for row in json.loads(_core.finished_tasks(os.fspath(folder))):
        outcome = row.pop("outcome")
        rows.append({**row, **dict(outcome.pop("numbers", [])), **outcome})
    keys = list(dict.fromkeys(key for row in rows for key in row))
    return Table("tasks", {key: [row.get(key) for row in rows] for key in keys})


def validate(source: Source, overrides: Mapping[str, Any] | None = None) -> list[Mistake]:
    """Every mistake and warning of an experiment; nothing is computed."""
    try:
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            open_experiment(source, overrides, with_records=True)
    except InvalidInput as refused:
        return refused.mistakes
    return [Mistake(str(one.message), warning=True) for one in told]


def schema() -> dict[str, Any]:
    """JSON schema of experiment files."""
    return dict(ask("schema"))


def plugins(kind: str | None = None) -> dict[str, str]:
    """Name and summary of every plug-in of a kind, or of every kind."""
    return {row["name"]: row["summary"] for row in ask("list", *([kind] if kind else []))}


def describe(kind: str, name: str) -> dict[str, Any]:
    """Summary and options of a plug-in: describe("experiment", "calibrate")."""
    return dict(ask("describe", kind, name))


def limit(source: str | os.PathLike[str], overrides: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """How well a calibration can do, before any experiment: `modcal limit`."""
    return dict(ask("limit", *_words(source, overrides)))


def new(kind: str, record: str | os.PathLike[str] | Record | None = None, *, length: str | float | None = None,
        linear_density: str | float | None = None) -> str:
    """The text of an experiment to start from; string and contact are read off the record."""
    words = ["new", kind]
    if record is not None:
        words.append(record.name if isinstance(record, Record) else os.path.abspath(record))
    for option, value in (("--length", length), ("--linear-density", linear_density)):
        if value is not None:
            words += [option, str(value)]
    return str(ask(*words)["text"])


def simulate(**keys: Any) -> Result:
    """Runs kind: simulate with these keys: simulate(scene={...}, measurement={...})."""
    return run({"kind": "simulate", "files": ["csv"], **keys})  # without, no signals are kept


def _section(record: Record) -> dict[str, Any]:
    if not isinstance(record, Record):
        raise InvalidInput(f"the record is a {type(record).__name__}; make it by modcal.Record(rate=, left=, right=)")
    return record.section()


def _on(record: Record, kind: str, string: Model | Mapping[str, Any], position: float | str | None,
        keys: Mapping[str, Any]) -> Result:
    return run({"kind": kind, "record": _section(record), **stated(string, position), **keys})


def invert(record: Record, string: Model | Mapping[str, Any], position: float | str | None = None,
           **keys: Any) -> Result:
    """Force and motion at the contact from the reactions.

    string: Model.string(), or {"length": 0.33, "linear_density": 1e-3, "fundamental": 294, ...} with
    position: x_c [m]. keys: the others of kind: invert, as inversion={"estimator": "one_sided"}.
    The number of modes is read off the record where string does not state it.
    """
    return _on(record, "invert", string, position, keys)


def calibrate(record: Record, string: Model | Mapping[str, Any], position: float | str | None = None,
              **keys: Any) -> Result:
    """The modal model with error bars from the reactions, and the force with it.

    string and position are a start. keys: the others of kind: calibrate.
    """
    return _on(record, "calibrate", string, position, keys)


def fit_modes(record: Record, low: float | str, high: float | str, **keys: Any) -> Result:
    """The modes of any structure from a strike whose force was measured; Model.table() takes the result.

    low, high: the band [Hz]. keys: the others of kind: fit_modes.
    """
    return run({"kind": "fit_modes", "record": _section(record), "low": low, "high": high, **keys})


def identify(record: Record, model: Model, **keys: Any) -> Result:
    """The force at the contact of any structure from its responses, with its band.

    model: Model.table(). keys: the others of kind: identify_force, as window="80 ms".
    """
    return run({"kind": "identify_force", **model.section("table"), "record": _section(record), **keys})
