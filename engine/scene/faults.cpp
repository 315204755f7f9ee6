// Sentences about what is wrong, and the nearest name to a misspelt one.
#include "engine/scene/faults.h"

#include <algorithm>
#include <numeric>

namespace weft {

void Faults::add(std::string_view path, std::string_view what) {
  ++count_;
  if (lines_.size() >= kShown) return;
  std::string line(path.empty() ? "scene" : path);
  line += ": ";
  line += what;
  lines_.push_back(std::move(line));
}

std::string Faults::text() const {
  std::string all;
  for (const std::string& line : lines_) {
    if (!all.empty()) all += '\n';
    all += line;
  }
  if (count_ > lines_.size()) all += "\nscene: has " + std::to_string(count_ - lines_.size()) + " more faults that are not shown";
  return all;
}

std::string printable(std::string_view text, std::size_t most) {
  std::size_t end = std::min(text.size(), most);
  // Cutting inside a UTF-8 sequence would leave bytes that no terminal can show: step back to its first byte.
  if (end < text.size())
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;
  std::string shown(text.substr(0, end));
  for (char& c : shown)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  if (end < text.size()) shown += "...";
  return shown;
}

namespace {

// Levenshtein's distance (1966), one row at a time.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string suggestion(std::string_view wrong, std::span<const std::string_view> names) {
  if (wrong.size() > 64) return "";  // longer than any name by far, and the distance costs its length
  std::string_view nearest;
  std::size_t least = std::max<std::size_t>(2, wrong.size() / 3) + 1;
  for (const std::string_view name : names) {
    const std::size_t distance = edit_distance(wrong, name);
    if (distance >= least || distance >= name.size()) continue;  // nothing in common is no likeness
    least = distance;
    nearest = name;
  }
  if (nearest.empty()) return "";
  return " (did you mean \"" + std::string(nearest) + "\"?)";
}

std::string either(std::span<const std::string_view> names) {
  std::string all;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) all += i + 1 == names.size() ? " or " : ", ";
    all += '"';
    all += names[i];
    all += '"';
  }
  return all;
}

}  // namespace weft
