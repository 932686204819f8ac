"""Pictures of other libraries, and samples of other types than those that files mostly have."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import numpy as np
import pytest
from conftest import ROOT
from PIL import Image

import isophote
from isophote._pixels import pixels

CASES = ROOT / "tests/data/cases/python_modes"


class Tensor:
    """A tensor that offers DLPack alone, as those of other libraries may."""

    def __init__(self, array: np.ndarray, device: tuple[int, int] = (1, 0)) -> None:
        self.array = array
        self.device = device

    def __dlpack__(self, **options: Any) -> Any:
        return self.array.__dlpack__(**options)

    def __dlpack_device__(self) -> tuple[int, int]:
        return self.device


class OlderTensor(Tensor):
    """One that hands over DLPack of before version 1, as those of PyTorch do, and has a method for arrays."""

    def __dlpack__(self, **options: Any) -> Any:
        return self.array.__dlpack__()

    def numpy(self) -> np.ndarray:
        return self.array


def equal(a: np.ndarray, b: np.ndarray) -> bool:
    return a.shape == b.shape and a.dtype == b.dtype and np.array_equal(a, b)


def test_cases_of_pillow_are_what_they_show() -> None:
    palette = Image.open(CASES / "pal8.png")
    assert palette.mode == "P" and equal(pixels(palette, "color"), np.asarray(palette.convert("RGB")))
    ink = Image.open(CASES / "cmyk.jpg")
    assert ink.mode == "CMYK" and equal(pixels(ink, "color"), np.asarray(ink.convert("RGB")))
    # The note of the case says 35, 215, 225, 0 in ink.
    colours = [pixels(image, "color").reshape(-1, 3).astype(int) for image in (palette, ink)]
    assert all((np.abs(found - (220, 40, 30)).max(axis=1) <= 3).any() for found in colours)
    bits = Image.open(CASES / "bit1.png")
    found = pixels(bits, "color")
    assert bits.mode == "1" and found.dtype == np.uint8 and set(np.unique(found)) == {0, 255}


@pytest.mark.parametrize("mode", ["1", "L", "LA", "La", "P", "PA", "RGB", "RGBA", "RGBa", "RGBX", "CMYK", "YCbCr", "HSV"])
def test_results_are_those_of_the_same_colours(small: np.ndarray, mode: str) -> None:
    colours = Image.fromarray(small)
    if mode in ("La", "RGBa"):
        colours = colours.convert({"La": "LA", "RGBa": "RGBA"}[mode])
    image = colours.convert("P").convert("PA") if mode == "PA" else colours.convert(mode)
    shown = {"1": "L", "La": "LA", "PA": "RGBA", "RGBa": "RGBA", "L": "L", "LA": "LA", "RGBA": "RGBA"}.get(mode, "RGB")
    result = isophote.apply("gaussian", image)
    assert equal(result, isophote.apply("gaussian", np.asarray(image.convert(shown))))


def test_colours_that_count_as_transparent_are(small: np.ndarray) -> None:
    palette = Image.fromarray(small).convert("P")
    palette.info["transparency"] = 3
    assert equal(pixels(palette, "color"), np.asarray(palette.convert("RGBA")))
    grey = Image.fromarray(small).convert("L")
    grey.info["transparency"] = int(np.asarray(grey)[5, 5])
    result = isophote.apply("gaussian", grey)
    assert result.shape == (*small.shape[:2], 2) and (result[..., 1] < 255).any()


def test_deep_images_of_pillow_keep_their_depth(small: np.ndarray) -> None:
    deep = small[..., 1].astype(np.uint16) * 257
    expected = isophote.apply("gaussian", deep)
    for image in (Image.fromarray(deep), Image.fromarray(deep.astype(np.int32))):
        assert equal(isophote.apply("gaussian", image), expected), image.mode
    assert equal(pixels(Image.fromarray(deep.astype(">u2")), "color"), deep[..., None])
    light = deep.astype(np.float32) / np.float32(65535)
    assert equal(isophote.apply("gaussian", Image.fromarray(light)), isophote.apply("gaussian", light))
    with pytest.raises(isophote.InvalidValueError, match="mode 'I' with numbers from"):
        isophote.apply("gaussian", Image.fromarray(deep.astype(np.int32) * 9))


def test_palettes_that_number_objects_are_numbers(small: np.ndarray) -> None:
    numbers = np.zeros(small.shape[:2], np.uint8)
    numbers[:, 50:] = 2
    image = Image.fromarray(numbers)
    image.putpalette([9, 9, 9, 8, 8, 8, 9, 9, 9])
    expected = isophote.apply("cartoon", small, object_id=numbers, lengths="pixels")
    assert image.mode == "P" and equal(isophote.apply("cartoon", small, object_id=image, lengths="pixels"), expected)
    assert equal(pixels(numbers > 0, "object_id"), (numbers > 0).astype(np.uint8)[..., None])


def test_true_is_white(small: np.ndarray) -> None:
    bits = small[..., 1] > 90
    white = bits.astype(np.uint8) * np.uint8(255)
    for name in ("color", "mask", "flow"):
        assert equal(pixels(bits, name), white[..., None])
    result = isophote.apply("gaussian", bits)
    assert result.dtype == np.uint8 and equal(result, isophote.apply("gaussian", white))
    rgb = np.dstack([bits, ~bits, bits])
    assert equal(isophote.apply("cartoon", rgb), isophote.apply("cartoon", rgb.astype(np.uint8) * np.uint8(255)))


@pytest.mark.parametrize("dtype", [np.uint16, np.float16, np.float32])
def test_pictures_may_be_big_endian_and_read_only(small: np.ndarray, dtype: type) -> None:
    image = small.astype(dtype) / dtype(1 if dtype is np.uint16 else 255)
    image = image.astype(dtype)
    expected = isophote.apply("gaussian", image)
    swapped = image.astype(image.dtype.newbyteorder())
    for each in (image, swapped):
        each.flags.writeable = False
        assert equal(isophote.apply("gaussian", each), expected)
    assert np.shares_memory(pixels(image, "color"), image)
    out = np.zeros_like(swapped)
    assert isophote.apply("gaussian", image, out=out) is out and np.array_equal(out, expected)


@pytest.mark.parametrize("dtype", [np.bool_, np.uint8, np.uint16, np.float16, np.float32])
def test_tensors_are_read_where_they_lie(small: np.ndarray, dtype: type) -> None:
    image = (small > 90) if dtype is np.bool_ else (small / (255 if dtype in (np.float16, np.float32) else 1)).astype(dtype)
    expected = isophote.apply("gaussian", image)
    assert equal(isophote.apply("gaussian", Tensor(image)), expected)
    assert np.shares_memory(pixels(Tensor(image), "color"), image) == (dtype is not np.bool_)
    planes = np.ascontiguousarray(np.moveaxis(image, -1, 0))
    assert equal(isophote.apply("gaussian", Tensor(np.moveaxis(planes, 0, -1))), expected)


def test_tensors_take_results_and_are_guides(small: np.ndarray) -> None:
    expected = isophote.apply("cartoon", small)
    out = Tensor(np.zeros_like(small))
    assert isophote.apply("cartoon", Tensor(small), out=out) is out and equal(out.array, expected)
    older = OlderTensor(np.zeros_like(small))
    assert not np.from_dlpack(older).flags.writeable
    assert isophote.apply("cartoon", small, out=older) is older and equal(older.array, expected)
    depth = np.linspace(1, 9, small.shape[1], dtype=np.float32) * np.ones((small.shape[0], 1), np.float32)
    given = isophote.apply("cartoon", Tensor(small), depth=Tensor(depth), lengths="pixels")
    assert equal(given, isophote.apply("cartoon", small, depth=depth, lengths="pixels"))
    sequence = isophote.Sequence("gaussian", lambda name, frame: Tensor(small))
    assert equal(sequence.frame(3), isophote.apply("gaussian", small))
    vectors = np.ones((*small.shape[:2], 2), np.float32)
    moved = [isophote.motion(each)["motion"] for each in (vectors, Tensor(vectors))]
    assert equal(*moved)


def test_each_picture_of_a_batch_is_computed_by_itself(small: np.ndarray) -> None:
    batch = np.stack([small, small[::-1], small[:, ::-1]])
    depths = np.stack([np.full(small.shape[:2], n, np.float32) for n in (1, 2, 3)])
    depths[1, :, 40:] = 9
    expected = np.stack(
        [isophote.apply("cartoon", image, depth=depth, lengths="pixels") for image, depth in zip(batch, depths)]
    )
    assert not np.array_equal(expected[1], isophote.apply("cartoon", batch[1], lengths="pixels"))
    for given in (batch, Tensor(batch)):
        for guide in (depths, depths[..., None], Tensor(depths)):
            assert equal(isophote.apply("cartoon", given, depth=guide, lengths="pixels"), expected)
    out = np.zeros_like(batch)
    assert isophote.apply("cartoon", batch, depth=depths, lengths="pixels", out=out) is out and equal(out, expected)
    of_all = isophote.apply("cartoon", batch, depth=depths[1], lengths="pixels")
    assert equal(of_all[1], expected[1]) and not np.array_equal(of_all[0], expected[0])


WRONG: dict[str, tuple[Any, dict[str, Any], str]] = {
    "planes": (np.zeros((3, 40, 50), np.float32), {}, "channels come last: use permute(1, 2, 0)"),
    "batch of planes": (np.zeros((2, 3, 40, 50), np.float32), {}, "use permute(0, 2, 3, 1)"),
    "no picture": (np.zeros((0, 40, 50, 3), np.float32), {}, "batch of no picture"),
    "five dimensions": (np.zeros((1, 1, 40, 50, 3), np.float32), {}, "perhaps channels, and batches"),
    "another number": (np.zeros((2, 40, 50, 3), np.uint8), {"mask": np.zeros((3, 40, 50, 1), np.uint8)}, "batch of 3"),
    "batch of guides": (np.zeros((40, 50, 3), np.uint8), {"mask": np.zeros((1, 40, 50, 1), np.uint8)}, "give one picture"),
    "device": (Tensor(np.zeros((9, 9, 3), np.float32), (2, 0)), {}, "memory of a device; copy it to the CPU's"),
    "double": (Tensor(np.zeros((9, 9, 3))), {}, "float64"),
    "out": (np.zeros((9, 9, 3), np.uint8), {"out": "there.png"}, "out is no array"),
    "out of one": (np.zeros((2, 9, 9, 3), np.uint8), {"out": np.zeros((1, 9, 9, 3), np.uint8)}, "and the batch (2, 9"),
}


@pytest.mark.parametrize("what", WRONG)
def test_other_layouts_are_told(what: str) -> None:
    image, others, words = WRONG[what]
    with pytest.raises(isophote.InvalidValueError) as raised:
        isophote.apply("gaussian", image, **others)
    assert words in str(raised.value)


def test_pillow_is_not_needed() -> None:
    code = "import sys; sys.modules['PIL'] = None; import isophote, numpy; isophote.apply('gaussian', numpy.zeros((9, 9, 3), 'u1'))"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_tensors_of_torch_are_taken(small: np.ndarray) -> None:
    torch = pytest.importorskip("torch")
    tensor = torch.from_numpy(small.copy())
    expected = isophote.apply("gaussian", small)
    assert equal(isophote.apply("gaussian", tensor), expected)
    assert isophote.apply("gaussian", tensor, out=tensor) is tensor and equal(tensor.numpy(), expected)
    with pytest.raises(isophote.InvalidValueError, match="cannot be read as a DLPack tensor"):
        isophote.apply("gaussian", tensor.float().requires_grad_())


def test_materials_of_any_size_are_tiled(small):
    paper = np.ones((7, 5, 3), np.float32)
    paper[:3, :2] = 0.5
    rows, columns = (np.arange(length) % own for length, own in zip(small.shape[:2], paper.shape[:2]))
    whole = paper[rows[:, None], columns]
    tiled = isophote.apply("watercolor", small, paper=paper)
    assert np.array_equal(tiled, isophote.apply("watercolor", small, paper=whole))
    assert not np.array_equal(tiled, isophote.apply("watercolor", small))
    with pytest.raises(isophote.errors.IsophoteError):
        isophote.apply("watercolor", small, control=paper)


def test_lines_have_the_colours_that_are_painted(small):
    plain = isophote.apply("blueprint", small, grid=0)
    clear = np.zeros((*small.shape[:2], 4), np.float32)
    assert np.allclose(isophote.apply("blueprint", small, grid=0, line_paint=clear), plain, atol=1e-5)
    green = np.zeros(small.shape, np.float32)
    green[..., 1] = 1
    painted = isophote.apply("blueprint", small, grid=0, line_paint=green)
    # Lines were white: red goes where they are, and nothing comes.
    assert (painted[..., 0] <= plain[..., 0] + 1e-5).all() and (plain[..., 0] - painted[..., 0]).max() > 0.2


def test_a_control_map_without_alpha_leaves_the_medium_alone(small):
    """Its alpha is the strength of the medium, and what is missing there changes nothing."""
    plain = isophote.apply("ink", small)
    for channels in (3, 4):
        neutral = np.full((*small.shape[:2], channels), 0.5, np.float32)
        assert np.array_equal(isophote.apply("ink", small, control=neutral), plain)
    painted = np.dstack([neutral[..., :3], np.ones(small.shape[:2], np.float32)])
    assert not np.array_equal(isophote.apply("ink", small, control=painted), plain)
