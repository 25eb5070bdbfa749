#!/usr/bin/env bash
# scripts/gallery.sh FOLDER: fills FOLDER with pictures of a run, a clip of the same ride with haptics
# on and off, and the paper's figures. Takes some minutes where the processor draws.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
folder=$1
most=2000000 # bytes a file

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$folder"
bikesim() { .venv/bin/python -m bikesim "$@"; }
render() { bikesim render "$@" --force; }

bikesim run --seed 1 --duration 8 --output "$work/on.h5" >/dev/null
bikesim run --seed 1 --duration 8 --law off --output "$work/off.h5" >/dev/null
bikesim run --seed 1 --duration 4.5 --output "$work/short.h5" >/dev/null
bikesim run --seed 1 --duration 30 --output "$work/long.h5" >/dev/null

render "$work/long.h5" --view first --at 13.5 --size 1280x720 --output "$folder/first.jpg"
render "$work/long.h5" --view second --at 13.5 --size 1280x720 --output "$folder/second.jpg"
render "$work/long.h5" --view bench --at 13.5 --size 1280x720 --output "$folder/bench.jpg"
render "$work/long.h5" --at 14.5 --size 1280x720 --output "$folder/both.jpg"
render "$work/long.h5" --sheet --output "$folder/sheet.jpg"
render "$work/on.h5" "$work/off.h5" --size 960x540 --fps 24 --output "$folder/on-off.mp4"
render "$work/short.h5" "$work/off.h5" --size 640x360 --fps 6.25 --output "$folder/on-off.gif"

bikesim paper --output "$work/paper" >/dev/null
cp "$work"/paper/*.png "$folder"

large=$(find "$folder" -type f -size +"$most"c)
[ -z "$large" ] || { echo "gallery: larger than $most bytes: $large" >&2; exit 1; }
ls -l "$folder"
