"""The nodes: one for looks, one for presets and graphs, and one for every node of the library from picture to picture."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import isophote

from .batches import stylized
from .widgets import changed, widget

_GUIDES = {
    "mask": ("MASK", {"tooltip": "Where the result is; the picture stays elsewhere."}),
    "control": (
        "IMAGE",
        {"tooltip": "A control map, grey for no change: red is detail, green the width of lines, blue their amount."},
    ),
    "paper": ("IMAGE", {"tooltip": "Paper to draw or paint on, of any size: it is tiled."}),
    "hatching": (
        "IMAGE",
        {"tooltip": "Hatching to draw tones with, of any size, dark on white; of several tones, one in each channel."},
    ),
    "line_paint": ("IMAGE", {"tooltip": "Colours that lines have where they lie: a painting, or the picture itself."}),
}
"""Inputs beside the pictures, by the names of the library's ports."""

_IMAGE = ("IMAGE", {"tooltip": "Pictures, or the frames of a video."})
_STEADINESS = (
    "FLOAT",
    {
        "default": 0.0,
        "min": 0.0,
        "max": 1.0,
        "step": 0.05,
        "tooltip": "How steady the frames of a video are; 0 takes the pictures one by one. Motion is estimated.",
    },
)


class _Stylizes:
    """What all nodes have: pictures in, pictures out."""

    RETURN_TYPES = ("IMAGE",)
    FUNCTION = "stylize"
    CATEGORY = "Isophote"


def _inputs(required: dict[str, Any], ports: tuple[str, ...]) -> dict[str, Any]:
    guides = {name: told for name, told in _GUIDES.items() if name in ports}
    return {"required": {"image": _IMAGE, **required}, "optional": guides}


class Look(_Stylizes):
    """One of the looks that come along."""

    DESCRIPTION = "Gives pictures one of the looks that come with Isophote."

    @classmethod
    def INPUT_TYPES(cls) -> dict[str, Any]:
        """Inputs and widgets."""
        looks = isophote.looks()
        about = "\n".join(f"{name}: {look.about}" for name, look in looks.items())
        return _inputs({"look": (list(looks), {"tooltip": about}), "steadiness": _STEADINESS}, tuple(_GUIDES))

    def stylize(self, image: Any, look: str, steadiness: float, **guides: Any) -> tuple[Any]:
        """Result of the node."""
        return (stylized(f"look:{look}", _steady(steadiness), image, guides),)


class Preset(_Stylizes):
    """A preset or graph of the user's."""

    DESCRIPTION = "Gives pictures the style of a preset or graph: a file, or the JSON that is in one."

    @classmethod
    def INPUT_TYPES(cls) -> dict[str, Any]:
        """Inputs and widgets."""
        preset = ("STRING", {"default": "", "multiline": True, "tooltip": "Path of a .json file, or what is in one."})
        return _inputs({"preset": preset, "steadiness": _STEADINESS}, tuple(_GUIDES))

    @classmethod
    def IS_CHANGED(cls, preset: str, **_: Any) -> str:
        """What tells a file that has changed from the one that the last result was made with."""
        text = preset.strip()
        if not text.startswith("{") and Path(text).is_file():
            return hashlib.sha256(Path(text).read_bytes()).hexdigest()
        return text

    def stylize(self, image: Any, preset: str, steadiness: float, **guides: Any) -> tuple[Any]:
        """Result of the node."""
        if not preset.strip():
            raise ValueError("there is no preset; write the path of a .json file, or paste what is in one")
        return (stylized(preset.strip(), _steady(steadiness), image, guides),)


def _steady(steadiness: float) -> dict[str, float]:
    return {"steadiness": steadiness} if steadiness > 0 else {}


def _of_node(node: isophote.Node) -> type[_Stylizes]:
    """The class of a node of the library."""

    class OfNode(_Stylizes):
        DESCRIPTION = node.hint
        CATEGORY = f"Isophote/{node.group.capitalize()}"

        @classmethod
        def INPUT_TYPES(cls) -> dict[str, Any]:
            return _inputs({param.id: widget(param) for param in node.params}, tuple(port.id for port in node.inputs))

        def stylize(self, image: Any, **values: Any) -> tuple[Any]:
            guides = {port.id: values.pop(port.id, None) for port in node.inputs if port.id in _GUIDES}
            return (stylized(node.id, changed(node.params, values), image, guides),)

    OfNode.__name__ = OfNode.__qualname__ = node.id
    return OfNode


def _is_filter(node: isophote.Node) -> bool:
    """True for nodes that make pictures of pictures and need nothing else."""
    color, *others = node.inputs
    return (color.kind, node.output.kind) == ("color", "color") and all(port.optional for port in others)


CLASSES: dict[str, tuple[type[_Stylizes], str]] = {
    "isophote_look": (Look, "Isophote Look"),
    "isophote_preset": (Preset, "Isophote Preset"),
    **{
        f"isophote_{node.id}": (_of_node(node), f"{node.label} (Isophote)")
        for node in isophote.catalogue().values()
        if _is_filter(node)
    },
}
"""Classes and labels of the nodes, by the names that workflows keep."""
