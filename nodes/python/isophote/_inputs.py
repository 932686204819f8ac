"""Pictures of other libraries as arrays of NumPy, in their own memory where that is possible."""

from __future__ import annotations

import os
import sys
from typing import Any

import numpy as np

from .errors import InvalidValueError

Array = np.ndarray[Any, Any]

_HOST_MEMORY = (1, 3)
"""DLPack's numbers of devices whose memory is the CPU's."""

_MODES = {
    "1": "L",
    "La": "LA",
    "PA": "RGBA",
    "RGBa": "RGBA",
    "RGBX": "RGB",
    "CMYK": "RGB",
    "YCbCr": "RGB",
    "HSV": "RGB",
    "BGR;15": "RGB",
    "BGR;16": "RGB",
    "BGR;24": "RGB",
}
"""Modes of Pillow whose numbers are no grey, RGB or RGBA, and the mode that shows the same."""

_KEPT = ("L", "LA", "RGB", "RGBA", "I", "I;16", "I;16L", "I;16B", "I;16N", "F")
"""Modes of Pillow that are read as they are."""


def given(image: Any, name: str) -> Array:
    """The picture as an array of rows and columns, perhaps channels, and perhaps pictures before them all.

    Images of Pillow become what they show, whatever their mode. Tensors with `__dlpack__`, such as those of PyTorch, stay
    where they are. What is true or false becomes 255 or 0, or 1 or 0 where it numbers objects. `name` is the input's.
    """
    what = f"input image '{name}'"
    if isinstance(image, (str, os.PathLike)):
        fix = "read it first, by PIL.Image.open(...) or what else reads such files"
        raise InvalidValueError(f"{what} is the name of a file; {fix}")
    array = image if isinstance(image, np.ndarray) else _foreign(image, name, what)
    if array.ndim not in (2, 3, 4):
        raise InvalidValueError(
            f"{what} has the shape {array.shape}; pictures have rows, columns and perhaps channels, and batches of them a "
            "dimension before these"
        )
    if name == "color" and array.ndim > 2 and array.shape[-1] > 4 and 1 <= array.shape[-3] <= 4:
        fix = "permute(0, 2, 3, 1)" if array.ndim == 4 else "permute(1, 2, 0)"
        raise InvalidValueError(
            f"{what} has the shape {array.shape}, and channels come last: use {fix} of a tensor, "
            "or numpy.moveaxis(array, -3, -1)"
        )
    if array.dtype == np.bool_:
        array = array.astype(np.uint8) * np.uint8(1 if name == "object_id" else 255)
    return np.asarray(array)


def _foreign(image: Any, name: str, what: str) -> Array:
    """An array of what is none of NumPy's."""
    pillow = sys.modules.get("PIL.Image")
    if pillow is not None and isinstance(image, pillow.Image):
        return _shown(image, name, what)
    if hasattr(image, "__dlpack__") and not hasattr(image, "__array_interface__"):
        return tensor(image, what)
    return np.asarray(image)


def tensor(image: Any, what: str) -> Array:
    """An array in the memory of a tensor with `__dlpack__`."""
    if hasattr(image, "__dlpack_device__"):
        kind = int(image.__dlpack_device__()[0])
        if kind not in _HOST_MEMORY:
            raise InvalidValueError(f"{what} lies in the memory of a device; copy it to the CPU's first, by its method cpu")
    try:
        # NumPy has it from 1.23 on.
        array: Array = getattr(np, "from_dlpack", np.asarray)(image)
    except (BufferError, RuntimeError, TypeError) as error:
        raise InvalidValueError(f"{what} cannot be read as a DLPack tensor: {error}") from error
    return array


def _shown(image: Any, name: str, what: str) -> Array:
    """An image of Pillow as what it shows: colours for indices into a palette, light for ink."""
    mode = image.mode
    if name == "object_id" and mode in ("1", "P"):
        # Numbers of objects are the indices themselves.
        return np.asarray(image)
    has_alpha = "transparency" in image.info or (mode == "P" and image.palette is not None and image.palette.mode == "RGBA")
    if mode == "P":
        wanted = "RGBA" if has_alpha else "RGB"
    elif mode in ("1", "L", "RGB") and has_alpha:
        wanted = "RGBA" if mode == "RGB" else "LA"
    else:
        wanted = _MODES.get(mode, mode if mode in _KEPT else "RGB")
    try:
        array: Array = np.asarray(image if mode == wanted else image.convert(wanted))
    except ValueError as error:
        raise InvalidValueError(f"{what} is an image of the mode '{mode}'; make it one of RGB first: {error}") from error
    if mode == "I" and name != "object_id":
        if array.size and (array.min() < 0 or array.max() > 65535):
            raise InvalidValueError(
                f"{what} is an image of the mode 'I' with numbers from {array.min()} to {array.max()}; those of pictures are "
                "0 to 65535: divide them, and make an array of float32"
            )
        array = array.astype(np.uint16)
    return array
