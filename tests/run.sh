#!/usr/bin/env bash
# Installs what is missing, builds and runs every test: first those that need no device under the sanitizers, then all others
# optimised. The longer part comes last, so that the output ends with its result. With --interop those with other programs instead.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
source "$root/samples/packages.sh"

usage() {
  cat <<END
Usage: tests/run.sh [--interop [NAME...]]

Installs the Debian packages that are missing, builds Weft into build/asan and build/ci, and runs its tests.

  --interop    instead of these, the tests with other programs, all of them or those that are named: installs what they
               need and builds the command line into build/ci
                 blender    the add-on of samples/blender, and PC2, MDD and GLB caches (some 600 MB of packages)
                 formats    GLB and USDA caches by Khronos' validator and tinyusdz, from npm
                 godot      samples/godot in Godot 4.6, which is fetched into ~/.cache/weft/godot (157 MB) unless GODOT names one
                 parallel   samples/farm/parallel.sh: a sweep in parts by GNU parallel
                 slurm      samples/farm/slurm.sh: a sweep in parts by slurmctld and slurmd; as root
END
}

everyone=(blender formats godot parallel slurm)
interop=false
case ${1:-} in
  "") ;;
  --interop) interop=true; shift ;;
  --help | -h) usage; exit 0 ;;
  *) usage >&2; exit 2 ;;
esac

if $interop; then
  (( $# > 0 )) || set -- "${everyone[@]}"
  needed=()
  for name in "$@"; do
    packages="packages_for_${name}[@]"
    [[ " ${everyone[*]} " == *" $name "* ]] || { usage >&2; exit 2; }
    needed+=("${!packages}")
  done
  if command -v npm >/dev/null; then needed=("${needed[@]/#npm/nodejs}"); fi   # Node's own package has it
  install_missing "${packages_to_run[@]}" "${packages_to_test[@]}" "${needed[@]}"
  build "$root" ci weft_cli
  failed=()
  for name in "$@"; do
    folder=$(mktemp -d)
    echo "Tests with others: $name"
    "$root/tests/interop/$name.sh" "$root/build/ci/bin/weft" "$folder" || failed+=("$name")
    rm -rf "$folder"
  done
  if (( ${#failed[@]} )); then
    echo "FAILED: ${failed[*]}" >&2
    exit 1
  fi
  echo "All passed: $*"
  exit
fi

install_missing "${packages_to_run[@]}" "${packages_to_test[@]}"

build "$root" asan weft_assets weft_cpu_tests weft_long_tests fuzz_mesh fuzz_scene fuzz_snapshot
ctest --test-dir "$root/build/asan" -j "$(nproc)" --output-on-failure --no-tests=error -L '^cpu$'

build "$root" ci
ctest --test-dir "$root/build/ci" -j "$(nproc)" --output-on-failure --no-tests=error
