// Lists as lines of text: what is shown is read back, and what cannot be read is a sentence.
#include "samples/view/lists.h"

#include <gtest/gtest.h>

namespace weft::view {
namespace {

using Numbers = std::vector<std::uint32_t>;
using Names = std::vector<std::string>;
constexpr auto kRange = scene_fields::between(0, 999);

TEST(Lists, numbers_are_read_back_as_they_were) {
  for (const Numbers& list : {Numbers{}, Numbers{7}, Numbers{0, 12, 3}, Numbers{1, 2}, Numbers{5, 6, 7, 8, 20}, Numbers{3, 2, 1, 1}}) {
    const auto read = numbers_in(in_a_line(list), kRange, 100);
    ASSERT_TRUE(read) << read.error();
    EXPECT_EQ(*read, list) << in_a_line(list);
  }
  EXPECT_EQ(in_a_line(Numbers{0, 12, 20, 21, 22, 4, 5}), "0, 12, 20-22, 4, 5");
  EXPECT_EQ(numbers_in(" 1 2,3 ,, 8-10 ", kRange, 100).value(), (Numbers{1, 2, 3, 8, 9, 10}));
}

TEST(Lists, numbers_that_are_none_are_sentences) {
  const auto fault = [](const char* line) {
    const auto read = numbers_in(line, kRange, 10);
    return read ? std::string() : read.error();
  };
  EXPECT_EQ(fault("1, x"), "\"x\" is no whole number");
  EXPECT_EQ(fault("1.5"), "\"1.5\" is no whole number");
  EXPECT_EQ(fault("-3"), "\"-3\" is no whole number");
  EXPECT_EQ(fault("3-"), "\"\" is no whole number");
  EXPECT_EQ(fault("1000"), "1000 is more than 999");
  EXPECT_EQ(fault("99999999999999999999999"), "1e+23 is more than 999");
  EXPECT_EQ(fault("8-3"), "the run 8-3 goes backwards");
  EXPECT_EQ(fault("0-900"), "more than 10 numbers");
  EXPECT_EQ(fault("0-9"), "");
}

TEST(Lists, names_are_read_back_as_they_were) {
  for (const Names& list : {Names{}, Names{"skirt"}, Names{"skirt", "cape"}, Names{"a, b", " c", "say \"d\"", "\"", "two words"}}) {
    const auto read = names_in(in_a_line(list), 100);
    ASSERT_TRUE(read) << read.error();
    EXPECT_EQ(*read, list) << in_a_line(list);
  }
  EXPECT_EQ(in_a_line(Names{"skirt", "a, b"}), "skirt, \"a, b\"");
  EXPECT_EQ(names_in("  skirt ,cape", 100).value(), (Names{"skirt", "cape"}));
}

TEST(Lists, names_that_are_none_are_sentences) {
  const auto fault = [](const char* line) {
    const auto read = names_in(line, 2);
    return read ? std::string() : read.error();
  };
  EXPECT_EQ(fault("a,,b"), "a name between the commas is empty");
  EXPECT_EQ(fault("a,"), "after the last comma there is no name");
  EXPECT_EQ(fault("\"a"), "the quote \"a does not end");
  EXPECT_EQ(fault("\"a\" b"), "between \"a\" and \"b\" there is no comma");
  EXPECT_EQ(fault("a, b, c"), "more than 2 names");
}

}  // namespace
}  // namespace weft::view
