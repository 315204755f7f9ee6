#!/usr/bin/env bash
# Installs what is missing, builds and runs every test: first those that need no device under the sanitizers, then those of
# threads under the thread sanitizer, then all of them optimised. The whole suite comes last, so that the output ends with its
# result. With --interop those with Blender instead.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
source "$root/samples/packages.sh"

usage() {
  cat <<END
Usage: tests/run.sh [--interop]

Installs the Debian packages that are missing, builds Weft into build/asan, build/tsan and build/ci, and runs its tests.

  --interop    instead of these, the tests with programs that read what Weft writes: installs Blender (with what it needs
               some 600 MB), builds the command line into build/ci, and runs tests/interop/blender_test.py in it: the
               add-on of samples/blender, and PC2, MDD and GLB caches
END
}

interop=false
case ${1:-} in
  "") ;;
  --interop) interop=true ;;
  --help | -h) usage; exit 0 ;;
  *) usage >&2; exit 2 ;;
esac

if $interop; then
  echo "Tests with Blender: the add-on of samples/blender, and caches that it plays"
  install_missing "${packages_to_run[@]}" "${packages_to_test[@]}" "${packages_for_interop[@]}"
  build "$root" ci weft_cli
  folder=$(mktemp -d)
  trap 'rm -rf "$folder"' EXIT
  blender --background --factory-startup --python-exit-code 1 --python "$root/tests/interop/blender_test.py" -- \
    "$root/build/ci/bin/weft" "$root/samples/blender/weft_cloth.py" "$folder"
  exit
fi

install_missing "${packages_to_run[@]}" "${packages_to_test[@]}"

build "$root" asan weft_assets weft_cpu_tests fuzz_mesh fuzz_scene fuzz_snapshot
ctest --test-dir "$root/build/asan" -j "$(nproc)" --output-on-failure --no-tests=error -L '^cpu$'

build "$root" tsan weft_thread_tests
"$root/build/tsan/bin/weft_thread_tests"

build "$root" ci
ctest --test-dir "$root/build/ci" -j "$(nproc)" --output-on-failure --no-tests=error
