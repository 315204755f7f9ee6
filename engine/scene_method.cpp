// Which scenes a method solves: a combination that makes no sense, or that nobody has built, is refused by a sentence that names
// both sides of it, by the reader and, for scenes that a host made, by the cook.
#include <cmath>

#include "engine/scene_fields.h"

namespace weft {

std::string method_fault(const Scene& scene) {
  const std::string named = '"' + std::string(scene_fields::kMethods[static_cast<std::size_t>(scene.solver.method)]) + '"';
  if (scene.solver.method != Method::jacobi && scene.solver.method != Method::implicit) return named + " is not there yet";
  for (std::size_t i = 0; i < scene.cloths.size(); ++i) {
    const Cloth& cloth = scene.cloths[i];
    const std::string path = "cloths[" + std::to_string(i) + "].";
    if (scene.solver.method != Method::implicit && cloth.springs)
      return named + " solves no springs, and " + path + "springs are there: \"implicit\" does";
    if (scene.solver.method == Method::implicit && !cloth.springs && (std::isinf(cloth.fabric.stretch) || std::isinf(cloth.fabric.shear)))
      return named + " needs springs that give way, and " + path + "fabric is \"rigid\": give its stretch and shear in N/m, or springs";
  }
  return {};
}

}  // namespace weft
