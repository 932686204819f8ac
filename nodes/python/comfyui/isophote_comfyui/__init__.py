"""Nodes of ComfyUI that stylize pictures and videos: looks, presets, and every style and filter of Isophote.

ComfyUI reads the two tables below. All nodes follow from the library's catalogue.
"""

from .nodes import CLASSES

NODE_CLASS_MAPPINGS = {name: node for name, (node, _) in CLASSES.items()}
"""Classes of nodes, by the names that workflows keep."""

NODE_DISPLAY_NAME_MAPPINGS = {name: label for name, (_, label) in CLASSES.items()}
"""Their labels."""
