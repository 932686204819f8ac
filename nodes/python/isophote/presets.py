"""Presets: a style with its parameters as a JSON file, which may change from frame to frame; and the looks that ship.

`isophote preset --help` of the sample host describes the files, which are the same here.
"""

from __future__ import annotations

import functools
import json
import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import resources
from pathlib import Path
from typing import Any, Union

import numpy as np

from ._catalogue import Node, Param, Value
from .errors import InvalidValueError, UnknownNameError

LOOK = "look:"
"""What the names of looks start with."""

_KEYS = ("name", "about", "tags", "style", "lengths", "parameters")
LENGTHS = {"relative": 1080, "pixels": 0}
"""What lengths mean, and the height of pictures at which they are meant."""


@dataclass(frozen=True)
class Keys:
    """Values of a parameter by frame."""

    values: tuple[tuple[int, str], ...]
    """Values as text, by ascending frame; at least one."""
    between: str | None = None
    """`linear`, `step`, or what suits the parameter."""

    def at(self, frame: int, param: Param) -> str:
        """The value at a frame, as text."""
        after = sum(key <= frame for key, _ in self.values)
        before = max(after - 1, 0)
        changes = param.type in ("float", "int", "color") and self.between != "step"
        if not changes or after in (0, len(self.values)):
            return self.values[before][1]
        (first, a), (last, b) = self.values[before], self.values[after]
        return _mixed(_numbers(a), _numbers(b), (frame - first) / (last - first), param.type == "int")


def _value(text: str, param: Param) -> Value:
    """A value that the library reads as text, of the type that it has in the catalogue."""
    if param.type == "choice":
        return text
    if param.type == "bool":
        return text in ("true", "on", "yes", "1")
    numbers = _numbers(text)
    if param.type == "color":
        # A colour without opacity is opaque.
        return (*numbers, *[1.0] * (4 - len(numbers)))
    return int(numbers[0]) if param.type == "int" else numbers[0]


def _mixed(a: list[float], b: list[float], share: float, whole: bool) -> str:
    # A colour without opacity is opaque.
    length = max(len(a), len(b))
    a, b = (part + [1.0] * (length - len(part)) for part in (a, b))
    mixed = (x + (y - x) * share for x, y in zip(a, b))
    if whole:
        return ",".join(str(int(math.copysign(math.floor(abs(value) + 0.5), value))) for value in mixed)
    return ",".join(str(np.float32(value)) for value in mixed)


def _numbers(text: str) -> list[float]:
    if text.startswith("#"):
        return [value / 255 for value in bytes.fromhex(text[1:])]
    return [float(part) for part in text.split(",")]


@dataclass(frozen=True)
class Preset:
    """A style with its parameters."""

    style: str | Mapping[str, Any]
    """The id of a node, the path of a graph file, or a graph."""
    parameters: Mapping[str, str | Keys] = field(default_factory=dict)
    """Values as text, or by frame."""
    lengths: str = "relative"
    """`relative` or `pixels`: whether lengths are pixels of a picture 1080 lines high, or of the picture itself."""
    name: str = ""
    about: str = ""
    tags: tuple[str, ...] = ()

    def values(self, node: Node, frame: int = 0) -> dict[str, Value]:
        """The parameters at a frame as values of the node that is the style."""
        found = {}
        for name, value in self.parameters.items():
            param = node.param(name)
            if param is None:
                raise UnknownNameError(f"node '{node.id}' has no parameter '{name}'")
            found[name] = _value(value if isinstance(value, str) else value.at(frame, param), param)
        return found

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Preset:
        """The preset in a file, or the look that is named `look:ID`."""
        named = os.fspath(path)
        if named.startswith(LOOK):
            return look(named[len(LOOK) :])
        try:
            file = json.loads(Path(path).read_text(encoding="utf-8"))
        except ValueError as error:
            raise InvalidValueError(f"{named}: is no JSON: {error}; correct the file") from error
        preset = cls.from_dict(file, named)
        # Graph files lie beside the preset.
        if isinstance(preset.style, str) and preset.style.lower().endswith(".json"):
            return Preset(**{**preset.__dict__, "style": str(Path(path).parent / preset.style)})
        return preset

    @classmethod
    def from_dict(cls, file: Mapping[str, Any], place: str = "the preset") -> Preset:
        """The preset that is written out; `place` names it in messages."""
        if not isinstance(file, Mapping):
            raise InvalidValueError(f"{place}: is no preset: an object is wanted; correct the preset")
        for key in file:
            if key not in _KEYS:
                raise InvalidValueError(f"{place}: has an unknown key '{key}'; the keys are {', '.join(_KEYS)}")
        if not isinstance(file.get("style"), (str, Mapping)):
            raise InvalidValueError(f'{place}: names no style; add "style": "cartoon" or another node')
        lengths = file.get("lengths", "relative")
        if lengths not in LENGTHS:
            raise InvalidValueError(f"{place}: its lengths are {lengths!r}; write {' or '.join(LENGTHS)}")
        parameters = file.get("parameters", {})
        if not isinstance(parameters, Mapping):
            raise InvalidValueError(f"{place}: its parameters are no object; correct the preset")
        return cls(
            style=file["style"],
            parameters={name: _track(value, f"{place}: parameter '{name}'") for name, value in parameters.items()},
            lengths=lengths,
            name=file.get("name", ""),
            about=file.get("about", ""),
            tags=tuple(file.get("tags", ())),
        )


def _track(value: Any, place: str) -> str | Keys:
    if not isinstance(value, Mapping):
        return as_text(value, place)
    between = value.get("between")
    if between not in (None, "linear", "step"):
        raise InvalidValueError(f'{place}: does not say how values change between frames; write "between": "linear" or "step"')
    keys = []
    for frame, entry in value.items():
        if frame != "between":
            try:
                keys.append((int(frame), as_text(entry, f"{place} at frame {frame}")))
            except ValueError as error:
                raise InvalidValueError(
                    f'{place}: \'{frame}\' is no number of a frame; write keyframes such as {{"1001": 2, "1050": 6}}'
                ) from error
    if not keys:
        raise InvalidValueError(f'{place}: has no keyframe; write keyframes such as {{"1001": 2, "1050": 6}}')
    return Keys(tuple(sorted(keys)), between)


def as_text(value: Any, place: str) -> str:
    """A value of a parameter as the library reads it."""
    if isinstance(value, str):
        return value
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, (np.integer, np.floating)):
        return str(value)
    if isinstance(value, (list, tuple, np.ndarray)) and len(value) > 0:
        return ",".join(as_text(part, place) for part in value)
    raise InvalidValueError(f"{place} cannot be {value!r}; give a number, a bool, a text, or the numbers of a colour")


def looks() -> dict[str, Preset]:
    """The looks that ship with the library, by their ids and in their order; `look:ID` takes the place of a style anywhere."""
    return dict(_looks())


@functools.cache
def _looks() -> dict[str, Preset]:
    folder = resources.files(__package__).joinpath("looks")
    texts = {id: folder.joinpath(f"{id}.json").read_text("utf-8") for id in folder.joinpath("order.txt").read_text().split()}
    return {id: Preset.from_dict(json.loads(text), LOOK + id) for id, text in texts.items()}


def look(id: str) -> Preset:
    """The look of this id."""
    import difflib

    known = _looks()
    if id in known:
        return known[id]
    near = difflib.get_close_matches(id.lower().replace(" ", "_"), known, 1)
    hint = f"did you mean '{LOOK}{near[0]}'?" if near else "isophote.looks() has them all"
    raise UnknownNameError(f"there is no look '{id}'; {hint}")


StyleLike = Union[str, "os.PathLike[str]", Mapping[str, Any], Preset]
"""What names a style: the id of a node, a graph or preset (a path or written out), a look, or its JSON."""
