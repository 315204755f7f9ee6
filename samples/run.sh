#!/usr/bin/env bash
# The first minute with Weft: installs what is missing, builds a release, simulates the curtain and draws it.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
source "$root/samples/packages.sh"

if [[ "${1:-}" == --help || "${1:-}" == -h ]]; then
  cat <<END
Usage: samples/run.sh [OPTION...]

Installs the Debian packages that are missing, builds Weft into build/release, and simulates assets/scenes/curtain.json
on the Vulkan device there is. Options are handed on to 'weft run', for example:
  --frames 60        fewer frames
  --out DIR          somewhere else than out
  --no-picture       no picture
  --device N         another device (build/release/bin/weft info lists them)
END
  exit 0
fi

out=$root/out
default_out=(--out "$out")
for (( n = 1; n <= $#; n++ )); do
  next=$(( n + 1 ))
  case ${!n} in
    --out) out=${!next:-}; default_out=() ;;
    --out=*) out=${!n#--out=}; default_out=() ;;
  esac
done

install_missing "${packages_to_run[@]}"
build "$root" release weft_cli weft_view
"$root/build/release/bin/weft" run "$root/assets/scenes/curtain.json" "${default_out[@]}" "$@"

if [[ -e $out/curtain.png ]]; then echo "The picture is $out/curtain.png"; fi
if [[ -e $out/timings.csv ]]; then echo "The timings are $out/timings.csv"; fi
