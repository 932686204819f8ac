"""The nodes of the library with everything that they say about themselves."""

from __future__ import annotations

import functools
import json
from dataclasses import dataclass
from typing import Any, Union

from ._library import native

Value = Union[bool, int, float, str, tuple[float, ...]]


@dataclass(frozen=True)
class Choice:
    """One option of a choice."""

    id: str
    label: str


@dataclass(frozen=True)
class Param:
    """A parameter of a node."""

    id: str
    label: str
    hint: str
    """A sentence or two in artists' words, for panels."""
    doc: str
    """The hint, and after an empty line documentation, where there is any."""
    group: str
    """Heading under which panels show it; empty for the node's own."""
    unit: str
    """`px` (scaled with the picture), `%`, `deg`, or empty."""
    structural: bool
    """Whether a change may change the passes of a plan."""
    type: str
    """`float`, `int`, `bool`, `choice` or `color`."""
    default: Value
    range: tuple[float, float] | None = None
    """Hard range of a number; values outside are refused."""
    slider: tuple[float, float] | None = None
    """Range of a slider."""
    options: tuple[Choice, ...] = ()
    """Options of a choice."""


@dataclass(frozen=True)
class Port:
    """An input or output of a node."""

    id: str
    kind: str
    optional: bool
    doc: str


@dataclass(frozen=True)
class Node:
    """A node."""

    id: str
    label: str
    group: str
    hint: str
    """A sentence in artists' words."""
    doc: str
    """The hint, and documentation after an empty line."""
    section: str
    """Sections of the thesis."""
    inputs: tuple[Port, ...]
    output: Port
    params: tuple[Param, ...]

    def param(self, id: str) -> Param | None:
        """The parameter of this id."""
        return next((param for param in self.params if param.id == id), None)


def catalogue() -> dict[str, Node]:
    """All nodes by their ids, in the library's order."""
    return dict(_nodes())


@functools.cache
def _nodes() -> dict[str, Node]:
    return {entry["id"]: _node(entry) for entry in json.loads(native.catalogue())["nodes"]}


def _node(entry: dict[str, Any]) -> Node:
    inputs = tuple(Port(**port) for port in entry["inputs"])
    params = tuple(_param(param) for param in entry["params"])
    return Node(**{**entry, "inputs": inputs, "output": Port(**entry["output"]), "params": params})


def _param(entry: dict[str, Any]) -> Param:
    fields: dict[str, Any] = {key: tuple(value) if isinstance(value, list) else value for key, value in entry.items()}
    fields["options"] = tuple(Choice(**option) for option in entry.get("options", []))
    return Param(**fields)
