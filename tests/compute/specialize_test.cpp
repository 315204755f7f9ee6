// Specialisation on Weft's own passes: what is decided is gone from the words, and what was specialised once is not specialised again.
#include "compute/specialize.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "compute/contraction.h"
#include "compute/reflect.h"
#include "compute/spirv.h"
#include "shaders/embedded.h"
#include "shaders/shared.h"

namespace weft::compute {
namespace {

using Words = std::vector<uint32_t>;
using Constants = std::vector<SpecializationConstant>;

const Constants kPlain = {{gpu::constant::workgroup, 64}};
const Constants kColliding = {{gpu::constant::workgroup, 64},
                              {gpu::constant::finalizes, 1},
                              {gpu::constant::has_colliders, 1},
                              {gpu::constant::spheres, 2}};

std::set<std::string> names(const Words& words) {
  const auto reflection = reflect(words);
  EXPECT_TRUE(reflection) << reflection.error();
  std::set<std::string> found;
  for (const Binding& binding : reflection->bindings) found.insert(binding.name);
  return found;
}

TEST(Specialize, what_a_constant_turns_off_is_gone_with_its_bindings) {
  const auto plain = specialize(shader("stretch"), kPlain), colliding = specialize(shader("stretch"), kColliding);
  ASSERT_TRUE(plain && colliding);
  EXPECT_FALSE(names(*plain).contains("colliders_block"));
  EXPECT_TRUE(names(*colliding).contains("colliders_block"));
  EXPECT_LT(plain->size(), colliding->size());
  const auto reflection = reflect(*colliding);
  ASSERT_TRUE(reflection) << reflection.error();
  EXPECT_TRUE(reflection->spec_constants.empty());
  EXPECT_EQ(reflection->local_size[0], 64u);
  std::set<std::pair<uint32_t, uint32_t>> numbers;
  for (const Binding& binding : reflection->bindings)
    EXPECT_TRUE(numbers.emplace(binding.set, binding.binding).second) << binding.name << " shares its number";
}

TEST(Specialize, what_may_not_be_contracted_is_decorated_once) {
  const auto solve = specialize(shader("contact_solve"), kPlain);
  ASSERT_TRUE(solve);
  const auto counted = [](const Words& words) {   // products of floats, and the arithmetic that is decorated
    std::pair<int, std::multiset<uint32_t>> count;
    for (size_t at = spirv::kHeaderWords; at < words.size(); at += words[at] >> 16) {
      count.first += (words[at] & 0xffff) == 133;
      if ((words[at] & 0xffff) == spirv::OpDecorate && words[at + 2] == spirv::kNoContraction) count.second.insert(words[at + 1]);
    }
    return count;
  };
  const Words free = *solve, strict = without_contraction(free);
  const auto before = counted(free), after = counted(strict);
  EXPECT_GT(before.first, 0);
  EXPECT_EQ(after.first, before.first);
  EXPECT_GT(before.second.size(), 0u) << "those that are `precise` anyway";
  EXPECT_GE(after.second.size(), before.second.size() + 5);
  for (const uint32_t id : after.second) EXPECT_EQ(after.second.count(id), 1u);
  EXPECT_EQ(without_contraction(strict), strict);
  EXPECT_EQ(names(strict), names(free));
  EXPECT_EQ(without_contraction(Words(3, 7)), Words(3, 7));
}

TEST(Specialize, words_that_are_no_module_are_refused_in_a_sentence) {
  EXPECT_NE(specialize(Words{}, {}).error().find("shorter than its header"), std::string::npos);
  EXPECT_NE(specialize(Words(100, 0x20202020), {}).error().find("could not be specialised"), std::string::npos);
}

TEST(Specializer, what_changes_nothing_that_a_module_knows_of_is_not_specialised_again) {
  Specializer specializer;
  const auto first = specializer.specialize(shader("surface"), kPlain);
  ASSERT_TRUE(first) << first.error();
  const auto again = specializer.specialize(shader("surface"), kColliding);   // it does not collide
  ASSERT_TRUE(again) << again.error();
  EXPECT_EQ(again->data(), first->data());
  const auto wide = specializer.specialize(shader("surface"), Constants{{gpu::constant::workgroup, 128}});
  ASSERT_TRUE(wide) << wide.error();
  EXPECT_NE(wide->data(), first->data());
  EXPECT_EQ(specializer.modules(), 2u);
  EXPECT_FALSE(specializer.specialize(Words(100, 0x20202020), {}));
  EXPECT_EQ(specializer.modules(), 2u);
}

TEST(Specializer, what_it_remembers_another_takes_over) {
  Specializer one, other;
  for (const char* name : {"stretch", "bend", "surface"})
    for (const Constants& constants : {kPlain, kColliding}) ASSERT_TRUE(one.specialize(shader(name), constants));
  const Words kept = one.remembered();
  other.remember(kept);
  EXPECT_EQ(other.modules(), one.modules());
  EXPECT_EQ(other.remembered(), kept);
  const auto taken = other.specialize(shader("bend"), kColliding), made = one.specialize(shader("bend"), kColliding);
  ASSERT_TRUE(taken && made);
  EXPECT_TRUE(std::equal(taken->begin(), taken->end(), made->begin(), made->end()));
  EXPECT_EQ(other.modules(), one.modules()) << "nothing new";
}

TEST(Specializer, damaged_words_are_left_out) {
  Specializer one;
  ASSERT_TRUE(one.specialize(shader("surface"), kPlain));
  const Words kept = one.remembered();
  for (std::size_t length = 0; length < kept.size(); length += 7) {
    Specializer other;
    other.remember(std::span(kept).first(length));
    EXPECT_EQ(other.modules(), 0u) << length;
  }
  for (std::size_t at = 0; at < 12; ++at)   // its lengths, its version, its key, its first words
    for (const uint32_t wrong : {0u, 1u << 16, 0xffffffffu}) {
      Words damaged = kept;
      damaged[at] = wrong;
      Specializer other;
      other.remember(damaged);
      const auto words = other.specialize(shader("surface"), kPlain);
      ASSERT_TRUE(words) << words.error();
      EXPECT_TRUE(reflect(*words)) << "word " << at;
    }
}

}  // namespace
}  // namespace weft::compute
