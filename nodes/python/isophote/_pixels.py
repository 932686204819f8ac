"""Arrays in and out of the library, as they lie in memory where that is possible."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._inputs import Array, given, tensor
from ._spaces import Colors
from .errors import InvalidValueError

MATERIALS = ("paper", "hatching")
"""Guides that are tiles."""

_FORMATS = "uint8, uint16, float16 or float32"


def pixels(image: Any, name: str) -> Array:
    """An array of rows, columns and channels that the library reads: `image` itself where its layout allows, else a copy.

    `name` is the input's, which says what other types of numbers mean.
    """
    array = given(image, name)
    if array.ndim == 2:
        array = array[:, :, np.newaxis]
    if array.ndim != 3:
        raise InvalidValueError(f"input image '{name}' has the shape {array.shape}, which is a batch; give one picture")
    if name == "object_id" and array.dtype.kind in "iu" and array.dtype.itemsize > 2:
        array = array.astype(np.float32)
    array = array.astype(_format(array.dtype, f"input image '{name}'"), copy=False)
    if name == "color" and array.shape[2] == 2:
        # Grey and alpha.
        array = array[:, :, [0, 0, 0, 1]]
    return dense(array)


def tiled(image: Any, name: str, size: tuple[int, ...]) -> Array:
    """As `pixels`, of so many rows and columns where it is a material: those of any size are laid again and again."""
    array = pixels(image, name)
    if name not in MATERIALS or array.shape[:2] == size or 0 in array.shape:
        return array
    rows, columns = (np.arange(length) % own for length, own in zip(size, array.shape[:2]))
    laid: Array = array[rows[:, np.newaxis], columns]
    return laid


def _format(dtype: np.dtype[Any], what: str) -> np.dtype[Any]:
    """The same type in the machine's byte order."""
    if dtype.kind not in "uf" or dtype.itemsize not in ((1, 2) if dtype.kind == "u" else (2, 4)):
        raise InvalidValueError(f"{what} has numbers of type {dtype}, not {_FORMATS}; use its method astype")
    native: np.dtype[Any] = dtype.newbyteorder("=")
    return native


def dense(array: Array) -> Array:
    """The array, or a copy, with the pixels of each row one after the other. Rows may lie in any order and distance."""
    _, width, channels = array.shape
    row, column, channel = array.strides
    size = array.itemsize
    one_after_the_other = (channels <= 1 or channel == size) and (width <= 1 or column == channels * size)
    apart = array.shape[0] <= 1 or abs(row) >= width * channels * size
    return array if one_after_the_other and apart else np.ascontiguousarray(array)


def writable(out: Any) -> Array:
    """The caller's array that a result is written to, or one in the memory of its tensor."""
    if isinstance(out, np.ndarray):
        return out
    if not hasattr(out, "__dlpack__"):
        raise InvalidValueError(f"out is no array and no tensor with __dlpack__, but of {type(out)}")
    array = tensor(out, "out")
    # Before its version 1, DLPack does not say whether memory may be written to, which NumPy takes for no.
    if not array.flags.writeable and hasattr(out, "numpy"):
        same = out.numpy()
        if isinstance(same, np.ndarray) and np.shares_memory(same, array):
            return same
    return array


class Target:
    """Where a result is written: the caller's array, or a new one."""

    def __init__(self, source: Array, kind: str, out: Any, colors: Colors) -> None:
        """`source` is the picture that a result of this kind is made of, `out` the caller's array or tensor."""
        self._colors = colors if kind == "color" and colors.is_needed else None
        self._caller: Array | None = out
        out = None if out is None else writable(out)
        height, width = source.shape[:2]
        if kind == "color":
            shape, dtype = source.shape, source.dtype
        elif kind == "scalar":
            shape, dtype = (height, width), source.dtype
        else:
            shape, dtype = (height, width, 2 if kind == "motion" else 4), np.dtype(np.float32)
        if out is None:
            out = np.empty(shape, dtype.newbyteorder("="))
        elif out.ndim not in (2, 3) or out.shape[:2] != (height, width):
            raise InvalidValueError(f"out has the shape {out.shape}, and the picture has {height} rows of {width} pixels")
        if not out.flags.writeable:
            raise InvalidValueError("out is read-only")
        self.out: Array = out
        _format(out.dtype, "out")
        view = out[:, :, np.newaxis] if out.ndim == 2 else out
        channels = view.shape[2]
        # The library writes pictures of 1, 3 or 4 channels.
        self._picked = [0, 3] if kind == "color" and channels == 2 else list(range(channels))
        written = {2: 4 if kind == "color" else 3}.get(channels, channels)
        is_fit = written == channels and out.dtype.isnative and dense(view) is view and self._colors is None
        of_library = out.dtype.newbyteorder("=") if self._colors is None else np.dtype(np.float32)
        self.pixels: Array = view if is_fit else np.empty((height, width, written), of_library)
        self._view = view

    def finished(self) -> Array:
        """The result: the caller's array or tensor, or the new array."""
        if self.pixels is not self._view:
            result = self.pixels if self._colors is None else self._colors.leaving(self.pixels, self._view.dtype)
            self._view[...] = result[:, :, self._picked]
        return self.out if self._caller is None else self._caller
