"""What the library refuses, as exceptions with its own sentences."""

from __future__ import annotations

import re

# Control characters, but for lines and tabs, and marks that turn the direction of writing.
_HIDDEN = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]")


class IsophoteError(Exception):
    """The library did not do what was asked; the message says what is wrong.

    Messages repeat names that come from files, so that what terminals would obey stands in them as `\\u001b`.
    """

    def __init__(self, message: str = "") -> None:
        super().__init__(_HIDDEN.sub(lambda found: f"\\u{ord(found[0]):04x}", message))


class UnknownNameError(IsophoteError, LookupError):
    """A node, parameter, input, option or look that does not exist; the message names the nearest."""


class InvalidValueError(IsophoteError, ValueError):
    """A value, connection, file or picture that cannot be."""


class UnsupportedError(IsophoteError, NotImplementedError):
    """Something that the library does not do."""


class DeviceError(IsophoteError, RuntimeError):
    """There is no graphics device, or it failed."""


class OutOfMemoryError(IsophoteError, MemoryError):
    """The system does not give the memory or the threads needed."""


class InternalError(IsophoteError, RuntimeError):
    """A mistake of the library's or of this package's; please report it."""


# By the numbers of `ISOPHOTE_ERROR_...` in isophote.h.
_CLASSES: dict[int, type[IsophoteError]] = {
    1: InvalidValueError,
    2: InternalError,
    3: UnknownNameError,
    4: InvalidValueError,
    5: InvalidValueError,
    6: InvalidValueError,
    7: InvalidValueError,
    8: InvalidValueError,
    9: InvalidValueError,
    10: UnsupportedError,
    12: DeviceError,
    13: DeviceError,
    14: OutOfMemoryError,
    16: InternalError,
}


def of_status(status: int, message: str) -> IsophoteError:
    """The exception for a status of the library."""
    return _CLASSES.get(status, IsophoteError)(message)
