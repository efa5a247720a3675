"""Python's values as the YAML that the program reads."""
from __future__ import annotations

import json
import re
from typing import Any, Mapping

from modcal.errors import InvalidInput

# Words and quantities such as "30 mm" and "1e-3 kg/m": a quoted text would never be a number.
_PLAIN = re.compile(r"[A-Za-z0-9_.+-]([A-Za-z0-9_ .+*/^%²³µ-]*[A-Za-z0-9_.+*/^%²³µ-])?")


def flow(value: Any) -> str:
    """The value on one line."""
    if hasattr(value, "tolist"):  # NumPy
        value = value.tolist()
    if value is None:
        return "~"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{json.dumps(str(key))}: {flow(held)}" for key, held in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(flow(held) for held in value) + "]"
    text = str(value)
    return text if _PLAIN.fullmatch(text) else json.dumps(text, ensure_ascii=False)


def block(experiment: Mapping[str, Any]) -> str:
    """An experiment, a line for each of its keys, so that mistakes have lines of their own."""
    return "".join(f"{key}: {flow(value)}\n" for key, value in experiment.items())


def assignments(overrides: Mapping[str, Any] | None) -> list[str]:
    """What --set takes. A text is YAML as it stands: "30 mm", "[1, 2]"."""
    if overrides is not None and not isinstance(overrides, Mapping):
        raise InvalidInput(f"the overrides are a {type(overrides).__name__}; give a dictionary {{\"scene.duration\": 0.2}}")
    return [f"{path}={value if isinstance(value, str) else flow(value)}"
            for path, value in (overrides or {}).items()]
