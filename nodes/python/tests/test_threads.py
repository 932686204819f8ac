"""Several threads of Python at once."""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import isophote

STYLES = ["cartoon", "ink", "oil_paint", "watercolor", "blueprint", "gaussian"]


def test_threads_get_what_one_gets(small: np.ndarray) -> None:
    alone = {style: isophote.apply(style, small) for style in STYLES}
    shared = {style: isophote.Style(style) for style in STYLES}

    def work(number: int) -> bool:
        style = STYLES[number % len(STYLES)]
        opened = shared[style] if number % 2 else style
        image = small if number % 3 else small.copy()
        return np.array_equal(isophote.apply(opened, image, threads=1 + number % 2), alone[style])

    with ThreadPoolExecutor(8) as pool:
        assert all(pool.map(work, range(96)))


def test_threads_that_share_an_animated_style_get_their_own_frames(small: np.ndarray) -> None:
    preset = {"style": "cartoon", "parameters": {"posterize": {"1": 2, "9": 10}, "detail": 0.4}}
    frames = {frame: isophote.apply("cartoon", small, posterize=frame + 1, detail=0.4) for frame in range(1, 10)}
    style = isophote.Style(preset)
    with ThreadPoolExecutor(6) as pool:
        results = list(pool.map(lambda frame: (frame, isophote.apply(style, small, frame=frame)), [*frames] * 4))
    assert all(np.array_equal(result, frames[frame]) for frame, result in results)


def test_the_interpreter_goes_on_meanwhile(scene: np.ndarray) -> None:
    steps, ended = 0, threading.Event()
    seen: list[int] = []

    def work() -> None:
        isophote.apply("coherent", np.tile(scene, (2, 2, 1)), progress=lambda _: seen.append(steps))
        ended.set()

    thread = threading.Thread(target=work)
    thread.start()
    while not ended.is_set():
        steps += 1
    thread.join()
    assert len(seen) > 1 and seen[-1] > seen[0]


def test_a_graph_may_go_while_others_work(small: np.ndarray) -> None:
    def work(number: int) -> float:
        style = isophote.Style("kuwahara", radius=1 + number % 5)
        result = isophote.apply(style, small)
        del style
        isophote.trim()
        return float(result.mean())

    with ThreadPoolExecutor(8) as pool:
        results = list(pool.map(work, range(40)))
    assert results[:5] * 8 == results
