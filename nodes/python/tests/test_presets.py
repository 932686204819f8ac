"""Presets and looks: the same files as everywhere."""

from __future__ import annotations

import inspect
import json
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from PIL import Image

import isophote
from isophote.style import GUIDES

TABLE = ROOT / "tests/data/presets.json"
ORDER = ROOT / "nodes/library/looks/order.txt"


def by_host(host: Path, style: str, picture: np.ndarray, folder: Path, frame: int) -> np.ndarray:
    """What the sample host makes of a picture."""
    target = folder / f"out.{frame:04}.png"
    Image.fromarray(picture).save(folder / f"in.{frame:04}.png")
    frames = [folder / "in.####.png", folder / "out.####.png", "--frames", str(frame)]
    command = [host, "apply", style, *frames, "--force", "--backend", "cpu"]
    subprocess.run(command, check=True, env={**os.environ, "NODEVICE_SELECT": "1"}, stdout=subprocess.DEVNULL)
    return np.asarray(Image.open(target))


PRESET = {
    "name": "Dusk",
    "about": "Lines that grow softer",
    "tags": ["comic"],
    "style": "cartoon",
    "parameters": {
        "posterize": {"1001": 6, "1010": 3},
        "line_color": {"1001": "#10182080", "1010": [1, 0.5, 0]},
        "sigma_d": {"1001": 2, "1010": 5.5},
        "abstraction": {"1001": "flow", "1006": "full", "between": "step"},
        "detail": {"1001": 0.2, "1008": 0.9, "between": "step"},
        "darks": 0.1,
    },
}


def test_keyframes_are_those_of_the_host(small: np.ndarray, host: Path, tmp_path: Path) -> None:
    file = tmp_path / "dusk.json"
    file.write_text(json.dumps(PRESET), encoding="utf-8")
    style = isophote.Style(file)
    for frame in (1000, 1001, 1004, 1006, 1009, 1010, 1023):
        expected = by_host(host, str(file), small, tmp_path, frame)
        assert np.array_equal(isophote.apply(style, small, frame=frame), expected), frame
    assert np.array_equal(isophote.apply(PRESET, small, frame=1023), expected)
    style.set("posterize", 12)
    assert not np.array_equal(isophote.apply(style, small, frame=1001), isophote.apply(PRESET, small, frame=1001))


@pytest.mark.parametrize("look", ["copperplate", "midnight_blueprint", "wet_in_wet"])
def test_looks_are_those_of_the_host(small: np.ndarray, host: Path, tmp_path: Path, look: str) -> None:
    expected = by_host(host, f"look:{look}", small, tmp_path, 1)
    assert np.array_equal(isophote.apply(f"look:{look}", small, frame=1), expected)


def test_all_looks_are_there_and_open() -> None:
    files = {file.stem for file in (ROOT / "nodes/library/looks").glob("*.json")}
    looks = isophote.looks()
    assert set(looks) == files and len(files) > 40
    assert list(looks) == ORDER.read_text().partition("{")[2].partition("}")[0].split()
    for id, look in looks.items():
        assert look.name and look.about and look.tags
        assert isophote.Style(f"look:{id}").output_kind == "color"


def test_rules_for_things_are_kept(tmp_path: Path) -> None:
    file = tmp_path / "rules.json"
    rules = [{"match": "cryptomatte:hero", "lines": False, "detail": 2}]
    file.write_text(json.dumps({"style": "cartoon", "objects": rules}), encoding="utf-8")
    preset = isophote.Preset.load(file)
    assert list(preset.objects) == rules
    assert json.loads(preset.to_json())["objects"] == rules
    assert isophote.Style(file).output_kind == "color"
    wrong = {"style": "cartoon", "objects": [{"match": "id:1", "detail": 9}]}
    with pytest.raises(isophote.InvalidValueError, match="object 1"):
        isophote.Preset.from_dict(wrong)


def test_rules_by_number_follow_object_ids(small: np.ndarray) -> None:
    height, width = small.shape[:2]
    ids = np.broadcast_to(np.where(np.arange(width) < width // 2, 3, 5), (height, width)).astype(np.float32)
    rules = [{"match": "id:3", "lines": False}, {"match": "id:5,7", "line_color": "#d01020"}]
    preset = {"style": "cartoon", "objects": rules}
    control = np.full((height, width, 4), 0.5, np.float32)
    control[:, : width // 2, 2] = 0
    paint = np.zeros((height, width, 4), np.float32)
    paint[:, width // 2 :] = (0xD0 / 255, 0x10 / 255, 0x20 / 255, 1)
    expected = isophote.apply("cartoon", small, object_id=ids, control=control, line_paint=paint)
    assert np.array_equal(isophote.apply(preset, small, object_id=ids), expected)
    assert not np.array_equal(isophote.apply("cartoon", small, object_id=ids), expected)
    assert np.array_equal(isophote.apply(preset, small), isophote.apply("cartoon", small))


def test_rules_by_name_follow_a_cryptomatte(small: np.ndarray) -> None:
    height, width = small.shape[:2]
    # The id of "bunny", over half of the picture whole, and over a quarter by half.
    matte = np.zeros((height, width, 4), np.float32)
    matte[..., 0] = np.array(0x13851A76, np.uint32).view(np.float32)
    matte[:, : width // 2, 1] = 1
    matte[:, width // 2 : width * 3 // 4, 1] = 0.5
    look = {"style": "watercolor"}
    preset = {"style": "cartoon", "objects": [{"match": "cryptomatte:bunny", "detail": 2, "look": look}]}
    control = np.full((height, width, 4), 0.5, np.float32)
    control[..., 0] += 0.25 * matte[..., 1]
    under = isophote.apply("cartoon", small, control=control).astype(float)
    over = isophote.apply("watercolor", small, control=control).astype(float)
    share = matte[..., 1:2]
    found = isophote.apply(preset, small, cryptomatte=matte).astype(float)
    assert np.abs(found - (under * (1 - share) + over * share)).max() <= 1
    with pytest.raises(isophote.IsophoteError, match="4 channels of f32"):
        isophote.apply(preset, small, cryptomatte=matte.astype(np.float16))


def test_rules_that_nobody_can_follow_are_warned_of() -> None:
    rules = [{"match": "cryptomatte:props/*", "lines": False}, {"match": "id:3", "look": "no_look"}]
    with pytest.warns(UserWarning) as warned:
        isophote.Style({"style": "cartoon", "objects": rules})
    messages = [str(warning.message) for warning in warned]
    assert "cryptomatte:props/*" in messages[0] and "whole names" in messages[0]
    assert "id:3: its look" in messages[1] and "no_look" in messages[1] and len(messages) == 2


def test_graphs_are_the_same_files(small: np.ndarray, host: Path, tmp_path: Path) -> None:
    for file in sorted((ROOT / "host-example/graphs").glob("*.json")):
        result = isophote.apply(file, small, frame=1)
        written = json.loads(file.read_text(encoding="utf-8"))
        assert np.array_equal(isophote.apply(written, small, frame=1), result)
        assert np.array_equal(isophote.apply(file.read_text(encoding="utf-8"), small, frame=1), result)
        expected = by_host(host, str(file), small, tmp_path, 1)
        shown = expected if expected.ndim == result.ndim else expected[..., 0]
        assert np.array_equal(result, shown), file.name
        again = isophote.Style(isophote.Style(file).to_json())
        assert np.array_equal(isophote.apply(again, small, frame=1), result)


def test_parameters_of_graphs_are_named_by_node_where_they_must(small: np.ndarray) -> None:
    node = {"node": "gaussian", "inputs": {"color": "@color"}}
    graph = {
        "format": "isophote-graph",
        "version": 1,
        "nodes": [
            {"name": "a", **node},
            {"name": "b", **node, "inputs": {"color": "a"}},
            {"name": "c", "node": "kuwahara", "inputs": {"color": "b"}},
        ],
        "output": "c",
    }
    style = isophote.Style(graph, radius=4, **{"a.sigma": 3})
    nodes = {node["name"]: node["params"] for node in json.loads(style.to_json())["nodes"] if "params" in node}
    assert nodes == {"a": {"sigma": 3.0}, "c": {"radius": 4.0}}
    assert style.inputs == ("color",)
    for name, words in [
        ("sigma", "write a.sigma or b.sigma"),
        ("d.sigma", "choose from a, b, c"),
        ("posterize", "no node of the graph has a parameter"),
    ]:
        with pytest.raises(isophote.InvalidValueError, match=words):
            style.set(name, 1)


@pytest.mark.parametrize("case", json.loads(TABLE.read_text(encoding="utf-8")), ids=lambda case: case["why"])
def test_presets_are_read_as_by_the_other_faces(tmp_path: Path, case: dict) -> None:
    file = tmp_path / "preset.json"
    file.write_text(json.dumps(case["preset"]), encoding="utf-8")
    for opened in (file, case["preset"], json.dumps(case["preset"])):
        if "error" in case:
            with pytest.raises(isophote.IsophoteError) as raised:
                isophote.Style(opened)
            assert case["error"] in str(raised.value)
            continue
        style = isophote.Style(opened)
        style._at(case.get("frame", 0))
        nodes = json.loads(style.to_json())["nodes"]
        assert {node["name"]: node["params"] for node in nodes if "params" in node} == case["values"]


def test_every_node_opens_by_its_id() -> None:
    for id in isophote.catalogue():
        assert "color" in isophote.Style(id).inputs, id


def test_values_are_of_the_types_that_the_catalogue_names() -> None:
    preset = isophote.Preset.from_dict(PRESET)
    values = preset.values(isophote.catalogue()["cartoon"], 1006)
    assert (values["posterize"], values["abstraction"], values["detail"]) == (4, "full", 0.2)
    assert len(values["line_color"]) == 4 and values["darks"] == 0.1


def test_every_guide_is_an_argument() -> None:
    arguments = inspect.signature(isophote.apply).parameters
    assert [name for name in arguments if name in GUIDES] == list(GUIDES)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[1]", "an object is wanted"),
        ("{", "is no JSON"),
        ('{"stile": "ink"}', "unknown key 'stile'"),
        ("{}", "names no style"),
        ('{"style": "ink", "lengths": "long"}', "write relative or pixels"),
        ('{"style": "ink", "parameters": 3}', "no object"),
        ('{"style": "ink", "parameters": {"tone": null}}', "parameter 'tone': cannot be null"),
        ('{"style": "ink", "parameters": {"tone": {}}}', "has no keyframe"),
        ('{"style": "ink", "parameters": {"tone": {"one": 1}}}', "'one' is no number of a frame"),
        ('{"style": "ink", "parameters": {"tone": {"1": 1, "between": "x"}}}', "linear"),
        ('{"style": "ink", "parameters": {"tone": {"1": 0.5, "5": 9}}}', "must be 0 to 1, not 9"),
        ('{"style": "ink", "parameters": {"ton": 1}}', "did you mean 'tone'?"),
    ],
)
def test_what_is_wrong_with_presets_is_told(tmp_path: Path, text: str, words: str) -> None:
    file = tmp_path / "preset.json"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(isophote.IsophoteError) as raised:
        isophote.Style(file)
    assert words in str(raised.value)


def test_a_graph_file_lies_beside_its_preset(small: np.ndarray, tmp_path: Path) -> None:
    graph = (ROOT / "host-example/graphs/poster.json").read_text(encoding="utf-8")
    (tmp_path / "graph.json").write_text(graph, encoding="utf-8")
    preset = tmp_path / "preset.json"
    preset.write_text('{"style": "graph.json", "parameters": {"bins": 4}}', encoding="utf-8")
    expected = isophote.apply(graph, small, bins=4)
    assert np.array_equal(isophote.apply(preset, small), expected)
