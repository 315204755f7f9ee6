#include "samples/weft/drape_measure.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace weft::command {

namespace {

constexpr int kPixels = 500;   // along a side of the picture

// A picture of shadows, seen from above.
class Shadow {
 public:
  Shadow(double left, double back, double pixel) : left_(left), back_(back), pixel_(pixel), dark_(kPixels * kPixels) {}
  void add(const gpu::vec4& a, const gpu::vec4& b, const gpu::vec4& c) {
    const double u[] = {across(a.x), across(b.x), across(c.x)}, w[] = {along(a.z), along(b.z), along(c.z)};
    const double area = (u[1] - u[0]) * (w[2] - w[0]) - (u[2] - u[0]) * (w[1] - w[0]);
    if (!(std::abs(area) > 0) || !std::isfinite(area)) return;
    const auto [low_x, high_x] = range(u);
    const auto [low_y, high_y] = range(w);
    for (int y = low_y; y < high_y; ++y)
      for (int x = low_x; x < high_x; ++x) {
        const double p = ((u[1] - x) * (w[2] - y) - (u[2] - x) * (w[1] - y)) / area;
        const double q = ((u[2] - x) * (w[0] - y) - (u[0] - x) * (w[2] - y)) / area;
        if (p >= 0 && q >= 0 && p + q <= 1) dark_[static_cast<std::size_t>(y * kPixels + x)] = true;
      }
  }
  double area() const { return pixel_ * pixel_ * static_cast<double>(std::count(dark_.begin(), dark_.end(), true)); }   // m^2

 private:
  double across(double x) const { return (x - left_) / pixel_; }
  double along(double z) const { return (z - back_) / pixel_; }
  static std::pair<int, int> range(const double (&values)[3]) {
    const auto [least, most] = std::minmax_element(values, values + 3);
    const auto within = [](double value) { return static_cast<int>(std::clamp(value, 0.0, double(kPixels))); };
    return {within(std::floor(*least)), within(*most + 1)};
  }

  double left_, back_, pixel_;
  std::vector<bool> dark_;
};

}  // namespace

std::optional<double> drape_coefficient(const CookedFabric& fabric, const ClothRange& cloth, std::span<const gpu::vec4> start,
                                        std::span<const gpu::vec4> positions) {
  double left = INFINITY, right = -INFINITY, back = INFINITY, front = -INFINITY;
  for (std::uint32_t i = cloth.first_particle; i < cloth.first_particle + cloth.particles; ++i) {
    left = std::min(left, double(start[i].x)), right = std::max(right, double(start[i].x));
    back = std::min(back, double(start[i].z)), front = std::max(front, double(start[i].z));
  }
  const double size = std::max(right - left, front - back), margin = 0.02 * size, pixel = (size + 2 * margin) / kPixels;
  Shadow whole(left - margin, back - margin, pixel), plate = whole, draped = whole;
  for (std::uint32_t t = 0; t < fabric.cloth_triangles; ++t) {
    const auto [a, b, c] = fabric.triangles[t];
    if (a < cloth.first_particle || a >= cloth.first_particle + cloth.particles) continue;
    whole.add(start[a], start[b], start[c]);
    draped.add(positions[a], positions[b], positions[c]);
    if (start[a].w == 0 && start[b].w == 0 && start[c].w == 0) plate.add(start[a], start[b], start[c]);
  }
  const double held = plate.area(), free = whole.area() - held;
  if (!(held > 0 && free > 0)) return std::nullopt;
  return (draped.area() - held) / free;
}

}  // namespace weft::command
