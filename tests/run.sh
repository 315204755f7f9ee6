#!/usr/bin/env bash
# Installs what is missing, builds and runs every test: first those that need no device under the sanitizers, then those of
# threads under the thread sanitizer, then all of them optimised. The whole suite comes last, so that the output ends with its
# result.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
source "$root/samples/packages.sh"

if (( $# )); then
  echo "Usage: tests/run.sh"
  echo "Installs the Debian packages that are missing, builds Weft into build/asan, build/tsan and build/ci, and runs its tests."
  [[ $1 == --help || $1 == -h ]] && exit 0 || exit 2
fi

install_missing "${packages_to_run[@]}" "${packages_to_test[@]}"

build "$root" asan weft_assets weft_cpu_tests fuzz_mesh fuzz_scene fuzz_snapshot
ctest --test-dir "$root/build/asan" -j "$(nproc)" --output-on-failure --no-tests=error -L '^cpu$'

build "$root" tsan weft_thread_tests
"$root/build/tsan/bin/weft_thread_tests"

build "$root" ci
ctest --test-dir "$root/build/ci" -j "$(nproc)" --output-on-failure --no-tests=error
