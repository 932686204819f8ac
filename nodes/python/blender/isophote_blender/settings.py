"""The settings of a scene, generated from the catalogue of the library."""

import bpy
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

import isophote

from .materials import MATERIALS

STYLES: dict[str, isophote.Node] = {
    id: node
    for id, node in isophote.catalogue().items()
    if node.output.kind == "color" and all(port.optional or port.id == "color" for port in node.inputs)
}
"""Nodes that make a picture of a picture, by id: styles first, as the catalogue has them."""

# A path of files to come, which would be red otherwise; Blender 4.5 and later ask whether it may be relative, too.
_OUTPUT = {"ANIMATABLE", "OUTPUT_PATH"}
if "is_path_supports_blend_relative" in bpy.types.Property.bl_rna.properties:
    _OUTPUT.add("PATH_SUPPORTS_BLEND_RELATIVE")

# Blender keeps no copy of the texts of items.
_STYLE_ITEMS = [(id, node.label, node.hint) for id, node in STYLES.items()]


def group_name(node_id: str) -> str:
    """The property of the settings that holds a node's parameters."""
    return f"params_{node_id}"


def _property(param: isophote.Param) -> object:
    """A parameter as a property of Blender's."""
    common = {"name": param.label, "description": param.hint}
    if param.type in ("float", "int"):
        low, high = param.range or (0, 1)
        soft_low, soft_high = param.slider or (low, high)
        ranges = {"min": low, "max": high, "soft_min": soft_low, "soft_max": soft_high}
        make = FloatProperty if param.type == "float" else IntProperty
        return make(default=param.default, **ranges, **common)
    if param.type == "bool":
        return BoolProperty(default=param.default, **common)
    if param.type == "choice":
        items = [(option.id, option.label, "") for option in param.options]
        return EnumProperty(items=items, default=param.default, **common)
    return FloatVectorProperty(default=param.default, size=4, min=0.0, max=1.0, subtype="COLOR_GAMMA", **common)


def _group(node: isophote.Node) -> type:
    """A group of properties for the parameters of a node."""
    properties = {param.id: _property(param) for param in node.params}
    return type(f"ISOPHOTE_PG_{node.id}", (bpy.types.PropertyGroup,), {"__annotations__": properties})


_GROUPS = {id: _group(node) for id, node in STYLES.items()}


class ISOPHOTE_PG_settings(bpy.types.PropertyGroup):
    """What a scene's render is stylized with."""

    __annotations__ = {
        "style": EnumProperty(name="Style", description="What the render is made into", items=_STYLE_ITEMS, default="cartoon"),
        "colors": EnumProperty(
            name="Colours",
            description="Which colours the style sees and gives",
            items=[
                (
                    "display",
                    "As displayed",
                    "After exposure and view transform: colours of ink and paper come out as chosen",
                ),
                ("linear", "Scene-linear", "Before them, for further compositing"),
            ],
        ),
        "lengths": EnumProperty(
            name="Lengths",
            description="What a pixel of a parameter is",
            items=[
                ("relative", "Relative", "Pixels of a picture 1080 lines high: the same look at any resolution"),
                ("pixels", "Pixels", "Pixels of the render itself"),
            ],
        ),
        "device": EnumProperty(
            name="Device",
            description="What computes the style",
            items=[
                ("auto", "Automatic", "A graphics card if there is one, otherwise the CPU"),
                ("cpu", "CPU", "The CPU"),
                ("gpu", "GPU", "The best graphics device there is"),
            ],
        ),
        "output": StringProperty(
            name="Output",
            description="Files of a stylized animation; # stands for digits of the frame",
            default="//stylized/####",
            subtype="FILE_PATH",
            options=_OUTPUT,
        ),
        **{id: PointerProperty(name=name, description=hint, type=bpy.types.Image) for id, (name, hint) in MATERIALS.items()},
        **{group_name(id): PointerProperty(type=group) for id, group in _GROUPS.items()},
    }


def values(settings: ISOPHOTE_PG_settings) -> dict[str, isophote.Value]:
    """The parameters of the chosen style, as the library takes them."""
    group = getattr(settings, group_name(settings.style))
    found = {}
    for param in STYLES[settings.style].params:
        value = getattr(group, param.id)
        found[param.id] = tuple(value) if param.type == "color" else value
    return found


def use(settings: ISOPHOTE_PG_settings, preset: isophote.Preset) -> None:
    """Sets the style and its parameters to those of a preset of one node."""
    settings.style = preset.style
    settings.lengths = preset.lengths
    group = getattr(settings, group_name(settings.style))
    given = preset.values(STYLES[settings.style])
    for param in STYLES[settings.style].params:
        setattr(group, param.id, given.get(param.id, param.default))


def register() -> None:
    """Makes the settings known to Blender."""
    for group in (*_GROUPS.values(), ISOPHOTE_PG_settings):
        bpy.utils.register_class(group)
    bpy.types.Scene.isophote = PointerProperty(type=ISOPHOTE_PG_settings)


def unregister() -> None:
    """Takes them away again; what scenes have set is kept in their files."""
    del bpy.types.Scene.isophote
    for group in (ISOPHOTE_PG_settings, *_GROUPS.values()):
        bpy.utils.unregister_class(group)
