"""The passes of a finished render as arrays.

Blender gives the pixels of passes to nobody but its own file writers. So they are written to a file for as long as it takes to
read it with the OpenImageIO that comes with Blender.
"""

import contextlib
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

import isophote

# By the names of Blender 4 and 5.
_WANTED = {
    "Combined": "color",
    "Depth": "depth",
    "Normal": "normal",
    "Vector": "vector",
    "IndexOB": "object_id",
    "Object Index": "object_id",
}

BACKGROUND = 1e9
"""From this depth on there is nothing: Blender writes 1e10."""


class NoRender(Exception):
    """There is no render whose passes could be read."""


@dataclass
class Frame:
    """What was rendered of a frame, rows from top to bottom."""

    color: np.ndarray
    guides: dict[str, np.ndarray]


def enable(view_layer: bpy.types.ViewLayer) -> None:
    """Lets renders have all passes that styles can use."""
    for name in ("use_pass_z", "use_pass_normal", "use_pass_object_index", "use_pass_vector"):
        setattr(view_layer, name, True)


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
        _save(scene, image, file, "OPEN_EXR_MULTILAYER", "MULTI_LAYER_IMAGE", "32")
        found = _layer(file, layer)
        if "color" not in found:
            raise NoRender(f"the render has no pass Combined of the view layer '{layer}'; render the image again")
        color = _rgba(found.pop("color"))
        if colors == "display":
            file = Path(folder) / "display.png"
            _save(scene, image, file, "PNG", "IMAGE", "16")
            color = _picture(file)
    return Frame(color, _guides(scene, found))


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


def _save(scene: bpy.types.Scene, image: bpy.types.Image, file: Path, format: str, media: str, depth: str) -> None:
    """Writes the render in a format, whatever the scene's own is."""
    with _settings(scene.render.image_settings) as settings:
        if hasattr(settings, "media_type"):
            settings.media_type = media
        settings.file_format = format
        settings.color_mode = "RGBA"
        settings.color_depth = depth
        try:
            image.save_render(str(file), scene=scene)
        except RuntimeError as error:
            raise NoRender(f"the render cannot be read: {error}; render the image first") from error
    if not file.exists():
        raise NoRender("there is no render yet; render the image first")


@contextlib.contextmanager
def _settings(settings: bpy.types.ImageFormatSettings) -> Iterator[bpy.types.ImageFormatSettings]:
    """The settings, which are afterwards as before. Each allows only some values of those after it."""
    names = ("media_type", "file_format", "color_mode", "color_depth")
    before = {name: getattr(settings, name) for name in names if hasattr(settings, name)}
    try:
        yield settings
    finally:
        for name, value in before.items():
            setattr(settings, name, value)


def _layer(file: Path, layer: str) -> dict[str, np.ndarray]:
    """The wanted passes of a layer in an EXR file, which has all in one part or each in its own."""
    import OpenImageIO as oiio

    source = oiio.ImageInput.open(str(file))
    if source is None:
        raise NoRender(f"the render's passes cannot be read: {oiio.geterror()}")
    found = {}
    part = 0
    while source.seek_subimage(part, 0):
        channels: dict[str, list[int]] = {}
        for place, name in enumerate(source.spec().channelnames):
            of, _, rest = name.rpartition(".")[0].rpartition(".")
            # What the compositor made is the picture.
            is_composite = of == "Composite" and rest == "Combined"
            if (of == layer or is_composite) and rest in _WANTED:
                channels.setdefault("composite" if is_composite else _WANTED[rest], []).append(place)
        if channels:
            pixels = source.read_image(part, 0, 0, source.spec().nchannels, oiio.FLOAT)
            found.update((name, pixels[..., places]) for name, places in channels.items())
        part += 1
    source.close()
    if "composite" in found:
        found["color"] = found.pop("composite")
    return found


def _rgba(pixels: np.ndarray) -> np.ndarray:
    """A picture with alpha."""
    if pixels.shape[2] == 4:
        return np.ascontiguousarray(pixels)
    return np.dstack([pixels[..., :3], np.ones(pixels.shape[:2], np.float32)])


def _picture(file: Path) -> np.ndarray:
    """A picture of 16 bits with straight alpha."""
    import OpenImageIO as oiio

    wish = oiio.ImageSpec()
    wish.attribute("oiio:UnassociatedAlpha", 1)
    source = oiio.ImageInput.open(str(file), wish)
    if source is None:
        raise NoRender(f"the render cannot be read: {oiio.geterror()}")
    pixels = source.read_image(oiio.UINT16)
    source.close()
    return pixels
