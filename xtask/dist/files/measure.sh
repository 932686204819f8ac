#!/bin/sh
# Measures the graphics card of this machine; options are those of `isophote bench --card`.
set -e
here=$(cd "$(dirname "$0")" && pwd)
# The library beside the program is the one that is measured.
unset ISOPHOTE_LIBRARY
exec "$here/bin/isophote" bench --card "$here/report" "$@"
