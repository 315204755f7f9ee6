// See engine/c/weft.h: what is drawn.
#include "engine/c/inside.h"

#include <cstring>

using weft::fail;
using weft::Result;
using namespace weft::c;

namespace {

static_assert(sizeof(weft::Vec3) == 3 * sizeof(float));

weft_view view_of(const weft::FrameView& view) {
  return {reinterpret_cast<std::uint64_t>(view.buffer), view.offset, view.stride, view.count};
}

Result<void> copy(Result<std::vector<weft::Vec3>> read, float* xyz, std::size_t vertices) {
  if (!read) return read.take_error();
  if (auto good = room(vertices, read->size(), "vertices"); !good) return good;
  std::memcpy(xyz, read->data(), read->size() * sizeof(weft::Vec3));
  return {};
}

}  // namespace

weft_view weft_positions(const weft_simulation* simulation) {
  return simulation != nullptr ? view_of(simulation->simulation->positions()) : weft_view{};
}
weft_view weft_normals(const weft_simulation* simulation) {
  return simulation != nullptr ? view_of(simulation->simulation->normals()) : weft_view{};
}

weft_status weft_read_positions(const weft_simulation* simulation, float* xyz, size_t vertices, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(xyz);
    return copy(simulation->simulation->read_vertex_positions(), xyz, vertices);
  });
}

weft_status weft_read_normals(const weft_simulation* simulation, float* xyz, size_t vertices, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(xyz);
    return copy(simulation->simulation->read_vertex_normals(), xyz, vertices);
  });
}

size_t weft_triangle_count(const weft_simulation* simulation) {
  std::size_t count = 0;
  if (simulation != nullptr)
    for (const weft::Mesh& mesh : simulation->simulation->meshes()) count += mesh.render.triangles.size();
  return count;
}

weft_status weft_triangles(const weft_simulation* simulation, uint32_t* corners, size_t triangles, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(corners);
    if (auto good = room(triangles, weft_triangle_count(simulation), "triangles"); !good) return good;
    std::uint32_t first = 0;
    for (const weft::Mesh& mesh : simulation->simulation->meshes()) {
      for (const weft::Triangle& triangle : mesh.render.triangles)
        for (const std::uint32_t corner : triangle) *corners++ = first + corner;
      first += static_cast<std::uint32_t>(mesh.render.positions.size());
    }
    return {};
  });
}

weft_status weft_read_uvs(const weft_simulation* simulation, float* uv, size_t vertices, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(uv);
    if (auto good = room(vertices, simulation->simulation->positions().count, "vertices"); !good) return good;
    for (const weft::Mesh& mesh : simulation->simulation->meshes())
      for (std::size_t k = 0; k < mesh.render.positions.size(); ++k) {
        const weft::Vec2 at = k < mesh.render.uvs.size() ? mesh.render.uvs[k] : weft::Vec2();
        *uv++ = at.x;
        *uv++ = at.y;
      }
    return {};
  });
}

uint32_t weft_cloth_count(const weft_simulation* simulation) {
  return simulation != nullptr ? static_cast<std::uint32_t>(simulation->simulation->fabric().cloths.size()) : 0;
}

weft_status weft_cloth_vertices(const weft_simulation* simulation, uint32_t cloth, uint32_t* first, uint32_t* count, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(first);
    WEFT_GIVEN(count);
    const auto& cloths = simulation->simulation->fabric().cloths;
    if (cloth >= cloths.size()) return fail("there is no cloth ", cloth, ", but ", cloths.size());
    *first = cloths[cloth].first_vertex;
    *count = cloths[cloth].vertices;
    return {};
  });
}
