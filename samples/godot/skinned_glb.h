// A cloth's mesh as a GLB with what the engine's writer leaves out, and a recording needs: its skin with an animation, and its attributes.
#pragma once

#include <filesystem>

#include "engine/mesh.h"

namespace weft_godot {

/// Writes `mesh` as one primitive of one mesh, with its joints as nodes of their own, their animation, and its attributes. A mesh without
/// skin and attributes is what weft::write_glb makes of it. Errors: what cannot be written.
weft::Result<void> write_skinned_glb(const std::filesystem::path& file, const weft::Mesh& mesh);

}  // namespace weft_godot
