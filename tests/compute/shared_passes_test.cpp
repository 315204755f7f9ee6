// Simulations of one device share what was compiled for it, and it does not grow without end.
#include <gtest/gtest.h>

#include "compute/shared_passes.h"
#include "engine/simulation.h"
#include "tests/support/sheets.h"

namespace weft::compute {
namespace {

using SharedPass = GpuTest;

TEST_F(SharedPass, is_compiled_once_for_all_simulations_that_have_it_and_stays_for_the_next) {
  SharedPasses& passes = device().passes();
  passes.clear();
  const std::size_t before = passes.count();
  auto first = must(Simulation::create(device(), sheet(4)));
  const std::size_t one = passes.count();
  EXPECT_GT(one, before);
  const auto second = must(Simulation::create(device(), sheet(5)));
  EXPECT_EQ(passes.count(), one) << "another size is no other code";
  Scene other = sheet(4);
  other.contacts.enabled = true;
  const auto third = must(Simulation::create(device(), other));
  EXPECT_GT(passes.count(), one);
  first.reset();
  passes.clear();
  EXPECT_GE(passes.count(), one) << "the second has them still";
  must(second->advance(1.0 / 60));
}

TEST(SharedPasses, keep_those_that_were_used_last_and_all_that_are_in_use) {
  SharedPasses passes;
  std::uint32_t made = 0;
  const auto get = [&](std::uint32_t word) {
    return must(passes.get("pass", std::span(&word, 1), [&]() -> Result<CompiledPass> { return ++made, CompiledPass(); }));
  };
  const auto held = get(0);
  for (std::uint32_t word = 1; word < SharedPasses::kMostKept; ++word) get(word);
  EXPECT_EQ(made, SharedPasses::kMostKept);
  get(1);
  EXPECT_EQ(made, SharedPasses::kMostKept);
  get(SharedPasses::kMostKept);   // in place of 2
  EXPECT_EQ(passes.count(), SharedPasses::kMostKept);
  const std::uint32_t so_far = made;
  EXPECT_EQ(get(0), held);
  get(1);
  get(3);
  EXPECT_EQ(made, so_far);
  get(2);
  EXPECT_EQ(made, so_far + 1);
}

TEST(SharedPasses, keep_nothing_of_what_could_not_be_made) {
  SharedPasses passes;
  const std::uint32_t word = 7;
  EXPECT_FALSE(passes.get("pass", std::span(&word, 1), []() -> Result<CompiledPass> { return Error{"no memory"}; }));
  EXPECT_EQ(passes.count(), 0u);
}

}  // namespace
}  // namespace weft::compute
