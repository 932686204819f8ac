"""The nodes as ComfyUI loads them, from the folder of their pack."""

from __future__ import annotations

import importlib.util
import os
import sys
import zipfile
from pathlib import Path
from types import ModuleType

import pytest


@pytest.fixture(scope="session")
def pack(tmp_path_factory: pytest.TempPathFactory) -> ModuleType:
    """The pack, unpacked as its users do and loaded by the path of its folder, under the name that ComfyUI gives it."""
    packed = os.environ.get("ISOPHOTE_COMFYUI")
    assert packed, "run the tests by `cargo xtask test python`"
    custom_nodes = tmp_path_factory.mktemp("custom_nodes")
    zipfile.ZipFile(packed).extractall(custom_nodes)
    (folder,) = custom_nodes.iterdir()
    assert {"requirements.txt", "pyproject.toml", "LICENSE-MIT"} <= {file.name for file in folder.iterdir()}
    assert "0.0.0" not in (folder / "pyproject.toml").read_text(encoding="utf-8")
    return load(folder)


def load(folder: Path) -> ModuleType:
    """Loads a module of nodes."""
    name = str(folder).replace(".", "_x_")
    spec = importlib.util.spec_from_file_location(name, folder / "__init__.py", submodule_search_locations=[str(folder)])
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module
