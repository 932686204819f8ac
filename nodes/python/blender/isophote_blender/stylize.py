"""A style on the passes of a still, or of an animation frame by frame."""

from collections.abc import Iterator
from pathlib import Path

import bpy
import numpy as np

import isophote

from . import materials, passes, rules
from .settings import STYLES, ISOPHOTE_PG_settings, values

IMAGE = "Stylized Render"
"""The image that results come back as."""


def _space(settings: ISOPHOTE_PG_settings) -> dict[str, str]:
    """What the numbers of colours mean to the library."""
    if settings.colors == "linear":
        return {"color_space": passes.working_space()[0], "alpha_mode": "premultiplied"}
    return {"color_space": "srgb", "alpha_mode": "straight"}


def _style(scene: bpy.types.Scene, params: dict[str, isophote.Value]) -> isophote.Style:
    """The style of a scene with the rules of its objects."""
    return isophote.Style({"style": scene.isophote.style, "objects": rules.of(scene)}, **params)


def _frame(scene: bpy.types.Scene, layer: str) -> passes.Frame:
    """The frame that is rendered, with what the style can use of it."""
    settings = scene.isophote
    frame = passes.read(scene, layer, settings.colors)
    read = {port.id for port in STYLES[settings.style].inputs}
    # Frames around are kept while an animation is rendered. Motion says how they move, whatever is drawn.
    frame.guides = {name: guide for name, guide in frame.guides.items() if name in read or name.startswith("motion")}
    frame.guides.update(materials.on(scene, read, frame.color.shape[0]))
    return frame


def still(context: bpy.types.Context) -> bpy.types.Image:
    """Stylizes the render that is finished."""
    scene, settings = context.scene, context.scene.isophote
    frame = _frame(scene, context.view_layer.name)
    guides = {name: guide for name, guide in frame.guides.items() if not name.startswith("motion")}
    result = _canvas(frame)
    isophote.apply(
        _style(scene, values(settings)),
        frame.color,
        out=result[::-1],
        frame=scene.frame_current,
        lengths=settings.lengths,
        device=settings.device,
        **guides,
        **_space(settings),
    )
    return _image(result, settings)


def animation(context: bpy.types.Context) -> Iterator[tuple[int, int, Path]]:
    """Renders the frames of the scene, stylizes them and writes them: after each, how many are done of how many, and its
    file.

    Neighbouring frames make each other steady where the style's steadiness is above 0. Animated settings are those of the
    frame.
    """
    scene, settings = context.scene, context.scene.isophote
    layer, before = context.view_layer.name, scene.frame_current
    numbers = list(range(scene.frame_start, scene.frame_end + 1, scene.frame_step))
    rendered: dict[int, passes.Frame] = {}
    chosen: dict[int, dict] = {}

    def render(number: int) -> None:
        scene.frame_set(number)
        bpy.ops.render.render(scene=scene.name)
        rendered[number] = _frame(scene, layer)
        chosen[number] = values(settings)

    def source(name: str, number: int) -> np.ndarray | None:
        frame = rendered.get(number)
        if frame is None:
            return None
        return frame.color if name == "color" else frame.guides.get(name)

    try:
        style = _style(scene, values(settings))
        sequence = None
        for done, number in enumerate(numbers):
            # Animated settings may look farther around in one frame than in another.
            _, future = _style(scene, chosen.get(number, values(settings))).frames
            for ahead in numbers[done : done + future + 1]:
                if ahead not in rendered:
                    render(ahead)
            if sequence is None:
                sequence = isophote.Sequence(
                    style,
                    source,
                    list(rendered[number].guides),
                    lengths=settings.lengths,
                    device=settings.device,
                    **_space(settings),
                )
            for name, value in chosen[number].items():
                style.set(name, value)
            result = _canvas(rendered[number])
            sequence.frame(number, out=result[::-1])
            _image(result, settings)
            file = _write(result, scene, number)
            for old in [old for old in rendered if old < number - style.frames[0]]:
                del rendered[old]
            yield done + 1, len(numbers), file
    finally:
        scene.frame_set(before)


def _canvas(frame: passes.Frame) -> np.ndarray:
    """Pixels as Blender's images have them: RGBA of floats, the lowest row first."""
    return np.empty((*frame.color.shape[:2], 4), np.float32)


def _image(pixels: np.ndarray, settings: ISOPHOTE_PG_settings) -> bpy.types.Image:
    """The image of results, with these pixels."""
    height, width = pixels.shape[:2]
    is_linear = settings.colors == "linear"
    image = bpy.data.images.get(IMAGE)
    # One that was saved shows its file.
    fits = image is not None and image.source == "GENERATED" and tuple(image.size) == (width, height)
    if not fits or image.is_float != is_linear:
        new = bpy.data.images.new(IMAGE, width, height, alpha=True, float_buffer=is_linear)
        if image is not None:
            image.user_remap(new)
            bpy.data.images.remove(image)
            new.name = IMAGE
        image = new
    _fill(image, pixels, is_linear)
    return image


def _fill(image: bpy.types.Image, pixels: np.ndarray, is_linear: bool) -> None:
    """Gives an image pixels, and says what they mean."""
    image.colorspace_settings.name = passes.working_space()[1] if is_linear else "sRGB"
    image.alpha_mode = "PREMUL" if is_linear else "STRAIGHT"
    image.pixels.foreach_set(pixels.ravel())
    image.update()


def _write(pixels: np.ndarray, scene: bpy.types.Scene, number: int) -> Path:
    """Writes pixels as the file of a frame."""
    is_linear = scene.isophote.colors == "linear"
    file = path(scene.isophote.output, number, ".exr" if is_linear else ".png")
    file.parent.mkdir(parents=True, exist_ok=True)
    height, width = pixels.shape[:2]
    # An image that is saved becomes that of its file.
    image = bpy.data.images.new(file.name, width, height, alpha=True, float_buffer=is_linear)
    try:
        _fill(image, pixels, is_linear)
        if is_linear:
            passes.save(scene, image, file, "OPEN_EXR", "16", "ZIP")
        else:
            # As it is: the colours have gone through the view transform.
            image.file_format = "PNG"
            image.filepath_raw = str(file)
            image.save()
    finally:
        bpy.data.images.remove(image)
    return file


def path(pattern: str, number: int, ending: str) -> Path:
    """The file of a frame."""
    name = bpy.path.abspath(pattern)
    digits = name.count("#")
    marks = "#" * digits
    if digits and marks in name:
        name = name.replace(marks, f"{number:0{digits}}")
    else:
        name += f"{number:04}"
    return Path(name if name.lower().endswith(ending) else name + ending)
