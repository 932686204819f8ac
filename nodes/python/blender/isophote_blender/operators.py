"""What one can do: stylize a render or an animation, get the passes for it, take a look."""

import bpy
from bpy.props import EnumProperty

import isophote

from . import passes, rules, stylize
from .settings import STYLES, use

_LOOKS = {id: look for id, look in isophote.looks().items() if look.style in STYLES}
_LOOK_ITEMS = [(id, look.name, look.about) for id, look in _LOOKS.items()]
_FAILURES = (isophote.IsophoteError, passes.NoRender, OSError, RuntimeError)


def shown(text: object) -> str:
    """Text for people, which Blender prints on the terminal, too.

    Paths and names of a scene's file may hold what acts on a terminal; it is written as Python writes it.
    """
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in str(text))


def _warn_of_rules(operator: bpy.types.Operator, context: bpy.types.Context) -> None:
    """Warns of rules that cannot be followed."""
    if names := rules.unnumbered(context.scene):
        text = f"no rule for {', '.join(names)}: press Enable Passes, which numbers objects, and render again"
        operator.report({"WARNING"}, shown(text))


class ISOPHOTE_OT_stylize(bpy.types.Operator):
    """Stylize the finished render; the result is the image 'Stylized Render'"""

    bl_idname = "isophote.stylize"
    bl_label = "Stylize Render"

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Does it at once."""
        _warn_of_rules(self, context)
        try:
            image = stylize.still(context)
        except _FAILURES as failure:
            self.report({"ERROR"}, shown(failure))
            return {"CANCELLED"}
        _show(context, image)
        return {"FINISHED"}


class ISOPHOTE_OT_stylize_animation(bpy.types.Operator):
    """Render all frames of the scene and stylize them into files; Esc stops after the frame at hand"""

    bl_idname = "isophote.stylize_animation"
    bl_label = "Stylize Animation"

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Does it at once, as scripts and Blender without a window want it."""
        _warn_of_rules(self, context)
        try:
            for done, count, file in stylize.animation(context):
                print(shown(f"Isophote: {done} of {count}: {file}"))
        except _FAILURES as failure:
            self.report({"ERROR"}, shown(failure))
            return {"CANCELLED"}
        return {"FINISHED"}

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Does a frame at a time, so that the window answers between them."""
        _warn_of_rules(self, context)
        self._frames = stylize.animation(context)
        self._timer = context.window_manager.event_timer_add(0.01, window=context.window)
        context.window_manager.progress_begin(0, 1)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """The next frame."""
        if event.type == "ESC":
            return self._end(context, "CANCELLED")
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        try:
            done, count, _ = next(self._frames)
        except StopIteration:
            return self._end(context, "FINISHED")
        except _FAILURES as failure:
            self.report({"ERROR"}, shown(failure))
            return self._end(context, "CANCELLED")
        context.window_manager.progress_update(done / count)
        _show(context, bpy.data.images[stylize.IMAGE])
        return {"RUNNING_MODAL"}

    def _end(self, context: bpy.types.Context, how: str) -> set[str]:
        self._frames.close()
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        return {how}


class ISOPHOTE_OT_prepare(bpy.types.Operator):
    """Let renders have depth, normals, object indices and motion vectors, and number objects that have no pass index"""

    bl_idname = "isophote.prepare"
    bl_label = "Enable Passes"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Does it."""
        passes.enable(context.view_layer)
        count = passes.number(context.scene)
        if context.scene.render.use_motion_blur:
            self.report({"WARNING"}, "with motion blur Blender renders no motion vectors")
        self.report({"INFO"}, f"{count} objects were numbered")
        return {"FINISHED"}


class ISOPHOTE_OT_use_look(bpy.types.Operator):
    """Set the style and all of its parameters to one of the looks that come along"""

    bl_idname = "isophote.use_look"
    bl_label = "Use Look"
    bl_options = {"REGISTER", "UNDO"}
    bl_property = "look"

    __annotations__ = {"look": EnumProperty(name="Look", items=_LOOK_ITEMS)}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Does it."""
        use(context.scene.isophote, _LOOKS[self.look])
        return {"FINISHED"}

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Lets one search."""
        context.window_manager.invoke_search_popup(self)
        return {"RUNNING_MODAL"}


def _show(context: bpy.types.Context, image: bpy.types.Image) -> None:
    """Shows the image where renders are shown, mostly in a window of their own."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "IMAGE_EDITOR":
                area.spaces.active.image = image


_CLASSES = (
    ISOPHOTE_OT_stylize,
    ISOPHOTE_OT_stylize_animation,
    ISOPHOTE_OT_prepare,
    ISOPHOTE_OT_use_look,
)


def register() -> None:
    """Makes the operators known to Blender."""
    for operator in _CLASSES:
        bpy.utils.register_class(operator)


def unregister() -> None:
    """Takes them away again."""
    for operator in reversed(_CLASSES):
        bpy.utils.unregister_class(operator)
