"""Every node of the library as a function, `isophote.nodes.cartoon(image, posterize=6)`.

They are made from the catalogue when they are asked for. `nodes.pyi` describes them to editors and type checkers.
"""

from __future__ import annotations

import inspect
import textwrap
from collections.abc import Callable
from typing import Any

from ._catalogue import Node, Param, catalogue
from ._inputs import Array
from .style import GUIDES, Style, apply

__all__ = list(catalogue())

_TYPES = {"float": "float", "int": "int", "bool": "bool", "color": "Color"}


def __getattr__(name: str) -> Callable[..., Array]:
    node = catalogue().get(name)
    if node is None:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    function = globals()[name] = _function(node)
    return function


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


def _function(node: Node) -> Callable[..., Array]:
    # A parameter may have the name of a guide that the node does not read.
    namesakes = {param.id for param in node.params} & set(GUIDES)

    def function(image: Any, /, **arguments: Any) -> Array:
        if not namesakes & set(arguments):
            return apply(node.id, image, **arguments)
        own = {param.id for param in node.params} | {"precision"}
        style = Style(node.id, **{name: value for name, value in arguments.items() if name in own})
        return apply(style, image, **{name: value for name, value in arguments.items() if name not in own})

    function.__name__ = function.__qualname__ = node.id
    function.__module__ = __name__
    function.__doc__ = docstring(node)
    function.__signature__ = _signature(node)  # type: ignore[attr-defined]
    return function


def guides(node: Node) -> list[str]:
    """Pictures beside the colour that a node reads, and no other node makes."""
    return [port.id for port in node.inputs if port.id in GUIDES]


def type_of(param: Param) -> str:
    """The type of a parameter, as it is written in a program."""
    if param.type == "choice":
        return f"Literal[{', '.join(repr(option.id) for option in param.options)}]"
    return _TYPES[param.type]


def docstring(node: Node) -> str:
    """What a node says about itself and its parameters."""
    section = f" (thesis § {node.section})" if node.section else ""
    lines = [*_wrapped(f"{node.label}. {node.doc}{section}", ""), "", "Inputs:"]
    for port in node.inputs:
        lines += _wrapped(f"{'image' if port.id == 'color' else port.id}: {port.doc}", "    ")
    lines += ["", "Parameters:"]
    for param in node.params:
        lines += _wrapped(f"{param.id}: {param.doc}{_range(param)}", "    ")
    lines += ["", "The other arguments are those of `isophote.apply`."]
    return "\n".join(lines)


def _range(param: Param) -> str:
    unit = f" {param.unit}" if param.unit else ""
    if param.range is None or param.type not in ("float", "int"):
        return ""
    low, high = param.range
    return f" {low:g} to {high:g}{unit}."


def _wrapped(text: str, indent: str) -> list[str]:
    return textwrap.wrap(" ".join(text.split()), 96, initial_indent=indent, subsequent_indent=indent and indent + "    ")


def _signature(node: Node) -> inspect.Signature:
    Parameter = inspect.Parameter
    parameters = [Parameter("image", Parameter.POSITIONAL_ONLY)]
    for name in guides(node):
        parameters.append(Parameter(name, Parameter.KEYWORD_ONLY, default=None))
    for param in node.params:
        kind = Parameter.KEYWORD_ONLY
        parameters.append(Parameter(param.id, kind, default=param.default, annotation=type_of(param)))
    parameters.append(Parameter("picture", Parameter.VAR_KEYWORD))
    return inspect.Signature(parameters, return_annotation="Array")
