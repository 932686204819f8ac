#!/bin/sh
# Installs the OpenFX plugin of this folder, or removes it.
set -eu

usage() {
    echo "usage: $0 [--to DIR] [--remove]"
    echo "DIR is $folder unless it is given; see OFX_PLUGIN_PATH for others."
}

here=$(cd "$(dirname "$0")" && pwd)
name=Isophote.ofx.bundle
case $(uname -s) in
    Darwin) folder=/Library/OFX/Plugins ;;
    *) folder=/usr/OFX/Plugins ;;
esac
remove=no
while [ $# -gt 0 ]; do
    case $1 in
        --to)
            [ $# -ge 2 ] || { usage >&2; exit 2; }
            folder=$2
            shift
            ;;
        --remove) remove=yes ;;
        -h | --help) usage; exit 0 ;;
        *) usage >&2; exit 2 ;;
    esac
    shift
done

if [ "$remove" = yes ]; then
    rm -rf "$folder/$name"
    echo "removed $folder/$name"
    exit 0
fi
if ! mkdir -p "$folder" 2>/dev/null || [ ! -w "$folder" ]; then
    echo "$0: $folder cannot be written: run this as an administrator (sudo), or name another folder with --to" >&2
    exit 1
fi
# Hosts look for names that end in .bundle: it bears the name only when it is whole.
new="$folder/.$name.new"
trap 'rm -rf "$new"' EXIT
rm -rf "$new"
cp -R "$here/$name" "$new"
rm -rf "${folder:?}/$name"
mv "$new" "$folder/$name"
echo "installed $folder/$name"
echo "Start the host anew. OPENFX.md says what each host remembers of an older version."
