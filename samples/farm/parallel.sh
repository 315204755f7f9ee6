#!/usr/bin/env bash
# A sweep of weft on several machines by GNU parallel over ssh, then merged here:
#
#   samples/farm/parallel.sh PARTS MACHINES FOLDER COMMAND [ARGUMENT...]
#   samples/farm/parallel.sh 8 1/anna,1/berta,1/: out/sweep accuracy assets/scenes/swing.json
#
# MACHINES are GNU parallel's --sshlogin: `1/anna` is one part at a time on anna, `:` is this machine. All see this folder under the same
# path, and FOLDER. A part that is stopped is started again and goes on where it was. WEFT is the program, else `weft` on the path.
set -euo pipefail

if (( $# < 4 )); then
  sed -n '2,/^set/s/^# \{0,1\}//p' "$0" >&2
  exit 2
fi
parts=$1 machines=$2 folder=$3
shift 3
weft=${WEFT:-weft}
log=$folder/parallel.log

mkdir -p "$folder"
call=$(printf '%q ' "$weft" "$@")
# Exit code 75 asks to be put back. A part that failed is tried three times in all.
seq "$parts" | parallel --will-cite --sshlogin "$machines" --workdir "$PWD" --joblog "$log" --retries 3 --line-buffer --tagstring 'part {}' \
  "code=75; while [ \$code = 75 ]; do $call --shard {}/$parts --out $(printf '%q' "$folder"); code=\$?; done; exit \$code"

files=()
for (( k = 1; k <= parts; k++ )); do files+=("$folder"/*."$k-of-$parts.rows"); done
"$weft" merge "${files[@]}" --out "$folder"
