"""Sequences of frames: what neighbouring frames have in common is computed once and kept."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

from ._inputs import Array, given
from ._library import native
from ._pixels import Target, pixels, tiled
from .presets import StyleLike
from .style import GUIDES, Settings, Style, opened

Source = Callable[[str, int], Any]
"""Gives the picture of an input, such as `color` or `motion`, in a frame; None where there is none."""

MEMORY = 1 << 30
"""Bytes that are kept between frames, unless said otherwise."""


class Sequence:
    """A style on the frames of a sequence, in any order.

    A frame depends on the frames around it that there are, never on which were computed before. Pictures are asked for as
    they are needed. Threads may share a sequence; they wait for each other.
    """

    def __init__(
        self,
        style: StyleLike | Style,
        source: Source | Mapping[str, Mapping[int, Any]],
        guides: Iterable[str] | None = None,
        /,
        *,
        memory: int = MEMORY,
        max_motion: float = 0.0,
        **settings: Any,
    ) -> None:
        """A style on what `source` gives: a function of an input's name and a frame, or frames by number by input.

        `guides` are the inputs beside the colour that there are, in all frames alike; those of the mapping unless given.
        `motion` leads from where a point is to where it was in the frame before, `motion_forward` to where it will be
        in the next, in pixels, x right and y down. At most `memory` bytes are kept; motion longer than `max_motion` pixels
        is unknown, 0 for the library's own bound. The other arguments are those of `isophote.apply`.
        """
        params = {name: settings.pop(name) for name in list(settings) if name not in _SETTINGS}
        self._settings = Settings(**settings)
        self.style = opened(style, **params)
        if callable(source):
            self._source, self._guides = source, list(guides or ())
        else:
            given = source
            self._source = lambda name, frame: given.get(name, {}).get(frame)
            self._guides = [name for name in given if name in GUIDES] if guides is None else list(guides)
        self._sequence = native.Sequence(memory, max_motion)
        self._lock = threading.RLock()

    def frame(self, number: int, out: Any = None) -> Array:
        """The stylized picture of a frame, in `out` where that is given."""
        picture = self._source("color", number)
        if picture is None:
            raise IndexError(f"there is no frame {number}")
        image = given(picture, "color")
        colors = self._settings.colors

        def source(name: str, frame: int) -> Array | None:
            found = image if (name, frame) == ("color", number) else self._source(name, frame)
            if found is None:
                return None
            read = tiled(found, name, image.shape[:2])
            return colors.entering(read) if name == "color" else read

        request = self._settings.request(pixels(image, "color"), self._guides, number, self.style)
        with self._lock, self.style._lock:
            self.style._at(number)
            target = Target(image, self.style.output_kind, out, colors)
            self._sequence.process(
                self.style._graph,
                request,
                source,
                target.pixels,
                self._settings.device,
                self._settings.threads,
                self._settings.progress,
            )
        return target.finished()

    def forget(self) -> None:
        """Gives back all memory; to be called when frames of the same numbers show something else, too."""
        self._sequence.forget()


_SETTINGS = (
    "color_space",
    "alpha_mode",
    "lengths",
    "scale",
    "origin",
    "canonical_height",
    "device",
    "threads",
    "progress",
)


def frames(
    style: StyleLike | Style,
    images: Iterable[Any],
    /,
    *,
    first: int = 1,
    memory: int = MEMORY,
    max_motion: float = 0.0,
    **settings: Any,
) -> Iterator[Array]:
    """Applies a style to pictures in order, such as those of a video, and yields the results.

    `motion`, `motion_forward`, `normal` and the other guides are iterables, too, in step with the pictures. Only as many
    pictures are read ahead, and kept, as the style looks around; they must not be changed meanwhile. `first` is the number
    of the first frame. The other arguments are those of `Sequence`.
    """
    streams = {"color": iter(images)}
    streams.update((name, iter(settings.pop(name))) for name in GUIDES if settings.get(name) is not None)
    window: dict[int, dict[str, Any]] = {}

    def source(name: str, frame: int) -> Any:
        return window.get(frame, {}).get(name)

    guides = [name for name in streams if name != "color"]
    sequence = Sequence(style, source, guides, memory=memory, max_motion=max_motion, **settings)
    past, future = sequence.style.frames
    number, read, at_end = first, first, False
    while True:
        while not at_end and read <= number + future:
            entry = {name: next(stream, None) for name, stream in streams.items()}
            at_end = entry["color"] is None
            if not at_end:
                window[read] = entry
                read += 1
        if number not in window:
            return
        yield sequence.frame(number)
        window.pop(number - past, None)
        number += 1
