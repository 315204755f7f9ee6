// Reflection: what is read, what is written, and that no module can make it crash.
#include "compute/reflect.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "touch_vulkan10.h"
#include "touch_vulkan12.h"
#include "touch_vulkan13.h"

namespace weft::compute {
namespace {

using Words = std::vector<uint32_t>;
using Kind = Binding::Kind;

// Three environments are three dialects: 1.0 writes BufferBlock, 1.2 StorageBuffer, 1.3 LocalSizeId.
const Words kDialects[] = {Words(std::begin(touch_vulkan10), std::end(touch_vulkan10)),
                           Words(std::begin(touch_vulkan12), std::end(touch_vulkan12)),
                           Words(std::begin(touch_vulkan13), std::end(touch_vulkan13))};

TEST(Reflect, every_kind_of_binding_is_found_with_its_access) {
  struct Expected {
    uint32_t set, binding;
    Kind kind;
    bool read, written;
  };
  constexpr Expected kExpected[] = {
      {0, 0, Kind::storage_buffer, true, false},       {0, 1, Kind::storage_buffer, true, true},
      {0, 2, Kind::storage_buffer, false, true},       {1, 4, Kind::uniform_texel_buffer, true, false},
      {1, 5, Kind::storage_texel_buffer, false, true}, {1, 6, Kind::combined_image, true, false},
      {1, 7, Kind::uniform_buffer, true, false},
  };
  for (const Words& words : kDialects) {
    const Result<Reflection> reflection = reflect(words);
    ASSERT_TRUE(reflection) << reflection.error();
    ASSERT_EQ(reflection->bindings.size(), std::size(kExpected));
    for (size_t i = 0; i < std::size(kExpected); ++i) {
      const Binding& found = reflection->bindings[i];
      EXPECT_EQ(found.set, kExpected[i].set);
      EXPECT_EQ(found.binding, kExpected[i].binding);
      EXPECT_EQ(found.kind, kExpected[i].kind) << kind_name(found.kind);
      EXPECT_EQ(found.read, kExpected[i].read) << found.name;
      EXPECT_EQ(found.written, kExpected[i].written) << found.name;
    }
  }
}

TEST(Reflect, instructions_are_those_of_functions) {
  const auto word = [](uint32_t words, uint32_t op) { return words << 16 | op; };
  constexpr uint32_t kVoid = 19, kFunction = 54, kFunctionEnd = 56, kLabel = 248, kReturn = 253;
  const Words module = {0x07230203, 0x00010500, 0, 9, 0, word(2, kVoid), 1, word(5, kFunction), 1, 2, 0, 3, word(2, kLabel), 4,
                        word(1, kReturn), word(1, kFunctionEnd), word(2, kVoid), 5};
  EXPECT_EQ(instructions_of(module), 4u);
  EXPECT_EQ(instructions_of(Words(module.begin(), module.begin() + 7)), 0u);
  EXPECT_EQ(instructions_of({}), 0u);
  for (const Words& words : kDialects) EXPECT_GT(instructions_of(words), 20u);
}

TEST(Reflect, a_binding_is_called_as_in_the_shader) {
  const Result<Reflection> reflection = reflect(kDialects[1]);
  ASSERT_TRUE(reflection) << reflection.error();
  EXPECT_EQ(reflection->bindings[0].name, "EDGES");
  EXPECT_EQ(reflection->bindings[3].name, "POSITIONS");
  EXPECT_EQ(reflection->entry_point, "main");
}

TEST(Reflect, the_workgroup_size_comes_with_the_constant_that_sets_it) {
  for (const Words& words : kDialects) {
    const Result<Reflection> reflection = reflect(words);
    ASSERT_TRUE(reflection) << reflection.error();
    EXPECT_EQ(reflection->local_size, (std::array<uint32_t, 3>{1, 2, 1}));
    EXPECT_EQ(reflection->local_size_id[0], std::optional<uint32_t>(3));
    EXPECT_FALSE(reflection->local_size_id[1]);
    EXPECT_FALSE(reflection->local_size_id[2]);
  }
}

TEST(Reflect, the_push_block_ends_with_its_last_member) {
  for (const Words& words : kDialects) {
    const Result<Reflection> reflection = reflect(words);
    ASSERT_TRUE(reflection) << reflection.error();
    EXPECT_EQ(reflection->push_constant_bytes, 28u);  // vec3, float, uint[3], scalar layout
  }
}

TEST(Reflect, specialisation_constants_come_by_id_with_their_defaults) {
  const Result<Reflection> reflection = reflect(kDialects[1]);
  ASSERT_TRUE(reflection) << reflection.error();
  ASSERT_EQ(reflection->spec_constants.size(), 2u);
  EXPECT_EQ(reflection->spec_constants[0].id, 3u);
  EXPECT_EQ(reflection->spec_constants[0].value, 1u);
  EXPECT_EQ(reflection->spec_constants[1].id, 7u);
  EXPECT_EQ(reflection->spec_constants[1].value, 0x3f000000u);  // 0.5f
  EXPECT_EQ(reflection->spec_constants[1].name, "damping");
}

TEST(Reflect, a_module_stripped_of_its_names_reflects_alike) {
  for (const Words& words : kDialects) {
    Words stripped(words.begin(), words.begin() + 5);
    for (size_t at = 5; at < words.size(); at += words[at] >> 16) {
      const uint32_t op = words[at] & 0xffff;
      if (op == 5 || op == 6) continue;  // OpName, OpMemberName
      stripped.insert(stripped.end(), words.begin() + at, words.begin() + at + (words[at] >> 16));
    }
    const Result<Reflection> full = reflect(words);
    const Result<Reflection> bare = reflect(stripped);
    ASSERT_TRUE(full) << full.error();
    ASSERT_TRUE(bare) << bare.error();
    ASSERT_EQ(bare->bindings.size(), full->bindings.size());
    for (size_t i = 0; i < full->bindings.size(); ++i) {
      EXPECT_EQ(bare->bindings[i].kind, full->bindings[i].kind);
      EXPECT_EQ(bare->bindings[i].written, full->bindings[i].written);
      EXPECT_TRUE(bare->bindings[i].name.empty());
    }
  }
}

TEST(Reflect, what_is_not_spirv_is_refused_in_a_sentence) {
  const Words empty;
  EXPECT_EQ(reflect(empty).error(), "SPIR-V of 0 words is shorter than its header of 5");
  const Words text(100, 0x20202020);
  EXPECT_NE(reflect(text).error().find("this is not SPIR-V"), std::string::npos);
  Words swapped = kDialects[0];
  swapped[0] = 0x03022307;
  EXPECT_NE(reflect(swapped).error().find("byte order"), std::string::npos);
  Words unbounded = kDialects[0];
  unbounded[3] = 0xffffffff;
  EXPECT_NE(reflect(unbounded).error().find("bound"), std::string::npos);
}

TEST(Reflect, a_module_cut_short_anywhere_does_no_harm) {
  for (const Words& words : kDialects) {
    for (size_t length = 0; length < words.size(); ++length) {
      const Result<Reflection> reflection = reflect(std::span(words).first(length));
      EXPECT_TRUE(reflection || !reflection.error().empty());
    }
  }
}

TEST(Reflect, words_changed_at_random_do_no_harm) {
  std::mt19937 random(20260721);
  for (const Words& words : kDialects) {
    for (int round = 0; round < 4000; ++round) {
      Words broken = words;
      for (uint32_t change = 0; change <= random() % 4; ++change) {
        uint32_t& word = broken[random() % broken.size()];
        switch (random() % 4) {
          case 0: word = random(); break;
          case 1: word ^= 1u << (random() % 32); break;
          case 2: word = random() % 200; break;  // most likely an id of something else
          default: word = broken[random() % broken.size()]; break;
        }
      }
      broken[3] %= 4096;  // a large bound is legal and only slow
      const Result<Reflection> reflection = reflect(broken);
      EXPECT_TRUE(reflection || !reflection.error().empty());
    }
  }
}

}  // namespace
}  // namespace weft::compute
