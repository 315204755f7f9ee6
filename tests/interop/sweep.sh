#!/usr/bin/env bash
# A sweep for farms, in one and in parts, and its table without its clocks; sourced by the tests of queues, which have set `weft`
# and `folder`.
export LP_NUM_THREADS=0   # a part a core
export XDG_CACHE_HOME=${folder:?}/cache
readonly parts=8 scene=$folder/sheet.json recorded=$folder/weft
readonly sweep=(accuracy "$scene" --quick --frames 96 --reference-cells 0)

fail() { echo "$*" >&2; exit 1; }

# within SECONDS CONDITION...: waits for it.
within() {
  local seconds=$1 tries
  shift
  for (( tries = 0; tries < 20 * seconds; tries++ )); do
    "$@" && return
    sleep 0.05
  done
  tail -v -n 5 "$folder"/*.log >&2
  fail "not within $seconds s: $*"
}

# part_has_rows K
part_has_rows() { [[ -s $folder/farm/accuracy.$1-of-$parts.rows ]]; }

# stop_part SIGNAL K: the program itself.
stop_part() { kill "-$1" "$(< "$folder/part-$2.pid")" || fail "part $2 does not run"; }

# Curves have clocks in four columns, and one in their head.
timeless() { grep -v '^# date:' "$1" | cut -d, -f1-7,11-17; }

# expect_same FOLDER: what was merged there is the sweep in one.
expect_same() {
  local lines name
  timeout 300 "${weft:?}" "${sweep[@]}" --out "$folder/one" > "$folder/one.log" 2>&1 || fail "the sweep in one failed"
  lines=$(timeless "$folder/one/curve.csv" | wc -l)
  (( lines > 30 )) || fail "the sweep in one has $lines lines"
  cmp <(timeless "$folder/one/curve.csv") <(timeless "$1/curve.csv") || fail "$1/curve.csv is not that of the sweep in one"
  for name in curve.svg curve.png curve.html; do [[ -s $1/$name ]] || fail "$1/$name is not there"; done
}

cat > "$scene" <<END
{"name": "sheet", "cloths": [{"grid": {"cells": [12, 12], "upright": true}, "anchors": [{"corners": ["low_high"]}]}]}
END
# The program, which tells by which process a part is worked on.
cat > "$recorded" <<END
#!/usr/bin/env bash
if [[ " \$* " =~ ' --shard '([0-9]+)/ ]]; then echo \$\$ > "$folder/part-\${BASH_REMATCH[1]}.pid"; fi
exec "$weft" "\$@"
END
chmod +x "$recorded"
