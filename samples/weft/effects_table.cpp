#include "samples/weft/effects_table.h"

#include <algorithm>
#include <cstdio>

#include "samples/weft/effect_rows.h"

namespace weft::command {

namespace {

template <class... Values>
std::string formatted(const char* format, const Values&... values) {
  char line[512];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

std::string name_of(const EffectPrice& price) {
  if (price.first.empty()) return "the barest cloth";
  return price.second.empty() ? price.first : price.first + " + " + price.second;
}

double kibibytes(const EffectPrice& price) { return static_cast<double>(price.with.bytes) / 1024; }

const char* what_of(const std::string& name) {
  for (const EffectRow& row : effect_rows())
    if (row.name == name) return row.what;
  return "a free sheet of links and a patch above it, method jacobi";
}

}  // namespace

std::string heading() {
  return formatted("%-30s %7s %11s %10s %13s %11s %9s %9s\n", "", "passes", "dispatches", "KiB", "instructions", "without ms", "with ms",
                   "added ms");
}

std::string line_of(const EffectPrice& price) {
  if (!price.refused.empty()) return formatted("%-30s there is none: ", name_of(price).c_str()) + price.refused + "\n";
  return formatted("%-30s %7zu %11.4g %10.0f %13llu %11.3f %9.3f %9.3f\n", name_of(price).c_str(), price.with.passes, price.dispatches,
                   kibibytes(price), static_cast<unsigned long long>(price.with.instructions), price.without_ms.median,
                   price.with_ms.median, price.with_ms.median - price.without_ms.median);
}

std::string csv(const std::vector<EffectPrice>& prices) {
  std::string text = "first,second,passes,dispatches,bytes,instructions,ms_without,ms_with,refused\n";
  for (const EffectPrice& price : prices) {
    if (!price.refused.empty()) {
      std::string sentence = price.refused;   // quoted, quotes doubled, a line
      for (std::size_t at = 0; (at = sentence.find('"', at)) != std::string::npos; at += 2) sentence.insert(at, 1, '"');
      std::replace(sentence.begin(), sentence.end(), '\n', ' ');
      text += price.first + "," + price.second + ",,,,,,,\"" + sentence + "\"\n";
      continue;
    }
    text += formatted("%s,%s,%zu,%g,%llu,%llu,%g,%g,\n", price.first.c_str(), price.second.c_str(), price.with.passes, price.dispatches,
                      static_cast<unsigned long long>(price.with.bytes), static_cast<unsigned long long>(price.with.instructions),
                      price.without_ms.median, price.with_ms.median);
  }
  return text;
}

std::string markdown(const std::vector<EffectPrice>& prices) {
  std::string alone = "| effect | | passes | dispatches | KiB | instructions | ms without | ms with |\n|---|---|---|---|---|---|---|---|\n";
  std::string pairs = "| pair | passes | dispatches | KiB | instructions | ms without | ms with |\n|---|---|---|---|---|---|---|\n";
  std::string none;
  for (const EffectPrice& price : prices) {
    const std::string figures =
        formatted("%zu | %.4g | %.0f | %llu | %.2f | %.2f |\n", price.with.passes, price.dispatches, kibibytes(price),
                  static_cast<unsigned long long>(price.with.instructions), price.without_ms.median, price.with_ms.median);
    if (!price.refused.empty()) none += "- " + name_of(price) + ": " + price.refused + "\n";
    else if (price.second.empty()) alone += "| " + name_of(price) + " | " + what_of(price.first) + " | " + figures;
    else pairs += "| " + name_of(price) + " | " + figures;
  }
  return alone + "\nPairs:\n\n" + pairs + "\nThere is no scene with both of:\n\n" + none;
}

}  // namespace weft::command
