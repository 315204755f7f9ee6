// Scenes of every method that there is, with everything about them that moves, for tests of what must hold for all.
#pragma once

#include <vector>

#include "tests/support/sheets.h"
#include "tests/support/without_contacts.h"

namespace weft {

// An anchor and a sphere that keys move, others that the host drives, the host's gravity, and substeps that do not fit its frames.
inline Scene moving(std::uint32_t cells = 12) {
  Scene scene = sheet(cells);
  scene.cloths[0].fabric.damping = 0.1;
  Anchor keyed = held_at({Corner::low_low});
  keyed.keys = {{0, {}, {0, 1, 0}, 0}, {0.5, {0.1f, 0, 0.2f}, {0, 1, 0}, 40}};
  scene.cloths[0].anchors = {keyed, held_at({Corner::high_low})};
  scene.colliders = {sphere({0, -0.25f, 0}, 0.2), sphere({0.3f, -0.5f, 0}, 0.1), plane(-0.6f)};
  scene.colliders[0].keys = {{0, {}, {0, 1, 0}, 0}, {0.5, {0.3f, 0, 0}, {0, 1, 0}, 90}};
  return scene;
}

inline Scene springy(Method method) {
  Scene scene = moving(8);
  scene.solver.method = method;
  Springs& springs = scene.cloths[0].springs.emplace();
  springs.structural = springs.shear = {300, 0.01};
  if (method != Method::verlet) springs.bend = {3, 0.001};
  springs.mass = 0.01;
  if (method == Method::implicit) scene.solver.iterations = 8;
  else scene.cloths[0].tethers = false;
  return scene;
}

/// A small scene for every method and for contacts.
struct Subject {
  const char* name;
  Scene scene = without_contacts();
};

/// So fine that its small ball holds it in the solve, and is told so.
inline Scene fine_and_held() {
  Scene scene = moving(52);
  scene.reactions = true;
  return scene;
}

inline std::vector<Subject> subjects() {
  std::vector<Subject> all;
  all.push_back({"jacobi", moving()});
  all.back().scene.solver.method = Method::jacobi;
  all.push_back({"strands", moving()});
  for (const Method method : {Method::strands, Method::gauss_seidel, Method::chebyshev}) {
    const char* name = method == Method::chebyshev ? "chebyshev" : method == Method::strands ? "strands iterated" : "gauss_seidel";
    Scene& scene = all.emplace_back(Subject{name, moving()}).scene;
    scene.solver.method = method;
    scene.solver.iterations = 4;
    scene.solver.substeps = 3;
    if (method != Method::chebyshev) continue;
    scene.cloths[0].tethers = false;
    scene.solver.rho = 0.999;   // more than is stable, so that the guard has a state to save
  }
  Scene& iterated = all.emplace_back(Subject{"iterated", moving()}).scene;
  iterated.solver.iterations = 3;
  iterated.solver.method = Method::jacobi;
  Scene& levels = all.emplace_back(Subject{"gauss_seidel on levels", moving()}).scene;
  levels.solver.method = Method::gauss_seidel;
  levels.solver.levels = true;
  all.emplace_back(Subject{"second order", moving()}).scene.solver.order = 2;
  Scene& board = all.emplace_back(Subject{"bending in steps", moving()}).scene;
  board.solver.method = Method::jacobi;
  board.solver.bend_steps = 3;
  board.cloths[0].fabric.bend = 1;   // so stiff for its cells that it takes all of them
  all.emplace_back(Subject{"hinges", moving()}).scene.cloths[0].bend_rest = BendRest::mesh;
  all.push_back({"mass_spring", springy(Method::mass_spring)});
  all.push_back({"verlet", springy(Method::verlet)});
  all.push_back({"implicit", springy(Method::implicit)});
  Scene& preconditioned = all.emplace_back(Subject{"implicit on levels", springy(Method::implicit)}).scene;
  preconditioned.solver.levels = true;
  Scene& relaxed = all.emplace_back(Subject{"implicit jacobi", springy(Method::implicit)}).scene;
  relaxed.solver.linear = Linear::jacobi;
  all.push_back({"fine and held", fine_and_held()});
  Scene& contacts = all.emplace_back(Subject{"contacts", moving()}).scene;
  contacts.contacts.enabled = true;
  contacts.contacts.capacity = 16;   // soon too small
  contacts.cloths.push_back(sheet(6).cloths[0]);
  contacts.cloths[1].transform.translate = {0, 0.02f, 0};
  return all;
}

}  // namespace weft
