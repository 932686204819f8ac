"""The C face by ctypes, to compare with: no code of the package is used here."""

from __future__ import annotations

import ctypes as c
import re

import numpy as np
from conftest import ROOT

import isophote

_HEADER = (ROOT / "include/isophote.h").read_text(encoding="utf-8")
_SAMPLES = {"uint8": 0, "uint16": 1, "float16": 2, "float32": 3}


def _functions(table: str) -> list[str]:
    """Names of a table's functions, in order."""
    body = re.search(r"typedef struct " + table + r" \{(.*?)\n\} " + table + ";", _HEADER, re.S)
    assert body is not None
    return re.findall(r"\(ISOPHOTE_ABI \*(\w+)\)\(", re.sub(r"//.*", "", body[1]))


class Text(c.Structure):
    _fields_ = [("data", c.c_char_p), ("capacity", c.c_size_t), ("length", c.c_size_t)]


class Image(c.Structure):
    _fields_ = [
        ("data", c.c_void_p),
        ("row_stride", c.c_ssize_t),
        ("sample", c.c_uint32),
        ("channels", c.c_uint32),
        ("width", c.c_uint32),
        ("height", c.c_uint32),
        ("x", c.c_int32),
        ("y", c.c_int32),
    ]


class Input(c.Structure):
    _fields_ = [("name", c.c_char_p), ("image", Image)]


class Request(c.Structure):
    _fields_ = [
        ("width", c.c_uint32),
        ("height", c.c_uint32),
        ("scale", c.c_float),
        ("space", c.c_uint32),
        ("alpha", c.c_uint32),
        ("guides", c.c_uint32),
        ("origin_x", c.c_double),
        ("origin_y", c.c_double),
        ("frame", c.c_int64),
        ("reference_height", c.c_uint32),
        ("canonical_height", c.c_uint32),
    ]


ASK = c.CFUNCTYPE(c.c_int32, c.c_void_p, c.c_char_p, c.c_int64, c.POINTER(Image))


class Frames(c.Structure):
    _fields_ = [("user", c.c_void_p), ("input", ASK), ("release", c.c_void_p)]


def image(array: np.ndarray) -> Image:
    """An array, whose rows hold pixels one after the other, as the header has it."""
    height, width, channels = array.shape
    sample = _SAMPLES[array.dtype.name]
    return Image(array.ctypes.data, array.strides[0], sample, channels, width, height, 0, 0)


class Face:
    """The library's table."""

    def __init__(self) -> None:
        library = c.CDLL(str(isophote.native.library_path()))
        library.isophote_api.restype = c.c_void_p
        self._table = library.isophote_api(1)
        self._names = _functions("IsophoteApi")

    def call(self, name: str, *arguments: object) -> int:
        """Calls a function of the table; its status."""
        # Two numbers of 32 bits and a pointer come first.
        address = c.c_void_p.from_address(self._table + 16 + 8 * self._names.index(name)).value
        return c.CFUNCTYPE(c.c_uint32)(address)(*arguments)

    def call_pointer(self, name: str, *arguments: object) -> int:
        """Calls a function of the table that returns a pointer."""
        address = c.c_void_p.from_address(self._table + 16 + 8 * self._names.index(name)).value
        return c.CFUNCTYPE(c.c_void_p)(address)(*arguments)

    def graph(self, node: str, **params: str) -> c.c_uint64:
        """A graph of one node."""
        graph = c.c_uint64()
        error = Text(c.cast(c.create_string_buffer(500), c.c_char_p), 500, 0)
        if self.call("graph_create_single", node.encode(), c.byref(error), c.byref(graph)):
            raise AssertionError(error.data)
        for name, text in params.items():
            assert self.call("graph_set_text", graph, 0, name.encode(), text.encode()) == 0, self.message(graph)
        return graph

    def message(self, graph: c.c_uint64) -> str:
        """The last failure of a graph."""
        buffer = c.create_string_buffer(2000)
        self.call("graph_error", graph, c.byref(Text(c.cast(buffer, c.c_char_p), 2000, 0)))
        return buffer.value.decode()

    def request(self, array: np.ndarray, **fields: float) -> Request:
        """A request for pictures of straight alpha."""
        request = Request()
        assert self.call("request_init", array.shape[1], array.shape[0], c.byref(request)) == 0
        request.alpha, request.reference_height = 1, 1080
        for name, value in fields.items():
            setattr(request, name, value)
        return request

    def apply(self, node: str, images: dict[str, np.ndarray], fields: dict[str, float], **params: str) -> np.ndarray:
        """Applies a node to images."""
        graph = self.graph(node, **params)
        color = images["color"]
        out = np.empty_like(color, order="C")
        inputs = (Input * len(images))(*(Input(name.encode(), image(array)) for name, array in images.items()))
        request, target = self.request(color, **fields), image(out)
        device = c.c_uint64(0)
        status = self.call("process", graph, device, c.byref(request), inputs, len(images), None, c.byref(target), None, None)
        assert status == 0, self.message(graph)
        self.call("graph_destroy", graph)
        return out
