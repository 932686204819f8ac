"""Graphics devices."""

from __future__ import annotations

import functools
from typing import Union

from ._library import native
from .errors import DeviceError

Device = native.Device
DeviceLike = Union[native.Device, str, None]


def open_device(device: DeviceLike) -> Device | None:
    """The device that is meant; none for the CPU. Devices opened by name are kept."""
    if isinstance(device, Device):
        return device
    if device is None or device == "cpu":
        return None
    if device == "auto":
        # A driver that computes on the CPU is slower there than the library itself.
        try:
            return _opened("gpu")
        except DeviceError:
            return None
    return _opened(None if device == "gpu" else device)


@functools.lru_cache(maxsize=8)
def _opened(adapter: str | None) -> Device:
    return Device(adapter)
