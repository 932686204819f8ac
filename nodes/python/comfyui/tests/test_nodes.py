"""The nodes, called as ComfyUI calls them. Its tensors are stood in for by arrays with the methods of them that nodes use."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from PIL import Image

import isophote

SCENE = Path(__file__).parents[4] / "tests/data/scene.png"


class Tensor(np.ndarray):
    """A tensor on the CPU."""

    device = "cpu"

    def cpu(self):
        return self

    def numpy(self):
        return self.view(np.ndarray)

    def new_empty(self, shape):
        return np.empty(shape, np.float32).view(Tensor)

    def clamp(self, low, high):
        return self.clip(low, high)

    def to(self, device):
        assert device == self.device
        return self


def tensor(array) -> Tensor:
    return np.ascontiguousarray(array, np.float32).view(Tensor)


@pytest.fixture
def batch() -> Tensor:
    """Two parts of the demo scene."""
    scene = np.asarray(Image.open(SCENE).convert("RGB")) / 255
    return tensor(np.stack([scene[20:84, 30:150], scene[30:94, 60:180]]))


def run(pack: ModuleType, name: str, image, **values):
    """The result of a node whose other widgets are as they are first shown."""
    node = pack.NODE_CLASS_MAPPINGS[name]
    shown = {}
    for widget, (kind, told) in node.INPUT_TYPES()["required"].items():
        if isinstance(kind, list):
            shown[widget] = told.get("default", kind[0])
            assert shown[widget] in kind
        elif kind != "IMAGE":
            shown[widget] = told["default"]
            assert kind not in ("INT", "FLOAT") or told["min"] <= told["default"] <= told["max"]
    assert node.RETURN_TYPES == ("IMAGE",)
    (result,) = getattr(node(), node.FUNCTION)(image=image, **{**shown, **values})
    assert type(result) is type(image) and result.shape == image.shape
    assert result.min() >= 0 and result.max() <= 1
    return result.numpy()


def applied(style, image, /, **params):
    result = isophote.apply(style, image.numpy(), **params)
    return np.clip(result, 0, 1)


def test_nodes_follow_from_the_catalogue(pack, batch):
    names = pack.NODE_DISPLAY_NAME_MAPPINGS
    assert names.keys() == pack.NODE_CLASS_MAPPINGS.keys() and len(set(names.values())) == len(names)
    styles = {node.id for node in isophote.catalogue().values() if node.group == "styles"}
    assert len(styles) == 8 and {f"isophote_{style}" for style in styles} | {"isophote_look", "isophote_preset"} <= set(names)
    for name, node in pack.NODE_CLASS_MAPPINGS.items():
        assert node.DESCRIPTION and node.CATEGORY.startswith("Isophote")
        if name not in ("isophote_look", "isophote_preset"):
            found = run(pack, name, batch[:1])
            wanted = applied(name.removeprefix("isophote_"), batch[:1])
            assert np.array_equal(found, wanted), name


def test_widgets_set_parameters(pack, batch):
    values = {"line_color": "#ff000080", "paper_color": "#fff4e4", "grid": 0.0, "hold": 3}
    red = (1.0, 0.0, 0.0, 128 / 255)
    wanted = applied("blueprint", batch[:1], line_color=red, paper_color="#fff4e4", grid=0.0, hold=3)
    found = run(pack, "isophote_blueprint", batch[:1], **values)
    assert np.abs(found - wanted).max() < 1e-6 and np.abs(found - run(pack, "isophote_blueprint", batch[:1])).max() > 0.1
    with pytest.raises(isophote.IsophoteError, match="posterize"):
        run(pack, "isophote_cartoon", batch, posterize=-1)


def test_looks_and_presets(pack, batch, tmp_path):
    assert set(pack.NODE_CLASS_MAPPINGS["isophote_look"].INPUT_TYPES()["required"]["look"][0]) == set(isophote.looks())
    found = run(pack, "isophote_look", batch[:1], look="copperplate")
    assert np.array_equal(found, applied("look:copperplate", batch[:1]))
    preset = {"style": "ink", "parameters": {"style": "woodcut"}}
    wanted = applied("ink", batch[:1], style="woodcut")
    assert np.array_equal(run(pack, "isophote_preset", batch[:1], preset=json.dumps(preset)), wanted)
    of_pixels = {"style": "cartoon", "parameters": {"line_width": 3}, "lengths": "pixels"}
    assert (isophote.Style(of_pixels).lengths, isophote.Style("ink").lengths) == ("pixels", "relative")
    found = run(pack, "isophote_preset", batch[:1], preset=json.dumps(of_pixels))
    assert np.array_equal(found, applied("cartoon", batch[:1], line_width=3, lengths="pixels"))
    file = tmp_path / "look.json"
    file.write_text(json.dumps(preset))
    assert np.array_equal(run(pack, "isophote_preset", batch[:1], preset=f" {file}\n"), wanted)
    changed = pack.NODE_CLASS_MAPPINGS["isophote_preset"].IS_CHANGED
    before = changed(preset=str(file), image=batch, steadiness=0.0)
    file.write_text(json.dumps({"style": "ink"}))
    assert changed(preset=str(file)) != before and changed(preset="{}") == "{}"
    with pytest.raises(ValueError, match="there is no preset"):
        run(pack, "isophote_preset", batch, preset=" ")
    with pytest.raises(OSError, match=r"none\.json"):
        run(pack, "isophote_preset", batch, preset=str(tmp_path / "none.json"))


def test_pictures_of_a_batch_are_alone_unless_they_are_to_be_steady(pack, batch):
    alone = [run(pack, "isophote_cartoon", batch[n : n + 1])[0] for n in range(2)]
    assert np.array_equal(run(pack, "isophote_cartoon", batch), np.stack(alone))
    # Frames of a pan, with noise that lasts no longer than one of them.
    scene = np.asarray(Image.open(SCENE).convert("RGB")) / 255
    noise = np.random.default_rng(1).normal(0, 0.03, (5, 80, 120, 3))
    shot = tensor(np.clip(np.stack([scene[20:100, 2 * n : 2 * n + 120] for n in range(5)]) + noise, 0, 1))
    plain, steady = (run(pack, "isophote_cartoon", shot, steadiness=steadiness) for steadiness in (0.0, 1.0))

    def change(frames):
        return np.abs(frames[1:, :, :-2] - frames[:-1, :, 2:]).mean()

    assert change(steady) < 0.9 * change(plain)
    looks = [run(pack, "isophote_look", shot, look="clear_line", steadiness=steadiness) for steadiness in (0.0, 1.0)]
    assert change(looks[1]) < change(looks[0])


def test_masks_and_control_maps_are_for_all_or_for_each(pack, batch):
    shape = batch.shape[:3]
    mask = tensor(np.zeros(shape))
    mask[1] = 1
    found = run(pack, "isophote_ink", batch, mask=mask)
    assert np.abs(found[0] - batch[0]).max() < 1e-6 and np.array_equal(found[1], run(pack, "isophote_ink", batch)[1])
    assert np.abs(run(pack, "isophote_ink", batch, mask=mask[0]) - batch).max() < 1e-6
    neutral, none = tensor(np.full((1, *shape[1:], 3), 0.5)), tensor(np.zeros((*shape, 3)))
    plain = run(pack, "isophote_ink", batch)
    assert np.array_equal(run(pack, "isophote_ink", batch, control=neutral), plain)
    assert np.abs(run(pack, "isophote_ink", batch, control=none) - plain).mean() > 0.01
    small = tensor(np.tile(np.linspace(0.2, 1, 8)[None, None, :, None], (1, 3, 1, 3)))
    for material in ("paper", "hatching"):
        assert np.abs(run(pack, "isophote_ink", batch, **{material: small}) - plain).mean() > 0.01
    green = tensor(np.tile(np.array([0.0, 1.0, 0.0]), (1, *shape[1:], 1)))
    assert np.abs(run(pack, "isophote_ink", batch, line_paint=green) - plain).mean() > 0.01
    assert "optional" in pack.NODE_CLASS_MAPPINGS["isophote_ink"].INPUT_TYPES()
    assert "control" not in pack.NODE_CLASS_MAPPINGS["isophote_gaussian"].INPUT_TYPES()["optional"]
    with pytest.raises(ValueError, match="the mask is 64x32, and the pictures are 120x64"):
        run(pack, "isophote_ink", batch, mask=tensor(np.zeros((1, 32, 64))))
    with pytest.raises(ValueError, match="there are 3 pictures of the mask, and 2"):
        run(pack, "isophote_ink", batch, mask=tensor(np.zeros((3, *shape[1:]))))


def test_progress_is_shown_and_work_ends_when_that_is_asked(pack, batch, monkeypatch):
    updates = []

    class ProgressBar:
        def __init__(self, total):
            updates.append(total)

        def update(self, count):
            updates.append(count)

    class Interrupted(Exception):
        pass

    asked = [False]

    def throw_exception_if_processing_interrupted():
        if asked[0]:
            raise Interrupted

    for name, members in {
        "comfy": {},
        "comfy.utils": {"ProgressBar": ProgressBar},
        "comfy.model_management": {"throw_exception_if_processing_interrupted": throw_exception_if_processing_interrupted},
    }.items():
        module = ModuleType(name)
        vars(module).update(members)
        monkeypatch.setitem(sys.modules, name, module)
    run(pack, "isophote_cartoon", batch)
    assert updates == [2, 1, 1]
    asked[0] = True
    with pytest.raises(Interrupted):
        run(pack, "isophote_cartoon", batch)
