"""Colours of spaces that the library does not compute in, changed on the way in and back on the way out."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._inputs import Array
from ._library import native

_LARGEST_HALF = 65504.0


class Colors:
    """Change of a picture's colours to the space in which the library computes, and back."""

    def __init__(self, space: str, alpha_mode: str) -> None:
        """From the space of an id or alias."""
        self._space, self._working = native.color_space(space)
        self._is_premultiplied = alpha_mode != "straight"

    @property
    def is_needed(self) -> bool:
        """True unless the library computes in the picture's own space."""
        return self._space != self._working

    def entering(self, image: Array) -> Array:
        """The picture as the library reads it: floats in its space, or `image` itself where that is in one."""
        if not self.is_needed:
            return image
        floats = np.array(image, dtype=np.float32, order="C")
        if image.dtype.kind == "u":
            floats /= np.float32(np.iinfo(image.dtype).max)
        native.change_space(floats, self._space, self._working, self._is_premultiplied)
        return floats

    def leaving(self, floats: Array, dtype: np.dtype[Any]) -> Array:
        """A result of the library's in the picture's space and in numbers of a type; `floats` are used up."""
        native.change_space(floats, self._working, self._space, self._is_premultiplied)
        result: Array = floats
        if dtype.kind == "u":
            result = np.clip(floats, 0, 1) * np.float32(np.iinfo(dtype).max) + np.float32(0.5)
        elif dtype.itemsize == 2:
            result = np.clip(floats, -_LARGEST_HALF, _LARGEST_HALF)
        return result.astype(dtype)
