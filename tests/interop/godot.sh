#!/usr/bin/env bash
# Godot, on a screen that nobody sees: the sample project and another with their recordings, and what the nodes promise, under validation.
# godot.sh WEFT FOLDER
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
folder=$2
source "$root/samples/godot/get_godot.sh"
cd "$root"   # Godot may leave a file beside it, but never here
failed=0
broken() { echo "BROKEN: $*" >&2; failed=1; }

# The sample: built, imported, played, and equal to weft run bit by bit.
WEFT_PRESET=ci WEFT_INSTALLED=1 timeout 1500 samples/godot/run.sh --frames "${WEFT_GODOT_FRAMES:-120}" --out "$folder/sample" ||
  broken "samples/godot/run.sh"
if grep -aq "ERROR" "$folder/sample/import.log"; then broken "the import of the sample says:" "$(grep -a ERROR "$folder/sample/import.log")"; fi
if grep -aq "ERROR\|stands still" "$folder/sample/godot.log"; then broken "Godot says:" "$(grep -a "ERROR\|stands still" "$folder/sample/godot.log")"; fi

godot=$(find_godot)
source_of_checks=$folder/checks_source
mkdir -p "$source_of_checks/addons"
cp -r tests/interop/godot/. "$source_of_checks/"
cp -r samples/godot/project/addons/weft "$source_of_checks/addons/"
cp assets/generated/cape.glb "$source_of_checks/"
project=$folder/checks
prepare_project "$source_of_checks" "$project" "$root/build/ci/samples/godot/libweft_godot.so"
timeout 300 "$godot" --headless --path "$project" --import >"$folder/import.log" 2>&1 || broken "the import of the checks ends with $?"
if grep -aq "ERROR" "$folder/import.log"; then broken "the import of the checks says:" "$(grep -a ERROR "$folder/import.log")"; fi

# play LOG RENDERER ARGUMENTS...: under Khronos' validation with synchronization validation.
play() {
  VK_LOADER_DEBUG=layer VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation VK_LAYER_ENABLES=VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT \
    on_a_screen timeout 900 "$godot" --path "$project" --rendering-driver vulkan --rendering-method "$2" --audio-driver Dummy --fixed-fps 60 \
    --disable-vsync "${@:3}" >"$1" 2>&1
}
# What validation says, each kind once: its identifier, and the format that it is about.
said() { grep -a "Validation\( Error\|Warning\)\|SYNC-HAZARD" "$1" | grep -ao "\(VUID\|UNASSIGNED\|SYNC\)-[A-Za-z0-9-]*\|VK_FORMAT_[A-Z0-9]*_[A-Z0-9]*" | sort -u || true; }

# Godot has messages of its own, which a scene without Weft shows.
for renderer in mobile forward_plus; do
  play "$folder/plain_$renderer.log" "$renderer" --quit-after 10 res://plain.tscn || broken "the scene without Weft ends with $?"
  grep -aq 'Insert instance layer "VK_LAYER_KHRONOS_validation"' "$folder/plain_$renderer.log" || broken "there is no validation layer"
done
for scene in checks effects motion; do
  renderer=mobile
  [[ $scene != motion ]] || renderer=forward_plus   # which alone has motion vectors
  result=0
  play "$folder/$scene.log" "$renderer" "res://$scene.tscn" || result=$?
  grep -a "BROKEN\|^checked\|ten loads" "$folder/$scene.log" || true
  (( result == 0 )) || broken "the $scene end with $result"
  grep -aq "^promised: $(grep -ac "^checked" "$folder/$scene.log")$" "$folder/$scene.log" || broken "not all $scene were made"
  if grep -aq "^ERROR: " "$folder/$scene.log"; then broken "Godot says:" "$(grep -a "^ERROR: " "$folder/$scene.log" | sort | uniq -c)"; fi
  grep -aq 'Inserted device layer "VK_LAYER_WEFT_queue_lock"' "$folder/$scene.log" || broken "Godot's queue has no lock"
  ours=$(comm -13 <(said "$folder/plain_$renderer.log") <(said "$folder/$scene.log"))
  [[ -z $ours ]] || broken "validation says with Weft, and does not without:" "$ours"
done

# Everything that a recording can have is for weft run the same, to the bit.
on_a_screen timeout 300 "$godot" --path "$project" --rendering-driver vulkan --rendering-method mobile --audio-driver Dummy --fixed-fps 60 \
  --disable-vsync res://recorded.tscn -- "$folder/recorded" >"$folder/recorded.log" 2>&1 || broken "the recording ends with $?" "$(tail -n 5 "$folder/recorded.log")"
as_godot "$godot" "$1" run "$folder/recorded/scene.json" --no-picture --out "$folder/alone" >"$folder/alone.log" 2>&1 || broken "weft run ends with $?"
in_godot=$(cat "$folder/recorded/digest") alone=$(python3 samples/godot/digest.py "$folder/alone/final.ply")
echo "Skin, inertia, maps, gas, tears, gusts and fields: in Godot $in_godot, by weft run $alone"
[[ $in_godot == "$alone" ]] || broken "they are not the same bits"
if grep -q "Not exactly" "$folder/recorded/scene.json"; then broken "the recording says: $(grep -o "Not exactly[^\"]*" "$folder/recorded/scene.json")"; fi

# Without a device there is a sentence, and a cloth that stands still.
timeout 300 "$godot" --headless --path "$project" --quit-after 30 res://small.tscn >"$folder/headless.log" 2>&1 || broken "without a device Godot ends with $?"
grep -aq "stands still: Godot draws without a RenderingDevice" "$folder/headless.log" || broken "without a device there is no sentence"
exit $failed
