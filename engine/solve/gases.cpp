// The gases of closed cloth, as the host changes them.
#include "engine/solve/state.h"

namespace weft {
namespace {

bool is_amount(double amount) { return amount >= 0 && amount <= kMostGas; }

}  // namespace

// Errors: what is damaged.
Result<void> Simulation::State::check_gases(const Snapshot& snapshot) const {
  if (snapshot.gas_amounts.size() != gas_amounts.size())
    return fail("it has gases of ", snapshot.gas_amounts.size(), " cloths instead of ", gas_amounts.size());
  for (const float amount : snapshot.gas_amounts)
    if (!is_amount(amount)) return fail("a cloth has ", amount, " times the scene's amount of gas");
  return {};
}

Result<void> Simulation::inflate(std::uint32_t cloth, double amount) try {
  const std::vector<Cloth>& cloths = state_->scene.cloths;
  if (cloth >= cloths.size() || !cloths[cloth].pressure) return fail("cloth ", cloth, " holds no gas (its key \"pressure\")");
  if (!is_amount(amount)) return fail("cloth ", cloth, " is given ", amount, " times the scene's amount of gas, not from 0 to ", kMostGas);
  state_->gas_amounts[cloth] = static_cast<float>(amount);
  return {};
} catch (...) {
  return caught("the gas");
}

}  // namespace weft
