// The table of effects, made from list.h.
#include <algorithm>
#include <cassert>

#include "engine/effects/contact/contact.h"
#include "engine/effects/effect.h"

namespace weft {

namespace {
constexpr const Effect* kTable[] = {
#define WEFT_ROW(name) &effects::name,
    WEFT_EFFECTS(WEFT_ROW)
#undef WEFT_ROW
};
}  // namespace

std::span<const Effect* const> all_effects() { return kTable; }

std::span<const Buffer* const> all_buffers() {
  static const std::vector<const Buffer*> rows = [] {
    std::vector<const Buffer*> all;
    for (const Effect* effect : all_effects()) all.insert(all.end(), effect->buffers.begin(), effect->buffers.end());
    return all;
  }();
  return rows;
}

std::size_t number_of(const Buffer& row) {
  const auto rows = all_buffers();
  const auto at = std::find(rows.begin(), rows.end(), &row);
  assert(at != rows.end() && "no effect declares this buffer");
  return static_cast<std::size_t>(at - rows.begin());
}

const Buffer* buffer_named(std::string_view name) {
  const auto rows = all_buffers();
  const auto at = std::find_if(rows.begin(), rows.end(), [&](const Buffer* row) { return row->name == name; });
  return at == rows.end() ? nullptr : *at;
}

Cooked cooked_of(const Scene& scene, const CookedFabric& fabric) { return {scene, fabric, contact_settings(scene, fabric)}; }

Needs needs_of(const Cooked& subject, std::uint32_t workgroup, bool through_texels, std::uint32_t narrow, std::uint32_t alone,
               std::uint32_t crew, std::uint32_t thin, bool idle_costs) {
  Needs needs;
  needs.narrow = std::min(narrow, workgroup);
  needs.alone = alone;
  needs.crew = crew;
  needs.thin = std::min(thin, workgroup);
  needs.constants[gpu::constant::workgroup] = workgroup;
  needs.constants[gpu::constant::through_texels] = through_texels;
  needs.constants[gpu::constant::idle_costs] = idle_costs;
  for (std::size_t k = 0; k < kEffects; ++k) {
    const Effect& effect = *all_effects()[k];
    if (!effect.called_for(subject.scene, subject.fabric)) continue;
    needs.effects.set(k);
    if (effect.specialize != nullptr) effect.specialize(subject, needs.constants);
  }
  return needs;
}

std::string reference_fault(const Scene& scene, const CookedFabric& fabric) {
  for (const Effect* effect : all_effects())
    if (effect->reference == Reference::absent && effect->called_for(scene, fabric))
      return std::string(*effect->key != 0 ? effect->key : effect->name) + ": the reference has none";
  return {};
}

}  // namespace weft
