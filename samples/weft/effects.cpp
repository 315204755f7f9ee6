// `weft effects`: a scene is charged only for what it calls for. Each effect alone over the barest cloth, then all pairs.
#include <cstdio>

#include "samples/weft/commands.h"
#include "samples/weft/console.h"
#include "samples/weft/effect_price.h"
#include "samples/weft/effect_rows.h"
#include "samples/weft/effects_table.h"
#include "samples/weft/files.h"
#include "samples/weft/outputs.h"

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

}  // namespace

Exit effects(const EffectsOptions& given) {
  EffectsOptions options = given;
  if (options.quick) {
    options.size = kFewCells;
    options.frames = kFewFrames;
  }
  listen_for_interrupts();
  const std::vector<std::string> names = {"effects.csv", "effects.md", kBodyFile};
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
  std::vector<EffectPrice> prices;
  const std::vector<Called> all = all_called(options.quick);
  {
    Progress progress("pricing effects", static_cast<std::uint32_t>(all.size()), "scenes");
    for (const Called& called : all) {
      if (interrupted()) break;
      auto price = price_or_refusal(**device, called, *base, options);
      if (!price) return failed(price.error());
      std::printf("%s", line_of(*price).c_str());
      std::fflush(stdout);
      prices.push_back(std::move(*price));
      progress.step();
    }
  }
  const std::pair<const char*, std::string> files[] = {{"effects.csv", csv(prices)}, {"effects.md", markdown(prices)}};
  for (const auto& [name, text] : files)
    if (const Result<void> written = write_text(options.out / name, text); !written) return failed(written.error());
  std::printf("Written: effects.csv, effects.md, effects_body.obj in %s\n", options.out.string().c_str());
  if (!interrupted()) return kDone;
  complain("Interrupted: what is written is of the effects before");
  return kInterrupted;
}

}  // namespace weft::command
