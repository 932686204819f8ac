"""Styles: a graph of nodes with its parameters, ready to be applied."""

from __future__ import annotations

import json
import os
import threading
import warnings
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypedDict

import numpy as np

from ._inputs import Array, given
from ._library import native
from ._pixels import Target, tiled, writable
from ._spaces import Colors
from .devices import Device, DeviceLike, open_device
from .errors import InvalidValueError
from .presets import LENGTHS, LOOK, PLACE, Preset, StyleLike, as_json, as_text

GUIDES = tuple(guide["id"] for guide in json.loads(native.guides()))
"""Pictures that may enter a graph beside the colour."""


class Picture(TypedDict, total=False):
    """What is known of a picture, and how it is computed: keywords of everything that computes one."""

    color_space: str
    """`srgb` (gamma-encoded), `linear` (Rec. 709), `acescg`, `display-p3` or another of the program's option `--space`; the
    result has the same."""
    alpha_mode: str
    """`straight`; `premultiplied`, as renderers write it; or `emissive`, premultiplied with light where alpha is 0."""
    lengths: str
    """`relative`: lengths are pixels of a picture 1080 lines high; `pixels`: of the picture itself."""
    scale: float
    """Size of the picture over full size: 0.5 for a half-size proxy."""
    origin: tuple[float, float]
    """Where the picture stands in the canonical one, in full-size pixels: noise and paper are anchored there."""
    canonical_height: int
    """Height of the canonical picture, where this is a part of it."""
    device: DeviceLike
    """`cpu`; `gpu`, the best graphics device; a part of an adapter's name; or an `isophote.Device`."""
    precision: str
    """How graphics devices compute: `exact`, or `half` and `fast` with 16-bit floats."""
    threads: int
    """Threads of the CPU to use; 0 for one per core."""
    progress: Callable[[float], object] | None
    """Called with the share of the work done."""


class Settings:
    """The keywords of `Picture`, checked."""

    def __init__(
        self,
        *,
        color_space: str = "srgb",
        alpha_mode: str = "straight",
        lengths: str | None = None,
        scale: float = 1.0,
        origin: tuple[float, float] = (0.0, 0.0),
        canonical_height: int = 0,
        device: DeviceLike = None,
        threads: int = 0,
        progress: Callable[[float], object] | None = None,
    ) -> None:
        if lengths is not None and lengths not in LENGTHS:
            raise InvalidValueError(f"lengths are {' or '.join(LENGTHS)}, not {lengths!r}")
        self.color_space = color_space
        self.colors = Colors(color_space, alpha_mode)
        self.alpha_mode = alpha_mode
        self.lengths = lengths
        self.scale = scale
        self.origin = origin
        self.canonical_height = canonical_height
        self.device: Device | None = open_device(device)
        self.threads = threads
        self.progress = progress

    def request(self, image: Array, guides: list[str], frame: int, style: Style) -> native.Request:
        """What is asked of the library for a picture of a style."""
        height, width = image.shape[:2]
        return native.Request(
            (width, height),
            scale=self.scale,
            color_space=self.color_space,
            alpha_mode=self.alpha_mode,
            guides=guides,
            origin=self.origin,
            frame=frame,
            reference_height=style._reference_height if self.lengths is None else LENGTHS[self.lengths],
            canonical_height=self.canonical_height,
        )


class Style:
    """A node, graph, preset or look with its parameters, ready to be applied to pictures.

    It keeps what one call leaves for the next, so that pictures of the same size come faster. Threads may share it; they
    wait for each other.
    """

    def __init__(self, style: StyleLike, /, *, precision: str = "exact", **params: Any) -> None:
        """Opens a style and sets parameters: `posterize=6`, or `**{"lines.sigma_m": 5}` for one node of a graph.

        `precision` says how graphics devices compute: `exact`, or `half` and `fast` with 16-bit floats.
        """
        self._lock = threading.RLock()
        self._style = _opened(style)
        self._graph = self._style.graph()
        for rule in self._style.left_out():
            warnings.warn(f"a rule for things is left out: {rule}", stacklevel=2)
        if precision != "exact":
            self._graph.set_precision(precision)
        for name, value in params.items():
            self.set(name, value)

    def set(self, name: str, value: Any) -> None:
        """Sets a parameter, for all frames: `posterize`, or `node.posterize` where several nodes have it."""
        with self._lock:
            self._style.set(self._graph, name, as_text(value, f"parameter '{name}'"))

    def to_json(self) -> str:
        """The graph as JSON, with the parameters that differ from their defaults."""
        return self._graph.to_json()

    @property
    def output_kind(self) -> str:
        """What leaves the graph: `color`, `scalar`, `tensor` and so on."""
        return self._graph.output_kind()

    @property
    def frames(self) -> tuple[int, int]:
        """Frames before and after its own that a frame depends on."""
        return self._graph.frames()

    @property
    def inputs(self) -> tuple[str, ...]:
        """Pictures that enter the graph."""
        read = {
            source[1:]
            for node in json.loads(self.to_json())["nodes"]
            for source in node.get("inputs", {}).values()
            if source.startswith("@")
        }
        return tuple(name for name in ("color", *GUIDES) if name in read)

    @property
    def lengths(self) -> str:
        """What its lengths are unless a picture says otherwise: `relative` or `pixels`, as in `Picture`."""
        return "relative" if self._reference_height else "pixels"

    @property
    def _reference_height(self) -> int:
        """Lines of the pictures that its lengths are meant for; 0: lengths are pixels."""
        return self._style.reference_height()

    def _at(self, frame: int) -> None:
        """Gives animated parameters their values at a frame."""
        self._style.at_frame(self._graph, frame)

    def apply(
        self,
        image: Any,
        /,
        *,
        out: Any = None,
        frame: int = 0,
        settings: Settings | None = None,
        **inputs: Any,
    ) -> Array:
        """Applies the style to a picture. `isophote.apply` describes the arguments."""
        guides = {name: inputs.pop(name) for name in GUIDES if name in inputs}
        settings = settings or Settings(**inputs)
        images = {"color": given(image, "color")}
        images.update((name, given(guide, name)) for name, guide in guides.items() if guide is not None)
        if images["color"].ndim == 4:
            return self._batch(images, out, frame, settings)
        return self._picture(images, out, frame, settings)

    def _picture(self, images: dict[str, Array], out: Array | None, frame: int, settings: Settings) -> Array:
        """The result of one picture."""
        image = images["color"]
        size = image.shape[:2]
        images = {name: tiled(each, name, size) for name, each in images.items()}
        request = settings.request(images["color"], list(images), frame, self)
        images["color"] = settings.colors.entering(images["color"])
        with self._lock:
            self._at(frame)
            target = Target(image, self.output_kind, out, settings.colors)
            self._graph.process(request, images, target.pixels, settings.device, settings.threads, settings.progress)
        return target.finished()

    def _batch(self, images: dict[str, Array], out: Array | None, frame: int, settings: Settings) -> Array:
        """The results of pictures that are one array, each by itself."""
        shape = images["color"].shape
        count = shape[0]
        if count == 0:
            raise InvalidValueError("input image 'color' is a batch of no picture")
        whole = None if out is None else writable(out)
        if whole is not None and (whole.ndim not in (3, 4) or whole.shape[:3] != shape[:3]):
            raise InvalidValueError(f"out has the shape {whole.shape}, and the batch {shape}")
        results = []
        for number in range(count):
            target = None if whole is None else whole[number]
            of_one = {name: _of_batch(each, name, number, shape) for name, each in images.items()}
            results.append(self._picture(of_one, target, frame, settings))
        return np.stack(results) if out is None else out


def _of_batch(images: Array, name: str, number: int, shape: tuple[int, ...]) -> Array:
    """The picture of this number in a batch, or the one picture that all have."""
    has_no_channels = images.shape == shape[:3] and images.shape[:2] != shape[1:3]
    if images.ndim != 4 and not has_no_channels:
        return images
    if images.shape[0] != shape[0]:
        raise InvalidValueError(f"input image '{name}' is a batch of {images.shape[0]} pictures, and there are {shape[0]}")
    picture: Array = images[number]
    return picture


def _opened(style: StyleLike) -> native.Style:
    """The style that a name, a file or what is in one means."""
    if isinstance(style, Preset):
        return _written_out(style.to_json(), PLACE, Path())
    if isinstance(style, Mapping):
        return _written_out(as_json(style), PLACE, Path())
    named = os.fspath(style)
    if named.lstrip().startswith("{"):
        return _written_out(named, PLACE, Path())
    if not named.startswith(LOOK) and (named.lower().endswith(".json") or isinstance(style, os.PathLike)):
        return _written_out(Path(named).read_text(encoding="utf-8"), named, Path(named).parent)
    return native.Style.named(named)


def _written_out(text: str, place: str, folder: Path) -> native.Style:
    """The style of a text. The graph file that it may name lies in `folder`."""
    graph = None
    preset = native.read_preset(place, text)
    if preset is not None:
        named = str(json.loads(preset)["style"])
        if named.lower().endswith(".json"):
            graph = (folder / named).read_text(encoding="utf-8")
    return native.Style.from_json(place, text, graph)


def apply(
    style: StyleLike | Style,
    image: Any,
    /,
    *,
    normal: Any = None,
    depth: Any = None,
    object_id: Any = None,
    mask: Any = None,
    flow: Any = None,
    motion: Any = None,
    motion_forward: Any = None,
    rest_position: Any = None,
    albedo: Any = None,
    diffuse: Any = None,
    specular: Any = None,
    control: Any = None,
    paper: Any = None,
    hatching: Any = None,
    line_paint: Any = None,
    cryptomatte: Any = None,
    out: Any = None,
    frame: int = 0,
    color_space: str = "srgb",
    alpha_mode: str = "straight",
    lengths: str | None = None,
    scale: float = 1.0,
    origin: tuple[float, float] = (0.0, 0.0),
    canonical_height: int = 0,
    device: DeviceLike = None,
    precision: str = "exact",
    threads: int = 0,
    progress: Callable[[float], object] | None = None,
    **params: Any,
) -> Array:
    """Applies a style to a picture and returns the result, an array of the picture's shape and type.

    `style` is the id of a node (`"cartoon"`), a look (`"look:copperplate"`), the path of a preset or graph file, what is
    in such a file as a dict, or an `isophote.Style`. `params` are the parameters that the catalogue names; `isophote.nodes`
    has a function with all of them for every node.

    Pictures are arrays of uint8, uint16 (0 to 1 is all of the range), float16 or float32, of rows, columns and channels:
    RGB, RGBA, or grey with or without alpha; bool is 0 or 255. They are read, and `out` is written, where they lie in
    memory if pixels of a row follow each other there, whatever the order of rows; other layouts are copied. Tensors with
    `__dlpack__`, such as those of PyTorch, are taken in the same way, and images of Pillow as what they show: a palette's
    colours, and RGB for CMYK. A batch has one dimension more, before the rows; each of its pictures is computed by itself,
    with its own guides or those of all, and the result is a batch. Guides are what a renderer knows:

    - `normal`: view-space normals, x right, y up, z towards the camera.
    - `depth`: distance from the camera, 0 or less where there is nothing.
    - `object_id`: a number per object, 0 where there is nothing.
    - `mask`: share of the result that is used, 0 to 1.
    - `flow`: a painted flow map: x and y in red and green, 0.5 for none, and its strength in alpha.
    - `motion`: pixels from where points are to where they were in the frame before.
    - `motion_forward`: pixels from where points are to where they will be in the next frame.
    - `rest_position`: points of the undeformed objects.
    - `albedo`: colours of surfaces without light, in the picture's space.
    - `diffuse`: light that surfaces reflect in all directions, in their colours and the picture's space.
    - `specular`: light that surfaces mirror: highlights and reflections, in the picture's space.
    - `control`: a control map, 0.5 for no change: detail, width of lines, their amount, and strength of the medium.
    - `paper`: a sheet of paper: its colours, and its grain, which is deep where it is darker than around; white where
      it is transparent.
    - `hatching`: hatching in up to four tones, the lightest in red and the darkest in alpha: 1 is paper, 0 is ink.
    - `line_paint`: colours of lines: that of the line here, as far as it is opaque.
    - `cryptomatte`: the two things that cover most of a pixel by a Cryptomatte: id of the one's name and its share,
      then those of the other.

    Normals have 3 or 4 channels of floats, rest positions 32 bits a channel, and motion goes x right and y down. Paper and
    hatching of another size than the picture's are tiled over it.

    `color_space` is `srgb` (gamma-encoded), `linear` (Rec. 709), `acescg`, `p3` or `rec2020` (linear), `aces2065-1`,
    `display-p3`, `adobe-rgb`, `encoded-rec709`, `encoded-rec2020`, `rec2100-pq` or `rec2100-hlg`, and the result has the
    same. `alpha_mode` is `straight`; `premultiplied`, as renderers write it; or `emissive`, premultiplied with light where
    alpha is 0. `lengths` of parameters are `relative`, in pixels of a picture 1080 lines high, unless a preset says
    otherwise, or `pixels` of the picture itself. `scale` is the picture's size over full size; `origin` is where it stands
    in the canonical picture, which has `canonical_height` lines. `frame` renews what `hold` lets last, and tells keyframes of
    presets apart.

    `device` is `cpu`; `gpu`, the best graphics device, or a software driver without one; `auto`, a graphics card or the
    CPU; a part of an adapter's name; or an `isophote.Device`. Devices compute with a `precision`: `exact`, or `half` and
    `fast` with 16-bit floats. `threads` of the CPU are one per core unless given.
    `progress` is called with the share of the work done, and ends the work by an exception, as Ctrl-C does.

    The interpreter's lock is not held meanwhile. Exceptions are those of `isophote.errors`.
    """
    settings = Settings(
        color_space=color_space,
        alpha_mode=alpha_mode,
        lengths=lengths,
        scale=scale,
        origin=origin,
        canonical_height=canonical_height,
        device=device,
        threads=threads,
        progress=progress,
    )
    return opened(style, precision=precision, **params).apply(
        image,
        out=out,
        frame=frame,
        settings=settings,
        normal=normal,
        depth=depth,
        object_id=object_id,
        mask=mask,
        flow=flow,
        motion=motion,
        motion_forward=motion_forward,
        rest_position=rest_position,
        albedo=albedo,
        diffuse=diffuse,
        specular=specular,
        control=control,
        paper=paper,
        hatching=hatching,
        line_paint=line_paint,
        cryptomatte=cryptomatte,
    )


def opened(style: StyleLike | Style, /, **params: Any) -> Style:
    """The style with these parameters; one that is open has its own."""
    if not isinstance(style, Style):
        return Style(style, **params)
    given = [name for name, value in params.items() if (name, value) != ("precision", "exact")]
    if given:
        raise TypeError(f"the style is open and has its own {', '.join(given)}; use its method set")
    return style
