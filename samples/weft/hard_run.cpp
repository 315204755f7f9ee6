// Runs a hard case and measures its figures, frame by frame.
#include "samples/weft/hard_run.h"

#include <algorithm>
#include <cmath>

#include "samples/weft/console.h"

namespace weft::command {

Result<Scene> scene_of(const HardCase& hard, const std::filesystem::path& scenes) {
  auto scene = load_scene(scenes / (std::string(hard.scene) + ".json"));
  if (scene && hard.cells > 0) scene->cloths.front().grid->cells_x = scene->cloths.front().grid->cells_y = hard.cells;
  return scene;
}

Result<std::vector<double>> measure(const compute::Device& device, const HardCase& hard, const Scene& scene) {
  auto created = Simulation::create(device, scene);
  if (!created) return created.take_error();
  Simulation& simulation = **created;
  const auto start = simulation.read_positions(), start_velocities = simulation.read_velocities();
  if (!start || !start_velocities) return fail((start ? start_velocities : start).why());
  const auto frames = std::max(1l, std::lround(hard.seconds * scene.solver.rate));
  std::vector<double> figures(hard.checks.size());
  double asked = 0, clamped = 0;
  for (long frame = 0; frame < frames && !interrupted(); ++frame) {
    const double seconds = hard.hitch > 0 && frame == frames / 2 ? hard.hitch : 1 / scene.solver.rate;
    const auto advance = simulation.advance(seconds);
    if (!advance) return fail(hard.name, ", frame ", frame, ": ", advance.why());
    asked += seconds;
    clamped += advance->clamped;
    const auto positions = simulation.read_positions(), velocities = simulation.read_velocities();
    if (!positions || !velocities) return fail((positions ? velocities : positions).why());
    const Glance at{simulation.scene(), simulation.fabric(), *start, *start_velocities, *positions, *velocities, simulation.time(), asked,
                    clamped, simulation.counts()};
    for (std::size_t k = 0; k < figures.size(); ++k) {
      const Check& check = hard.checks[k];
      if (check.when == When::at_end && frame + 1 < frames) continue;
      const double value = check.figure(at);
      figures[k] = std::isnan(value) || std::isnan(figures[k]) ? NAN : std::max(figures[k], value);
    }
  }
  return figures;
}

}  // namespace weft::command
