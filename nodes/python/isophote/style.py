"""Styles: a graph of nodes with its parameters, ready to be applied."""

from __future__ import annotations

import json
import os
import threading
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypedDict

from ._catalogue import Node, Param, catalogue
from ._library import native
from ._pixels import Array, Target, pixels
from .devices import Device, DeviceLike, open_device
from .errors import InvalidValueError
from .presets import LENGTHS, LOOK, Keys, Preset, StyleLike, as_text

GUIDES = ("normal", "depth", "object_id", "mask", "flow", "motion", "motion_forward", "rest_position")
"""Pictures that may enter a graph beside the colour."""


class Picture(TypedDict, total=False):
    """What is known of a picture, and how it is computed: keywords of everything that computes one."""

    color_space: str
    """`srgb` (gamma-encoded), `linear` (Rec. 709) or `acescg`; the result has the same."""
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
        self.alpha_mode = alpha_mode
        self.lengths = lengths
        self.scale = scale
        self.origin = origin
        self.canonical_height = canonical_height
        self.device: Device | None = open_device(device)
        self.threads = threads
        self.progress = progress

    def request(self, image: Array, guides: list[str], frame: int, lengths: str) -> native.Request:
        """What is asked of the library for a picture; `lengths` are the style's."""
        height, width = image.shape[:2]
        return native.Request(
            (width, height),
            scale=self.scale,
            color_space=self.color_space,
            alpha_mode=self.alpha_mode,
            guides=guides,
            origin=self.origin,
            frame=frame,
            reference_height=LENGTHS[self.lengths or lengths],
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
        self._keys: dict[tuple[int, str], tuple[Keys, Param]] = {}
        self._lengths = "relative"
        self._graph, self._is_single = self._open(style)
        if precision != "exact":
            self._graph.set_precision(precision)
        for name, value in params.items():
            self.set(name, value)

    def _open(self, style: StyleLike) -> tuple[native.Graph, bool]:
        if isinstance(style, Preset):
            return self._follow(style)
        if isinstance(style, Mapping):
            if "nodes" in style or "format" in style:
                return native.Graph(json.dumps(style)), False
            return self._follow(Preset.from_dict(style))
        named = os.fspath(style)
        if named.lstrip().startswith("{"):
            return self._open(json.loads(named))
        if named.startswith(LOOK):
            return self._follow(Preset.load(named))
        if named.lower().endswith(".json") or isinstance(style, os.PathLike):
            text = Path(named).read_text(encoding="utf-8")
            if _is_graph(text):
                return native.Graph(text), False
            return self._follow(Preset.load(named))
        return _fed(named), True

    def _follow(self, preset: Preset) -> tuple[native.Graph, bool]:
        self._graph, self._is_single = self._open(preset.style)
        self._lengths = preset.lengths
        for name, value in preset.parameters.items():
            self._put(name, value)
        return self._graph, self._is_single

    def set(self, name: str, value: Any) -> None:
        """Sets a parameter, for all frames: `posterize`, or `node.posterize` where several nodes have it."""
        self._put(name, as_text(value, f"parameter '{name}'"))

    def _put(self, name: str, value: str | Keys) -> None:
        with self._lock:
            node, param = self._find(name)
            self._keys.pop((node, param), None)
            if isinstance(value, str):
                self._graph.set(node, param, value)
                return
            # From the last to the first, whose value stays.
            for _, text in reversed(value.values):
                self._graph.set(node, param, text)
            declared = self._specs()[node][1].param(param)
            assert declared is not None, "the graph took a value for it"
            self._keys[node, param] = (value, declared)

    def _find(self, name: str) -> tuple[int, str]:
        """The node that a parameter's name means, and the parameter."""
        specs = self._specs()
        node_name, _, param = name.rpartition(".")
        if node_name:
            for index, (known, _) in enumerate(specs):
                if known == node_name:
                    return index, param
            names = ", ".join(known for known, _ in specs)
            raise InvalidValueError(f"the graph has no node '{node_name}'; choose from {names}")
        holders = [index for index, (_, spec) in enumerate(specs) if spec.param(param)]
        if len(holders) == 1 or (self._is_single and 0 in holders):
            return holders[0], param
        if holders:
            first, second = (specs[index][0] for index in holders[:2])
            raise InvalidValueError(
                f"several nodes of the graph have a parameter '{param}'; write {first}.{param} or {second}.{param}"
            )
        if self._is_single:
            # It is asked even when it has no such parameter: its message names the nearest.
            return 0, param
        raise InvalidValueError(f"no node of the graph has a parameter '{param}'")

    def _specs(self) -> list[tuple[str, Node]]:
        known = catalogue()
        return [(name, known[id]) for name, id in self._graph.nodes()]

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

    def _at(self, frame: int) -> None:
        """Gives animated parameters their values at a frame."""
        for (node, param), (keys, declared) in self._keys.items():
            self._graph.set(node, param, keys.at(frame, declared))

    def apply(
        self,
        image: Any,
        /,
        *,
        out: Array | None = None,
        frame: int = 0,
        settings: Settings | None = None,
        **inputs: Any,
    ) -> Array:
        """Applies the style to a picture. `isophote.apply` describes the arguments."""
        guides = {name: inputs.pop(name) for name in GUIDES if name in inputs}
        settings = settings or Settings(**inputs)
        images = {"color": pixels(image, "color")}
        images.update((name, pixels(guide, name)) for name, guide in guides.items() if guide is not None)
        request = settings.request(images["color"], list(images), frame, self._lengths)
        with self._lock:
            self._at(frame)
            target = Target(image, self.output_kind, out)
            self._graph.process(request, images, target.pixels, settings.device, settings.threads, settings.progress)
        return target.finished()


def _is_graph(text: str) -> bool:
    try:
        file = json.loads(text)
    except ValueError:
        return False
    return isinstance(file, dict) and ("nodes" in file or "format" in file)


def _fed(node: str) -> native.Graph:
    """A graph of one node, fed with what it needs and no picture gives, such as a tensor: from the first node of the
    catalogue that makes it of pictures alone."""
    graph = native.Graph.single(node)
    nodes = catalogue()

    def is_picture(name: str) -> bool:
        return name in ("color", *GUIDES)

    for port in nodes[node].inputs:
        if port.optional or is_picture(port.id):
            continue
        for feeder in nodes.values():
            makes = feeder.output.kind == port.kind and feeder.id != node
            if makes and all(p.optional or is_picture(p.id) for p in feeder.inputs):
                index = graph.add(port.id, feeder.id)
                for picture in feeder.inputs:
                    if is_picture(picture.id):
                        graph.connect_input(picture.id, index)
                graph.connect(index, 0, port.id)
                break
    return graph


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
    out: Array | None = None,
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
    RGB, RGBA, or grey with or without alpha. They are read, and `out` is written, where they lie in memory if pixels of a
    row follow each other there, whatever the order of rows; other layouts are copied. Guides are what a renderer knows:

    - `normal`: view-space normals, 3 or 4 channels of floats, x right, y up, z towards the camera.
    - `depth`: distance from the camera, 0 or less where there is nothing.
    - `object_id`: a number per object, 0 where there is nothing.
    - `mask`: how much of the result is used.
    - `flow`: a painted flow map.
    - `motion`, `motion_forward`: to the frame before and the next, in pixels, x right and y down.
    - `rest_position`: points of the undeformed objects, 32 bits a channel.

    `color_space` is `srgb` (gamma-encoded), `linear` (Rec. 709) or `acescg`, and the result has the same. `alpha_mode` is
    `straight`; `premultiplied`, as renderers write it; or `emissive`, premultiplied with light where alpha is 0. `lengths`
    of parameters are `relative`, in pixels of a picture 1080 lines high, unless a preset says otherwise, or `pixels` of the
    picture itself. `scale` is the picture's size over full size; `origin` is where it stands in the canonical picture,
    which has `canonical_height` lines. `frame` renews what `hold` lets last, and tells keyframes of presets apart.

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
    )


def opened(style: StyleLike | Style, /, **params: Any) -> Style:
    """The style with these parameters; one that is open has its own."""
    if not isinstance(style, Style):
        return Style(style, **params)
    given = [name for name, value in params.items() if (name, value) != ("precision", "exact")]
    if given:
        raise TypeError(f"the style is open and has its own {', '.join(given)}; use its method set")
    return style
