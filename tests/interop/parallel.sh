#!/usr/bin/env bash
# GNU parallel, on this machine: samples/farm/parallel.sh with a sweep in eight parts, one of which is asked to stop.
# parallel.sh WEFT FOLDER
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
weft=$1 folder=$2
# shellcheck source=tests/interop/sweep.sh
source "$root/tests/interop/sweep.sh"

cd "$folder"
WEFT=$recorded timeout 500 "$root/samples/farm/parallel.sh" "$parts" 2/: "$folder/farm" "${sweep[@]}" > farm.log 2>&1 &
farm=$!
within 60 part_has_rows 2
stop_part TERM 2
wait "$farm" || { cat farm.log >&2; fail "the sweep in parts failed"; }
grep -q 'part 2.*Stopped by SIGTERM after' farm.log || fail "part 2 was not stopped"
grep -q 'part 2.*Going on: ' farm.log || fail "part 2 did not go on"
expect_same "$folder/farm"
echo "passed: a sweep in $parts parts by GNU parallel, one of them stopped"
