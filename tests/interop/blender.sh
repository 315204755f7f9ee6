#!/usr/bin/env bash
# Blender, without a window: the add-on of samples/blender, and PC2, MDD and GLB caches that it plays. blender.sh WEFT FOLDER
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
timeout 600 blender --background --factory-startup --python-exit-code 1 --python "$root/tests/interop/blender_test.py" -- \
  "$1" "$root/samples/blender/weft_cloth.py" "$2"
