# What Weft needs from Debian 12, and how to get it; sourced by samples/run.sh and tests/run.sh.

# libglfw3-dev, libimgui-dev: for `weft view` alone; without them everything else is built.
# libbullet-dev: for the samples hammock and tow alone; without it everything else is built.
# libdraco-dev, libmeshoptimizer-dev: for glTFs that they have compressed; without them such a file is refused, and everything else is built.
# zlib1g-dev: for PNGs; and Debian's libassimp-dev links to it without depending on it.
packages_to_run=(build-essential cmake ninja-build libvulkan-dev mesa-vulkan-drivers glslang-tools spirv-tools
  libeigen3-dev libassimp-dev zlib1g-dev nlohmann-json3-dev libcli11-dev libstb-dev python3
  libglfw3-dev libimgui-dev libbullet-dev libdraco-dev libmeshoptimizer-dev)
# xvfb, xdotool, x11-apps, libx11-dev: a screen that nobody sees, for the viewer's window.
packages_to_test=(libgtest-dev libbenchmark-dev vulkan-validationlayers pkg-config python3-numpy xvfb xdotool x11-apps libx11-dev)
# tests/run.sh --interop NAME alone
packages_for_blender=(blender)
packages_for_formats=(nodejs npm)
packages_for_godot=(xvfb xauth)
packages_for_parallel=(parallel)
packages_for_slurm=(slurm-wlm munge)

# Installs those of the named packages that are missing, and says which; asks nothing.
install_missing() {
  if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    echo "This is no Debian: what is missing of these packages has to be installed by hand: $*"
    return 0
  fi
  local package missing=()
  for package in "$@"; do
    [[ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" == installed ]] || missing+=("$package")
  done
  (( ${#missing[@]} )) || return 0

  local as_root=()
  if (( EUID != 0 )); then
    if ! command -v sudo >/dev/null; then
      echo "${#missing[@]} packages are missing, and installing them needs root or sudo. As root: apt-get install ${missing[*]}" >&2
      return 1
    fi
    as_root=(sudo)
    [[ -t 0 ]] || as_root+=(-n)   # nobody there to type a password: fail rather than wait
  fi
  echo "Installing ${#missing[@]} packages: ${missing[*]}"
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -q &&
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}" && return 0
  echo "apt-get could not install what is missing: ${missing[*]}" >&2
  return 1
}

# build ROOT PRESET [TARGET...]: configures and builds into ROOT/build/PRESET; what is up to date is left alone.
build() {
  local root=$1 preset=$2 launcher=() targets=()
  shift 2
  (( $# == 0 )) || targets=(--target "$@")
  if command -v ccache >/dev/null; then
    # Without precompiled headers: ccache would hand out those of another clone that was built at the same path, and `#pragma once`
    # knows files by their times, which differ there.
    launcher=(-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON)
  fi
  echo "Building $preset into $root/build/$preset"
  (cd "$root" && cmake --log-level=WARNING --preset "$preset" "${launcher[@]}") >/dev/null || return
  cmake --build "$root/build/$preset" "${targets[@]}"
}
