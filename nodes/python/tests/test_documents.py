"""Examples of the documents, and what editors and type checkers are told."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
from conftest import ROOT
from PIL import Image

HERE = Path(__file__).parent


def test_examples_run(scene: np.ndarray, tmp_path: Path) -> None:
    text = (ROOT / "nodes/python/README.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", text, re.S)
    assert blocks
    shot = tmp_path / "shot"
    shot.mkdir()
    for number in range(1, 4):
        Image.fromarray(scene[40:100, 10 * number : 110 + 10 * number]).save(shot / f"frame.{number:04}.png")
        motion = np.zeros((60, 110, 2), np.float32)
        motion[..., 0] = 10
        np.save(shot / f"motion.{number:04}.npy", motion)
    Image.fromarray(scene).save(tmp_path / "photo.png")
    np.save(
        tmp_path / "normal.npy",
        np.dstack([np.zeros((*scene.shape[:2], 2), np.float32), np.ones(scene.shape[:2], np.float32)]),
    )
    for block in blocks:
        program = tmp_path / "example.py"
        program.write_text(block, encoding="utf-8")
        done = subprocess.run([sys.executable, program], cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, f"{block}\n{done.stderr}"
    assert (tmp_path / "cartoon.png").exists()


GOOD = """
import numpy as np
import isophote
picture = np.zeros((8, 8, 3), np.uint8)
a: isophote.Array = isophote.nodes.cartoon(picture, posterize=6, abstraction="flow", device="cpu", line_color="#102030")
b: isophote.Array = isophote.apply("cartoon", picture, posterize=6)
"""

BAD = {
    "posterise=6": 'Unexpected keyword argument "posterise"',
    'abstraction="ful"': 'Argument "abstraction"',
    'detail="much"': 'Argument "detail"',
    "color_space=3": "color_space",
}


def checked(program: str, folder: Path) -> str:
    """What the type checker says of a program."""
    file = folder / "program.py"
    file.write_text(program, encoding="utf-8")
    config = ROOT / "nodes/python/pyproject.toml"
    command = [sys.executable, "-m", "mypy", "--config-file", config, "--cache-dir", folder / "cache", file]
    return subprocess.run(command, capture_output=True, text=True, cwd=folder).stdout


def test_type_checkers_know_parameters(tmp_path: Path) -> None:
    assert "Success" in checked(GOOD, tmp_path)
    calls = "".join(f"isophote.nodes.cartoon(picture, {argument})\n" for argument in BAD)
    told = checked(GOOD + calls, tmp_path)
    assert f"Found {len(BAD)} errors" in told, told
    assert all(words in told for words in BAD.values()), told


def test_stubs_are_those_of_the_catalogue(tmp_path: Path) -> None:
    tool = HERE.parent / "tools/stubs.py"
    committed = HERE.parent / "isophote/nodes.pyi"
    assert subprocess.run([sys.executable, tool, "--check", committed]).returncode == 0
    stale = tmp_path / "nodes.pyi"
    stale.write_text(committed.read_text(encoding="utf-8").replace("posterize", "posterise", 1), encoding="utf-8")
    assert subprocess.run([sys.executable, tool, "--check", stale], stderr=subprocess.DEVNULL).returncode == 1
