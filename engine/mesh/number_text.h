// Floats as the shortest text that is read back as the same bits. Internal.
#pragma once

#include <charconv>
#include <cstddef>
#include <string>

namespace weft::parts {

inline constexpr std::size_t kNumberLength = 15;   // at most: -1.17549435e-38

/// Writes it to a place of kNumberLength; returns its end.
inline char* put_number(float value, char* to) { return std::to_chars(to, to + kNumberLength, value).ptr; }

inline void add_number(std::string& text, float value) {
  char number[kNumberLength];
  text.append(number, put_number(value, number));
}

}  // namespace weft::parts
