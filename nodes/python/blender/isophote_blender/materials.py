"""Paper and hatching that styles draw on: images of the file, laid again and again from the picture's corner."""

import bpy
import numpy as np

from isophote._library import native

from . import passes

MATERIALS = {
    "paper": ("Paper", "A sheet that the style draws or paints on, in the place of its own"),
    "hatching": ("Hatching", "Tones of the style's own hand: up to four, in red, green, blue and alpha, from light to dark"),
}
"""Materials with their names and hints."""

_LINES = 1080
"""Lines of the picture on which materials are as large as their pixels."""


def on(scene: bpy.types.Scene, read: set[str], height: int) -> dict[str, np.ndarray]:
    """The materials of a scene that a style reads, for pictures of a height."""
    settings = scene.isophote
    chosen = {name: getattr(settings, name) for name in MATERIALS if name in read}
    return {name: _pixels(image, name, height, settings.colors) for name, image in chosen.items() if image is not None}


def _pixels(image: bpy.types.Image, name: str, height: int, colors: str) -> np.ndarray:
    """A material in the numbers of the picture, as large as on pictures of the height."""
    pixels, is_float = _scaled(image, height / _LINES)
    if name == "paper":
        light = passes.working_space()[0]
        source = light if is_float else "srgb"
        native.change_space(pixels, source, light if colors == "linear" else "srgb", False)
        if colors == "linear":
            pixels[..., :3] *= pixels[..., 3:]
    return pixels


def _scaled(image: bpy.types.Image, factor: float) -> tuple[np.ndarray, bool]:
    """RGBA of an image times a factor, rows from top to bottom, and whether it holds light."""
    if 0 in image.size:
        raise passes.NoRender(f"the image {image.name} has no pixels; choose another, or find its file")
    width, height = (max(1, round(side * factor)) for side in image.size)
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    if (width, height) != tuple(image.size):
        # A copy of an image that nobody saved would be empty.
        copy = bpy.data.images.new(image.name, *image.size, alpha=True, float_buffer=image.is_float)
        try:
            copy.pixels.foreach_set(_rgba(pixels, image.channels).ravel())
            copy.scale(width, height)
            pixels = np.empty(width * height * 4, np.float32)
            copy.pixels.foreach_get(pixels)
        finally:
            bpy.data.images.remove(copy)
    else:
        pixels = _rgba(pixels, image.channels)
    return np.ascontiguousarray(pixels.reshape(height, width, 4)[::-1]), image.is_float


def _rgba(pixels: np.ndarray, channels: int) -> np.ndarray:
    """Four numbers a pixel."""
    own = pixels.reshape(-1, channels)
    if channels == 4:
        return own
    rgba = np.ones((len(own), 4), np.float32)
    rgba[:, :3] = own[:, :3] if channels >= 3 else own[:, :1]
    return rgba
