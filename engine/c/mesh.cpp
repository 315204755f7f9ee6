// See engine/c/weft.h: meshes made in code.
#include "engine/c/inside.h"

#include <cstring>

using weft::fail;
using weft::Result;
using namespace weft::c;

weft_status weft_mesh_create(const float* xyz, size_t vertices, const uint32_t* corners, size_t triangles, const float* uv,
                             weft_mesh** mesh, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_LIST(xyz, vertices);
    WEFT_LIST(corners, triangles);
    WEFT_GIVEN(mesh);
    // Before room is made for what nobody can have.
    if (vertices > weft::kMostVertices) return fail("a mesh of ", vertices, " vertices has more than ", weft::kMostVertices);
    if (triangles > std::size_t{4} * weft::kMostVertices)
      return fail("a mesh of ", triangles, " triangles has more than ", std::size_t{4} * weft::kMostVertices);
    weft::RenderMesh all;
    all.positions = vectors(xyz, vertices);
    all.triangles.resize(triangles);
    for (std::size_t t = 0; t < triangles; ++t) all.triangles[t] = {corners[3 * t], corners[3 * t + 1], corners[3 * t + 2]};
    if (uv != nullptr) {
      all.uvs.resize(vertices);
      for (std::size_t k = 0; k < vertices; ++k) all.uvs[k] = {uv[2 * k], uv[2 * k + 1]};
    }
    auto welded = weft::weld_mesh(std::move(all));
    if (!welded) return welded.take_error();
    *mesh = new weft_mesh{std::move(*welded), vertices};
    return {};
  });
}

weft_status weft_mesh_set_attribute(weft_mesh* mesh, const char* name, const float* values, uint32_t channels, size_t vertices,
                                    weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(mesh);
    WEFT_GIVEN(name);
    WEFT_GIVEN(values);
    if (*name == '\0') return fail("an attribute has no name");
    if (channels < 1 || channels > 4) return fail("attribute \"", name, "\" has ", channels, " channels, and not 1 ... 4");
    if (vertices != mesh->vertices)
      return fail("attribute \"", name, "\" has values for ", vertices, " vertices, and the mesh was given ", mesh->vertices);
    std::vector<weft::Vec4> of_points(mesh->mesh.points.size());
    // From the last on: what the first says stays.
    for (std::size_t k = vertices; k-- > 0;)
      if (const std::uint32_t point = mesh->mesh.point_of_source[k]; point != weft::kNone) {
        float four[4] = {};
        std::memcpy(four, values + k * channels, channels * sizeof(float));
        of_points[point] = {four[0], four[1], four[2], four[3]};
      }
    mesh->mesh.attributes[name] = std::move(of_points);
    return {};
  });
}

void weft_mesh_destroy(weft_mesh* mesh) { delete mesh; }
