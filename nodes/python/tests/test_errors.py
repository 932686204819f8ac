"""What goes wrong: the library's own sentences, as exceptions."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from c_face import Face

import isophote


@pytest.mark.parametrize(
    ("name", "text", "kind"),
    [
        ("posterise", "6", LookupError),
        ("posterize", "900", ValueError),
        ("posterize", "many", ValueError),
        ("abstraction", "ful", LookupError),
    ],
)
def test_sentences_are_those_of_the_c_face(small: np.ndarray, name: str, text: str, kind: type) -> None:
    face = Face()
    graph = face.graph("cartoon")
    assert face.call("graph_set_text", graph, 0, name.encode(), text.encode()) != 0
    with pytest.raises(kind) as raised:
        isophote.apply("cartoon", small, **{name: text})
    # How to mend it follows.
    assert str(raised.value) == f"{face.message(graph)}; see the parameters of 'cartoon'"
    assert isinstance(raised.value, isophote.IsophoteError)


COLUMN = np.zeros((63, 1), np.float32)

WRONG: dict[str, tuple[Callable[[np.ndarray], object], type[Exception], str]] = {
    "node": (lambda i: isophote.apply("cartoun", i), isophote.UnknownNameError, "did you mean 'cartoon'"),
    "look": (lambda i: isophote.apply("look:coperplate", i), isophote.UnknownNameError, "look:copperplate"),
    "numbers": (lambda i: isophote.apply("cartoon", i.astype(float)), ValueError, "float64"),
    "signs": (lambda i: isophote.apply("cartoon", i.astype(np.int16)), ValueError, "int16"),
    "path": (lambda i: isophote.apply("cartoon", "photo.png"), ValueError, "Image.open"),
    "nothing": (lambda i: isophote.apply("cartoon", None), ValueError, "shape"),
    "list": (lambda i: isophote.apply("cartoon", [[["a"]]]), ValueError, "numbers of type"),
    "empty": (lambda i: isophote.apply("cartoon", i[:0]), ValueError, "has no pixel"),
    "channels": (lambda i: isophote.apply("cartoon", np.dstack([i, i])), ValueError, "6 channels"),
    "size": (lambda i: isophote.apply("cartoon", i, depth=COLUMN), ValueError, "input image 'depth' holds 1x63"),
    "normals": (lambda i: isophote.apply("cartoon", i, normal=i), ValueError, "of f16 or f32"),
    "space": (lambda i: isophote.apply("cartoon", i, color_space="p4"), isophote.InvalidValueError, "'srgb' or 'linear'"),
    "no space": (lambda i: isophote.apply("cartoon", i, color_space="SRGB"), ValueError, "'aces2065-1' or 'display-p3'"),
    "alpha": (lambda i: isophote.apply("cartoon", i, alpha_mode="some"), isophote.InvalidValueError, "'straight' or"),
    "lengths": (lambda i: isophote.apply("cartoon", i, lengths="long"), ValueError, "relative or pixels"),
    "precision": (lambda i: isophote.apply("cartoon", i, precision="low"), isophote.InvalidValueError, "'exact' or"),
    "scale": (lambda i: isophote.apply("cartoon", i, scale=0.0), ValueError, "render scale"),
    "origin": (lambda i: isophote.apply("ink", i, origin=(1e9, 0)), ValueError, "origin must be"),
    "out": (lambda i: isophote.apply("cartoon", i, out=np.zeros((3, 4, 3), np.uint8)), ValueError, "63 rows"),
    "frozen": (
        lambda i: isophote.apply("cartoon", i, out=np.broadcast_to(i, i.shape)),
        isophote.InvalidValueError,
        "read-only",
    ),
    "value": (lambda i: isophote.apply("cartoon", i, detail={}), ValueError, "cannot be"),
    "zero": (lambda i: isophote.apply("cartoon", i, detail="a\0b"), ValueError, "zero character"),
    "graph": (lambda i: isophote.apply({"format": "isophote-graph"}, i), ValueError, "not a graph file"),
    "file": (lambda i: isophote.apply("none/there.json", i), OSError, "there.json"),
    "threads": (lambda i: isophote.apply("cartoon", i, threads=5000), ValueError, "1024"),
    "open style": (lambda i: isophote.apply(isophote.Style("ink"), i, tone=1), TypeError, "tone"),
}


@pytest.mark.parametrize("what", WRONG)
def test_mistakes_are_told(small: np.ndarray, what: str) -> None:
    mistake, kind, words = WRONG[what]
    with pytest.raises(kind) as raised:
        mistake(small)
    assert words in str(raised.value)


def test_arrays_that_claim_another_shape_are_not_believed(small: np.ndarray) -> None:
    class Liar(np.ndarray):
        @property
        def __array_interface__(self) -> dict:
            return {"data": (8, False), "shape": (9, 9, 3), "strides": None, "typestr": "|u1", "version": 3}

    liar = small.view(Liar)
    style = isophote.Style("gaussian")
    graph = style._graph
    request = isophote.style.Settings().request(small, ["color"], 0, style)
    out = np.empty_like(small)
    graph.process(request, {"color": liar}, out, None, 0, None)
    assert np.array_equal(out, isophote.apply("gaussian", small))
    for wrong in (small[:, ::2], small[..., ::-1], small[0], small.astype(float), small.tobytes(), None):
        with pytest.raises((TypeError, ValueError)):
            graph.process(request, {"color": wrong}, out, None, 0, None)


def test_a_function_that_is_told_of_progress_can_end_the_work(scene: np.ndarray) -> None:
    told: list[float] = []

    def stop(done: float) -> None:
        told.append(done)
        raise KeyError("enough")

    out = np.zeros_like(scene)
    with pytest.raises(KeyError, match="enough"):
        isophote.apply("coherent", scene, out=out, progress=stop)
    assert len(told) == 1 and not out.any()


def test_objects_at_work_refuse_calls_from_within(scene: np.ndarray) -> None:
    style = isophote.Style("cartoon")
    with pytest.raises(RuntimeError, match="called from within"):
        isophote.apply(style, scene, progress=lambda _: style.set("detail", 0.1))
    style.set("detail", 0.1)


ENDLESS = """
import signal, sys, numpy as np, isophote
# Programs that are started in the background ignore it otherwise.
signal.signal(signal.SIGINT, signal.default_int_handler)
image = np.random.default_rng(1).random((3000, 3000, 3), np.float32)
isophote.apply("coherent", image, progress=lambda done: print(done, flush=True))
print("done")
"""


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such signals")
def test_ctrl_c_ends_the_work() -> None:
    folder = str(Path(isophote.__file__).parents[1])
    environment = {**__import__("os").environ, "PYTHONPATH": folder}
    with subprocess.Popen(
        [sys.executable, "-c", ENDLESS], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline()
        process.send_signal(signal.SIGINT)
        output, error = process.communicate(timeout=300)
    assert process.returncode != 0 and "KeyboardInterrupt" in error and "done" not in output


def test_messages_hold_no_commands_to_terminals() -> None:
    hostile = "\x1b]0;title\x07\u202e"
    for style in (hostile, f"look:{hostile}", {"style": "gaussian", "parameters": {hostile: 1}}):
        with pytest.raises(isophote.IsophoteError) as caught:
            isophote.apply(style, np.zeros((4, 4, 3), np.float32))
        assert r"\u001b]0;title\u0007\u202e" in str(caught.value)
        assert str(caught.value).isprintable()
