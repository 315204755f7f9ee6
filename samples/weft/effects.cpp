// `weft effects`: a scene is charged only for what it calls for. Each effect alone over the barest cloth, then all pairs.
#include <cstdio>

#include "samples/weft/commands.h"
#include "samples/weft/console.h"
#include "samples/weft/effect_price.h"
#include "samples/weft/effect_rows.h"
#include "samples/weft/effects_table.h"
#include "samples/weft/files.h"
#include "samples/weft/merge.h"
#include "samples/weft/outputs.h"
#include "samples/weft/shard.h"

namespace weft::command {

namespace {

constexpr std::uint32_t kFewCells = 12, kFewFrames = 4;

struct Called {
  std::string first, second;
  Result<std::vector<Assignment>> on;
};

// The base scene itself, effects alone, pairs.
std::vector<Called> all_called(bool quick) {
  std::vector<Called> all{{"", "", std::vector<Assignment>()}};
  const auto rows = effect_rows();
  for (const EffectRow& row : rows) all.push_back({row.name, "", row.on});
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t j = i + 1; j < (quick ? std::min(i + 2, rows.size()) : rows.size()); ++j)
      all.push_back({rows[i].name, rows[j].name, both_of(rows[i], rows[j])});
  return all;
}

// What the scene's rules refuse has a price, too: the sentence.
Result<EffectPrice> price_or_refusal(const compute::Device& device, const Called& called, const Scene& base,
                                     const EffectsOptions& options) {
  const Result<Scene> scene = called.on ? base_scene(options.size, options.out, *called.on) : Result<Scene>(called.on.why());
  EffectPrice price;
  if (!scene) price.refused = scene.error();
  if (scene) {
    auto priced = price_of(device, base, *scene, options.frames);
    if (!priced) return priced;
    price = std::move(*priced);
  }
  price.first = called.first;
  price.second = called.second;
  return price;
}

constexpr const char *kEffectsTable = "effects.csv", *kEffectsPage = "effects.md";

Exit conclude_effects(const Rows& all, const std::filesystem::path& out) {
  std::vector<EffectPrice> prices;
  for (const auto& [item, row] : all.rows) prices.push_back(row.get<EffectPrice>());
  const std::pair<const char*, std::string> files[] = {{kEffectsTable, csv(prices)}, {kEffectsPage, markdown(prices)}};
  for (const auto& [name, text] : files)
    if (const Result<void> written = write_text(out / name, text); !written) return failed(written.error());
  std::printf("Written: %s, %s in %s\n", kEffectsTable, kEffectsPage, out.string().c_str());
  return kDone;
}

}  // namespace

Exit effects(const EffectsOptions& given) {
  EffectsOptions options = given;
  if (options.quick) {
    options.size = kFewCells;
    options.frames = kFewFrames;
  }
  listen_for_interrupts();
  std::vector<std::string> names = outputs_of("effects", options.farm.shard, {kEffectsTable, kEffectsPage});
  names.push_back(kBodyFile);
  names.push_back(kMorphFile);
  if (const Exit exit = prepare_outputs(options.out, names, {}); exit != kDone) return exit;
  if (const Result<void> written = write_body(options.out); !written) return failed(written.error());
  compute::DeviceChoice choice;
  choice.name = options.device;
  const auto device = compute::Device::create(choice);
  if (!device) return failed(device.error());
  const Result<Scene> base = base_scene(options.size, options.out);
  if (!base) return failed(base.error());

  std::printf("%u x %u cells, %u frames with and without in turns, on %s\n%s", options.size, options.size, options.frames,
              (*device)->name().c_str(), heading().c_str());
  const std::vector<Called> all = all_called(options.quick);
  Labour labour;
  labour.unit = "scenes";
  labour.measure = [&](std::uint32_t item) -> Result<Row> {
    const auto price = price_or_refusal(**device, all[item], *base, options);
    if (!price) return fail(price.why());
    if (!interrupted()) std::printf("%s", line_of(*price).c_str());
    std::fflush(stdout);
    return Row(*price);
  };
  labour.conclude = [&](const Rows& rows) { return conclude_effects(rows, options.out); };
  Work work{"effects",
            {{"device", (*device)->name()}, {"size", options.size}, {"frames", options.frames}, {"quick", options.quick}}};
  work.items = static_cast<std::uint32_t>(all.size());
  return work_through(work, labour, options.farm, options.out);
}

Mergeable merged_effects() {
  return {"effects", {kEffectsTable, kEffectsPage}, [](const Rows& all, const std::filesystem::path& out) {
            std::printf("%s", heading().c_str());
            for (const auto& [item, row] : all.rows) std::printf("%s", line_of(row.get<EffectPrice>()).c_str());
            return conclude_effects(all, out);
          }};
}

}  // namespace weft::command
