// Rules that bind several keys of one object together.
#include "engine/scene/rules.h"

#include <algorithm>

#include "compute/text.h"
#include "engine/scene/fields.h"
#include "engine/scene/limits.h"

namespace weft {

namespace {

template <class... Parts>
std::string join(const Parts&... parts) {
  TextStream text;
  (text << ... << parts);
  return text.str();
}

void check_vertices(const std::string& path, const Grid& grid, const std::vector<std::uint32_t>& vertices, Faults& faults) {
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (vertices[i] >= vertices_of(grid))
      faults.add(join(path, "[", i, "]"), join(vertices[i], " is not a vertex, the grid has ", number_text(vertices_of(grid))));
}

// That cloths of these names are there, and that one that has bones has a skin.
void check_names(const Scene& scene, Faults& faults) {
  std::vector<std::string_view> names;
  for (const Cloth& cloth : scene.cloths) names.push_back(cloth.name);
  const auto look = [&](const std::string& path, const std::string& name) {
    const bool found = std::ranges::find(names, name) != names.end();
    if (!found) faults.add(path, join("there is no cloth \"", printable(name), "\"", suggestion(name, names)));
    return found;
  };
  const auto look_all = [&](const std::string& path, const std::optional<std::vector<std::string>>& list) {
    for (std::size_t k = 0; list && k < list->size(); ++k) look(join(path, ".meets[", k, "]"), (*list)[k]);
  };
  for (std::size_t i = 0; i < scene.cloths.size(); ++i) look_all(join("cloths[", i, "]"), scene.cloths[i].meets);
  for (std::size_t i = 0; i < scene.colliders.size(); ++i) {
    const Collider& collider = scene.colliders[i];
    look_all(join("colliders[", i, "]"), collider.meets);
    const std::string path = join("colliders[", i, "].bone.cloth");
    if (!collider.bone || !look(path, collider.bone->cloth)) continue;
    const Cloth& cloth = scene.cloths[static_cast<std::size_t>(std::ranges::find(names, collider.bone->cloth) - names.begin())];
    if (!cloth.skin && !cloth.motion_constraints)
      faults.add(path, join("the cloth \"", printable(cloth.name), "\" has no skin that could move a collider: give it the key \"skin\""));
  }
}

}  // namespace

void check_times(const std::string& path, const std::vector<Key>& keys, Faults& faults) {
  for (std::size_t i = 1; i < keys.size(); ++i)
    if (!(keys[i].time > keys[i - 1].time))
      faults.add(join(path, "[", i, "].time"), join(keys[i].time, " is not after ", keys[i - 1].time, " (s), the time of the key before"));
}

void check(const Read& read, const Anchor::Box& box) {
  for (const char* needed : {"low", "high"})
    if (!read.has(needed, true))
      read.faults.add(read.path, join("has no \"", needed, "\": a box is given by its low and high corners"));
  const float low[] = {box.low.x, box.low.y, box.low.z}, high[] = {box.high.x, box.high.y, box.high.z};
  for (int i = 0; i < 3; ++i)
    if (low[i] > high[i]) read.faults.add(join(read.path, ".low[", i, "]"), join(low[i], " is more than ", high[i], ", its high (m)"));
}

void check(const Read& read, const Anchor& anchor) {
  // A selector of the wrong type has been named already; only one that is absent or empty chooses nothing.
  const auto list = [&](const char* key, bool empty) {
    return read.has(key, !empty) && (read.json == nullptr || !(*read.json)[key].empty());
  };
  const bool chooses = read.has("top", anchor.top.has_value()) || read.has("box", anchor.box.has_value()) ||
                       list("vertices", anchor.vertices.empty()) || list("corners", anchor.corners.empty()) ||
                       read.has("map", !anchor.map.empty());
  if (!chooses) read.faults.add(read.path, "chooses no vertex: give vertices, corners, top, box or map");
  check_times(read.path + ".keys", anchor.keys, read.faults);
}

void check(const Read& read, const Cloth& cloth) {
  const bool grid = read.has("grid", cloth.grid.has_value()), mesh = read.has("mesh", !cloth.mesh.empty());
  if (grid && mesh) read.faults.add(read.path, "has both a grid and a mesh: give one of them");
  // A program may give the mesh itself; make_meshes asks for one of them.
  if (!grid && !mesh && read.json != nullptr) read.faults.add(read.path, "has neither a grid nor a mesh: give one of them");
  if (cloth.pressure && grid)
    read.faults.add(read.path + ".pressure", "a grid is open and holds no gas: give the cloth a closed mesh");
  if (cloth.tear && cloth.pressure)
    read.faults.add(read.path + ".tear", "opens what holds a gas: leave tear or pressure away");
  if (cloth.tear && (cloth.skin || cloth.motion_constraints))
    read.faults.add(read.path + ".tear", "does not go with a skin or motion constraints: leave tear or these away");
  if (cloth.tear && !cloth.render_mesh.empty())
    read.faults.add(read.path + ".tear", "does not tear a render_mesh, which the cloth carries: leave one of the two away");
  if (cloth.bending && cloth.fabric.bend == 0)
    read.faults.add(read.path + ".fabric.bend", "0 is not above 0 (N m); for a cloth that does not resist bending say \"bending\": false");
  if (!cloth.bending && cloth.bend_rest == BendRest::mesh)
    read.faults.add(read.path + ".bend_rest",
                    "\"mesh\" is the shape that a cloth bends about, and this one does not resist bending: leave one of the two away");
  if (cloth.springs)
    for (const auto& [key, map] : {std::pair("stretch", &cloth.maps.stretch), std::pair("bend", &cloth.maps.bend)})
      if (!map->empty())
        read.faults.add(join(read.path, ".maps.", key), "is of the fabric's stiffness, and this cloth has springs instead");
  for (std::size_t i = 0; i < cloth.anchors.size(); ++i) {
    const Anchor& anchor = cloth.anchors[i];
    const std::string path = join(read.path, ".anchors[", i, "]");
    if (mesh && !grid && !anchor.corners.empty())
      read.faults.add(path + ".corners", "name the corners of a grid, and this cloth is a mesh: choose by top, box or vertices");
    if (cloth.grid) check_vertices(path + ".vertices", *cloth.grid, anchor.vertices, read.faults);
  }
}

void check(const Read& read, const Collider& collider) {
  const auto shape = static_cast<std::size_t>(collider.shape);
  for (const scene_fields::ShapeKey& own : scene_fields::kShapeKeys)
    if (read.has(own.key, false) && !own.of[shape])
      read.faults.add(join(read.path, ".", own.key), join("a ", scene_fields::kShapes[shape], " has no ", own.key));
  if (collider.shape == ColliderShape::mesh && !read.has("mesh", true))
    read.faults.add(read.path, "has no \"mesh\": the file that it is made of");
  check_times(read.path + ".keys", collider.keys, read.faults);
  if (collider.bone && !collider.keys.empty())
    read.faults.add(read.path + ".keys", "move what a bone moves already: leave one of the two away");
}

void check(const Read& read, const Scene& scene) {
  check_names(scene, read.faults);
  if (const std::string fault = size_fault(scene); !fault.empty()) read.faults.add("cloths", fault);
  if (const std::string fault = method_fault(scene); !fault.empty()) read.faults.add("solver.method", fault);
  if (const std::string fault = order_fault(scene); !fault.empty()) read.faults.add("solver.order", fault);
  if (const std::string fault = relaxation_fault(scene); !fault.empty()) read.faults.add("solver.relaxation", fault);
  if (const auto meshes = mesh_colliders(scene); !meshes.empty() && scene.contacts.enabled == false)
    read.faults.add("contacts", join("are off, and colliders[", meshes.front(), "] is a mesh, which cloth meets through contacts alone"));
}

void check(const Read& read, const Camera& camera) {
  if (camera.eye == camera.target) read.faults.add(read.path + ".target", "is where the eye is: the camera looks nowhere");
}

}  // namespace weft
