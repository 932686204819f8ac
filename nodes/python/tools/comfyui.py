"""Packs the nodes of ComfyUI for a wheel: isophote-comfyui-VERSION.zip, a folder for custom_nodes."""

from __future__ import annotations

import argparse
import sys
import zipfile
from pathlib import Path

UNKNOWN = "0.0.0"
"""Version in the sources."""


def main() -> None:
    """Packs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("wheel", type=Path)
    parser.add_argument("out", type=Path)
    options = parser.parse_args()
    package = Path(__file__).parents[1]
    source = package / "comfyui/isophote_comfyui"
    version = options.wheel.name.split("-")[1]
    project = (source / "pyproject.toml").read_text(encoding="utf-8")
    if project.count(UNKNOWN) != 2:
        sys.exit(f"pyproject.toml has lost its versions {UNKNOWN}, of the nodes and of the wheel")
    options.out.mkdir(parents=True, exist_ok=True)
    packed = options.out / f"isophote-comfyui-{version}.zip"
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(f"{source.name}/pyproject.toml", project.replace(UNKNOWN, version))
        # Managers of nodes install what this names.
        archive.writestr(f"{source.name}/requirements.txt", f"isophote=={version}\n")
        for file in sorted(source.glob("*.py")):
            archive.write(file, f"{source.name}/{file.name}")
        for name in ("LICENSE-MIT", "LICENSE-APACHE"):
            archive.write(package / name, f"{source.name}/{name}")
    print(packed)


if __name__ == "__main__":
    main()
