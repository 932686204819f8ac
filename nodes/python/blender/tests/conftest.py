"""Blender with the extension installed from its file, and a scene to render."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

_MODULE = "bl_ext.user_default.isophote"


def _install() -> ModuleType:
    """Installs and enables the extension as its users do; its wheel brings the package that the tests import."""
    packed, resources = os.environ.get("ISOPHOTE_EXTENSION"), os.environ.get("BLENDER_USER_RESOURCES", "")
    assert packed and Path(resources).is_dir(), "run the tests by `cargo xtask test python`"
    import bpy

    install = bpy.ops.extensions.package_install_files
    assert install(filepath=packed, repo="user_default", enable_on_install=True, overwrite=True) == {"FINISHED"}
    return sys.modules[_MODULE]


_EXTENSION = _install()


@pytest.fixture(scope="session")
def extension() -> Iterator[ModuleType]:
    """The extension, which can be disabled and leaves nothing behind."""
    import bpy

    yield _EXTENSION
    assert bpy.ops.preferences.addon_disable(module=_MODULE) == {"FINISHED"}
    assert not hasattr(bpy.types.Scene, "isophote")


@pytest.fixture
def scene(extension: ModuleType) -> Any:
    """A small scene: a head and a ball on a floor, the ball in motion, rendered by Cycles with few samples."""
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)
    scene = bpy.context.scene
    render, cycles = scene.render, scene.cycles
    render.engine, cycles.device, cycles.samples, cycles.use_denoising = "CYCLES", "CPU", 1, False
    render.resolution_x, render.resolution_y = 160, 90
    scene.world = bpy.data.worlds.new("sky")
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location, camera.rotation_euler = (0, -8, 1.5), (1.4, 0, 0.1)
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.rotation_euler, sun.data.energy = (0.6, 0.3, 0), 3
    for thing in (camera, sun):
        scene.collection.objects.link(thing)
    scene.camera = camera
    bpy.ops.mesh.primitive_plane_add(size=6, location=(0, 0, 0))
    bpy.ops.mesh.primitive_monkey_add(location=(-1.2, 0, 1))
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.8, location=(1, 0, 1))
    ball = bpy.context.object
    ball.name = "ball"
    for frame, x in ((1, 0.4), (9, 2.0)):
        ball.location.x = x
        ball.keyframe_insert("location", frame=frame)
    for curve in curves(ball):
        for key in curve.keyframe_points:
            key.interpolation = "LINEAR"
    assert bpy.ops.isophote.prepare() == {"FINISHED"}
    scene.isophote.device = "cpu"
    return scene


def curves(thing: Any) -> Any:
    """What animates an object, by Blender 4's and 5's ways."""
    action = thing.animation_data.action
    if hasattr(action, "fcurves"):
        return action.fcurves
    return action.layers[0].strips[0].channelbags[0].fcurves
