// Which scenes a method solves: a combination that makes no sense, or that nobody has built, is refused by a sentence that names
// both sides of it, by the reader and, for scenes that a host made, by the cook.
#include <algorithm>
#include <cmath>

#include "compute/text.h"
#include "engine/scene/fields.h"

namespace weft {
namespace {

// With k Jacobi iterations a substep, a mode that an iteration corrects by the fraction b is left with q = (1 - omega b)^k of its
// violation, and obeys x'' = q (2 x' - x) from substep to substep. That is stable for -1/3 < q <= 1 (engine/README.md, "Stable
// over-relaxation"). Masses that are split keep b <= 1, so omega < 1 + 3^(-1/k) is stable in every pose. Defaults keep q >= -1/4.
//
// Chebyshev's iteration leaves q = T_k((1 - omega b) / rho) / T_k(1 / rho), T_k the Chebyshev polynomial (Golub and Varga 1961). While
// omega <= 1 + rho its argument is at least -1 and q at least -1 / T_k(1 / rho): above -1/4 for rho < 1 / cosh(acosh(4) / k).
//
// In second order (shaders/bdf2/bdf2.glsl) the same mode obeys G(w)^2 x = (1 - 1/q) x, with w the step back by a substep and
// G(w) = (1 - w) (1 - w/3). Its roots w = 2 +- (1 +- 3 (1 - 1/q)^(1/2))^(1/2) lie outside of the unit circle for -9/55 < q <= 1. There
// defaults keep q >= -1/8.
struct Least {
  double limit, by_default;   // of -1/q
};

Least least_of(const SolverSettings& solver) { return solver.order == 2 ? Least{55.0 / 9, 8} : Least{3, 4}; }

constexpr double kChebyshev = 4;

}  // namespace

double rho_of(const SolverSettings& solver) {
  return solver.rho != 0 ? solver.rho : 1 / std::cosh(std::acosh(kChebyshev) / std::max(1u, solver.iterations));
}

double most_relaxation(const SolverSettings& solver) {
  return solver.method == Method::chebyshev ? 1 + rho_of(solver) : 1 + std::pow(least_of(solver).limit, -1.0 / std::max(1u, solver.iterations));
}

bool contacts_on(const Scene& scene) {
  const bool go_together = scene.solver.method != Method::chebyshev && scene.solver.order == 1;
  return scene.contacts.enabled.value_or(go_together) || !mesh_colliders(scene).empty();
}

bool tethers_hold(const Scene& scene) {
  const auto moves = [](const Anchor& anchor) { return !anchor.keys.empty(); };
  return std::ranges::all_of(scene.cloths, [&](const Cloth& cloth) {
    return cloth.tethers && !cloth.anchors.empty() && std::ranges::none_of(cloth.anchors, moves);
  });
}

bool is_driven(const Scene& scene) {
  const auto moves = [](const Anchor& anchor) { return !anchor.keys.empty(); };
  return scene.pins > 0 || !mesh_colliders(scene).empty() || std::ranges::any_of(scene.cloths, [&](const Cloth& cloth) {
           return cloth.skin.has_value() || std::ranges::any_of(cloth.anchors, moves);
         });
}

bool levels_of(const Scene& scene) {
  const bool by_default = scene.solver.method == Method::by_default && !tethers_hold(scene);
  return scene.solver.levels.value_or(by_default || scene.solver.method == Method::strands);
}

namespace {
bool may_shift(const Scene& scene) {
  const Method method = method_of(scene);
  return (method == Method::strands || method == Method::gauss_seidel) && levels_of(scene) && scene.solver.iterations == 1 &&
         std::ranges::none_of(scene.cloths, [](const Cloth& cloth) { return cloth.tear.has_value(); });
}
}  // namespace

// In second order Jacobi, which corrects as much along a as along b what a and b share: what a pass leaves of a mode is a real part of it. A
// sweep through links, one after another, leaves a part that is not, and in second order, which takes no energy, that grows (a sheet that
// turns had 1.2 times its energy after five seconds by gauss_seidel on levels, and 12 times by strands).
//
// Cloth that Gauss-Seidel holds together in patches gives way less than four iterations of contacts ask of it in a substep: a held sheet
// that is driven into it at 8 m/s waits for it.
Method method_of(const Scene& scene) {
  if (scene.solver.method != Method::by_default) return scene.solver.method;
  if (!levels_of(scene) || scene.solver.order == 2) return Method::jacobi;
  return contacts_on(scene) ? Method::strands : Method::gauss_seidel;
}

double relaxation_of(const Scene& scene) {
  const SolverSettings& solver = scene.solver;
  if (solver.relaxation != 0) return solver.relaxation;
  if (solver.method == Method::chebyshev) return 1 + rho_of(solver);
  // Measured: Gauss-Seidel strains least at 1.1.
  if (method_of(scene) == Method::gauss_seidel) return 1.1;
  return 1 + std::pow(least_of(solver).by_default, -1.0 / std::max(1u, solver.iterations));
}

std::string relaxation_fault(const Scene& scene) {
  const double most = most_relaxation(scene.solver);
  TextStream text;
  if (scene.solver.relaxation < 0) text << scene.solver.relaxation << " is less than 0";
  if (!(scene.solver.relaxation < most))
    text << scene.solver.relaxation << " is not below " << most << ", up to which " << scene.solver.iterations
         << (scene.solver.iterations == 1 ? " iteration" : " iterations") << " a substep are stable";
  return text.str();
}

std::string order_fault(const Scene& scene) {
  const SolverSettings& solver = scene.solver;
  if (solver.order == 1) return {};
  if (solver.order != 2) return std::to_string(solver.order) + " is neither 1 nor 2";
  if (solver.method != Method::jacobi && solver.method != Method::by_default)
    return "2 goes with the method \"jacobi\", and solver.method is \"" +
           std::string(scene_fields::kMethods[static_cast<std::size_t>(solver.method)]) + '"';
  if (contacts_on(scene)) return "2 does not go with contacts, which a mesh collider has on, too, and which stop particles as only 1 expects it: leave one of the two away";
  if (scene.reactions) return "2 does not go with reactions, which are of impulses that only 1 gives: leave one of the two away";
  const bool is_pushed =
      !scene.colliders.empty() || std::ranges::any_of(scene.cloths, [](const Cloth& cloth) { return cloth.motion_constraints.has_value(); });
  if (is_pushed && solver.iterations > 1)
    return "2 with colliders or motion constraints takes one iteration a substep, and solver.iterations is " +
           std::to_string(solver.iterations) + ": take substeps instead";
  return {};
}

std::string method_fault(const Scene& scene) {
  const std::string named = '"' + std::string(scene_fields::kMethods[static_cast<std::size_t>(scene.solver.method)]) + '"';
  const Method method = scene.solver.method;
  const bool automatic = method == Method::automatic;
  if (automatic && !scene.solver.budget_ms) return named + " needs solver.budget_ms, the milliseconds that a frame may take";
  if (!automatic && scene.solver.budget_ms)
    return named + " takes the time it takes, and solver.budget_ms is there: \"auto\" chooses by it";
  if (automatic && (scene.solver.substeps != 0 || scene.solver.iterations != 1))
    return named + " chooses substeps and iterations, and solver has some: leave them away";
  const bool is_relaxation =
      method == Method::by_default || method == Method::jacobi || method == Method::strands || method == Method::gauss_seidel;
  const bool may_have_levels = is_relaxation || (method == Method::implicit && scene.solver.linear == Linear::cg);
  if (levels_of(scene) && !may_have_levels)
    return named + " has no levels, and solver.levels is true: \"jacobi\", \"strands\", \"gauss_seidel\" and, with linear \"cg\", "
                   "\"implicit\" may have them";
  if (scene.solver.shifts && !may_shift(scene))
    return named + " has no shifts here, and solver.shifts is true: one iteration of \"strands\" or \"gauss_seidel\" on levels may have "
                   "them, of cloth that does not tear";
  for (std::size_t i = 0; i < scene.cloths.size(); ++i) {
    const Cloth& cloth = scene.cloths[i];
    const std::string path = "cloths[" + std::to_string(i) + "].";
    if (!on_springs(method) && cloth.springs)
      return named + " solves no springs, and " + path + "springs are there: \"implicit\" and \"mass_spring\" do";
    if (on_springs(method) && !cloth.springs && (std::isinf(cloth.fabric.stretch) || std::isinf(cloth.fabric.shear)))
      return named + " needs springs that give way, and " + path + "fabric is \"rigid\": give its stretch and shear in N/m, or springs";
    if (method == Method::implicit && cloth.motion_constraints)
      return named + " solves for all particles at once, and " + path +
             "motion_constraints hold each by itself: \"mass_spring\" goes with them";
    if (cloth.bend_rest == BendRest::mesh && (on_springs(method) || method == Method::chebyshev))
      return named + " bends cloth about a flat shape, and " + path +
             "bend_rest is \"mesh\": \"jacobi\", \"strands\" and \"gauss_seidel\" bend it about the mesh's";
    if (cloth.tear && !is_relaxation)
      return named + " solves cloth that stays whole, and " + path +
             "tear is there: \"jacobi\", \"strands\" and \"gauss_seidel\" go with it";
    if (method == Method::verlet && cloth.springs && cloth.springs->bend.stiffness > 0)
      return named + " has links to 8 neighbours that only pull, and " + path + "springs.bend is there: \"mass_spring\" has it";
  }
  if (scene.reactions && (method == Method::implicit || method == Method::chebyshev))
    return named + " does not tell what colliders are given, and reactions are asked for: the other methods do";
  if ((method == Method::mass_spring || method == Method::verlet) && scene.solver.iterations > 1)
    return named + " evaluates its forces once a substep, and solver.iterations is " + std::to_string(scene.solver.iterations) + ", not 1";
  if (method == Method::chebyshev) {
    if (scene.solver.iterations < 2) return named + " accelerates iterations, and solver.iterations is 1, not at least 2";
    if (contacts_on(scene)) return named + " does not go with contacts: pushing pairs apart is not among the steps that it extrapolates";
    // Measured: with them a hung sheet strains up to hundreds of times as much as with Jacobi.
    for (std::size_t i = 0; i < scene.cloths.size(); ++i)
      if (scene.cloths[i].tethers && !scene.cloths[i].anchors.empty())
        return named + " does not go with tethers, which hold particles back by what it extrapolates: set cloths[" + std::to_string(i) +
               "].tethers to false";
  }
  return {};
}

}  // namespace weft
