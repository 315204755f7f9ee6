// See samples/godot/drawn.h.
#include "samples/godot/drawn.h"

#include "samples/godot/meshes.h"

namespace weft_godot {
namespace {

using godot::Rid;
using godot::Variant;

constexpr int kTextureAlbedo = 0, kTextureNormal = 4;   // BaseMaterial3D::TextureParam

}  // namespace

Drawn::Drawn(godot::Object node, const weft::RenderMesh& mesh, const Variant& texture, std::uint32_t first_vertex,
             const std::string& folder)
    : node_(godot::id_of(node)), server_(godot::singleton("RenderingServer")) {
  const Variant self(node);
  std::vector<std::uint32_t> surfaces;
  mesh_ = drawn_mesh(mesh, surfaces);
  instance_ = self.call("get_instance").to_rid();
  server_.call("instance_set_base", instance_, mesh_.call("get_rid"));
  server_.call("instance_attach_skeleton", instance_, Rid{});
  server_.call("instance_geometry_set_material_override", instance_, Rid{});
  const Variant shader = godot::singleton("ResourceLoader").call("load", folder + "/cloth.gdshader", "Shader");
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    const bool has_surface = surfaces[k] < self.call("get_surface_override_material_count").to_int();
    const Variant source = has_surface ? self.call("get_active_material", surfaces[k]) : self.call("get_material_override");
    materials_.push_back(material_for(source, texture, first_vertex, shader));
    server_.call("instance_set_surface_override_material", instance_, int(k), materials_.back().call("get_rid"));
  }
}

Drawn::~Drawn() {
  const Variant node(godot::object_of(node_));
  if (node.to_object() == nullptr) return;
  const Variant mesh = node.call("get_mesh"), override_of_all = node.call("get_material_override");
  server_.call("instance_set_base", instance_, mesh.to_object() ? mesh.call("get_rid").to_rid() : Rid{});
  server_.call("instance_geometry_set_material_override", instance_,
               override_of_all.to_object() ? override_of_all.call("get_rid").to_rid() : Rid{});
  server_.call("instance_set_custom_aabb", instance_, node.call("get_custom_aabb"));
  node.call("set_skeleton_path",
            node.call("get_skeleton_path"));   // it is attached again
  if (!node.call("is_inside_tree").to_bool()) return;
  server_.call("instance_set_transform", instance_, node.call("get_global_transform"));
}

void Drawn::reshape(const weft::RenderMesh& mesh) {
  std::vector<std::uint32_t> surfaces;
  mesh_ = drawn_mesh(mesh, surfaces);
  server_.call("instance_set_base", instance_, mesh_.call("get_rid"));
  for (std::size_t k = 0; k < materials_.size(); ++k)
    server_.call("instance_set_surface_override_material", instance_, int(k), materials_[k].call("get_rid"));
}

// A standard material's colours and textures go into ours; a shader of the user's own gets what it needs to fetch vertices.
Variant Drawn::material_for(const Variant& source, const Variant& texture, std::uint32_t first_vertex, const Variant& shader) const {
  const bool has_own_shader = godot::is(source.to_object(), "ShaderMaterial");
  const Variant material = has_own_shader ? source.call("duplicate") : godot::make("ShaderMaterial");
  const auto set = [&](const char* key, const Variant& value) { material.call("set_shader_parameter", godot::name(key), value); };
  if (!has_own_shader) material.call("set_shader", shader);
  set("weft_vertices", texture);
  set("weft_first", first_vertex);
  if (!godot::is(source.to_object(), "BaseMaterial3D")) return material;
  set("albedo", source.call("get_albedo"));
  set("roughness", source.call("get_roughness"));
  set("metallic", source.call("get_metallic"));
  set("specular", source.call("get_specular"));
  set("uv_scale", source.call("get_uv1_scale"));
  set("uv_offset", source.call("get_uv1_offset"));
  if (const Variant picture = source.call("get_texture", kTextureAlbedo); picture.to_object()) set("albedo_texture", picture);
  if (const Variant picture = source.call("get_texture", kTextureNormal); picture.to_object()) {
    set("normal_texture", picture);
    set("normal_scale", source.call("get_normal_scale"));
  }
  return material;
}

void Drawn::present(const Moment& moment, const godot::Box& box) const {
  godot::Transform code;
  code.origin = {float(moment.before), float(moment.newest), moment.between};
  server_.call("instance_set_transform", instance_, code);
  server_.call("instance_set_custom_aabb", instance_, godot::Box{box.low - code.origin, box.size});
}

}  // namespace weft_godot
