"""Parameters of the catalogue as widgets of ComfyUI, and back."""

from __future__ import annotations

import math
from typing import Any

import isophote

_FOLDED = ("advanced", "time", "output")
"""Groups that are folded away where the editor can do so."""

_STEPS = 100
"""About so many steps has a slider."""


def widget(param: isophote.Param) -> tuple[Any, dict[str, Any]]:
    """Type of a parameter's widget, or its options, and what the editor is told of it."""
    told: dict[str, Any] = {"default": param.default, "tooltip": param.hint}
    if param.group in _FOLDED:
        told["advanced"] = True
    if param.type == "choice":
        return [option.id for option in param.options], told
    if param.type == "bool":
        return "BOOLEAN", told
    if param.type == "color":
        return "STRING", {**told, "default": _hex(param.default)}
    low, high = param.range or (-math.inf, math.inf)
    if param.type == "int":
        return "INT", {**told, "min": int(low), "max": int(high), "step": 1}
    first, last = param.slider or (low, high)
    step = 10.0 ** math.floor(math.log10((last - first) / _STEPS))
    # Values stay as they are typed: defaults are no multiples of the step.
    return "FLOAT", {**told, "min": low, "max": high, "step": step, "round": False}


def changed(params: tuple[isophote.Param, ...], values: dict[str, Any]) -> dict[str, Any]:
    """Values of parameters that are not their defaults."""
    found = {}
    for param in params:
        default = _hex(param.default) if param.type == "color" else param.default
        if values.get(param.id, default) != default:
            found[param.id] = values[param.id]
    return found


def _hex(color: Any) -> str:
    """A colour as text, with its alpha unless it is opaque."""
    digits = "".join(f"{round(255 * channel):02x}" for channel in color)
    return f"#{digits.removesuffix('ff') if len(digits) == 8 else digits}"
