// See samples/view/lists.h.
#include "samples/view/lists.h"

#include <algorithm>
#include <charconv>

#include "engine/scene/faults.h"
#include "engine/scene/limits.h"

namespace weft::view {
namespace {

constexpr std::string_view kSpaces = " \t";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kSpaces);
  return first == std::string_view::npos ? std::string_view() : text.substr(first, text.find_last_not_of(kSpaces) - first + 1);
}

Result<std::uint32_t> number_in(std::string_view text, const scene_fields::Range& range) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, std::chars_format::fixed);
  const bool is_digits = text.find_first_not_of("0123456789") == std::string_view::npos;
  if (error != std::errc() || end != text.data() + text.size() || !is_digits) return fail("\"", printable(text), "\" is no whole number");
  if (const std::string what = outside(number, range); !what.empty()) return fail(what);
  return static_cast<std::uint32_t>(number);
}

bool needs_quotes(std::string_view name) { return name.find_first_of(",\"") != std::string_view::npos || trimmed(name) != name; }

}  // namespace

std::string in_a_line(std::span<const std::uint32_t> numbers) {
  std::string line;
  for (std::size_t k = 0; k < numbers.size();) {
    std::size_t last = k;
    while (last + 1 < numbers.size() && numbers[last] + 1 == numbers[last + 1]) ++last;
    if (last < k + 2) last = k;
    if (!line.empty()) line += ", ";
    line += std::to_string(numbers[k]);
    if (last > k) line.append("-").append(std::to_string(numbers[last]));
    k = last + 1;
  }
  return line;
}

Result<std::vector<std::uint32_t>> numbers_in(std::string_view line, const scene_fields::Range& range, std::size_t most) {
  std::vector<std::uint32_t> numbers;
  constexpr std::string_view kBetween = ", \t";
  for (std::size_t at = line.find_first_not_of(kBetween); at != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(kBetween, at), line.size());
    const std::string_view entry = line.substr(at, end - at);
    const std::size_t dash = entry.find('-', 1);
    const auto first = number_in(entry.substr(0, dash), range);
    if (!first) return first.why();
    const auto last = dash == std::string_view::npos ? *first : number_in(entry.substr(dash + 1), range);
    if (!last) return last.why();
    if (*last < *first) return fail("the run ", *first, "-", *last, " goes backwards");
    if (numbers.size() + (*last - *first) >= most) return fail("more than ", most, " numbers");
    for (std::uint32_t k = *first;; ++k) {
      numbers.push_back(k);
      if (k == *last) break;
    }
    at = line.find_first_not_of(kBetween, end);
  }
  return numbers;
}

std::string in_a_line(std::span<const std::string> names) {
  std::string line;
  for (const std::string& name : names) {
    if (&name != names.data()) line += ", ";
    if (!needs_quotes(name)) {
      line += name;
      continue;
    }
    line += '"';
    for (const char c : name) line.append(c == '"' ? 2 : 1, c);
    line += '"';
  }
  return line;
}

Result<std::vector<std::string>> names_in(std::string_view line, std::size_t most) {
  std::vector<std::string> names;
  line = trimmed(line);
  while (!line.empty()) {
    std::string name;
    if (line.front() == '"') {
      std::size_t at = 1;
      for (; at < line.size(); ++at) {
        if (line[at] == '"' && !(at + 1 < line.size() && line[at + 1] == '"')) break;
        if (line[at] == '"') ++at;
        name += line[at];
      }
      if (at >= line.size()) return fail("the quote ", printable(line), " does not end");
      line = trimmed(line.substr(at + 1));
      if (!line.empty() && line.front() != ',')
        return fail("between \"", printable(name), "\" and \"", printable(line), "\" there is no comma");
    } else {
      const std::size_t comma = std::min(line.find(','), line.size());
      name = trimmed(line.substr(0, comma));
      line = line.substr(comma);
    }
    if (name.empty()) return fail("a name between the commas is empty");
    if (names.size() >= most) return fail("more than ", most, " names");
    names.push_back(std::move(name));
    if (line.empty()) break;
    line = trimmed(line.substr(1));
    if (line.empty()) return fail("after the last comma there is no name");
  }
  return names;
}

}  // namespace weft::view
