#include "samples/weft/contact_price.h"

#include <chrono>
#include <cstdio>

#include "engine/reference/intersections.h"
#include "engine/simulation.h"
#include "samples/weft/console.h"

namespace weft::command {

namespace {

struct Side {
  std::unique_ptr<Simulation> simulation;
  std::vector<double> frames;   // ms

  Result<void> advance(double seconds) {
    const auto start = std::chrono::steady_clock::now();
    if (const auto advance = simulation->advance(seconds); !advance) return fail(advance.why());
    frames.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    return {};
  }
};

// Both by the method that the scene has with contacts: by default it has another without.
Result<Side> side_of(const compute::Device& device, Scene scene, bool contacts) {
  scene.contacts.enabled = true;
  const bool levels = levels_of(scene);
  scene.solver.method = method_of(scene);
  scene.solver.levels = levels;
  scene.contacts.enabled = contacts;
  auto created = Simulation::create(device, scene, SimulationOptions{});
  if (!created) return created.take_error();
  return Side{std::move(*created), {}};
}

Result<ContactPrice> cost_of(const Side& side) {
  ContactPrice price;
  price.frame = spread_of({side.frames.begin() + 1, side.frames.end()});
  const auto positions = side.simulation->read_positions();
  if (!positions) return fail(positions.why());
  const CookedFabric& fabric = side.simulation->fabric();
  price.strain = measure_strain(fabric, *positions);
  std::vector<Vec3> places;
  for (const gpu::vec4& x : *positions) places.push_back({x.x, x.y, x.z});
  price.crossings = count_crossings(places, fabric.triangles, fabric.cloth_triangles);
  return price;
}

}  // namespace

Result<ContactPrices> contact_prices(const compute::Device& device, const Scene& scene, std::uint32_t frames) {
  Result<Side> without = side_of(device, scene, false), with = side_of(device, scene, true);
  if (!without) return without.take_error();
  if (!with) return with.take_error();
  ContactPrices prices;
  Progress progress("comparing frames", frames, "frames");
  for (; prices.frames < frames && (prices.frames < 2 || !interrupted()); ++prices.frames) {
    for (Side* side : {&*without, &*with})
      if (auto done = side->advance(1 / scene.solver.rate); !done) return done.take_error();
    progress.step();
  }
  auto price_without = cost_of(*without), price_with = cost_of(*with);
  if (!price_without) return price_without.take_error();
  if (!price_with) return price_with.take_error();
  prices.without = *price_without;
  prices.with = *price_with;
  return prices;
}

void print(const ContactPrices& prices, const std::string& scene) {
  std::printf("%s, %u frames in turns: ms a frame; strain and crossings in the last\n", scene.c_str(), prices.frames);
  std::printf("%-18s %10s %10s %12s %12s %10s\n", "", "median", "95 %", "mean strain", "worst", "crossings");
  for (const auto& [name, price] : {std::pair("without contacts", &prices.without), std::pair("with contacts", &prices.with)})
    std::printf("%-18s %10.4g %10.4g %10.3g %% %10.3g %% %10zu\n", name, price->frame.median, price->frame.p95, 100 * price->strain.mean,
                100 * price->strain.max, price->crossings);
  std::printf("%-18s %10.3g %10.3g\n", "with over without", prices.with.frame.median / prices.without.frame.median,
              prices.with.frame.p95 / prices.without.frame.p95);
}

std::string csv(const ContactPrices& prices) {
  std::string text = "contacts,frames,ms_median,ms_p95,strain_mean,strain_max,crossings\n";
  for (const auto& [name, price] : {std::pair("false", &prices.without), std::pair("true", &prices.with)}) {
    char line[160];
    std::snprintf(line, sizeof line, "%s,%u,%g,%g,%g,%g,%zu\n", name, prices.frames, price->frame.median, price->frame.p95,
                  price->strain.mean, price->strain.max, price->crossings);
    text += line;
  }
  return text;
}

}  // namespace weft::command
