"""The reader of EXR files, on files that are not as they should be."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from typing import Any

import bpy
import numpy as np
import pytest


def test_files_that_are_cut_or_compressed_are_refused(scene: Any, extension: ModuleType, tmp_path: Path) -> None:
    exr = extension.exr
    image = bpy.data.images.new("ramp", 7, 5, alpha=True, float_buffer=True)
    values = np.arange(7 * 5 * 4, dtype=np.float32).reshape(5, 7, 4)
    image.pixels.foreach_set(values.ravel())
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "IMAGE"
    settings.file_format, settings.color_mode = "OPEN_EXR", "RGBA"
    for depth, codec in (("32", "NONE"), ("16", "NONE"), ("32", "ZIP")):
        settings.color_depth, settings.exr_codec = depth, codec
        file = tmp_path / f"{depth}{codec}.exr"
        image.save_render(str(file), scene=scene)
        if codec == "ZIP":
            with pytest.raises(exr.Unreadable, match="compressed"):
                exr.read(file)
            continue
        found = exr.read(file)
        read = np.dstack([found[channel] for channel in "RGBA"])
        assert read.shape == values.shape and np.allclose(read[::-1], values, rtol=1e-3)
    whole = (tmp_path / "32NONE.exr").read_bytes()
    cut = tmp_path / "cut.exr"
    for length in (0, 3, 8, 20, 100, len(whole) // 2, len(whole) - 1):
        cut.write_bytes(whole[:length])
        with pytest.raises(exr.Unreadable):
            exr.read(cut)
    cut.write_bytes(b"no EXR file" * 100)
    with pytest.raises(exr.Unreadable, match="no EXR file"):
        exr.read(cut)
