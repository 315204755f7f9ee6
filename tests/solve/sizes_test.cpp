// Scenes that are too large for a device: the sentence names what their author wrote.
#include "engine/solve/sizes.h"

#include <gtest/gtest.h>

#include "tests/support/cooked.h"

namespace weft {
namespace {

Scene touching(std::uint32_t cells) {
  Scene scene;
  scene.cloths.resize(2);
  scene.cloths[0].grid = Grid{{1, 1}, 2, 2};
  scene.cloths[1].grid = Grid{{1, 1}, cells, cells};
  scene.contacts.enabled = true;
  return scene;
}

std::string fault_of(const Scene& scene, const SizeLimits& limits = {}) {
  const CookedFabric fabric = cooked(scene);
  const Cooked subject = cooked_of(scene, fabric);
  compute::Specializer specializer;
  return beyond(limits, "toaster", must(make_plan(needs_of(subject, limits.workgroup, true), specializer)), subject);
}

std::uint32_t number_after(const std::string& text, const std::string& words) {
  const std::size_t at = text.find(words);
  return at == text.npos ? 0 : static_cast<std::uint32_t>(std::stoul(text.substr(at + words.size())));
}

TEST(Sizes, a_capacity_that_no_device_need_have_is_named_with_the_limit_that_would_do) {
  Scene scene = touching(4);
  EXPECT_EQ(fault_of(scene), "");
  scene.contacts.capacity = kMostCandidates;
  const std::string fault = fault_of(scene);
  EXPECT_TRUE(fault.starts_with("contacts.capacity: 67108864 candidate pairs, too many for toaster (at most ")) << fault;
  scene.contacts.capacity = number_after(fault, "at most ");
  EXPECT_GT(scene.contacts.capacity, 1'000'000u);
  EXPECT_EQ(fault_of(scene), "");
  ++scene.contacts.capacity;
  EXPECT_NE(fault_of(scene), "");
}

TEST(Sizes, a_cloth_that_is_too_large_is_named_with_its_particles) {
  SizeLimits small;
  small.storage_bytes = 1 << 16;
  std::string fault = fault_of(touching(40), small);
  EXPECT_TRUE(fault.starts_with("cloths[1]: has 1681 of the scene's 1690 particles, too many for toaster: buffer ")) << fault;
  EXPECT_NE(fault.find("maxStorageBufferRange of 65536"), fault.npos) << fault;
  small = {};
  small.workgroups = 10;
  fault = fault_of(touching(40), small);
  EXPECT_TRUE(fault.starts_with("cloths[1]: has 1681 of the scene's 1690 particles, too many for toaster: pass ")) << fault;
}

}  // namespace
}  // namespace weft
