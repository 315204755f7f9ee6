#!/usr/bin/env bash
# Readers from npm: Khronos' glTF validator finds nothing in an animated GLB, and tinyusdz reads the mesh of a USDA. formats.sh WEFT FOLDER
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
weft=$1 folder=$2
cd "$folder"
if ! timeout 300 npm install --no-audit --no-fund gltf-validator@2.0.0-dev.3.10 tinyusdz@0.9.0-rc10 > npm.log 2>&1; then
  tail -n 5 npm.log >&2
  echo "The readers could not be had from npm; is there a network?" >&2
  exit 1
fi
for scene in flag minimal; do
  timeout 120 "$weft" run "$root/assets/scenes/$scene.json" --frames 12 --no-picture --out out --cache "$scene.glb" --cache "$scene.usda" \
    > run.log 2>&1 || { cat run.log >&2; exit 1; }
  cp "$root/tests/interop/formats_test.mjs" .   # which finds the readers beside it
  timeout 120 node formats_test.mjs "out/$scene.glb" "out/$scene.usda" out/final.ply
done
