#include "samples/weft/painter.h"

#include <cstdio>

#include "samples/weft/console.h"
#include "samples/weft/subject.h"

namespace weft::command {

Exit Painter::create(compute::Device& device, const Simulation& simulation, VkExtent2D size) {
  const Scene& scene = simulation.scene();
  const auto cloths = shaded_cloths(scene, simulation.fabric(), simulation.meshes());
  auto shading = Shading::create(device, scene, cloths, size);
  if (shading) {
    shading_ = std::move(*shading);
    for (const std::string& note : shading_->notes()) std::printf("note: %s\n", note.c_str());
    return kDone;
  }
  const std::vector<std::string> faults = file_faults(scene);
  for (const std::string& fault : faults) complain(fault);
  if (!faults.empty()) return kBadInput;
  complain(shading.error());
  return kFailed;
}

Result<Image> Painter::draw(const Simulation& simulation) {
  if (const std::uint32_t splits = simulation.splits(); splits != splits_) {
    const auto cloths = shaded_cloths(simulation.scene(), simulation.fabric(), simulation.meshes());
    if (auto followed = shading_->follow(cloths); !followed) return followed.take_error();
    splits_ = splits;
  }
  return shading_->draw({.positions = simulation.positions(),
                         .normals = simulation.normals(),
                         .colliders = simulation.colliders(),
                         .sizes = simulation.collider_sizes()});
}

Result<void> Painter::draw(const Simulation& simulation, const std::filesystem::path& file) {
  if (!shading_) return {};
  const Result<Image> image = draw(simulation);
  if (!image) return fail(image.why());
  return write_png(file, *image);
}

}  // namespace weft::command
