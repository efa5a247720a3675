"""What modcal raises."""
from __future__ import annotations

import re
from typing import NamedTuple, Sequence


class Mistake(NamedTuple):
    """One mistake: its text, and its place as far as it is known."""

    text: str
    path: str | None = None  #: file, or "--set 1" for the first override
    line: int | None = None  #: from 1
    column: int | None = None  #: from 1
    warning: bool = False
    source: str = ""  #: the line that stands there, and a caret

    def __str__(self) -> str:
        place = [str(part) for part in (self.path, self.line, self.column) if part is not None]
        return f"{':'.join(place)}: {self.text}" if place else self.text

    @property
    def remedy(self) -> str:
        """What the sentence says to do; empty where it says nothing apart."""
        asked = re.search(r"did you mean .*", self.text)
        if asked:
            return asked.group()
        head, _, tail = self.text.rpartition("; ")
        if not head:
            head, _, tail = self.text.rpartition(": ")
        return tail if head else ""


class InvalidInput(ValueError):
    """What was asked for cannot be done. The message says what was given, why and what to do.

    Of several mistakes `path`, `line`, `column` and `remedy` are those of the first error.
    """

    def __init__(self, mistakes: Sequence[Mistake] | str) -> None:
        if isinstance(mistakes, str):
            mistakes = [Mistake(mistakes)]
        self.mistakes: list[Mistake] = list(mistakes)
        errors = [one for one in self.mistakes if not one.warning]
        first = (errors or self.mistakes)[0]
        self.path = first.path
        self.line = first.line
        self.column = first.column
        self.remedy = first.remedy
        shown = [f"{one}\n{one.source}".rstrip() for one in errors or self.mistakes]
        super().__init__("\n".join(shown))

    def __reduce__(self) -> tuple[type[InvalidInput], tuple[list[Mistake]]]:
        return type(self), (self.mistakes,)


class SearchOver(Exception):
    """The budget of a search is spent, or its target is reached: let it pass."""
