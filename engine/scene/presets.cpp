// Four fabrics by name. The figures are measurements of the kind that the Kawabata evaluation system (KES-F) gives,
// turned into SI units:
//
//   bend     B in gf cm^2/cm   1 gf cm^2/cm   = 9.81e-5 N m
//   shear    G in gf/(cm deg)  1 gf/(cm deg)  = 56.2 N/m per radian
//   stretch  the secant of KES-FB1, which pulls with 500 gf/cm = 490 N/m: an extension EMT of 5 % is 9.8 kN/m
//
// Fabrics vary by a factor of two and more with yarn, weave and finish; these are one plausible cloth each, not a standard.
// Sources:
//   S. Kawabata, The Standardization and Analysis of Hand Evaluation, 2nd ed., 1980: the tests and their usual ranges
//     (for dress fabrics B about 0.04 ... 0.2 gf cm^2/cm, G about 0.3 ... 1 gf/(cm deg)); silk and cotton stand within them.
//   A. Majumdar and S. B. Pol, Fibers and Polymers 15(9), 2014: B and G grow with the pick density of plain cotton.
//   A. Kumari and K. Khurana, Journal of Textiles 2016, 4614168, table 5: soft denims, B 0.14 ... 0.23 gf cm^2/cm,
//     G 1.5 ... 3.4 gf/(cm deg), EMT 4.7 ... 5.7 %. The preset is a 12 ounce cloth, not washed, hence stiffer in bending.
//   H. Memon et al., Materials 14(16), 4553, 2021: sheep garment leather is 0.64 ... 0.96 mm thick. Leather is a felt, not
//     a weave, so the preset is a plate: thickness t = 0.8 mm, density 0.7 g/cm^3, E = 10 MPa, Poisson's ratio 0.3:
//     stretch E t, shear E t / (2 (1 + nu)), bend E t^3 / (12 (1 - nu^2)).
// Silk is a 14 momme habutai (1 momme = 4.34 g/m^2). Friction is between the cloth and a smooth hard body.
#include "engine/scene.h"

namespace weft {

std::optional<Fabric> fabric_preset(std::string_view name) {
  struct Row {
    std::string_view name;
    double area_density, stretch, shear, bend, friction;  // kg/m^2, N/m, N/m, N m, 1
  };
  static constexpr Row kPresets[] = {
      {"silk", 0.06, 8e3, 20, 4e-6, 0.25},
      {"cotton", 0.12, 10e3, 45, 1e-5, 0.4},
      {"denim", 0.4, 15e3, 100, 5e-5, 0.5},
      {"leather", 0.56, 8e3, 3.1e3, 4.7e-4, 0.5},
  };
  for (const Row& row : kPresets) {
    if (row.name != name) continue;
    Fabric fabric;
    fabric.preset = row.name;
    fabric.area_density = row.area_density;
    fabric.stretch = row.stretch;
    fabric.shear = row.shear;
    fabric.bend = row.bend;
    fabric.friction = row.friction;
    return fabric;
  }
  return std::nullopt;
}

}  // namespace weft
