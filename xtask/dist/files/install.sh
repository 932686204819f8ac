#!/bin/sh
# Installs what is in this folder, or removes it: the OpenFX plugin for all users, panels for Shotcut and Kdenlive for the
# user who runs this.
set -eu

usage() {
    echo "usage: $0 [--to DIR] [--remove]      the plugin, into DIR instead of $plugins"
    echo "       $0 --shotcut|--kdenlive [--to DIR] [--remove]      panels, into the user's own folder or DIR"
}

here=$(cd "$(dirname "$0")" && pwd)
data=${XDG_DATA_HOME:-$HOME/.local/share}
shotcut=$data/Meltytech/Shotcut/extensions/filters
plugins=/usr/OFX/Plugins
if [ "$(uname -s)" = Darwin ]; then
    data="$HOME/Library/Application Support"
    shotcut=$data/Meltytech/Shotcut/extensions/filters
    plugins=/Library/OFX/Plugins
fi
what=plugin
folder=
remove=no
while [ $# -gt 0 ]; do
    case $1 in
        --to)
            [ $# -ge 2 ] || { usage >&2; exit 2; }
            folder=$2
            shift
            ;;
        --shotcut | --kdenlive) what=${1#--} ;;
        --remove) remove=yes ;;
        -h | --help) usage; exit 0 ;;
        *) usage >&2; exit 2 ;;
    esac
    shift
done
case $what in
    plugin) from=$here; names=Isophote.ofx.bundle; folder=${folder:-$plugins} ;;
    shotcut) from=$here/shotcut; names=$(ls "$from"); folder=${folder:-$shotcut} ;;
    kdenlive) from=$here/kdenlive; names=$(ls "$from"); folder=${folder:-$data/kdenlive/effects} ;;
esac

if [ "$remove" = yes ] && [ ! -d "$folder" ]; then
    echo "nothing to remove: there is no $folder"
    exit 0
fi
if ! mkdir -p "$folder" 2>/dev/null || [ ! -w "$folder" ]; then
    echo "$0: $folder cannot be written: run this as an administrator (sudo), or name another folder with --to" >&2
    exit 1
fi
new=
trap '[ -z "$new" ] || rm -rf "$new"' EXIT
for name in $names; do
    if [ "$remove" = yes ]; then
        rm -rf "${folder:?}/$name"
        continue
    fi
    # Hosts look for names with their own ending: it bears the name only when it is whole.
    new="$folder/.$name.new"
    rm -rf "$new"
    cp -R "$from/$name" "$new"
    rm -rf "${folder:?}/$name"
    mv "$new" "$folder/$name"
done
if [ "$remove" = yes ]; then
    echo "removed from $folder"
else
    echo "installed into $folder"
    if [ "$what" = plugin ] && [ "$folder" != "$plugins" ]; then
        echo "Hosts search it when OFX_PLUGIN_PATH names it: export OFX_PLUGIN_PATH='$folder'"
    fi
    echo "Start the host anew. OPENFX.md says what each host remembers of an older version."
fi
