#include "engine/scene/limits.h"

#include <cmath>

#include "compute/text.h"
#include "shaders/shared.h"

namespace weft {
namespace {

template <class T>
std::string sentence_for(T value, const scene_fields::Range& range) {
  const auto sentence = [&](const char* relation, double limit) {
    std::string text = number_text(value) + relation + number_text(limit);
    if (!range.unit.empty()) text += " (" + std::string(range.unit) + ")";
    return text;
  };
  if (!std::isfinite(value)) return std::isnan(value) ? "not a number, not finite" : "infinite, not finite";
  const double number = value;
  if (range.above && number <= range.low) return sentence(" is not above ", range.low);
  if (number < range.low) return sentence(" is less than ", range.low);
  if (range.below && number >= range.high) return sentence(" is not below ", range.high);
  if (number > range.high) return sentence(" is more than ", range.high);
  return "";
}

}  // namespace

std::string number_text(double value) { return rounded_text(value, 10); }
std::string number_text(float value) { return rounded_text(value, 6); }

std::string outside(double value, const scene_fields::Range& range) { return sentence_for(value, range); }
std::string outside(float value, const scene_fields::Range& range) { return sentence_for(value, range); }

double vertices_of(const Grid& grid) {
  const double x = grid.cells_x, y = grid.cells_y;
  return (x + 1) * (y + 1) + (grid.topology == Topology::centre ? x * y : 0);
}

std::string size_fault(const Scene& scene) {
  double vertices = 0;
  for (const Cloth& cloth : scene.cloths)
    if (cloth.grid) vertices += vertices_of(*cloth.grid);
  if (vertices <= WEFT_MAX_PARTICLES) return "";
  return "their grids have " + number_text(vertices) + " vertices together, more than the " + std::to_string(WEFT_MAX_PARTICLES) +
         " particles that a scene may have: take fewer cells";
}

}  // namespace weft
