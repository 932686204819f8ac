"""Stylizes finished renders of Blender: their passes go through a style of Isophote and come back as an image.

The settings are in the render properties, generated from the library's catalogue; rules for objects are among theirs. `stylize`
does the work, `passes` knows how Blender gives passes away.
"""

from . import operators, panels, rules, settings

_PARTS = (settings, rules, operators, panels)


def register() -> None:
    """Called by Blender when the extension is enabled."""
    for part in _PARTS:
        part.register()


def unregister() -> None:
    """Called by Blender when it is disabled."""
    for part in reversed(_PARTS):
        part.unregister()
