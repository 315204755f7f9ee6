// Cloth that starts out crossing itself, or was driven through cloth, is untangled: detection finds what goes through each other
// (shaders/untangle/crossing.glsl), and one pass takes it back by contacts (untangle.comp). engine/README.md, "Untangling", has more.
#include "engine/effects/untangle/untangle.h"

#include <cstddef>

namespace weft::effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::tangled_pairs, &buffers::crossed_triangles, &buffers::regions, &buffers::region_sizes};

constexpr Threads kTangles{lengths::particles, lengths::one, {&buffers::detection, offsetof(gpu::Detection, tangles)}};
constexpr Pass kPasses[] = {
    {.name = "untangle", .stage = Stage::detect, .threads = kTangles, .only_after_motion = true, .alone = true, .crew = true}};

constexpr Figure kFigures[] = {
    {.name = "contacts.crossings", .counted = [](const Counts& c) { return std::uint64_t(c.crossings); }},
    {.name = "contacts.crossings_max", .counted = [](const Counts& c) { return std::uint64_t(c.crossings_most); }},
};

void remark(const Counts& counts, std::vector<std::string>& remarks) {
  if (counts.crossings_most == 0) return;
  remarks.push_back("Up to " + std::to_string(counts.crossings_most) + " edges went through triangles; " +
                    (counts.crossings == 0 ? "all are untangled" : std::to_string(counts.crossings) + " still do"));
}

}  // namespace

constinit const Effect untangle{
    .name = "untangle",
    .key = "contacts.untangle",
    .called_for = [](const Scene& scene, const CookedFabric& fabric) { return !fabric.rest.empty() && scene.contacts.untangle; },
    .buffers = kBuffers,
    .passes = kPasses,
    .specialize = [](const Cooked&, Constants& constants) { constants[gpu::constant::untangles] = 1; },
    .reference = Reference::absent,
    .figures = kFigures,
    .remark = remark,
};

}  // namespace weft::effects
