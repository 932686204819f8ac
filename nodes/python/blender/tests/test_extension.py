"""The extension in Blender, on a rendered scene."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import bpy
import numpy as np
import pytest

import isophote


def shown() -> np.ndarray:
    """What the image of results shows, rows from top to bottom."""
    image = bpy.data.images["Stylized Render"]
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(image.size[1], image.size[0], 4)[::-1]


def test_settings_are_those_of_the_catalogue(scene: Any, extension: ModuleType) -> None:
    settings = scene.isophote
    styles = extension.settings.STYLES
    assert settings.style == "cartoon" and len(styles) > 20
    for id, node in styles.items():
        settings.style = id
        found = extension.settings.values(settings)
        assert list(found) == [param.id for param in node.params]
        for param in node.params:
            exact = isinstance(param.default, (str, bool))
            assert found[param.id] == (param.default if exact else pytest.approx(param.default, rel=1e-6)), (id, param.id)
            declared = getattr(settings, f"params_{id}").bl_rna.properties[param.id]
            assert declared.name == param.label
            if param.range and param.type in ("float", "int"):
                assert (declared.hard_min, declared.hard_max) == pytest.approx(param.range, rel=1e-6)

    output = settings.bl_rna.properties["output"]
    # Blender paints paths red that have to exist, and those with // where they must not be relative.
    assert output.is_path_output and getattr(output, "is_path_supports_blend_relative", True)

    class Layout:
        """Notes what is drawn, as no window is there to draw in."""

        def __init__(self) -> None:
            self.drawn: list[str] = []

        def prop(self, owner: Any, name: str) -> None:
            assert hasattr(owner, name)
            self.drawn.append(name)

        def template_ID(self, owner: Any, name: str, open: str, text: str) -> None:
            assert hasattr(owner, name) and hasattr(bpy.ops.image, open.split(".")[1]) and text
            self.drawn.append(name)

        def operator(self, name: str, icon: str) -> None:
            assert hasattr(bpy.ops.isophote, name.split(".")[1])

        def column(self, align: bool) -> Layout:
            return self

    panels = [name for name in dir(bpy.types) if name.startswith("ISOPHOTE_PT_params")]
    assert len(panels) == len({param.group for node in styles.values() for param in node.params})
    for id, node in styles.items():
        settings.style = id
        layout = Layout()
        for panel in (getattr(bpy.types, name) for name in panels):
            if panel.poll(bpy.context):
                panel.draw(SimpleNamespace(layout=layout), bpy.context)
        assert sorted(layout.drawn) == sorted(param.id for param in node.params)
    bpy.types.ISOPHOTE_PT_style.draw(SimpleNamespace(layout=layout), bpy.context)
    assert {"style", "colors", "lengths", "device", "output"} <= set(layout.drawn)


def test_looks_set_every_parameter(scene: Any, extension: ModuleType) -> None:
    settings = scene.isophote
    for id, look in isophote.looks().items():
        settings.params_ink.tone = 0.123
        assert bpy.ops.isophote.use_look(look=id) == {"FINISHED"}
        assert settings.style == look.style
        chosen = isophote.Style(settings.style, **extension.settings.values(settings))
        expected = isophote.Style(f"look:{id}")
        assert chosen.to_json() == expected.to_json(), id


def test_objects_are_drawn_by_their_rules(scene: Any, extension: ModuleType) -> None:
    bpy.ops.render.render()
    ball = scene.objects["ball"]
    ids = extension.passes.read(scene, "ViewLayer", "display").guides["object_id"][..., 0]
    inside = ids == ball.pass_index
    scene.isophote.lengths, scene.isophote.params_cartoon.line_width = "pixels", 2

    def stylized() -> np.ndarray:
        assert bpy.ops.isophote.stylize() == {"FINISHED"}
        return shown().copy()

    def red(pixels: np.ndarray) -> int:
        return int((pixels[..., 0] > 2 * pixels[..., 1] + 0.1).sum())

    plain = stylized()
    rule = ball.isophote
    rule.line_color = (0.8, 0, 0)
    rule.has_line_color = True
    assert np.array_equal(stylized(), plain), "rules that are off change nothing"
    rule.enabled = True
    assert extension.rules.of(scene) == [{"match": f"id:{ball.pass_index}", "line_color": "#cc0000"}]
    coloured = stylized()
    assert red(plain) == 0 and red(coloured) > 50
    rule.lines, rule.has_line_color, rule.detail = False, False, 2
    assert extension.rules.of(scene) == [{"match": f"id:{ball.pass_index}", "lines": False, "detail": 2.0}]
    without = stylized()
    assert without[inside].min(axis=-1).mean() > plain[inside].min(axis=-1).mean()
    # What no number tells from other things has no rule.
    ball.pass_index = 0
    assert extension.rules.of(scene) == [] and extension.rules.unnumbered(scene) == ["ball"]
    assert np.array_equal(stylized(), plain)


def test_light_is_cut_into_steps(scene: Any, extension: ModuleType) -> None:
    paint = bpy.data.materials.new("paint")
    paint.use_nodes = True
    surface = next(node for node in paint.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    surface.inputs["Base Color"].default_value = (0.5, 0.2, 0.1, 1)
    surface.inputs["Roughness"].default_value = 1
    ball = scene.objects["ball"]
    ball.data.materials.append(paint)
    bpy.ops.render.render()
    frame = extension.passes.read(scene, "ViewLayer", "linear")
    inside = frame.guides["object_id"][..., 0] == ball.pass_index
    albedo, diffuse = (frame.guides[name][inside] for name in ("albedo", "diffuse"))
    middle = np.median(albedo, axis=0)
    assert middle == pytest.approx([0.5, 0.2, 0.1, 1], abs=0.01)
    # Light has the colours of the surface in it, and is the picture where nothing shines.
    lit = diffuse[:, 0] > 0.1
    assert np.median(diffuse[lit, 1] / diffuse[lit, 0]) == pytest.approx(0.4, abs=0.02)
    whole = diffuse + frame.guides["specular"][inside]
    assert np.median(np.abs(whole - frame.color[inside])[:, :3]) < 0.01
    scene.view_settings.exposure = 1
    shown_frame = extension.passes.read(scene, "ViewLayer", "display")
    scene.view_settings.exposure = 0
    encoded = np.median(shown_frame.guides["albedo"][inside], axis=0)
    assert encoded == pytest.approx([0.735, 0.485, 0.349, 1], abs=0.01)

    settings = scene.isophote
    settings.style = "toon_shading"
    assert bpy.ops.isophote.stylize() == {"FINISHED"}
    red = np.round(shown()[inside][:, 0], 2)
    _, counts = np.unique(red, return_counts=True)
    assert np.sort(counts)[-3:].sum() > 0.6 * inside.sum(), "few steps have most of the ball"


@pytest.mark.parametrize("colors", ["display", "linear"])
def test_styles_draw_on_materials(scene: Any, extension: ModuleType, tmp_path: Path, colors: str) -> None:
    settings = scene.isophote
    settings.style, settings.colors = "ink", colors
    bpy.ops.render.render()

    def stylized() -> np.ndarray:
        assert bpy.ops.isophote.stylize() == {"FINISHED"}
        return shown().copy()

    plain = stylized()
    paper = bpy.data.images.new("paper", 240, 120)
    paper.pixels.foreach_set(np.tile(np.float32([0.2, 0.6, 0.3, 1]), 240 * 120))
    settings.paper = paper
    green = stylized()
    expected = [0.2, 0.6, 0.3] if colors == "display" else [0.0331, 0.3185, 0.0732]
    light = green[..., 1] >= np.quantile(green[..., 1], 0.8)
    assert np.median(green[light][:, :3], axis=0) == pytest.approx(expected, abs=0.05)
    assert not np.array_equal(plain, green)
    scene.frame_start = scene.frame_end = scene.frame_current
    settings.output = str(tmp_path / "####")
    assert bpy.ops.isophote.stylize_animation() == {"FINISHED"}
    assert np.array_equal(shown(), green), "frames of animations lie on it, too"
    # As large as its pixels on 1080 lines, where the render has 90.
    over = extension.materials.on(scene, {"paper"}, 90)["paper"]
    assert over.shape == (10, 20, 4) and tuple(paper.size) == (240, 120)
    assert "paper.001" not in bpy.data.images
    settings.style = "cartoon"
    assert extension.materials.on(scene, {"color"}, 90) == {}
    settings.paper = None
    settings.style = "ink"
    assert np.array_equal(stylized(), plain)


def test_passes_are_what_the_library_means(scene: Any, extension: ModuleType) -> None:
    scene.frame_set(5)
    before = [getattr(scene.render.image_settings, name) for name in ("file_format", "color_mode", "color_depth")]
    bpy.ops.render.render()
    frame = extension.passes.read(scene, "ViewLayer", "linear")
    after = [getattr(scene.render.image_settings, name) for name in ("file_format", "color_mode", "color_depth")]
    assert before == after
    ids = frame.guides["object_id"][..., 0]
    ball = ids == scene.objects["ball"].pass_index
    assert 200 < ball.sum() < 4000 and set(np.unique(ids)) >= {0}
    depth = frame.guides["depth"][..., 0]
    assert (depth[ids == 0] == 0).all() and 6 < depth[ball].min() < 8.5
    normal = frame.guides["normal"]
    rows, columns = np.nonzero(ball)
    middle = normal[int(rows.mean()), int(columns.mean())]
    assert middle[2] > 0.9, "the middle of the ball faces the camera"
    left = normal[int(rows.mean()), columns.min() + 2]
    top = normal[rows.min() + 1, int(columns.mean())]
    assert left[0] < -0.7 and top[1] > 0.7
    # The ball moves to the right: it comes from the left, and goes to the right.
    motion, forward = frame.guides["motion"][ball], frame.guides["motion_forward"][ball]
    assert (motion[:, 0] < -0.5).all() and (forward[:, 0] > 0.5).all()
    assert np.abs(motion[:, 1]).max() < 0.5
    scene.frame_set(4)
    bpy.ops.render.render()
    earlier = extension.passes.read(scene, "ViewLayer", "linear").guides["object_id"][..., 0] == ids[ball][0]
    came_from = np.nonzero(earlier)[1].mean() - columns.mean()
    assert came_from == pytest.approx(motion[:, 0].mean(), abs=0.4)


@pytest.mark.parametrize("colors", ["display", "linear"])
def test_a_still_comes_back_as_an_image(scene: Any, extension: ModuleType, colors: str) -> None:
    settings = scene.isophote
    settings.colors, settings.lengths = colors, "pixels"
    settings.params_cartoon.posterize, settings.params_cartoon.detail = 6, 0.4
    bpy.ops.render.render()
    assert bpy.ops.isophote.stylize() == {"FINISHED"}
    frame = extension.passes.read(scene, "ViewLayer", colors)
    guides = {name: guide for name, guide in frame.guides.items() if "motion" not in name}
    assert set(guides) == {"depth", "normal", "object_id", "albedo", "diffuse", "specular"}
    space = {"display": ("srgb", "straight"), "linear": ("linear", "premultiplied")}[colors]
    common = {"color_space": space[0], "alpha_mode": space[1], "lengths": "pixels", "posterize": 6, "detail": np.float32(0.4)}
    out = np.empty((*frame.color.shape[:2], 4), np.float32)
    expected = isophote.apply("cartoon", frame.color, out=out, frame=scene.frame_current, **common, **guides)
    result = shown()
    if colors == "linear":
        assert np.array_equal(result, expected)
    else:
        # Images of display colours have eight bits.
        assert np.abs(result - expected).max() <= 0.6 / 255
    plain = isophote.apply("cartoon", frame.color, out=np.empty_like(out), **common)
    ids = guides["object_id"][..., 0]
    border = ids[:, 1:] != ids[:, :-1]
    assert np.abs(expected - plain)[:, 1:][border].mean() > 0.05, "passes draw lines where things meet"
    # Once more, after it was saved, which turns it into a file's image.
    bpy.data.images["Stylized Render"].filepath_raw = str(Path(bpy.app.tempdir) / "saved.png")
    bpy.data.images["Stylized Render"].file_format = "PNG"
    bpy.data.images["Stylized Render"].save()
    assert bpy.ops.isophote.stylize() == {"FINISHED"}
    assert np.array_equal(shown(), result)


@pytest.mark.parametrize(("colors", "ending"), [("linear", ".exr"), ("display", ".png")])
def test_an_animation_is_written_frame_by_frame(
    scene: Any, extension: ModuleType, tmp_path: Path, colors: str, ending: str
) -> None:
    settings = scene.isophote
    scene.frame_start, scene.frame_end = 3, 6
    scene.frame_set(8)
    settings.colors, settings.output = colors, str(tmp_path / "shot/####")
    settings.params_cartoon.steadiness = 1
    settings.params_cartoon.posterize = 4
    settings.params_cartoon.keyframe_insert("posterize", frame=3)
    settings.params_cartoon.posterize = 10
    settings.params_cartoon.keyframe_insert("posterize", frame=6)
    assert bpy.ops.isophote.stylize_animation() == {"FINISHED"}
    assert scene.frame_current == 8
    files = sorted(file.name for file in (tmp_path / "shot").iterdir())
    assert files == [f"{number:04}{ending}" for number in range(3, 7)]
    assert not [image.name for image in bpy.data.images if image.name.endswith(ending)]
    frames, chosen = {}, {}
    for number in range(3, 7):
        scene.frame_set(number)
        bpy.ops.render.render()
        frames[number] = extension.passes.read(scene, "ViewLayer", colors)
        chosen[number] = extension.settings.values(settings)
    assert {chosen[n]["posterize"] for n in (3, 6)} == {4, 10}
    source = {"color": {n: frame.color for n, frame in frames.items()}}
    source.update((name, {n: frame.guides[name] for n, frame in frames.items()}) for name in frames[3].guides)
    linear = {"color_space": "linear", "alpha_mode": "premultiplied"}
    space, tolerance = (linear, 2e-3) if colors == "linear" else ({}, 0.6 / 255)
    for number in (3, 5):
        style = isophote.Style("cartoon", **chosen[number])
        expected = isophote.Sequence(style, source, **space).frame(number)
        written = bpy.data.images.load(str(tmp_path / f"shot/{number:04}{ending}"))
        pixels = np.empty(len(written.pixels), np.float32)
        written.pixels.foreach_get(pixels)
        assert np.abs(pixels.reshape(expected.shape)[::-1] - expected).max() < tolerance
        alone = isophote.apply(style, frames[number].color, frame=number, **space)
        assert not np.allclose(alone, expected, atol=tolerance), "neighbours count"


def test_all_windows_with_images_show_the_result(scene: Any, extension: ModuleType) -> None:
    image = bpy.data.images.new("Stylized Render", 2, 2)
    views = [
        SimpleNamespace(type=kind, spaces=SimpleNamespace(active=SimpleNamespace(image=None)))
        for kind in ("PROPERTIES", "VIEW_3D", "IMAGE_EDITOR")
    ]
    # Where nobody has chosen otherwise, Blender opens a window for each render.
    windows = [SimpleNamespace(screen=SimpleNamespace(areas=areas)) for areas in (views[:2], views[2:])]
    extension.operators._show(SimpleNamespace(window_manager=SimpleNamespace(windows=windows)), image)
    assert [view.spaces.active.image for view in views] == [None, None, image]


def test_mistakes_are_told(scene: Any, extension: ModuleType, tmp_path: Path) -> None:
    for image in list(bpy.data.images):
        bpy.data.images.remove(image)
    with pytest.raises(RuntimeError, match="render the image first"):
        bpy.ops.isophote.stylize()
    bpy.ops.render.render()
    scene.isophote.params_cartoon.window = 2
    (tmp_path / "file").write_text("")
    scene.isophote.output = str(tmp_path / "file/####")
    scene.frame_start = scene.frame_end = 1
    with pytest.raises(RuntimeError, match="file"):
        bpy.ops.isophote.stylize_animation()
    assert extension.stylize.path("/a/b", 7, ".png") == Path("/a/b0007.png")
    assert extension.stylize.path("/a/##.PNG", 123, ".png") == Path("/a/123.PNG")


def test_what_the_compositor_makes_is_the_picture(scene: Any, extension: ModuleType) -> None:
    bpy.ops.render.render()
    plain = {colors: extension.passes.read(scene, "ViewLayer", colors) for colors in ("display", "linear")}
    if hasattr(scene, "compositing_node_group"):
        tree = bpy.data.node_groups.new("compositing", "CompositorNodeTree")
        tree.interface.new_socket(name="Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        scene.compositing_node_group = tree
        end = tree.nodes.new("NodeGroupOutput")
    else:
        scene.use_nodes = True
        tree = scene.node_tree
        tree.nodes.clear()
        end = tree.nodes.new("CompositorNodeComposite")
    layers, invert = tree.nodes.new("CompositorNodeRLayers"), tree.nodes.new("CompositorNodeInvert")
    layers.scene = scene
    tree.links.new(layers.outputs["Image"], invert.inputs["Color"])
    tree.links.new(invert.outputs[0], end.inputs[0])
    bpy.ops.render.render()
    made = extension.passes.read(scene, "ViewLayer", "linear")
    assert np.allclose(made.color[..., :3], 1 - plain["linear"].color[..., :3], atol=1e-3)
    assert all(np.array_equal(made.guides[name], guide) for name, guide in plain["linear"].guides.items())
    display = extension.passes.read(scene, "ViewLayer", "display").color
    dark = plain["display"].color[..., 0] < 0.15
    assert dark.any() and (display[dark][:, 0] > 0.6).all()


def test_colours_are_of_the_files_working_space_and_of_one_display(scene: Any, extension: ModuleType) -> None:
    scene.objects["sun"].data.color = (1.0, 0.2, 0.05)
    bpy.ops.render.render()
    before = {colors: extension.passes.read(scene, "ViewLayer", colors).color for colors in ("display", "linear")}
    assert bpy.ops.wm.set_working_color_space(working_space="Linear Rec.2020", convert_colors=True) == {"FINISHED"}
    scene.display_settings.display_device = "Display P3"
    written = scene.render.image_settings

    def chosen() -> tuple[str, str, str]:
        display, linear = written.display_settings, written.linear_colorspace_settings
        return written.color_management, display.display_device, linear.name

    for override in (False, True):
        if override:
            written.color_management = "OVERRIDE"
            written.display_settings.display_device = "Rec.1886"
            written.linear_colorspace_settings.name = "ACEScg"
        asked = chosen()
        bpy.ops.render.render()
        now = {colors: extension.passes.read(scene, "ViewLayer", colors).color for colors in ("display", "linear")}
        assert np.abs(now["display"] - before["display"]).max() < 3 / 255
        # The matrix of Rec. ITU-R BT.2087 from Rec.709.
        matrix = np.array([[0.6274, 0.3293, 0.0433], [0.0691, 0.9195, 0.0114], [0.0164, 0.0880, 0.8956]], np.float32)
        light = before["linear"][..., :3] @ matrix.T
        assert np.abs(now["linear"][..., :3] - light).max() < 2e-3 * light.max()
        assert np.abs(light - before["linear"][..., :3]).max() > 0.1
        # What is not overridden counts for nothing.
        assert chosen()[0] == asked[0] and (not override or chosen() == asked)
    scene.isophote.colors = "linear"
    assert bpy.ops.isophote.stylize() == {"FINISHED"}
    assert bpy.data.images["Stylized Render"].colorspace_settings.name == "Linear Rec.2020"
    frame = extension.passes.read(scene, "ViewLayer", "linear")
    guides = {name: guide for name, guide in frame.guides.items() if "motion" not in name}
    common: dict[str, Any] = {"frame": scene.frame_current, "lengths": scene.isophote.lengths, "alpha_mode": "premultiplied"}
    out = np.empty(frame.color.shape, np.float32)
    assert np.array_equal(shown(), isophote.apply("cartoon", frame.color, out=out, color_space="rec2020", **common, **guides))
