// Who meets whom.
#include <algorithm>

#include "engine/scene.h"

namespace weft {
namespace {

bool names(const std::optional<std::vector<std::string>>& list, const std::string& name) {
  return !list || std::ranges::find(*list, name) != list->end();
}

}  // namespace

bool meet(const Cloth& cloth, const Collider& collider) { return names(collider.meets, cloth.name); }
bool meet(const Cloth& a, const Cloth& b) { return names(a.meets, b.name) && names(b.meets, a.name); }

}  // namespace weft
