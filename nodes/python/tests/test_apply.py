"""Pictures of all formats and layouts, and what is computed of them."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from c_face import Face
from PIL import Image

import isophote
from isophote._pixels import pixels

FORMATS = [np.uint8, np.uint16, np.float16, np.float32]


def converted(image: np.ndarray, dtype: type) -> np.ndarray:
    """A picture of 8 bits in another format."""
    if dtype in (np.float16, np.float32):
        return (image / 255).astype(dtype)
    return image.astype(dtype) * (257 if dtype is np.uint16 else 1)


def with_alpha(image: np.ndarray) -> np.ndarray:
    """The picture with an alpha that has every value."""
    rows, columns = np.indices(image.shape[:2])
    return np.dstack([image, ((rows * 7 + columns * 5) % 256).astype(np.uint8)])


LAYOUTS = {
    "as it is": (lambda a: a, True),
    "rows upwards": (lambda a: a[::-1], True),
    "every second row": (lambda a: a[::2], True),
    "columns cut": (lambda a: a[:, 5:-9], True),
    "columns mirrored": (lambda a: a[:, ::-1], False),
    "channels reversed": (lambda a: a[..., ::-1], False),
    "every third column": (lambda a: a[:, ::3], False),
    "columns first": (lambda a: np.asfortranarray(a), False),
    "one row for all": (lambda a: np.broadcast_to(a[3], a.shape), False),
    "one column": (lambda a: a[:, 4:5], True),
}


@pytest.mark.parametrize("dtype", FORMATS)
@pytest.mark.parametrize("channels", [1, 3, 4])
def test_results_are_those_of_the_c_face_to_the_bit(small: np.ndarray, dtype: type, channels: int) -> None:
    image = np.ascontiguousarray(converted(with_alpha(small), dtype)[:, :, :channels])
    expected = Face().apply("cartoon", {"color": image}, {}, posterize="6", detail="0.4")
    result = isophote.apply("cartoon", image, posterize=6, detail=0.4)
    assert result.dtype == image.dtype and result.tobytes() == expected.tobytes()
    assert not np.array_equal(result, image)


@pytest.mark.parametrize("dtype", FORMATS)
@pytest.mark.parametrize("layout", LAYOUTS)
def test_layouts_make_no_difference_and_are_copied_only_where_they_must(small: np.ndarray, dtype: type, layout: str) -> None:
    change, is_taken = LAYOUTS[layout]
    image = change(converted(small, dtype))
    before = image.copy()
    assert np.shares_memory(pixels(image, "color"), image) == is_taken
    result = isophote.apply("gaussian", image, sigma=4, lengths="pixels")
    expected = Face().apply("gaussian", {"color": np.ascontiguousarray(image)}, {"reference_height": 0}, sigma="4")
    assert np.array_equal(result, expected) and np.array_equal(image, before)


@pytest.mark.parametrize("layout", [layout for layout in LAYOUTS if layout != "one row for all"])
def test_results_go_where_they_are_wanted(small: np.ndarray, layout: str) -> None:
    change, _ = LAYOUTS[layout]
    whole = np.zeros((*small.shape[:2], 3), np.float32)
    out = change(whole)
    image = np.ascontiguousarray(change(small))
    assert isophote.apply("gaussian", image, out=out) is out
    same = image.astype(np.float32) / np.float32(255)
    assert np.array_equal(out, Face().apply("gaussian", {"color": same}, {}))
    if not np.shares_memory(out, whole):
        return
    untouched = np.ones(whole.shape, bool)
    change(untouched)[...] = False
    assert not whole[untouched].any()


def test_a_picture_may_be_its_own_result(small: np.ndarray) -> None:
    image = small.copy()
    expected = isophote.apply("cartoon", image)
    assert isophote.apply("cartoon", image, out=image) is image
    assert np.array_equal(image, expected)


def test_other_byte_orders_are_understood(small: np.ndarray) -> None:
    image = converted(small, np.uint16)
    swapped = image.astype(image.dtype.newbyteorder(">" if image.dtype.newbyteorder("=").str[0] == "<" else "<"))
    assert np.array_equal(isophote.apply("kuwahara", swapped), isophote.apply("kuwahara", image))


def test_grey_pictures_stay_grey_with_their_alpha(small: np.ndarray) -> None:
    grey = small[:, :, 1]
    both = with_alpha(small)[:, :, [1, 3]]
    assert isophote.apply("gaussian", grey).shape == grey.shape
    result = isophote.apply("gaussian", both)
    assert result.shape == both.shape and result.dtype == both.dtype
    expected = isophote.apply("gaussian", np.dstack([both[..., 0]] * 3 + [both[..., 1]]))
    assert np.array_equal(result, expected[..., [0, 3]])


def test_guides_reach_the_nodes_that_read_them(small: np.ndarray) -> None:
    height, width = small.shape[:2]
    left = np.arange(width) < width // 2
    object_id = np.broadcast_to(np.where(left, 1, 2), (height, width))
    depth = np.broadcast_to(np.where(left, 1.0, 4.0), (height, width)).astype(np.float32)
    normal = np.zeros((height, width, 3), np.float32)
    normal[..., 2] = 1
    images = {
        "color": small,
        "normal": normal,
        "depth": np.ascontiguousarray(depth)[:, :, None],
        "object_id": np.ascontiguousarray(object_id, np.float32)[:, :, None],
    }
    guides = {"normal": normal, "depth": depth, "lengths": "pixels"}
    result = isophote.apply("cartoon", small, object_id=object_id, **guides)
    assert np.array_equal(result, Face().apply("cartoon", images, {"reference_height": 0}))
    plain = isophote.apply("cartoon", small, lengths="pixels")
    changed = (result != plain).any(axis=(0, 2))
    assert changed[width // 2 - 1 : width // 2 + 1].all(), "there is a line where things meet"
    for dtype in (np.uint8, np.int64, np.float32):
        again = isophote.apply("cartoon", small, object_id=object_id.astype(dtype), **guides)
        assert np.array_equal(again, result), dtype


def test_a_mask_says_where(small: np.ndarray) -> None:
    mask = np.zeros(small.shape[:2], bool)
    mask[:, 40:] = True
    result = isophote.apply("cartoon", small, mask=mask, mix=1.0)
    assert np.array_equal(result[:, :40], small[:, :40])
    assert np.array_equal(result[:, 40:], isophote.apply("cartoon", small)[:, 40:])


def test_spaces_and_alpha_are_the_requests(small: np.ndarray) -> None:
    image = converted(with_alpha(small), np.float32)
    for space, number in [("srgb", 0), ("linear", 1), ("acescg", 2)]:
        for alpha, relation in [("straight", 1), ("premultiplied", 0), ("emissive", 2)]:
            fields = {"space": number, "alpha": relation, "frame": 7, "origin_x": 3.5, "scale": 0.5}
            expected = Face().apply("ink", {"color": image}, fields, hold="2")
            result = isophote.apply(
                "ink",
                image,
                color_space=space,
                alpha_mode=alpha,
                frame=7,
                origin=(3.5, 0),
                scale=0.5,
                hold=2,
            )
            assert np.array_equal(result, expected), (space, alpha)


SPACES = [
    "p3",
    "rec2020",
    "aces2065-1",
    "display-p3",
    "encoded-rec709",
    "encoded-rec2020",
    "adobe-rgb",
    "rec2100-pq",
    "rec2100-hlg",
]
"""Spaces in which the library does not compute."""


@pytest.mark.parametrize("space", SPACES)
def test_other_spaces_are_those_of_the_host(small: np.ndarray, host: Path, tmp_path: Path, space: str) -> None:
    image = with_alpha(small)
    given, made = tmp_path / "given.png", tmp_path / "made.png"
    Image.fromarray(image).save(given)
    command = [host, "apply", "cartoon", given, made, "--space", space, "--backend", "cpu"]
    subprocess.run(command, check=True, env={**os.environ, "NODEVICE_SELECT": "1"}, stdout=subprocess.DEVNULL)
    # Light, PQ and HLG have 16 bits there, of which Pillow shows the upper ones.
    expected = np.asarray(Image.open(made)).astype(int)
    result = isophote.apply("cartoon", image, color_space=space)
    assert result.dtype == np.uint8 and np.abs(result - expected).max() <= 1
    assert not np.array_equal(result, isophote.apply("cartoon", image))


@pytest.mark.parametrize("space", SPACES)
def test_other_spaces_come_back_as_they_were(small: np.ndarray, space: str) -> None:
    seen = with_alpha(small)
    seen[seen[..., 3] == 0] = 0
    for dtype in FORMATS:
        image = converted(seen, dtype)
        for picture in (image, image[..., :3], image[..., 0]):
            result = isophote.apply("cartoon", picture, mix=0.0, color_space=space)
            near = 1e-3 if dtype in (np.float16, np.float32) else 255 if space.startswith("rec2100") else 4
            assert result.shape == picture.shape and result.dtype == dtype
            assert np.abs(result.astype(float) - picture).max() <= (0 if dtype is np.uint8 else near), dtype
    colors = converted(seen, np.float32)
    colors[..., :3] *= colors[..., 3:]
    back = isophote.apply("cartoon", colors, mix=0.0, color_space=space, alpha_mode="premultiplied")
    assert np.abs(back - colors).max() < 1e-3


def test_spaces_have_aliases_and_results_a_place(small: np.ndarray) -> None:
    result = isophote.apply("cartoon", small, color_space="p3")
    out = np.empty_like(small)[::-1]
    assert isophote.apply("cartoon", small, color_space="linear-p3", out=out) is out
    assert np.array_equal(out, result)
    assert np.array_equal(
        isophote.apply("cartoon", small, color_space="rec709"), isophote.apply("cartoon", small, color_space="linear")
    )
    lines = isophote.apply("flow_dog", small, color_space="p3")
    assert lines.shape == small.shape[:2] and lines.dtype == np.uint8


def test_other_kinds_of_results_have_their_own_shapes(small: np.ndarray) -> None:
    height, width = small.shape[:2]
    assert isophote.apply("flow_dog", small).shape == (height, width)
    assert isophote.apply("flow_dog", small).dtype == np.uint8
    tensor = isophote.apply("structure_tensor", small)
    assert tensor.shape == (height, width, 4) and tensor.dtype == np.float32 and (tensor[..., 0] >= 0).all()
    motion = isophote.apply("optical_flow", small)
    assert motion.shape == (height, width, 2) and motion.dtype == np.float32


def test_every_node_is_a_function_and_does_something(small: np.ndarray) -> None:
    for id, node in isophote.catalogue().items():
        function = getattr(isophote.nodes, id)
        assert node.doc.split(".")[0][:40] in " ".join(function.__doc__.split())
        result = function(small, lengths="pixels")
        assert result.shape[:2] == small.shape[:2], id
        if node.output.kind == "color" and id not in ("steady", "flow_map"):
            assert not np.array_equal(result, small), id
        params = {param.id: param.default for param in node.params}
        assert np.array_equal(function(small, lengths="pixels", **params), result), id
    assert set(isophote.nodes.__all__) <= set(dir(isophote.nodes))


def test_a_device_agrees_with_the_cpu(small: np.ndarray) -> None:
    device = isophote.Device()
    assert device.name
    cpu = isophote.apply("cartoon", small, posterize=6)
    for given in (device, "gpu"):
        gpu = isophote.apply("cartoon", small, posterize=6, device=given)
        assert np.mean(np.abs(gpu.astype(int) - cpu) > 1) < 0.01
    half = isophote.apply("cartoon", small, posterize=6, device=device, precision="half")
    assert np.mean(np.abs(half.astype(int) - cpu) > 4) < 0.02
    with pytest.raises(isophote.DeviceError, match="no such card"):
        isophote.apply("cartoon", small, device="no such card")
