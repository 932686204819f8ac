"""Packs the Blender extension with a wheel: isophote-blender-VERSION-PLATFORM.zip."""

from __future__ import annotations

import argparse
import re
import sys
import zipfile
from pathlib import Path

PLATFORMS = {
    r"linux.*_x86_64": "linux-x64",
    r"linux.*_aarch64": "linux-arm64",
    r"macosx_.*_x86_64": "macos-x64",
    r"macosx_.*_arm64": "macos-arm64",
    r"win_amd64": "windows-x64",
    r"win_arm64": "windows-arm64",
}
"""Blender's names of platforms, by the tags of wheels."""


def platform(wheel: Path) -> str:
    """What a wheel is for."""
    for tag, name in PLATFORMS.items():
        if re.search(tag, wheel.stem):
            return name
    sys.exit(f"{wheel.name} is for no platform of Blender's")


def manifest(text: str, wheel: Path) -> str:
    """The manifest with the wheel and its platform."""
    text, wheels = re.subn(r"^wheels = \[\]$", f'wheels = ["./wheels/{wheel.name}"]', text, flags=re.M)
    text, platforms = re.subn(r"^platforms = \[\]$", f'platforms = ["{platform(wheel)}"]', text, flags=re.M)
    version = wheel.name.split("-")[1]
    text, versions = re.subn(r'^version = ".*"$', f'version = "{version}"', text, flags=re.M)
    if (wheels, platforms, versions) != (1, 1, 1):
        sys.exit("the manifest has lost its lines 'wheels = []', 'platforms = []' or 'version'")
    return text


def main() -> None:
    """Packs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("wheel", type=Path)
    parser.add_argument("out", type=Path)
    options = parser.parse_args()
    package = Path(__file__).parents[1]
    source = package / "blender/isophote_blender"
    version = options.wheel.name.split("-")[1]
    options.out.mkdir(parents=True, exist_ok=True)
    packed = options.out / f"isophote-blender-{version}-{platform(options.wheel)}.zip"
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        text = (source / "blender_manifest.toml").read_text(encoding="utf-8")
        archive.writestr("blender_manifest.toml", manifest(text, options.wheel))
        for file in sorted(source.glob("*.py")):
            archive.write(file, file.name)
        # Those that the wheel was made with, too.
        for licence in sorted(package.glob("LICENSE*")):
            archive.write(licence, licence.name)
        # Wheels are compressed already.
        archive.write(options.wheel, f"wheels/{options.wheel.name}", zipfile.ZIP_STORED)
    print(packed)


if __name__ == "__main__":
    main()
