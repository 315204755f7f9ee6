// Cloths of pictures: their triangles, one run of them for each look, and the textures of these.
#include <array>

#include "engine/mesh/parts.h"
#include "engine/shading/state.h"

namespace weft {
namespace {

template <class T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
  return std::as_bytes(std::span(values));
}

// The i-th of what is drawn: a cloth, or a mesh collider after all cloths. Colliders look as the other shapes do (layout.cpp).
struct Drawn {
  shading::Look look;
  double transmission = 0;
};

Result<Drawn> drawn_of(const Scene& scene, std::size_t i, const ShadedCloth& shaded) {
  if (shaded.appearance != nullptr) {
    const std::string name = i < scene.cloths.size() ? scene.cloths[i].name : std::to_string(i);
    return Drawn{shading::look_of("cloth \"" + name + "\"", *shaded.appearance, scene.folder), shaded.transmission};
  }
  const std::vector<std::uint32_t> meshes = mesh_colliders(scene);
  const std::size_t k = i - scene.cloths.size();   // a cloth wraps around and is beyond them
  if (k >= meshes.size()) return fail("cloth ", i, " has no appearance, and is no mesh collider of the scene");
  Appearance look;
  look.base_colour = scene.colliders[meshes[k]].colour;
  look.roughness_factor = 0.45;
  return Drawn{shading::look_of("collider " + std::to_string(meshes[k]), look, scene.folder)};
}

}  // namespace

std::vector<ShadedCloth> shaded_cloths(const Scene& scene, const CookedFabric& fabric, std::span<const Mesh> meshes) {
  std::vector<ShadedCloth> cloths;
  for (const Cloth& cloth : scene.cloths)
    cloths.push_back({.mesh = &meshes[cloths.size()].render, .appearance = &cloth.appearance, .shown = cloth.render_mesh.empty()});
  for (std::size_t k = 0; k < mesh_colliders(scene).size(); ++k) cloths.push_back({.mesh = &meshes[cloths.size()].render});
  for (const CarriedMesh& carried : fabric.render_meshes)
    cloths.push_back({.mesh = &meshes[cloths.size()].render, .appearance = &scene.cloths[carried.cloth].appearance});
  return cloths;
}

Result<void> Shading::Geometry::add(const std::string& name, const ShadedCloth& cloth) {
  const RenderMesh& mesh = *cloth.mesh;
  for (const Triangle& triangle : mesh.triangles)
    for (std::uint32_t vertex : triangle)
      if (vertex >= mesh.positions.size())
        return fail("a triangle of ", name, " refers to vertex ", vertex, ", but there are ", mesh.positions.size());
  if (auto good = parts::check_materials(mesh); !good) return fail(name, ": ", good.why());
  const std::size_t first = uvs.size();
  uvs.insert(uvs.end(), mesh.uvs.begin(), mesh.uvs.end());
  uvs.resize(first + mesh.positions.size());  // a mesh without texture coordinates has zeros
  for (const auto& [material, own] : shading::runs_of(mesh, cloth.appearance)) {
    runs.push_back({material, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(triangles.size()),
                    static_cast<std::uint32_t>(own.size())});
    triangles.insert(triangles.end(), own.begin(), own.end());
  }
  return {};
}

Result<compute::DrawSet> Shading::State::maps_of(shading::Look& look) {
  std::vector<compute::DrawBinding> bound;
  for (shading::Source& source : look.maps) {
    auto texture = textures.load(source);
    if (!texture && source.embedded != nullptr) {   // a file may have kinds of pictures that nobody reads here
      notes.push_back(look.name + ": a texture is left out, " + texture.why().message);
      source.embedded = nullptr;
      texture = textures.load(source);
    }
    if (!texture) return fail(look.name, ": ", texture.why());
    const VkDescriptorImageInfo image{map_sampler.get(), (*texture)->view(), compute::kSampled.layout};
    bound.push_back({static_cast<std::uint32_t>(bound.size()), {}, image});
  }
  return compute::DrawSet::create(*device, "maps of " + look.name, map_layout, bound);
}

Result<void> Shading::State::create_cloths(const Scene& scene, std::span<const ShadedCloth> shaded) {
  auto sampler = compute::create_sampler(*device, "map sampler", {.linear = true, .repeat = true});
  if (!sampler) return sampler.take_error();
  map_sampler = std::move(*sampler);
  constexpr VkDescriptorType kMap = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
  const std::array bindings = {compute::DescriptorBinding{0, kMap}, compute::DescriptorBinding{1, kMap},
                               compute::DescriptorBinding{2, kMap}, compute::DescriptorBinding{3, kMap}};
  auto layout = compute::DescriptorLayout::create(*device, "cloth maps", bindings, VK_SHADER_STAGE_FRAGMENT_BIT);
  if (!layout) return layout.take_error();
  map_layout = std::move(*layout);

  Geometry all;
  for (std::size_t i = 0; i < shaded.size(); ++i) {
    const RenderMesh& mesh = *shaded[i].mesh;
    auto described = drawn_of(scene, i, shaded[i]);
    if (!described) return described.take_error();
    if (mesh.triangles.empty()) return fail(described->look.name, " has no triangle to draw");
    const std::size_t first_run = all.runs.size();
    if (auto added = all.add(described->look.name, shaded[i]); !added) return added;
    if (!shaded[i].shown) continue;
    std::vector<shading::Look> looks;
    if (all.runs.back().material != kNone || all.runs.size() > first_run + 1)
      looks = shading::looks_of(described->look.name, *mesh.materials, notes);

    for (const Geometry::Run& run : std::span(all.runs).subspan(first_run)) {
      shading::Look& look = run.material < looks.size() ? looks[run.material] : described->look;
      DrawnCloth drawn;
      drawn.first_vertex = run.first_vertex;
      drawn.first_index = 3 * run.first_triangle;
      drawn.index_count = 3 * run.triangles;
      drawn.push = {look.base_colour, static_cast<float>(look.roughness), look.repeat, static_cast<float>(look.metallic),
                    static_cast<float>(described->transmission), WEFT_VIEW_CAMERA, static_cast<float>(look.cutoff)};
      auto set = maps_of(look);
      if (!set) return set.take_error();
      drawn.maps = std::move(*set);
      cloths.push_back(std::move(drawn));
    }
  }

  meshes = shaded.size();
  vertices = all.uvs.size();
  triangles = all.triangles.size();
  runs = all.runs;
  const std::array requests = {
      compute::BufferRequest{"shading uvs", all.uvs.size() * sizeof(Vec2),
                             VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT},
      compute::BufferRequest{"shading indices", all.triangles.size() * sizeof(Triangle),
                             VK_BUFFER_USAGE_INDEX_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT},
  };
  auto arena = compute::Arena::create(*device, compute::Memory::device, "shading geometry", requests);
  if (!arena) return arena.take_error();
  geometry = std::move(*arena);
  if (meshes == 0) return {};
  return send(all);
}

Result<void> Shading::State::send(const Geometry& all) {
  const std::array uploads = {compute::Upload{&geometry[0], bytes_of(all.uvs)}, compute::Upload{&geometry[1], bytes_of(all.triangles)}};
  return compute::upload_all(*device, uploads);
}

Result<void> Shading::follow(std::span<const ShadedCloth> cloths) try {
  Geometry all;
  if (cloths.size() != state_->meshes) return fail(cloths.size(), " cloths were given for ", state_->meshes);
  for (const ShadedCloth& cloth : cloths)
    if (auto added = all.add("cloth " + std::to_string(&cloth - cloths.data()), cloth); !added) return added;
  if (all.uvs.size() != state_->vertices || all.triangles.size() != state_->triangles)
    return fail(all.uvs.size(), " vertices and ", all.triangles.size(), " triangles were given for ", state_->vertices, " and ",
                state_->triangles);
  if (all.runs != state_->runs) return fail("the cloths' triangles have other materials than they had");
  return state_->send(all);
} catch (...) {
  return caught("the torn cloth's picture");
}

}  // namespace weft
