"""The passes of a finished render as arrays.

Blender gives the pixels of passes to nobody but its own file writers: to Python the image of a render has none, and in 5.2 a
viewer of the compositor has none where there is no window. So they are written to a file for as long as it takes to read it.
"""

import contextlib
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

import isophote
from isophote._library import native

from . import exr

# By the names of Blender 4 and 5.
_WANTED = {
    "Combined": "color",
    "Depth": "depth",
    "Normal": "normal",
    "Vector": "vector",
    "IndexOB": "object_id",
    "Object Index": "object_id",
    "DiffCol": "diffuse_color",
    "Diffuse Color": "diffuse_color",
    "DiffDir": "diffuse_direct",
    "Diffuse Direct": "diffuse_direct",
    "DiffInd": "diffuse_indirect",
    "Diffuse Indirect": "diffuse_indirect",
    "GlossCol": "glossy_color",
    "Glossy Color": "glossy_color",
    "GlossDir": "glossy_direct",
    "Glossy Direct": "glossy_direct",
    "GlossInd": "glossy_indirect",
    "Glossy Indirect": "glossy_indirect",
}

_WORKING = {"lin_rec709_scene": "linear", "lin_rec2020_scene": "rec2020", "lin_ap1_scene": "acescg"}
"""The library's spaces for those that a file's scenes can be lit in, by the names of the Color Interop Forum."""

_DISPLAY = "sRGB"
"""The display that colours are read for, whatever the user's is: the library's parameters have colours of it."""

BACKGROUND = 1e9
"""From this depth on there is nothing: Blender writes 1e10."""


class NoRender(Exception):
    """There is no render whose passes could be read."""


@dataclass
class Frame:
    """What was rendered of a frame, rows from top to bottom."""

    color: np.ndarray
    guides: dict[str, np.ndarray]


def working_space() -> tuple[str, str]:
    """The space of the light of scenes in this file, by the library's name and Blender's; before Blender 5 there was one."""
    name = _working_space()
    colors = getattr(bpy.data, "colorspace", None)
    space = "linear" if colors is None else _WORKING.get(colors.working_space_interop_id)
    if space is None:
        raise NoRender(f"the file's working space {name} is not known; choose 'As displayed', or another working space")
    return space, name


def _working_space() -> str:
    """Blender's name for it, whether or not the library knows it."""
    colors = getattr(bpy.data, "colorspace", None)
    return "Linear Rec.709" if colors is None else colors.working_space


def enable(view_layer: bpy.types.ViewLayer) -> None:
    """Lets renders have all passes that styles can use."""
    light = [f"{kind}_{part}" for kind in ("diffuse", "glossy") for part in ("color", "direct", "indirect")]
    for name in ("z", "normal", "object_index", "vector", *light):
        setattr(view_layer, f"use_pass_{name}", True)


def number(scene: bpy.types.Scene) -> int:
    """Gives objects without a pass index one of their own; how many there were."""
    taken = {thing.pass_index for thing in scene.objects}
    free = (index for index in range(1, 32768) if index not in taken)
    unnumbered = [thing for thing in scene.objects if thing.pass_index == 0]
    for thing, index in zip(unnumbered, free):
        thing.pass_index = index
    return len(unnumbered)


def read(scene: bpy.types.Scene, layer: str, colors: str) -> Frame:
    """The passes of a view layer of the render that is finished; `colors` as in the settings."""
    image = bpy.data.images.get("Render Result")
    if image is None:
        raise NoRender("there is no render yet; render the image first")
    with tempfile.TemporaryDirectory(prefix="isophote-") as folder:
        file = Path(folder) / "passes.exr"
        _save(scene, image, file, "OPEN_EXR_MULTILAYER")
        found = _layer(file, layer)
        if "color" not in found:
            raise NoRender(f"the render has no pass Combined of the view layer '{layer}'; render the image again")
        color = _rgba(found.pop("color"))
        if colors == "display":
            file = Path(folder) / "display.png"
            _save(scene, image, file, "PNG")
            color = _picture(file)
    guides = _guides(scene, found)
    guides.update({name: _lit(light, color, colors) for name, light in _light(scene, found, colors).items()})
    return Frame(color, guides)


def _guides(scene: bpy.types.Scene, found: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The passes as the library means them."""
    guides = {}
    if "depth" in found:
        depth = found["depth"][..., :1]
        guides["depth"] = np.where(depth < BACKGROUND, depth, np.float32(0))
    if "object_id" in found:
        guides["object_id"] = found["object_id"][..., :1]
    if "normal" in found and scene.camera is not None:
        # The pass has the axes of the world; the library wants those of the camera.
        camera = scene.camera.evaluated_get(bpy.context.evaluated_depsgraph_get())
        to_world = np.array(camera.matrix_world.to_3x3().normalized(), np.float32)
        guides["normal"] = np.ascontiguousarray(found["normal"][..., :3] @ to_world)
    if "vector" in found and found["vector"].shape[2] == 4:
        guides.update(isophote.motion(found["vector"], convention="blender"))
    return guides


def _light(scene: bpy.types.Scene, found: dict[str, np.ndarray], colors: str) -> dict[str, np.ndarray]:
    """Colours of surfaces, and the light that they reflect: Blender writes light without their colours, in two parts."""
    light = {}
    # What is shown is as bright as the exposure says.
    exposure = np.float32(1 if colors == "linear" else 2**scene.view_settings.exposure)
    for name, kind in (("diffuse", "diffuse"), ("specular", "glossy")):
        color, direct = found.get(f"{kind}_color"), found.get(f"{kind}_direct")
        if color is None or direct is None:
            continue
        indirect = found.get(f"{kind}_indirect")
        light[name] = exposure * color[..., :3] * (direct if indirect is None else direct + indirect)[..., :3]
        if name == "diffuse":
            light["albedo"] = color[..., :3]
    return light


def _lit(light: np.ndarray, color: np.ndarray, colors: str) -> np.ndarray:
    """Colours of surfaces, or light that they reflect, in the numbers of the picture and with its alpha."""
    alpha = color[..., 3:]
    if colors == "linear":
        return np.concatenate((light, alpha), axis=2)
    # Numbers of displays are not multiplied by alpha. A style says itself how light is shown: no view transform does.
    straight = np.divide(light, alpha, out=np.zeros_like(light), where=alpha > 0)
    shown = np.concatenate((straight, alpha), axis=2)
    native.change_space(shown, working_space()[0], "srgb", False)
    return shown


def _save(scene: bpy.types.Scene, image: bpy.types.Image, file: Path, format: str) -> None:
    """Writes the render: its light in the working space, or in a format for displays as one of sRGB shows it."""
    is_light = "EXR" in format
    try:
        with _kept(scene.render.image_settings) as settings:
            if not is_light:
                # It takes view, look and exposure of the scene along, where it was not so before.
                settings.color_management = "OVERRIDE"
                with contextlib.suppress(TypeError):
                    # A studio's own configuration may have none of that name.
                    settings.display_settings.display_device = _DISPLAY
            elif settings.color_management == "OVERRIDE":
                settings.linear_colorspace_settings.name = _working_space()
            save(scene, image, file, format, "32" if is_light else "16", "NONE")
    except RuntimeError as error:
        raise NoRender(f"the render cannot be read: {error}; render the image first") from error
    if not file.exists():
        raise NoRender("there is no render yet; render the image first")


def save(scene: bpy.types.Scene, image: bpy.types.Image, file: Path, format: str, depth: str, codec: str) -> None:
    """Writes an image as renders are written, in a format, whatever the scene's own is; `codec` is that of EXR files."""
    with _kept(scene.render.image_settings) as settings:
        if hasattr(settings, "media_type"):
            settings.media_type = "MULTI_LAYER_IMAGE" if format == "OPEN_EXR_MULTILAYER" else "IMAGE"
        settings.file_format = format
        settings.color_mode = "RGBA"
        settings.color_depth = depth
        if "EXR" in format:
            settings.exr_codec = codec
        image.save_render(str(file), scene=scene)


@contextlib.contextmanager
def _kept(settings: bpy.types.ImageFormatSettings) -> Iterator[bpy.types.ImageFormatSettings]:
    """The settings, which are afterwards as before. Each allows only some values of those after it."""
    names = ("media_type", "file_format", "color_mode", "color_depth", "exr_codec", "color_management")
    kept = [(settings, name) for name in names if hasattr(settings, name)]
    if settings.color_management == "OVERRIDE":
        # Otherwise they count for nothing.
        view = settings.view_settings
        kept += [(settings.linear_colorspace_settings, "name"), (settings.display_settings, "display_device")]
        kept += [(view, "view_transform"), (view, "look")]
    before = [(owner, name, getattr(owner, name)) for owner, name in kept]
    try:
        yield settings
    finally:
        for owner, name, value in before:
            # What is set anew takes other settings along.
            if getattr(owner, name) != value:
                setattr(owner, name, value)


def _layer(file: Path, layer: str) -> dict[str, np.ndarray]:
    """The wanted passes of a layer in an EXR file."""
    try:
        channels = exr.read(file)
    except exr.Unreadable as error:
        raise NoRender(f"the render's passes cannot be read: {error}") from error
    passes: dict[str, dict[str, np.ndarray]] = {}
    for name, pixels in channels.items():
        layer_name, _, pass_name = name.rpartition(".")[0].rpartition(".")
        # What the compositor made is the picture.
        is_composite = (layer_name, pass_name) == ("Composite", "Combined")
        if is_composite or (layer_name == layer and pass_name in _WANTED):
            found = "composite" if is_composite else _WANTED[pass_name]
            passes.setdefault(found, {})[name.rpartition(".")[2]] = pixels
    if "composite" in passes:
        passes["color"] = passes.pop("composite")
    return {name: np.dstack([parts[of] for of in _ordered(parts)]) for name, parts in passes.items()}


def _ordered(parts: dict[str, np.ndarray]) -> list[str]:
    """Components in the order that they are meant in; files have them in that of the alphabet."""
    return sorted(parts, key="RGBAXYZW".index)


def _rgba(pixels: np.ndarray) -> np.ndarray:
    """A picture with alpha."""
    if pixels.shape[2] == 4:
        return np.ascontiguousarray(pixels)
    return np.dstack([pixels[..., :3], np.ones(pixels.shape[:2], np.float32)])


def _picture(file: Path) -> np.ndarray:
    """A picture as it is stored, with straight alpha."""
    image = bpy.data.images.load(str(file), check_existing=False)
    try:
        image.colorspace_settings.name = "Non-Color"
        image.alpha_mode = "CHANNEL_PACKED"
        pixels = np.empty(len(image.pixels), np.float32)
        image.pixels.foreach_get(pixels)
        width, height = image.size
    finally:
        bpy.data.images.remove(image)
    return pixels.reshape(height, width, 4)[::-1]
