// Maps: what a cloth's figures are multiplied by, vertex by vertex. A map is an attribute of the mesh, and a painted picture becomes one:
// its pixels at the UVs of each point, bilinear, linear from 0 to 1 as the file has them.
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "compute/text.h"
#include "engine/cook/parts.h"
#include "engine/image.h"
#include "engine/scene/limits.h"

namespace weft {
namespace cooking {
namespace {

constexpr double kLargestFactor = 1e6;

std::string in_quotes(std::string_view name) { return '"' + std::string(name) + '"'; }

bool is_picture(std::string_view name) {
  for (const std::string_view ending : scene_fields::kPictureEndings) {
    if (name.size() <= ending.size()) continue;
    const std::string_view last = name.substr(name.size() - ending.size());
    bool same = true;
    for (std::size_t k = 0; k < last.size(); ++k) same = same && (last[k] | ('A' <= last[k] && last[k] <= 'Z' ? 32 : 0)) == ending[k];
    if (same) return true;
  }
  return false;
}

struct Map {
  std::string name;          // of an attribute
  std::size_t channel = 0;
};

// "NAME" or "NAME.c", with a channel r, g, b or a.
Result<Map> parsed(const std::string& map) {
  const auto dot = map.rfind('.');
  if (is_picture(map) || dot == std::string::npos) return Map{map, 0};
  const std::string channel = map.substr(dot + 1);
  const std::size_t which = channel.size() == 1 ? std::string_view("rgba").find(channel[0]) : std::string::npos;
  if (which == std::string::npos) return fail(in_quotes(map), " ends in a channel that is not r, g, b or a");
  return Map{map.substr(0, dot), which};
}

// Of the picture where the UV is; outside 0 ... 1 it repeats, and at its rim nothing of the other side shows.
Vec4 pixel_at(const Image& image, Vec2 uv) {
  const auto along = [](float t, std::uint32_t size) {
    const double whole = t < 0 || t > 1 ? t - std::floor(double(t)) : double(t);
    return std::clamp(whole * size - 0.5, 0.0, size - 1.0);
  };
  const double x = along(uv.x, image.width), y = along(uv.y, image.height);
  const auto left = static_cast<std::size_t>(x), top = static_cast<std::size_t>(y);
  const std::size_t right = std::min<std::size_t>(left + 1, image.width - 1), below = std::min<std::size_t>(top + 1, image.height - 1);
  const double u = x - double(left), v = y - double(top);
  std::array<float, 4> mean{};
  for (std::size_t c = 0; c < 4; ++c) {
    const auto at = [&](std::size_t i, std::size_t j) { return image.rgba[4 * (j * image.width + i) + c] / 255.0; };
    const auto row = [&](std::size_t j) { return (1 - u) * at(left, j) + u * at(right, j); };
    mean[c] = static_cast<float>((1 - v) * row(top) + v * row(below));
  }
  return {mean[0], mean[1], mean[2], mean[3]};
}

std::vector<Vec4> painted(const Mesh& mesh, const Image& image) {
  std::vector<Vec4> values(mesh.points.size());
  std::vector<float> count(mesh.points.size());
  for (std::size_t v = 0; v < mesh.point_of.size(); ++v) {   // a point on a seam has several UVs: the mean
    const Vec4 pixel = pixel_at(image, mesh.render.uvs[v]);
    Vec4& sum = values[mesh.point_of[v]];
    sum = {sum.x + pixel.x, sum.y + pixel.y, sum.z + pixel.z, sum.w + pixel.w};
    ++count[mesh.point_of[v]];
  }
  for (std::size_t p = 0; p < values.size(); ++p) {
    Vec4& v = values[p];
    v = {v.x / count[p], v.y / count[p], v.z / count[p], v.w / count[p]};
  }
  return values;
}

// Every map of a cloth, with its key.
template <class Each>
Result<void> for_maps(const Cloth& cloth, const Each& each) {
  const std::pair<const char*, const std::string*> own[] = {{"maps.mass", &cloth.maps.mass},
                                                            {"maps.stretch", &cloth.maps.stretch},
                                                            {"maps.bend", &cloth.maps.bend},
                                                            {"maps.friction", &cloth.maps.friction},
                                                            {"maps.thickness", &cloth.maps.thickness}};
  for (const auto& [key, map] : own)
    if (auto done = each(key, *map); !done) return done;
  if (const auto& constraints = cloth.motion_constraints) {
    const std::pair<const char*, const std::string*> theirs[] = {{"motion_constraints.max_distance_map", &constraints->max_distance_map},
                                                                 {"motion_constraints.stiffness_map", &constraints->stiffness_map},
                                                                 {"motion_constraints.backstop_map", &constraints->backstop_map}};
    for (const auto& [key, map] : theirs)
      if (auto done = each(key, *map); !done) return done;
  }
  if (cloth.tear)
    if (auto done = each("tear.map", cloth.tear->map); !done) return done;
  for (std::size_t k = 0; k < cloth.anchors.size(); ++k)
    if (auto done = each("anchors[" + std::to_string(k) + "].map", cloth.anchors[k].map); !done) return done;
  return {};
}

}  // namespace

}  // namespace cooking

std::vector<std::pair<std::string, std::string>> painted_maps(const Cloth& cloth) {
  std::vector<std::pair<std::string, std::string>> maps;
  (void)cooking::for_maps(cloth, [&](const std::string& key, const std::string& text) -> Result<void> {
    const auto map = cooking::parsed(text);
    if (map && cooking::is_picture(map->name)) maps.emplace_back(key, map->name);
    return {};
  });
  return maps;
}

namespace cooking {

Result<void> add_pictures(const std::filesystem::path& folder, const Cloth& cloth, Mesh& mesh) {
  return for_maps(cloth, [&](const std::string& key, const std::string& text) -> Result<void> {
    if (text.empty()) return {};
    const auto map = parsed(text);
    if (!map) return fail(key, ": ", map.why());
    if (!is_picture(map->name) || mesh.attributes.contains(map->name)) return {};
    const auto image = read_image(folder / map->name);
    if (!image) return fail(key, ": ", image.why());
    mesh.attributes[map->name] = painted(mesh, *image);
    return {};
  });
}

Result<std::vector<float>> mapped(const std::string& key, const std::string& text, const Mesh& mesh) {
  if (text.empty()) return std::vector<float>{};
  const auto map = parsed(text);
  if (!map) return fail(key, ": ", map.why());
  const auto at = mesh.attributes.find(map->name);
  if (at == mesh.attributes.end()) {
    std::string names;
    for (const auto& [known, list] : mesh.attributes) names += (names.empty() ? "" : ", ") + known;
    return fail(key, ": the mesh has no attribute ", in_quotes(map->name), "; it has ", names.empty() ? "none" : names);
  }
  std::vector<float> values;
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    const Vec4& v = at->second[p];
    values.push_back(std::array{v.x, v.y, v.z, v.w}[map->channel]);
    if (!(values[p] >= 0)) return fail(key, ": ", in_quotes(text), " is ", values[p], " at point ", p, ", less than 0");
    if (!(values[p] <= kLargestFactor))
      return fail(key, ": ", in_quotes(text), " is ", values[p], " at point ", p, ", more than ", number_text(kLargestFactor));
  }
  return values;
}

Result<Factors> factors_of(const Maps& maps, const Mesh& mesh) {
  Factors factors;
  const std::tuple<const char*, const std::string*, std::vector<float>*> all[] = {{"maps.mass", &maps.mass, &factors.mass},
                                                                                  {"maps.stretch", &maps.stretch, &factors.stretch},
                                                                                  {"maps.bend", &maps.bend, &factors.bend},
                                                                                  {"maps.friction", &maps.friction, &factors.friction},
                                                                                  {"maps.thickness", &maps.thickness, &factors.thickness}};
  for (const auto& [key, map, values] : all) {
    auto read = mapped(key, *map, mesh);
    if (!read) return read.take_error();
    *values = std::move(*read);
  }
  return factors;
}

}  // namespace cooking
}  // namespace weft
