"""Frames of sequences."""

from __future__ import annotations

import ctypes as c
import weakref
from collections.abc import Iterator

import numpy as np
import pytest
from c_face import ASK, Face, Frames, image

import isophote

COUNT = 6
STEP = 3


@pytest.fixture(scope="module")
def footage(scene: np.ndarray) -> dict[int, np.ndarray]:
    """The scene from a camera that moves to the right, with noise of its own in each frame."""
    noise = np.random.default_rng(5)

    def frame(n: int) -> np.ndarray:
        view = scene[10:90, 20 + STEP * n : 150 + STEP * n].astype(float)
        return np.clip(view + noise.normal(0, 14, view.shape), 0, 255).astype(np.uint8)

    return {n: frame(n) for n in range(1, COUNT + 1)}


@pytest.fixture(scope="module")
def motion(footage: dict[int, np.ndarray]) -> np.ndarray:
    """Where things were in the frame before: further right."""
    vectors = np.zeros((*footage[1].shape[:2], 2), np.float32)
    vectors[..., 0] = STEP
    return vectors


def by_c(footage: dict[int, np.ndarray], motion: np.ndarray, number: int, **params: str) -> np.ndarray:
    """A frame of the C face's sequence."""
    face = Face()
    graph = face.graph("cartoon", **params)
    extension = face.call_pointer("extension", b"isophote.sequence/1")
    functions = [c.c_void_p.from_address(extension + 8 * (1 + n)).value for n in range(7)]
    create, process = functions[1], functions[5]
    sequence = c.c_uint64()
    assert c.CFUNCTYPE(c.c_uint32)(create)(c.c_uint64(1 << 28), c.c_float(0), None, c.byref(sequence)) == 0

    @ASK
    def ask(_: object, name: bytes, frame: int, out: object) -> int:
        if frame not in footage:
            return 0
        out[0] = image(footage[frame] if name == b"color" else motion)
        return 1

    out = np.empty_like(footage[number])
    request, target = face.request(out, guides=32, frame=number), image(out)
    frames = Frames(None, ask, None)
    status = c.CFUNCTYPE(c.c_uint32)(process)(
        sequence, graph, c.c_uint64(0), c.byref(request), c.byref(frames), None, c.byref(target), None, None
    )
    assert status == 0
    return out


def test_frames_are_those_of_the_c_face_in_any_order(footage: dict[int, np.ndarray], motion: np.ndarray) -> None:
    expected = {n: by_c(footage, motion, n, steadiness="1", posterize="6") for n in footage}
    motions = {n: motion for n in footage}
    sequence = isophote.Sequence("cartoon", {"color": footage, "motion": motions}, steadiness=1, posterize=6)
    for number in [4, 1, 6, 2, 3, 5, 4]:
        assert np.array_equal(sequence.frame(number), expected[number]), number
    in_order = isophote.frames("cartoon", footage.values(), motion=motions.values(), steadiness=1, posterize=6)
    for number, result in enumerate(in_order, 1):
        assert np.array_equal(result, expected[number]), number
    assert number == COUNT


def test_motion_makes_frames_steady(footage: dict[int, np.ndarray], motion: np.ndarray) -> None:
    def flicker(results: list[np.ndarray]) -> float:
        pairs = zip(results, results[1:])
        return float(np.mean([np.abs(a[:, STEP:].astype(float) - b[:, :-STEP]).mean() for a, b in pairs]))

    motions = [motion] * COUNT
    # Noise, which this footage is, has no areas.
    plain = list(isophote.frames("cartoon", footage.values(), motion=motions, steps="levels"))
    steady = list(isophote.frames("cartoon", footage.values(), motion=motions, steps="levels", steadiness=1))
    assert flicker(steady) < 0.85 * flicker(plain)
    alone = [isophote.apply("cartoon", picture, frame=n, steps="levels") for n, picture in footage.items()]
    assert all(np.array_equal(a, b) for a, b in zip(plain, alone))


def test_only_what_is_looked_at_is_read_ahead_and_kept(footage: dict[int, np.ndarray]) -> None:
    given: list[weakref.ref[np.ndarray]] = []

    def pictures() -> Iterator[np.ndarray]:
        for picture in footage.values():
            copy = picture.copy()
            given.append(weakref.ref(copy))
            yield copy

    style = isophote.Style("cartoon", steadiness=1, window=1)
    past, future = style.frames
    for number, _ in enumerate(isophote.frames(style, pictures(), first=101), 1):
        assert len(given) == min(number + future, COUNT)
        assert sum(picture() is not None for picture in given) <= past + 1 + future
    assert (past, future) == (1, 1) and number == COUNT


def test_what_the_source_raises_is_raised(footage: dict[int, np.ndarray]) -> None:
    def source(name: str, frame: int) -> np.ndarray:
        if frame == 4:
            raise OSError("the disk is gone")
        return footage[frame]

    sequence = isophote.Sequence("cartoon", source, steadiness=1)
    with pytest.raises(OSError, match="the disk is gone"):
        sequence.frame(3)
    with pytest.raises(OSError, match="the disk is gone"):
        sequence.frame(4)
    whole = isophote.Sequence("cartoon", {"color": footage}, steadiness=1)
    repaired = isophote.Sequence("cartoon", lambda name, frame: footage.get(frame), steadiness=1)
    assert np.array_equal(repaired.frame(3), whole.frame(3))
    with pytest.raises(IndexError, match="no frame 9"):
        whole.frame(9)


def test_presets_change_from_frame_to_frame_in_sequences(footage: dict[int, np.ndarray]) -> None:
    preset = {"style": "cartoon", "parameters": {"posterize": {"1": 3, "6": 8}}}
    for number, result in enumerate(isophote.frames(preset, footage.values()), 1):
        expected = isophote.apply("cartoon", footage[number], posterize=number + 2, frame=number)
        assert np.array_equal(result, expected), number


def test_motion_vectors_of_renderers_are_understood() -> None:
    vector = np.arange(24, dtype=np.float32).reshape(2, 3, 4)
    x, y, z, w = np.moveaxis(vector, -1, 0)
    found = isophote.motion(vector, convention="blender")
    assert np.array_equal(found["motion"], np.dstack([x, -y]))
    assert np.array_equal(found["motion_forward"], np.dstack([-z, w]))
    arnold = isophote.motion(vector[:, ::-1, :2], convention="arnold,y=down")
    assert np.array_equal(arnold["motion_forward"], vector[:, ::-1, :2])
    assert np.array_equal(arnold["motion"], -vector[:, ::-1, :2])
    own = isophote.motion(vector[..., :2], vector[..., 2:])
    assert np.array_equal(own["motion"], np.dstack([x, -y])) and np.array_equal(own["motion_forward"], np.dstack([z, -w]))
    with pytest.raises(isophote.InvalidValueError, match="no convention"):
        isophote.motion(vector, convention="cinema")
    with pytest.raises(ValueError, match="too few channels"):
        isophote.motion(vector[..., :1])
    with pytest.raises(ValueError, match="one size"):
        isophote.motion(vector[..., :2], vector[:1, :, :2])


def test_colors_of_neighbours_are_in_the_same_space(footage: dict[int, np.ndarray], motion: np.ndarray) -> None:
    wanted = {"steadiness": 0.5, "color_space": "linear"}
    floats = {n: (frame / 255).astype(np.float32) for n, frame in footage.items()}
    # Light of Rec.2020 of the same colours, by the matrix of Rec. ITU-R BT.2087.
    matrix = np.float32([[0.6274, 0.3293, 0.0433], [0.0691, 0.9195, 0.0114], [0.0164, 0.0880, 0.8956]])
    wide = {n: frame @ matrix.T for n, frame in floats.items()}
    paths = {"motion": {n: motion for n in footage}}
    plain = isophote.Sequence("oil_paint", {"color": floats, **paths}, **wanted).frame(3)
    same = isophote.Sequence("oil_paint", {"color": wide, **paths}, **{**wanted, "color_space": "rec2020"}).frame(3)
    assert np.abs(same - plain @ matrix.T).mean() < 3e-3
    still = isophote.apply("oil_paint", wide[3], color_space="rec2020")
    assert not np.array_equal(same, still)
