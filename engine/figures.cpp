// The figures that effects declare (engine/effects/effect.h).
#include "engine/figures.h"

#include "engine/effects/effect.h"

namespace weft {
namespace {

template <class Body>
void for_each_called_for(const Scene& scene, const CookedFabric& fabric, const Body& body) {
  for (const Effect* effect : all_effects())
    if (effect->called_for(scene, fabric)) body(*effect);
}

}  // namespace

std::vector<FigureValue> cooked_figures(const Scene& scene, const CookedFabric& fabric) {
  std::vector<FigureValue> found;
  for_each_called_for(scene, fabric, [&](const Effect& effect) {
    for (const Figure& figure : effect.figures)
      if (figure.cooked != nullptr) found.push_back({figure.name, figure.cooked(fabric)});
  });
  return found;
}

std::vector<FigureValue> counted_figures(const Scene& scene, const CookedFabric& fabric, const Counts& counts) {
  std::vector<FigureValue> found;
  for_each_called_for(scene, fabric, [&](const Effect& effect) {
    for (const Figure& figure : effect.figures) {
      if (figure.counted != nullptr) found.push_back({figure.name, figure.counted(counts)});
      if (figure.measured != nullptr) found.push_back({figure.name, figure.measured(counts)});
    }
  });
  return found;
}

std::vector<std::string> remarks_on(const Scene& scene, const CookedFabric& fabric, const Counts& counts) {
  std::vector<std::string> remarks;
  for_each_called_for(scene, fabric, [&](const Effect& effect) {
    if (effect.remark != nullptr) effect.remark(counts, remarks);
  });
  return remarks;
}

std::string summary_of(const Scene& scene, const CookedFabric& fabric) {
  std::string text = std::to_string(cloth_particles(fabric)) + " particles, " + std::to_string(fabric.links.size()) + " edges";
  for (const FigureValue& figure : cooked_figures(scene, fabric))
    text += ", " + std::to_string(std::get<std::uint64_t>(figure.value)) + ' ' + std::string(figure.name);
  return text;
}

}  // namespace weft
