#!/usr/bin/env python3
"""Writes the stub of modcal._core, python/modcal/_core.pyi, from the signatures that pybind11 gives: stubs.py > FILE."""
import inspect
import re
import textwrap

import modcal._core as core

HEAD = '''"""{}"""
# Written by python/core/stubs.py (`make stubs`).
from typing import Any, Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
'''
# Arguments that C++ takes as any object.
ARGUMENTS = {
    "x": "ArrayLike",
    "z": "ArrayLike",
    "progress": "Callable[[float], None] | None",
    "search": "Callable[[Evaluator], str | None]",
    "bind": "Callable[[Any], Any]",
}
SPELLED = [
    (r"modcal\._core\.", ""),
    (r"numpy\.ndarray\[numpy\.(\w+)\]", r"NDArray[np.\1]"),
    (r"numpy\.ndarray\b", "NDArray[np.float64]"),
    (r"\bOptional\[(NDArray\[[\w.]+\])\]", r"\1 | None"),
    (r"\b(List|Tuple|Dict)\[", lambda found: found[1].lower() + "["),
    (r"\blist\b(?!\[)", "list[Any]"),
    (r"\bdict\b(?!\[)", "dict[str, Any]"),
    (r"\btuple\b(?!\[)", "tuple[Any, ...]"),
    (r"\bobject\b", "Any"),
]


def spelled(words):
    for pattern, now in SPELLED:
        words = re.sub(pattern, now, words)
    return words


def argument(words):
    """`name: type` as a caller may give it; of `self` the name."""
    name, _, kind = words.partition(": ")
    if name == "self":
        return name
    kind = ARGUMENTS.get(name, "") if kind == "object" else re.sub(r"NDArray\[[\w.]+\]", "ArrayLike", spelled(kind))
    return f"{name}: {re.sub('^list', 'Sequence', kind)}"


def signature(name, doc):
    """The definition of a function, in lines of at most 120 with four before them."""
    given, result = re.match(r"\w*\((.*)\) -> (.*)", doc).groups()
    whole = "\N{NO-BREAK SPACE}"  # an argument is not broken
    arguments = [argument(one).replace(" ", whole) for one in re.split(r", (?=\w+: )", given)]
    words = f"def {name}({', '.join(arguments)}) -> {spelled(result)}: ..."
    lines = textwrap.wrap(words, 116, subsequent_indent=" " * (len(name) + 5))
    return "\n".join(lines).replace(whole, " ")


def members(kind):
    for name, member in vars(kind).items():
        if isinstance(member, property):
            yield "@property"
            yield f"def {name}(self) -> {spelled(member.fget.__doc__.partition('-> ')[2].strip())}: ..."
        elif isinstance(member, staticmethod):
            yield "@staticmethod"
            yield signature(name, member.__func__.__doc__)
        elif not name.startswith("_") or (name == "__init__" and "->" in member.__doc__):
            yield signature(name, member.__doc__)


def main():
    print(HEAD.format(core.__doc__), end="")
    held = {name: member for name, member in vars(core).items() if not name.startswith("_")}
    for name, kind in held.items():
        if inspect.isclass(kind):
            print(f"\nclass {name}:")
            if kind.__doc__:
                print(f'    """{kind.__doc__}"""\n')
            print(textwrap.indent("\n".join(members(kind)), "    "))
    print()
    for name, function in held.items():
        if not inspect.isclass(function):
            print(signature(name, function.__doc__))


main()
