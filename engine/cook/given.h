// Scenes whose meshes are partly files and partly made by a program, which names them. Internal.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "engine/mesh.h"
#include "engine/scene.h"

namespace weft {

/// By the names that Cloth::mesh, Cloth::render_mesh and Collider::mesh have in place of a file's; they come before files.
using GivenMeshes = std::map<std::string, const Mesh*, std::less<>>;

/// make_meshes (engine/fabric.h), of a scene that may name these, too: transforms apply to them as to files.
Result<std::vector<Mesh>> make_meshes_with(const Scene& scene, const GivenMeshes& given);

}  // namespace weft
