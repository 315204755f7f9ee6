// Floats as text that is read back as the same bits. Internal.
//
// Nine significant digits tell any two floats apart: these are 6e-8 of their size apart at least, and nine digits round by 5e-9. Most
// coordinates get as many by a multiplication in double precision and integers; for the rest std::to_chars looks for the shortest text,
// which takes three times as long. tests/mesh/number_text_test.cpp goes through the floats.
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

namespace weft::parts {

inline constexpr std::size_t kNumberLength = 15;   // at most: -1.17549435e-38

/// Writes it to a place of kNumberLength; returns its end, behind which anything may stand in that place.
inline char* put_number(float value, char* to) {
  // Nine decimals are nine digits or more, or as good as these: the error of 5e-10 is below 3e-8 of the size. Of the small ones twelve are.
  constexpr double kSmallest = 2e-5, kSmall = 0.02, kLargest = 1000;
  constexpr std::uint64_t kNine = 1'000'000'000;
  static constexpr auto pairs = [] {
    std::array<char, 200> text{};
    for (std::size_t k = 0; k < 100; ++k) text[2 * k] = static_cast<char>('0' + k / 10), text[2 * k + 1] = static_cast<char>('0' + k % 10);
    return text;
  }();
  const double size = std::abs(static_cast<double>(value));
  if (!(size >= kSmallest && size < kLargest)) return std::to_chars(to, to + kNumberLength, value).ptr;
  if (value < 0) *to++ = '-';
  const bool is_small = size < kSmall;
  const auto scaled = static_cast<std::uint64_t>(size * (is_small ? 1000 * static_cast<double>(kNine) : static_cast<double>(kNine)) + 0.5);
  const auto whole = static_cast<std::uint32_t>(scaled / kNine);
  auto rest = static_cast<std::uint32_t>(scaled % kNine);
  if (is_small) {
    for (const char c : {'0', '.'}) *to++ = c;
  }
  if (is_small || whole >= 100) *to++ = static_cast<char>('0' + whole / 100);
  if (is_small || whole >= 10) *to++ = static_cast<char>('0' + whole / 10 % 10);
  *to++ = static_cast<char>('0' + whole % 10);
  if (rest == 0 && !is_small) return to;
  if (!is_small) *to++ = '.';
  *to = static_cast<char>('0' + rest / 100'000'000);
  rest %= 100'000'000;
  for (int k = 3; k >= 0; --k, rest /= 100) std::memcpy(to + 1 + 2 * k, pairs.data() + 2 * (rest % 100), 2);
  to += 9;
  while (to[-1] == '0') --to;
  return to;
}

inline void add_number(std::string& text, float value) {
  char number[kNumberLength];
  text.append(number, put_number(value, number));
}

}  // namespace weft::parts
