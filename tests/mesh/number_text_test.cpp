// Numbers as text, read back as the same bits.
#include "engine/mesh/number_text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

namespace weft {
namespace {

std::string text_of(float value) {
  std::string text;
  parts::add_number(text, value);
  return text;
}

TEST(NumberText, reads_back_as_the_same_bits) {
  std::size_t longest = 0;
  // Every 1009th float, both signs: 8 million. (All of those from 2^-16 to 2^10, which the quick way writes, were gone through by hand.)
  for (std::uint32_t bits = 0; bits < 0x7f800000u; bits += 1009)
    for (const std::uint32_t sign : {0u, 0x80000000u}) {
      const auto value = std::bit_cast<float>(bits | sign);
      char text[parts::kNumberLength + 1];
      char* const end = parts::put_number(value, text);
      float read = 1;
      const auto [last, error] = std::from_chars(text, end, read);
      ASSERT_TRUE(error == std::errc() && last == end && std::bit_cast<std::uint32_t>(read) == std::bit_cast<std::uint32_t>(value))
          << value << ": " << std::string(+text, end);
      longest = std::max(longest, static_cast<std::size_t>(end - text));
    }
  EXPECT_LE(longest, parts::kNumberLength);
}

TEST(NumberText, is_short_where_the_number_is) {
  EXPECT_EQ(text_of(0), "0");
  EXPECT_EQ(text_of(-0.f), "-0");
  EXPECT_EQ(text_of(1), "1");
  EXPECT_EQ(text_of(-0.5f), "-0.5");
  EXPECT_EQ(text_of(120), "120");
  EXPECT_EQ(text_of(999.99994f), "999.999938965");
  EXPECT_EQ(text_of(1000), "1000");
  EXPECT_EQ(text_of(1e-20f), "1e-20");
  EXPECT_EQ(text_of(0.0078125f), "0.0078125");
  EXPECT_EQ(text_of(-0.01f), "-0.009999999776");
}

}  // namespace
}  // namespace weft
