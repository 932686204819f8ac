"""Structure-adaptive stylization: cartoons, line drawings and paintings of renders and photographs.

    import isophote

    picture = isophote.apply("cartoon", image, posterize=6, normal=normal)

Pictures are arrays of NumPy: rows, columns and, but for grey ones, channels.
"""

from __future__ import annotations

from . import nodes
from ._catalogue import Choice, Node, Param, Port, Value, catalogue
from ._inputs import Array
from ._library import native
from ._motion import motion
from .devices import Device, DeviceLike
from .errors import (
    DeviceError,
    InternalError,
    InvalidValueError,
    IsophoteError,
    OutOfMemoryError,
    UnknownNameError,
    UnsupportedError,
)
from .presets import Preset, StyleLike, looks
from .sequences import Sequence, frames
from .style import Picture, Style, apply

__version__ = native.version()


def trim() -> None:
    """Ends worker threads that are idle and gives back memory kept for later calls; both return when they are needed."""
    native.trim()


__all__ = [
    "Array",
    "Choice",
    "Device",
    "DeviceError",
    "DeviceLike",
    "InternalError",
    "InvalidValueError",
    "IsophoteError",
    "Node",
    "OutOfMemoryError",
    "Param",
    "Picture",
    "Port",
    "Preset",
    "Sequence",
    "Style",
    "StyleLike",
    "UnknownNameError",
    "UnsupportedError",
    "Value",
    "apply",
    "catalogue",
    "frames",
    "looks",
    "motion",
    "nodes",
    "trim",
]
