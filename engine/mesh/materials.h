// Materials as JSON: what is done to those that a file has, on their way into another file. Internal.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "engine/json_tree.h"
#include "engine/mesh.h"

namespace weft::parts {

/// Calls `act(name, info)` for each texture that a material names, those of extensions too; `info` has an "index".
template <class Json, class Act>
void for_textures(Json& value, const Act& act) {
  if (value.is_array())
    for (auto& entry : value) for_textures(entry, act);
  if (!value.is_object()) return;
  for (auto member = value.begin(); member != value.end(); ++member) {
    if (member.key() == "extras") continue;   // anything at all
    auto& inner = member.value();
    if (inner.is_object() && inner.contains("index") && member.key().ends_with("Texture")) act(member.key(), inner);
    else for_textures(inner, act);
  }
}

/// Triangles by their materials, in their order; those without one last.
std::vector<std::pair<std::uint32_t, std::vector<Triangle>>> by_material(const RenderMesh& mesh);

/// The lists of a text, numbers in them raised as if so many materials' textures and images came before; see Materials::text. A host's
/// own text may be anything: what is no JSON, too long or too deep (engine/mesh/outline.h) has empty lists.
JsonTree material_lists(const Materials& materials, std::size_t textures = 0, std::size_t samplers = 0, std::size_t images = 0);

/// The extensions that are used in a value, added to a list of names.
void add_extensions(const nlohmann::json& value, std::vector<std::string>& names);

/// One list of materials after another: `all` may be empty. Returns the first of those added.
std::uint32_t append(Materials& all, const Materials& added);

}  // namespace weft::parts
