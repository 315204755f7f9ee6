#include "engine/mesh/outline.h"

#include "compute/result.h"

namespace weft::parts {
namespace {

constexpr int kDeepestNesting = 64;
constexpr std::size_t kMostValues = 4'000'000;

}  // namespace

std::string outline_fault(std::string_view text) {
  int depth = 0;
  std::size_t values = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == '\\') ++i;
      quoted = c != '"';
      continue;
    }
    quoted = c == '"';
    values += c == ',' || c == '[' || c == '{';
    depth += (c == '[' || c == '{') - (c == ']' || c == '}');
    if (depth > kDeepestNesting) return fail("its brackets nest deeper than ", kDeepestNesting, " levels").message;
    if (values > kMostValues) return fail("its JSON has more than ", kMostValues, " values").message;
  }
  return {};
}

}  // namespace weft::parts
