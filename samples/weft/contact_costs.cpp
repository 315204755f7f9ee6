#include "samples/weft/contact_costs.h"

#include <cmath>
#include <string_view>

#include "engine/effects/contact/contact.h"
#include "engine/simulation.h"
#include "samples/weft/console.h"

namespace weft::command {

namespace {

constexpr int kSearches = 8;

bool begins_with_one_of(std::string_view name, std::initializer_list<std::string_view> beginnings) {
  for (const std::string_view beginning : beginnings)
    if (name.starts_with(beginning)) return true;
  return false;
}

bool of_searches(std::string_view pass) {
  return begins_with_one_of(pass, {"detect_track", "detect_outline", "detect_alone", "detect_search", "detect_pair", "outline_", "cluster_",
                                   "grid_", "search_", "pair_"});
}
bool of_pairs(std::string_view pass) { return begins_with_one_of(pass, {"detect_arguments", "contact_", "untangle"}); }

// Written state needs a detection. Of several the fastest counts, since other programs use the machine too.
Result<void> time_searches(Simulation& simulation, ContactCosts& costs) {
  for (int k = 0; k < kSearches; ++k) {
    const auto positions = simulation.read_positions();
    if (!positions) return fail(positions.why());
    if (auto done = simulation.write_positions(*positions); !done) return done;
    const std::uint32_t before = simulation.counts().detections;
    if (const auto advance = simulation.advance(1 / simulation.scene().solver.rate); !advance) return fail(advance.why());
    const std::uint32_t searches = simulation.counts().detections - before;
    if (searches == 0) return fail("no search for pairs in a frame that was to begin with one");
    ContactCosts these;
    for (const PassTiming& timing : simulation.timings())
      if (of_searches(timing.name)) these.passes.push_back({timing.name, timing.milliseconds / searches});
    if (k == 0 || these.per_search() < costs.per_search()) costs.passes = std::move(these.passes);
  }
  return {};
}

}  // namespace

double ContactCosts::per_search() const {
  double sum = 0;
  for (const PassCost& pass : passes) sum += pass.ms;
  return sum;
}

Result<ContactCosts> contact_costs(const compute::Device& device, const Scene& scene, std::uint32_t vertices, std::uint32_t frames,
                                   double cell) {
  Scene sized = scene;
  for (Cloth& cloth : sized.cloths)
    if (cloth.grid) cloth.grid->cells_x = cloth.grid->cells_y = vertices - 1;
  sized.contacts.enabled = true;
  sized.contacts.cell = cell;
  sized.contacts.untangle = false;   // whoever writes positions has crossings looked for; a detection as a rule does not
  SimulationOptions options;
  options.timings = true;
  auto created = Simulation::create(device, sized, options);
  if (!created) return created.take_error();
  Simulation& simulation = **created;
  ContactCosts costs;
  costs.vertices = vertices;
  costs.edge = simulation.fabric().mean_edge;
  costs.cell = contact_settings(sized, simulation.fabric()).cell;
  for (std::uint32_t frame = 0; frame <= frames; ++frame) {
    const auto advance = simulation.advance(1 / sized.solver.rate);
    if (!advance) return fail(vertices, " x ", vertices, " vertices, frame ", frame, ": ", advance.why());
    if (interrupted()) return fail("interrupted");
    costs.substeps += advance->substeps;
    if (frame == 0) continue;
    for (const PassTiming& timing : simulation.timings())
      (of_searches(timing.name) ? costs.search : of_pairs(timing.name) ? costs.contacts : costs.solve) += timing.milliseconds / frames;
  }
  costs.searches = simulation.counts().detections;
  if (auto done = time_searches(simulation, costs); !done) return done.take_error();
  costs.pairs_most = simulation.counts().contacts_most;
  costs.pairs_overflowed = simulation.counts().contacts_overflowed;
  return costs;
}

double growth(const std::vector<ContactCosts>& costs) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const ContactCosts& cost : costs) {
    if (!(cost.per_search() > 0)) continue;
    const double a = std::log(cost.vertices), b = std::log(cost.per_search());
    ++n, x += a, y += b, xx += a * a, xy += a * b;
  }
  const double divisor = n * xx - x * x;
  return divisor > 0 ? (n * xy - x * y) / divisor : 0;
}

}  // namespace weft::command
