"""Results as data."""
from __future__ import annotations

import csv
import html
import io
import json
from pathlib import Path
from typing import Any, Iterator

import numpy as np
from numpy.typing import NDArray

from modcal.errors import InvalidInput


class Table:
    """Columns of equal length by their keys; None stands where there is no value."""

    def __init__(self, name: str, columns: dict[str, list[Any]], units: dict[str, str] | None = None,
                 title: str = "", caption: str = "") -> None:
        self.name = name
        self.columns = columns
        self.units = units or {}
        self.title = title or name
        self.caption = caption

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()), []))

    def __iter__(self) -> Iterator[dict[str, Any]]:
        for cells in zip(*self.columns.values()):
            yield dict(zip(self.columns, cells))

    def __getitem__(self, key: str) -> list[Any]:
        return self.columns[key]

    def to_dict(self) -> list[dict[str, Any]]:
        return list(self)

    def to_frame(self) -> Any:
        """A pandas.DataFrame."""
        import pandas  # type: ignore[import]

        return pandas.DataFrame(self.columns)

    def __repr__(self) -> str:
        return f"<modcal.Table {self.name}: {len(self)} rows of {', '.join(self.columns)}>"

    def _repr_html_(self) -> str:
        def heading(key: str) -> str:
            unit = self.units.get(key, "")
            return html.escape(f"{key} [{unit}]" if unit not in ("", "1") else key)

        def cell(value: Any) -> str:
            text = "–" if value is None else f"{value:.6g}" if isinstance(value, float) else str(value)
            return f"<td>{html.escape(text)}</td>"

        head = "".join(f"<th>{heading(key)}</th>" for key in self.columns)
        shown = 60
        rows = "".join("<tr>" + "".join(map(cell, row.values())) + "</tr>" for _, row in zip(range(shown), self))
        more = f"<p>… and {len(self) - shown} more rows</p>" if len(self) > shown else ""
        return (f"<p><b>{html.escape(self.title)}</b></p>"
                f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>{more}")


class Result:
    """What an experiment found.

    documents: what the program writes as JSON, by name ("calibration").
    tables: by name. texts: other files by name ("table.yaml"). signals: arrays by name; `time` belongs to them [s].
    figures: as the report draws them, for plot().
    answer: in a sentence. summary: what the program prints. warnings: sentences.
    status: "ok", "some_failed" or "failed".

    The members of the documents, the tables and the signals are attributes, too:
    result.parameters, result.f_c_joint.
    """

    def __init__(self, kind: str, title: str) -> None:
        self.kind = kind
        self.title = title
        self.status = "ok"  #: "some_failed" of a list, "failed"; of a folder "running" or "unfinished", too
        self.seconds = float("nan")  #: that a run in memory took
        self.answer = ""
        self.summary = ""
        self.warnings: list[str] = []
        self.missed: list[str] = []
        self.documents: dict[str, Any] = {}
        self.tables: dict[str, Table] = {}
        self.texts: dict[str, str] = {}
        self.signals: dict[str, NDArray[np.float64]] = {}
        self.units: dict[str, str] = {}
        self.rate = float("nan")  #: of the signals [Hz]
        self.figures: dict[str, Any] = {}
        self.folder: Path | None = None  #: where the results stand
        self.provenance: dict[str, Any] = {}

    @property
    def time(self) -> NDArray[np.float64]:
        """Instants of the signals [s]."""
        size = next((held.size for held in self.signals.values()), 0)
        return np.arange(size) / self.rate if size else np.zeros(0)

    def _members(self) -> dict[str, Any]:
        members: dict[str, Any] = dict(self.signals)
        members.update(self.tables)
        for document in self.documents.values():
            if isinstance(document, dict):
                members.update(document)
        return members

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        members = self._members()
        if name in members:
            return members[name]
        raise AttributeError(f"a result of kind {self.kind} has no {name}; it has "
                             f"{', '.join(sorted(members))}")

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self._members()})

    def to_dict(self) -> dict[str, Any]:
        """Documents, tables and signals as plain data."""
        return {"kind": self.kind, "title": self.title, "status": self.status, "summary": self.summary,
                "warnings": self.warnings, **self.documents,
                "tables": {name: table.to_dict() for name, table in self.tables.items()},
                "signals": {name: held.tolist() for name, held in self.signals.items()}}

    def to_frame(self, table: str | None = None) -> Any:
        """A table as a pandas.DataFrame; without a name the signals over time."""
        if table is not None:
            if table not in self.tables:
                raise InvalidInput(f"there is no table {table}; there are {', '.join(self.tables)}")
            return self.tables[table].to_frame()
        import pandas

        return pandas.DataFrame(self.signals, index=pandas.Index(self.time, name="t"))

    def plot(self, figure: str | None = None) -> Any:
        """A matplotlib.figure.Figure: the one of that name, or the force with its 95 % band."""
        from modcal import plotting

        return plotting.plot(self, figure)

    def __repr__(self) -> str:
        return f"<modcal.Result of kind {self.kind}, {self.status}: {self.title}>\n{self.summary}".rstrip()

    def _repr_html_(self) -> str:
        """The first screen of the report: the answer, a figure, a table."""
        head = f"<h3>{html.escape(self.title or self.kind)}</h3>"
        if self.answer:
            head += f"<p><b>{html.escape(self.answer)}</b></p>"
        told = "".join(f"<p>⚠ {html.escape(text)}</p>" for text in self.warnings)
        first = next(iter(self.tables.values()), None)
        return (f"{head}<p>{html.escape(self.kind)}, {html.escape(self.status)}</p>{told}"
                f"{self._drawing()}{first._repr_html_() if first else ''}"
                f"<details><summary>what the program says</summary><pre>{html.escape(self.summary)}</pre></details>")

    def _drawing(self) -> str:
        """The default plot as SVG; nothing without matplotlib or signals."""
        try:
            drawn = self.plot()
        except (ImportError, InvalidInput):
            return ""
        file = io.StringIO()
        drawn.savefig(file, format="svg")
        return file.getvalue()[file.getvalue().index("<svg"):]


def of_outcome(kind: str, title: str, outcome: Any) -> Result:
    """Of a run in memory: arrays are views of what it holds."""
    result = Result(kind, title)
    result.status = outcome.status
    result.seconds = outcome.seconds
    result.answer = outcome.answer
    result.summary = outcome.summary
    result.warnings = [text for text, _ in outcome.warnings()]
    result.missed = outcome.missed
    for name, content in outcome.files.items():
        stem, _, kind_of_file = name.rpartition(".")
        if kind_of_file == "json":
            result.documents[stem] = json.loads(content)
        elif kind_of_file == "csv":
            result.tables[stem] = _Csv(content).table(stem)
        else:
            result.texts[name] = content
    for name, told in outcome.tables().items():
        result.tables[name] = Table(name, told["columns"], told["units"], told["title"], told["caption"])
    for _, quantity, unit, rate, samples in outcome.signals():
        result.signals[quantity] = samples
        result.units[quantity] = unit
        result.rate = rate
    result.figures = outcome.figures()
    return result


def _number(text: str) -> Any:
    for read in (int, float):
        try:
            return read(text)
        except ValueError:
            pass
    return None


def _typed(texts: list[str]) -> list[Any]:
    """Numbers where all are; an empty text is None."""
    told = [text for text in texts if text]
    if told and all(_number(text) is not None for text in told):
        return [_number(text) for text in texts]
    return [text or None for text in texts]


class _Csv:
    """A CSV file that the program wrote."""

    def __init__(self, content: str) -> None:
        rows = list(csv.reader(content.splitlines()))
        self.rate = float("nan")  #: of signals [Hz]
        self.texts: dict[str, list[str]] = {}
        self.units: dict[str, str] = {}
        for heading in rows[0]:
            key, _, unit = heading.rstrip("]").partition(" [")
            self.texts[key] = []
            self.units[key] = unit
        for row in rows[1:]:
            if row and row[0].startswith("# sample_rate:"):
                self.rate = float(row[0].split()[2])
            if row and not row[0].startswith("#"):
                for held, text in zip(self.texts.values(), row):
                    held.append(text)

    def table(self, name: str, typed: list[dict[str, Any]] | None = None) -> Table:
        """typed: the same rows as JSON, which has no word for numbers that are not finite."""
        if typed is None:
            return Table(name, {key: _typed(texts) for key, texts in self.texts.items()}, self.units)
        columns = {
            key: [float(text) if row[key] is None and text in ("nan", "inf", "-inf") else row[key]
                  for row, text in zip(typed, texts)]
            for key, texts in self.texts.items()
        }
        return Table(name, columns, self.units)


def _read_csv(result: Result, file: Path) -> None:
    content = _Csv(file.read_text(encoding="utf-8"))
    if content.rate == content.rate:
        result.rate = content.rate
        for key, texts in content.texts.items():
            if key != "t":
                result.signals[key] = np.array(texts, dtype=np.float64)
                result.units[key] = content.units[key]
        return
    rows = file.with_suffix(".json")
    typed = json.loads(rows.read_text(encoding="utf-8")) if rows.exists() else None
    result.tables[file.stem] = content.table(file.stem, typed)


def _read_file(result: Result, file: Path) -> None:
    if file.suffix == ".csv":
        _read_csv(result, file)
    elif file.suffix == ".json" and not file.with_suffix(".csv").exists():
        result.documents[file.stem] = json.loads(file.read_text(encoding="utf-8"))
    elif file.suffix == ".yaml":
        result.texts[file.name] = file.read_text(encoding="utf-8")


def of_folder(folder: Path) -> Result:
    """Of the files that a run has left."""
    record = folder / "provenance.json"
    if not record.exists():
        raise InvalidInput(f"{folder} holds no run: there is no provenance.json; name the folder that "
                           "modcal run wrote")
    provenance = json.loads(record.read_text(encoding="utf-8"))
    heads: dict[str, str] = {}
    for line in (folder / "resolved.yaml").read_text(encoding="utf-8").splitlines():
        key, colon, value = line.partition(": ")
        if colon and key in ("kind", "title"):
            heads[key] = json.loads(value.partition("  #")[0]) if value.startswith('"') else value.split(" ")[0]
    result = Result(heads["kind"], heads.get("title", ""))
    result.folder = folder
    result.provenance = provenance
    _read_answer(result, folder / "answer.json")
    for name in sorted(provenance.get("files", [])):
        file = folder / name
        if "/" not in name and name not in ("provenance.json", "answer.json") and file.exists():
            _read_file(result, file)
    return result


def _read_answer(result: Result, file: Path) -> None:
    """What the run has said; without it there is none yet."""
    if not file.exists() and (file.parent / "report.html").exists():
        return  # of a version that kept no answer
    if not file.exists():
        result.status = "unfinished"
        result.summary = "the run has not ended: it still works, or was stopped; modcal.run() with out= begins it again"
        return
    told = json.loads(file.read_text(encoding="utf-8"))
    result.status = told["status"]
    result.answer = told["verdict"]
    result.summary = told["summary"]
    result.warnings = told["warnings"]
    result.missed = told["missed"]
