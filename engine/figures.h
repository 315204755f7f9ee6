// What the effects of a scene report about it: numbers for files, sentences for people.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "engine/counts.h"
#include "engine/fabric.h"

namespace weft {

struct FigureValue {
  std::string_view name;   // "tethers"; "contacts.max"
  std::variant<std::uint64_t, double> value;
};

/// Of what was cooked: bends, tethers, and so on, of the effects that the scene calls for.
std::vector<FigureValue> cooked_figures(const Scene& scene, const CookedFabric& fabric);
/// Of what was counted in a run.
std::vector<FigureValue> counted_figures(const Scene& scene, const CookedFabric& fabric, const Counts& counts);
std::vector<std::string> remarks_on(const Scene& scene, const CookedFabric& fabric, const Counts& counts);

/// "7081 particles, 40618 edges, 20568 bends".
std::string summary_of(const Scene& scene, const CookedFabric& fabric);

}  // namespace weft
