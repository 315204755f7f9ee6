# Where Godot comes from; sourced by run.sh and tests/interop/godot.sh.
#
# find_godot prints a command: $GODOT, or a `godot` of version 4.6 or later, or one that lies in the cache. Debian 12 has none, but its suite
# forky does: its packages are fetched by an apt with a root of its own and unpacked, without root rights and beside the system.

godot_cache() { echo "${XDG_CACHE_HOME:-$HOME/.cache}/weft/godot"; }

# is_new_enough COMMAND
is_new_enough() {
  local version
  version=$(timeout 60 "$1" --version 2>/dev/null | tail -n 1) || return 1
  [[ $version =~ ^([0-9]+)\.([0-9]+) ]] && (( BASH_REMATCH[1] == 4 && BASH_REMATCH[2] >= 6 || BASH_REMATCH[1] > 4 ))
}

# fetch_godot FOLDER: 157 MB, 520 MB unpacked.
fetch_godot() {
  local folder=$1 apt=$1/apt root=$1/root mirror=${WEFT_DEBIAN_MIRROR:-http://deb.debian.org/debian}
  local keyring=/usr/share/keyrings/debian-archive-keyring.gpg tool
  for tool in apt-get dpkg-deb; do
    command -v "$tool" >/dev/null || { echo "There is no $tool here to fetch Godot with: set GODOT to a Godot of version 4.6 or later" >&2; return 1; }
  done
  [[ $(uname -m) == x86_64 ]] || { echo "Godot is fetched for x86_64 alone: set GODOT to a Godot of version 4.6 or later" >&2; return 1; }
  rm -rf "$apt" "$root"
  mkdir -p "$apt"/state/lists/partial "$apt"/cache/archives/partial "$root"
  : > "$apt/state/status"
  echo "deb [signed-by=$keyring] $mirror forky main" > "$apt/sources.list"
  local options=(-q -o Dir::State="$apt/state" -o Dir::State::status="$apt/state/status" -o Dir::Cache="$apt/cache"
    -o Dir::Etc::sourcelist="$apt/sources.list" -o Dir::Etc::sourceparts=/dev/null -o Debug::NoLocking=1 -o APT::Install-Recommends=false
    -o APT::Architecture=amd64 -o APT::Sandbox::User=)
  echo "Fetching Godot from $mirror, suite forky (157 MB), into $folder" >&2
  if ! { apt-get "${options[@]}" update && apt-get "${options[@]}" install -y --download-only godot; } >"$folder/apt.log" 2>&1; then
    echo "Godot could not be fetched ($folder/apt.log says why): set GODOT to a Godot of version 4.6 or later" >&2
    return 1
  fi
  local package
  for package in "$apt"/cache/archives/*.deb; do dpkg-deb -x "$package" "$root" || return 1; done
  rm -rf "$apt"
  # With its own C library and loader, but this machine's Vulkan loader and drivers.
  cat > "$folder/with_its_libraries" <<END
#!/bin/sh
libraries='$root/usr/lib/x86_64-linux-gnu'
exec "\$libraries/ld-linux-x86-64.so.2" --library-path "\$libraries:\$libraries/pulseaudio:/usr/lib/x86_64-linux-gnu" "\$@"
END
  cat > "$folder/godot.part" <<END
#!/bin/sh
exec '$folder/with_its_libraries' '$root/usr/bin/godot' "\$@"
END
  chmod +x "$folder/with_its_libraries" "$folder/godot.part"
  mv "$folder/godot.part" "$folder/godot"
}

# as_godot GODOT COMMAND...: with the C library that Godot has. The rotation of a collider in a tick is an arc tangent of floats, whose last bit
# is another in Debian 12's (glibc 2.36) than in forky's.
as_godot() {
  local godot=$1
  shift
  if [[ $godot == "$(godot_cache)/godot" ]]; then "$(godot_cache)/with_its_libraries" "$@"; else "$@"; fi
}

find_godot() {
  local folder name
  folder=$(godot_cache)
  if [[ -n ${GODOT:-} ]]; then
    is_new_enough "$GODOT" || { echo "GODOT is $GODOT, which is no Godot of version 4.6 or later" >&2; return 1; }
    echo "$GODOT"
    return
  fi
  for name in godot4 godot; do
    if command -v "$name" >/dev/null && is_new_enough "$name"; then command -v "$name"; return; fi
  done
  [[ -x $folder/godot ]] || { mkdir -p "$folder" && fetch_godot "$folder"; } || return 1
  is_new_enough "$folder/godot" || { echo "$folder/godot does not run: remove that folder, or set GODOT" >&2; return 1; }
  echo "$folder/godot"
}

# godot_headers GODOT FOLDER: has Godot write its C header there.
godot_headers() {
  mkdir -p "$2"
  [[ -e $2/gdextension_interface.h ]] || (cd "$2" && timeout 120 "$1" --headless --dump-gdextension-interface >godot.log 2>&1) || true
  [[ -e $2/gdextension_interface.h ]] || { echo "$1 wrote no gdextension_interface.h into $2" >&2; return 1; }
}

# on_a_screen COMMAND...: on the screen there is, or on one that nobody sees.
on_a_screen() {
  if [[ -n ${DISPLAY:-} ]]; then "$@"; else xvfb-run -a -s "-screen 0 1280x720x24" "$@"; fi
}

# prepare_project FROM TO PLUGIN: a copy of a project with the plug-in in it. Godot 4.5 to 4.7 crash where an import without a window meets an
# extension for the first time (godotengine/godot issues 111048 and 123511), so it is told of it beforehand.
prepare_project() {
  rm -rf "$2"
  mkdir -p "$2/.godot"
  cp -r "$1/." "$2/"
  cp "$3" "$2/addons/weft/"
  echo "res://addons/weft/weft.gdextension" > "$2/.godot/extension_list.cfg"
}
