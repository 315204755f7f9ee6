// Prices of effects as tables: for a terminal, as CSV and for the manual.
#pragma once

#include <string>
#include <vector>

#include "samples/weft/effect_price.h"

namespace weft::command {

/// The base scene comes first, without a name.
std::string heading();
std::string line_of(const EffectPrice& price);
std::string csv(const std::vector<EffectPrice>& prices);
/// Effects alone in one table, then what their pairs take beyond both, then the pairs that there are not.
std::string markdown(const std::vector<EffectPrice>& prices);

}  // namespace weft::command
