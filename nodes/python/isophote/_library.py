"""The extension module, with the library loaded: the file that ISOPHOTE_LIBRARY names, or the one in this package."""

from __future__ import annotations

import sys
from pathlib import Path

from . import _native as native

_NAMES = {"win32": "isophote.dll", "darwin": "libisophote.dylib"}

native.load(Path(__file__).with_name(_NAMES.get(sys.platform, "libisophote.so")))

__all__ = ["native"]
