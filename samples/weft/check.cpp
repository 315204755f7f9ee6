// `weft check`: everything that is wrong with a scene or a mesh, without a device.
#include <cstdio>

#include "engine/fabric.h"
#include "engine/figures.h"
#include "engine/solve/sizes.h"
#include "samples/weft/commands.h"
#include "samples/weft/console.h"
#include "samples/weft/subject.h"

namespace weft::command {

namespace {

// What is too large for some devices; which one a run will have is not known here.
std::string size_note(const Scene& scene, const CookedFabric& fabric) {
  const Cooked subject = cooked_of(scene, fabric);
  const SizeLimits anywhere;
  compute::Specializer specializer;
  const auto plan = make_plan(needs_of(subject, anywhere.workgroup, true), specializer);
  return plan ? beyond(anywhere, "a device with no more than Vulkan asks for", *plan, subject) : plan.error();
}

Exit check_scene(const std::filesystem::path& file, BufferFiles buffer_files) {
  const Result<Scene> scene = load_subject(file, {}, buffer_files);
  if (!scene) {
    complain(scene.error());
    return kBadInput;
  }
  const std::vector<std::string> faults = file_faults(*scene);
  for (const std::string& fault : faults) complain(fault);
  if (!faults.empty()) return kBadInput;

  const Result<std::vector<Mesh>> meshes = make_meshes(*scene);
  if (!meshes) {
    complain(meshes.error());
    return kBadInput;
  }
  const std::size_t cloths = scene->cloths.size();
  const std::vector<std::uint32_t> colliders = mesh_colliders(*scene);
  for (std::size_t i = 0; i < meshes->size(); ++i)
    for (const std::string& sentence : (*meshes)[i].mended)
      std::printf("%s[%zu]: mended: %s\n", i < cloths ? "cloths" : "colliders", i < cloths ? i : colliders[i - cloths], sentence.c_str());
  const Result<CookedFabric> fabric = cook(*scene, *meshes);
  if (!fabric) {
    complain(fabric.error());
    return kBadInput;
  }
  for (const std::string& note : fabric->notes) std::printf("note: %s\n", note.c_str());
  if (const std::string note = crossing_note(*scene, *fabric); !note.empty()) std::printf("note: %s\n", note.c_str());
  if (const std::string note = size_note(*scene, *fabric); !note.empty()) std::printf("note: %s\n", note.c_str());
  std::printf("%s: nothing is wrong: %s, %zu colliders\n", file.string().c_str(), summary_of(*scene, *fabric).c_str(),
              scene->colliders.size());
  return kDone;
}

Exit check_mesh(const std::filesystem::path& file, BufferFiles buffer_files) {
  const Result<Mesh> mesh = load_mesh(file, buffer_files);
  if (!mesh) {
    complain(mesh.error());
    return kBadInput;
  }
  for (const std::string& sentence : mesh->mended) std::printf("%s: mended: %s\n", file.string().c_str(), sentence.c_str());
  std::size_t boundary = 0;
  for (const WingedEdge& edge : mesh->edges) boundary += edge.triangle[0] == kNone || edge.triangle[1] == kNone;
  std::printf(
      "%s: can be simulated: %zu vertices welded to %zu points within %g m, %zu triangles, %zu edges, %zu of them on the boundary\n",
      file.string().c_str(), mesh->render.positions.size(), mesh->points.size(), mesh->weld_tolerance, mesh->triangles.size(),
      mesh->edges.size(), boundary);
  return kDone;
}

}  // namespace

Exit check(const std::filesystem::path& file, BufferFiles buffer_files) {
  return is_mesh(file) ? check_mesh(file, buffer_files) : check_scene(file, buffer_files);
}

}  // namespace weft::command
