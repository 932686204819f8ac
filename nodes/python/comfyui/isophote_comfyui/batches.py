"""Styles on batches of pictures: tensors of pictures, rows, columns and channels, floats from 0 to 1, gamma-encoded.

A batch is a shot where the style is to be steady, and pictures of their own otherwise.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import isophote


def stylized(style: Any, params: dict[str, Any], image: Any, guides: dict[str, Any]) -> Any:
    """The result of a style on a batch, a tensor where the batch is.

    Guides are `mask`, pictures without channels, and `control`, `paper`, `hatching` and `line_paint`, pictures; None where they
    are not connected.
    """
    # Arrays in the memory of the tensors: what DLPack hands over is read-only in some versions.
    pictures, result = image.cpu().numpy(), image.cpu().new_empty(image.shape)
    results = result.numpy()
    given = {name: _of_each(each.cpu().numpy(), name, pictures) for name, each in guides.items() if each is not None}
    opened = isophote.Style(style, **params)
    bar = _progress_bar(len(pictures))
    if len(pictures) > 1 and opened.frames != (0, 0):
        lengths = opened.lengths
        opened = isophote.Style(_with_estimated_motion(opened))

        def source(name: str, frame: int) -> Any:
            if not 0 <= frame < len(pictures):
                return None
            return pictures[frame] if name == "color" else given[name](frame)

        shot = isophote.Sequence(opened, source, list(given), lengths=lengths, progress=_interrupted)
        for number in range(len(pictures)):
            shot.frame(number, out=results[number])
            bar(1)
    else:
        settings = isophote.style.Settings(progress=_interrupted)
        for number in range(len(pictures)):
            of_one = {name: each(number) for name, each in given.items()}
            opened.apply(pictures[number], out=results[number], frame=number, settings=settings, **of_one)
            bar(1)
    return result.clamp(0, 1).to(image.device)


def _of_each(guide: Any, name: str, pictures: Any) -> Callable[[int], Any]:
    """A function that gives the guide of each picture: its own, or the one that all have."""
    if len(guide.shape) == 2:
        guide = guide[None]
    rows, columns = guide.shape[1:3]
    height, width = pictures.shape[1:3]
    if name not in ("paper", "hatching") and (rows, columns) != (height, width):
        raise ValueError(f"the {name} is {columns}x{rows}, and the pictures are {width}x{height}; scale it to their size")
    if len(guide) not in (1, len(pictures)):
        raise ValueError(
            f"there are {len(guide)} pictures of the {name}, and {len(pictures)} to stylize; give one, or one each"
        )
    return lambda number: guide[number if len(guide) > 1 else 0]


def _with_estimated_motion(style: isophote.Style) -> str:
    """The graph of a style whose motion is the optical flow of its pictures, as JSON."""
    graph = json.loads(style.to_json())
    catalogue = isophote.catalogue()
    for name, direction in (("motion", "backward"), ("motion_forward", "forward")):
        readers = [node for node in graph["nodes"] if any(port.id == name for port in catalogue[node["node"]].inputs)]
        flow = f"estimated {name}"
        for node in readers:
            node.setdefault("inputs", {})[name] = flow
        if readers:
            inputs, params = {"color": "@color"}, {"direction": direction, "quality": "fast"}
            graph["nodes"].append({"name": flow, "node": "optical_flow", "inputs": inputs, "params": params})
    return json.dumps(graph)


def _progress_bar(count: int) -> Callable[[int], object]:
    """What moves the bar of the node; nothing outside ComfyUI."""
    try:
        from comfy.utils import ProgressBar
    except ImportError:
        return lambda _: None
    update: Callable[[int], object] = ProgressBar(count).update
    return update


def _interrupted(_: float) -> None:
    """Ends the work, by an exception of ComfyUI's, where its user asked for that."""
    try:
        from comfy.model_management import throw_exception_if_processing_interrupted
    except ImportError:
        return
    throw_exception_if_processing_interrupted()
