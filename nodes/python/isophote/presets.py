"""Presets: a style with its parameters as a JSON file, which may change from frame to frame; and the looks that ship.

`isophote preset --help` of the sample host describes the files, which are the same here. The library reads them.
"""

from __future__ import annotations

import functools
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Union

import numpy as np

from ._catalogue import Node, Value
from ._library import native
from .errors import InvalidValueError, UnknownNameError

LOOK = "look:"
"""What the names of looks start with."""

PLACE = "the preset"
"""What messages call a preset that is no file."""

LENGTHS = {"relative": native.REFERENCE_HEIGHT, "pixels": 0}
"""What lengths mean, and the height of pictures at which they are meant."""


@dataclass(frozen=True)
class Keys:
    """Values of a parameter by frame."""

    values: tuple[tuple[int, str], ...]
    """Values as text, by ascending frame; at least one."""
    between: str | None = None
    """`linear`, `step`, or what suits the parameter."""


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
    objects: tuple[Mapping[str, Any], ...] = ()
    """Rules for things in pictures, which `isophote apply` follows; here they are kept."""

    def values(self, node: Node, frame: int = 0) -> dict[str, Value]:
        """The parameters at a frame as values of the node that is the style."""
        style = native.Style.from_json(PLACE, self.to_json(), None)
        graph = style.graph()
        style.at_frame(graph, frame)
        given = json.loads(graph.to_json())["nodes"][0].get("params", {})
        found: dict[str, Value] = {}
        for name in self.parameters:
            param = node.param(name)
            if param is None:
                raise UnknownNameError(f"node '{node.id}' has no parameter '{name}'")
            value = given.get(name, param.default)
            found[name] = tuple(value) if param.type == "color" else value
        return found

    def to_json(self) -> str:
        """The preset as the text of a file."""
        file: dict[str, Any] = {"name": self.name, "about": self.about, "tags": list(self.tags)}
        file = {key: value for key, value in file.items() if value}
        file.update(style=self.style, lengths=self.lengths)
        file["parameters"] = {name: _written(value) for name, value in self.parameters.items()}
        if self.objects:
            file["objects"] = list(self.objects)
        return as_json(file)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Preset:
        """The preset in a file, or the look that is named `look:ID`."""
        named = os.fspath(path)
        if named.startswith(LOOK):
            return look(named[len(LOOK) :])
        preset = cls._read(Path(path).read_text(encoding="utf-8"), named)
        # Graph files lie beside the preset.
        if isinstance(preset.style, str) and preset.style.lower().endswith(".json"):
            return Preset(**{**preset.__dict__, "style": str(Path(path).parent / preset.style)})
        return preset

    @classmethod
    def from_dict(cls, file: Mapping[str, Any], place: str = PLACE) -> Preset:
        """The preset that is written out; `place` names it in messages."""
        return cls._read(as_json(file), place)

    @classmethod
    def _read(cls, text: str, place: str) -> Preset:
        read = native.read_preset(place, text)
        if read is None:
            raise InvalidValueError(f"{place}: is a graph and no preset; name a preset")
        file = json.loads(read)
        style = file["style"]
        title = {key: value for key, value in file["title"].items() if value is not None}
        return cls(
            style=json.loads(style) if style.lstrip().startswith("{") else style,
            parameters={name: _track(track) for name, track in file["params"]},
            lengths=file["lengths"] or "relative",
            objects=tuple(rule["rule"] for rule in file["objects"]),
            **{**title, "tags": tuple(title["tags"])},
        )


def _track(track: Mapping[str, Any]) -> str | Keys:
    if "still" in track:
        return str(track["still"])
    keys = track["keys"]
    between = {None: None, True: "step", False: "linear"}[keys["step"]]
    return Keys(tuple((frame, text) for frame, text in keys["keys"]), between)


def _written(value: str | Keys) -> str | dict[str, str]:
    if isinstance(value, str):
        return value
    between = {} if value.between is None else {"between": value.between}
    return {**{str(frame): text for frame, text in value.values}, **between}


def as_json(file: Any) -> str:
    """What is in a file as its text; numbers and arrays may be those of NumPy."""

    def plain(value: Any) -> Any:
        if isinstance(value, (np.generic, np.ndarray)):
            return value.tolist()
        if isinstance(value, Mapping):
            return dict(value)
        raise InvalidValueError(f"a preset cannot hold {value!r}; give numbers, bools, texts, lists and dicts")

    return json.dumps(file, default=plain)


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
    return {id: Preset._read(text, LOOK + id) for id, text in native.looks()}


def look(id: str) -> Preset:
    """The look of this id."""
    if id not in _looks():
        # It names the nearest.
        native.Style.named(LOOK + id)
    return _looks()[id]


StyleLike = Union[str, "os.PathLike[str]", Mapping[str, Any], Preset]
"""What names a style: the id of a node, a graph or preset (a path or written out), a look, or its JSON."""
