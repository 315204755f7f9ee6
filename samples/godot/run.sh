#!/usr/bin/env bash
# Weft in Godot: gets Godot, builds the plug-in, plays the sample project for ten seconds, and compares what came out with `weft run`.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
source "$root/samples/packages.sh"
source "$here/get_godot.sh"

usage() {
  cat <<END
Usage: samples/godot/run.sh [--frames N] [--out DIR] [--edit]

Gets Godot 4.6 (from Debian's suite forky, unpacked into ~/.cache/weft/godot without root rights; GODOT=... names another one), builds the
plug-in into build/release, and plays samples/godot/project on the screen, or on one that nobody sees.

  --frames N    how many frames of 1/60 s, 600 by default
  --out DIR     where pictures, frame times, the recording and the project with the plug-in go; out/godot by default
  --edit        opens the project in Godot's editor instead
END
}

frames=600 out=$root/out/godot edit=false
while (( $# )); do
  case $1 in
    --frames) frames=${2:?--frames needs a number}; shift 2 ;;
    --out) out=${2:?--out needs a folder}; shift 2 ;;
    --edit) edit=true; shift ;;
    --help | -h) usage; exit 0 ;;
    *) usage >&2; exit 2 ;;
  esac
done
[[ $frames =~ ^[1-9][0-9]{0,5}$ ]] || { echo "--frames is $frames, no number from 1 to 999999" >&2; exit 2; }
preset=${WEFT_PRESET:-release}

[[ -n ${WEFT_INSTALLED:-} ]] || install_missing "${packages_to_run[@]}" xvfb xauth
godot=$(find_godot)
headers=$root/build/godot
godot_headers "$godot" "$headers"
(cd "$root" && cmake --log-level=WARNING --preset "$preset" -DWEFT_GODOT=ON -DWEFT_GODOT_HEADERS="$headers") >/dev/null
build "$root" "$preset" weft_godot weft_cli weft_assets

mkdir -p "$out"
out=$(cd "$out" && pwd)
project=$out/project
prepare_project "$here/project" "$project" "$root/build/$preset/samples/godot/libweft_godot.so"
mkdir -p "$project/meshes"
for mesh in body cape skirt; do cp "$root/assets/generated/$mesh.glb" "$project/meshes/"; done
echo "Importing the project"
timeout 300 "$godot" --headless --path "$project" --import >"$out/import.log" 2>&1 || { tail -n 20 "$out/import.log" >&2; exit 1; }
if $edit; then exec "$godot" --path "$project" --editor; fi

rm -rf "$out/pictures" "$out/recording"
echo "Playing $frames frames"
on_a_screen timeout $(( 120 + frames )) "$godot" --path "$project" --rendering-driver vulkan --rendering-method mobile --audio-driver Dummy --fixed-fps 60 --disable-vsync \
  -- --frames "$frames" --out "$out" 2>&1 | tee "$out/godot.log"

echo "Pictures: $out/pictures, frame times: $out/frames.csv"
for world in calm windy; do
  scene=$out/recording/$world/scene.json
  [[ -e $scene ]] || { echo "Godot left no $scene" >&2; exit 1; }
  echo "Playing what is in $scene by weft run"
  as_godot "$godot" "$root/build/$preset/bin/weft" run "$scene" --no-picture --out "$out/alone/$world" >"$out/alone_$world.log" 2>&1
  in_godot=$(cat "$out/recording/$world/digest") alone=$(python3 "$here/digest.py" "$out/alone/$world/final.ply")
  echo "Vertices after $(python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))["frames"])' "$scene") ticks: in Godot $in_godot, by weft run $alone"
  [[ $in_godot == "$alone" ]] || { echo "They are not the same bits" >&2; exit 1; }
done
