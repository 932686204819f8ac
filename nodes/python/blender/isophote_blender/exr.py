"""Reads the EXR files that Blender writes here: scan lines without compression, in one part or several.

Not all versions of Blender come with a module that reads them, and none gives away the layers of an image.
"""

import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np

_MAGIC = 20000630
_MULTIPART = 0x1000
_TYPES = {0: np.dtype("<u4"), 1: np.dtype("<f2"), 2: np.dtype("<f4")}


@dataclass
class _Part:
    """The header of a part."""

    channels: list[tuple[str, np.dtype]]
    """In the order in which a line has them."""
    window: tuple[int, int, int, int]
    """First column and row, last column and row."""


class Unreadable(Exception):
    """The file is of another kind, or cut short."""


def read(file: Path) -> dict[str, np.ndarray]:
    """All channels of all parts by their names, of 32-bit floats, rows from top to bottom."""
    data = file.read_bytes()
    try:
        return _read(data)
    except (struct.error, IndexError, ValueError) as error:
        raise Unreadable(f"{file.name} cannot be read as an EXR file: {error}") from error


def _read(data: bytes) -> dict[str, np.ndarray]:
    magic, version = struct.unpack_from("<2i", data)
    if magic != _MAGIC:
        raise Unreadable("the file is no EXR file")
    is_multipart = bool(version & _MULTIPART)
    parts, at = [], 8
    while True:
        part, at = _header(data, at)
        parts.append(part)
        if not is_multipart:
            break
        if data[at] == 0:
            at += 1
            break
    found: dict[str, np.ndarray] = {}
    for number, part in enumerate(parts):
        _, first, _, last = part.window
        # The places of the lines come before all lines, part by part.
        places = struct.unpack_from(f"<{last - first + 1}Q", data, at)
        at += 8 * len(places)
        found.update(_channels(data, places, part, number if is_multipart else None))
    return found


def _text(data: bytes, at: int) -> tuple[str, int]:
    """Text up to a zero, and where it goes on."""
    end = data.index(0, at)
    return data[at:end].decode("utf-8"), end + 1


def _header(data: bytes, at: int) -> tuple[_Part, int]:
    """The header that begins there, and where it ends."""
    channels: list[tuple[str, np.dtype]] = []
    window = (0, 0, -1, -1)
    while data[at] != 0:
        name, at = _text(data, at)
        _, at = _text(data, at)
        (size,) = struct.unpack_from("<i", data, at)
        value = data[at + 4 : at + 4 + size]
        at += 4 + size
        if name == "channels":
            channels = _channel_list(value)
        elif name == "dataWindow":
            window = struct.unpack("<4i", value)
        elif name == "compression" and value[0] != 0:
            raise Unreadable("the file is compressed")
        elif name == "type" and value != b"scanlineimage":
            raise Unreadable(f"the file has a part of the type {value.decode()}")
    return _Part(channels, window), at + 1


def _channel_list(value: bytes) -> list[tuple[str, np.dtype]]:
    channels, at = [], 0
    while value[at] != 0:
        name, at = _text(value, at)
        (kind,) = struct.unpack_from("<i", value, at)
        channels.append((name, _TYPES[kind]))
        # Type, linearity and three bytes that say nothing, sampling in x and y.
        at += 16
    return channels


def _channels(data: bytes, places: tuple[int, ...], part: _Part, number: int | None) -> dict[str, np.ndarray]:
    """The channels of a part, whose lines are at these places."""
    left, top, right, bottom = part.window
    width = right - left + 1
    found = {name: np.empty((bottom - top + 1, width), np.float32) for name, _ in part.channels}
    for place in places:
        if number is not None:
            (of,) = struct.unpack_from("<i", data, place)
            if of != number:
                raise Unreadable(f"a line of part {number} is of part {of}")
            place += 4
        (row,) = struct.unpack_from("<i", data, place)
        at = place + 8
        for name, kind in part.channels:
            found[name][row - top] = np.frombuffer(data, kind, width, at)
            at += width * kind.itemsize
    return found
