"""The settings in the render properties: one panel, and one below it for every group of the style's parameters. Rules are among
the properties of objects."""

import bpy

from .materials import MATERIALS
from .rules import FACTORS
from .settings import STYLES, group_name


class ISOPHOTE_PT_style(bpy.types.Panel):
    """The style and what is done with it."""

    bl_label = "Isophote"
    bl_idname = "ISOPHOTE_PT_style"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Draws it."""
        layout, settings = self.layout, context.scene.isophote
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(settings, "style")
        layout.operator("isophote.use_look", icon="VIEWZOOM")
        for name in ("colors", "lengths", "device"):
            layout.prop(settings, name)
        for port in STYLES[settings.style].inputs:
            if port.id in MATERIALS:
                layout.template_ID(settings, port.id, open="image.open", text=MATERIALS[port.id][0])
        column = layout.column(align=True)
        column.operator("isophote.prepare", icon="RENDERLAYERS")
        column.operator("isophote.stylize", icon="RENDER_STILL")
        layout.prop(settings, "output")
        layout.operator("isophote.stylize_animation", icon="RENDER_ANIMATION")


def _headings() -> list[str]:
    """Groups of all parameters, in their order."""
    found = {param.group: None for node in STYLES.values() for param in node.params}
    return list(found)


def _panel(number: int, heading: str) -> type:
    """A panel for the parameters under a heading."""

    def poll(cls: type, context: bpy.types.Context) -> bool:
        return any(param.group == heading for param in STYLES[context.scene.isophote.style].params)

    def draw(self: bpy.types.Panel, context: bpy.types.Context) -> None:
        settings = context.scene.isophote
        self.layout.use_property_split = True
        for param in STYLES[settings.style].params:
            if param.group == heading:
                self.layout.prop(getattr(settings, group_name(settings.style)), param.id)

    members = {
        "bl_label": heading.capitalize() or "Parameters",
        "bl_idname": f"ISOPHOTE_PT_params_{number}",
        "bl_parent_id": ISOPHOTE_PT_style.bl_idname,
        "bl_space_type": "PROPERTIES",
        "bl_region_type": "WINDOW",
        "bl_context": "render",
        "bl_options": set() if number == 0 else {"DEFAULT_CLOSED"},
        "poll": classmethod(poll),
        "draw": draw,
    }
    return type(members["bl_idname"], (bpy.types.Panel,), members)


class ISOPHOTE_PT_rule(bpy.types.Panel):
    """How an object is drawn, among its properties."""

    bl_label = "Isophote"
    bl_idname = "ISOPHOTE_PT_rule"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """True where there is an object to draw."""
        return context.object is not None and context.object.type not in {"CAMERA", "LIGHT", "LIGHT_PROBE", "SPEAKER"}

    def draw_header(self, context: bpy.types.Context) -> None:
        """Draws the switch."""
        self.layout.prop(context.object.isophote, "enabled", text="")

    def draw(self, context: bpy.types.Context) -> None:
        """Draws it."""
        layout, rule = self.layout, context.object.isophote
        layout.use_property_split = True
        layout.active = rule.enabled
        layout.prop(rule, "lines")
        for factor in FACTORS:
            if rule.lines or factor != "line_amount":
                layout.prop(rule, factor)
        layout.prop(rule, "has_line_color")
        if rule.has_line_color:
            layout.prop(rule, "line_color")


_CLASSES = (ISOPHOTE_PT_rule, ISOPHOTE_PT_style, *(_panel(number, heading) for number, heading in enumerate(_headings())))


def register() -> None:
    """Makes the panels known to Blender."""
    for panel in _CLASSES:
        bpy.utils.register_class(panel)


def unregister() -> None:
    """Takes them away again."""
    for panel in reversed(_CLASSES):
        bpy.utils.unregister_class(panel)
