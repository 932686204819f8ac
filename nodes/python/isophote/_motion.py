"""Motion vectors of renderers as the library's."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._inputs import Array, given
from ._library import native
from ._pixels import dense


def motion(backward: Any = None, forward: Any = None, *, convention: str = "isophote") -> dict[str, Array]:
    """The guides `motion` and `motion_forward` from the passes of motion vectors of a renderer.

    `convention` names the renderer: `isophote` (pixels, y up, as in compositors), `arnold`, `blender`, `renderman`, `vray` or
    `unreal`, and after commas what differs, `"arnold,y=down"`. A pass that has both ways, such as Blender's Vector, is given
    as either; a pass that leads one way stands for the other too, reversed.

        isophote.apply("cartoon", image, **isophote.motion(vector, convention="blender"))
    """
    before, after = _floats(backward), _floats(forward)
    given = after if before is None else before
    if given is None:
        raise TypeError("no motion vectors are given")
    found = {}
    for name, is_forward in (("motion", False), ("motion_forward", True)):
        target = np.empty((*given.shape[:2], 2), np.float32)
        native.motion(before, after, target, convention, is_forward)
        found[name] = target
    return found


def _floats(vectors: Any) -> Array | None:
    return None if vectors is None else dense(np.asarray(given(vectors, "motion"), np.float32))
