// Which scenes a method solves: a combination that makes no sense, or that nobody has built, is refused by a sentence that names
// both sides of it, by the reader and, for scenes that a host made, by the cook.
#include "engine/scene_fields.h"

namespace weft {

std::string method_fault(const Scene& scene) {
  const std::string named = '"' + std::string(scene_fields::kMethods[static_cast<std::size_t>(scene.solver.method)]) + '"';
  if (scene.solver.method != Method::jacobi) return named + " is not there yet";
  return {};
}

}  // namespace weft
