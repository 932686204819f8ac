"""Rules for objects: how each of them is drawn, set among its own properties."""

from typing import Any

import bpy
from bpy.props import BoolProperty, FloatProperty, FloatVectorProperty, PointerProperty

FACTORS = {
    "line_width": ("Line width", "How wide its lines are, against those of the style"),
    "line_amount": ("Line amount", "How many lines it has, against what the style draws"),
    "detail": ("Detail", "How much detail it keeps, against the style"),
    "medium": ("Medium", "How strong grain, hatching or pigment are on it"),
}
"""Factors of a rule, with their names and hints; 1 changes nothing."""


def _factor(name: str, hint: str) -> object:
    """A factor as a property of Blender's."""
    return FloatProperty(name=name, description=hint, default=1.0, min=0.25, max=4.0)


class ISOPHOTE_PG_rule(bpy.types.PropertyGroup):
    """How an object is drawn."""

    __annotations__ = {
        "enabled": BoolProperty(name="Rule", description="Draws the object by a rule of its own"),
        "lines": BoolProperty(name="Lines", description="Draws lines on the object and around it", default=True),
        **{id: _factor(*texts) for id, texts in FACTORS.items()},
        "has_line_color": BoolProperty(name="Own line colour", description="Draws its lines in a colour of their own"),
        "line_color": FloatVectorProperty(
            name="Line colour", description="Colour of its lines", size=3, min=0.0, max=1.0, subtype="COLOR_GAMMA"
        ),
    }


def of(scene: bpy.types.Scene) -> list[dict[str, Any]]:
    """The rules of a scene's objects, as presets have them: by pass index."""
    return [_rule(thing) for thing in _ruled(scene) if thing.pass_index > 0]


def unnumbered(scene: bpy.types.Scene) -> list[str]:
    """Names of objects with a rule that renders cannot tell from others, since they have no pass index."""
    return [thing.name for thing in _ruled(scene) if thing.pass_index == 0]


def _ruled(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    return [thing for thing in scene.objects if thing.isophote.enabled]


def _rule(thing: bpy.types.Object) -> dict[str, Any]:
    own = thing.isophote
    rule: dict[str, Any] = {"match": f"id:{thing.pass_index}"}
    factors = {id: getattr(own, id) for id in FACTORS}
    if not own.lines:
        # Without lines there is no amount of them.
        del factors["line_amount"]
        rule["lines"] = False
    rule.update({id: factor for id, factor in factors.items() if factor != 1.0})
    if own.has_line_color:
        rule["line_color"] = "#" + "".join(f"{round(channel * 255):02x}" for channel in own.line_color)
    return rule


def register() -> None:
    """Makes rules known to Blender."""
    bpy.utils.register_class(ISOPHOTE_PG_rule)
    bpy.types.Object.isophote = PointerProperty(type=ISOPHOTE_PG_rule)


def unregister() -> None:
    """Takes them away again; what objects have set is kept in their files."""
    del bpy.types.Object.isophote
    bpy.utils.unregister_class(ISOPHOTE_PG_rule)
