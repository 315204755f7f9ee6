// Lists as a line of text: how the panels show them and read them back.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "compute/result.h"
#include "engine/effects/ranges.h"

namespace weft::view {

/// "0, 12, 20-28": a run of three or more that follow one another is its two ends.
std::string in_a_line(std::span<const std::uint32_t> numbers);
/// Separated by commas or spaces. Errors: what is no number and no run, one outside the range, or more than `most`.
Result<std::vector<std::uint32_t>> numbers_in(std::string_view line, const scene_fields::Range& range, std::size_t most);

/// `skirt, cape`: in quotes where a name has a comma, a quote or a space at an end in it, and a quote within is two, as in CSV.
std::string in_a_line(std::span<const std::string> names);
/// Separated by commas. Errors: a name of nothing, a quote that does not end, or more than `most`.
Result<std::vector<std::string>> names_in(std::string_view line, std::size_t most);

}  // namespace weft::view
