// Writes and reads parts. JSON has no number that is not finite: one is written as an object with the key "float".
#include "samples/weft/rows_file.h"

#include <cmath>
#include <fstream>
#include <iterator>

#include "samples/weft/files.h"

namespace weft::command {

namespace {

constexpr int kFormat = 1, kDeepest = 16;
constexpr std::uintmax_t kMostBytes = 1u << 28;
constexpr std::uint32_t kMostItems = 10'000'000;
constexpr std::string_view kEnd = "{\"fingerprint\":\"";

void pack(Row& value) {
  if (value.is_structured())
    for (Row& part : value) pack(part);
  if (!value.is_number_float() || std::isfinite(value.get<double>())) return;
  const double number = value;
  value = {{"float", std::isnan(number) ? "nan" : number > 0 ? "inf" : "-inf"}};
}

void unpack(Row& value) {
  if (value.is_object() && value.size() == 1 && value.begin().key() == "float") {
    const Row word = value.begin().value();
    value = word == "nan" ? std::nan("") : word == "-inf" ? -INFINITY : INFINITY;
  } else if (value.is_structured()) {
    for (Row& part : value) unpack(part);
  }
}

// A line; discarded where it is none, or deeper than any that is written.
Row parse_line(std::string_view line) {
  bool deep = false;
  Row value = Row::parse(line, [&](int depth, Row::parse_event_t, Row&) { return !(deep |= depth > kDeepest); }, false);
  if (deep) return Row(Row::value_t::discarded);
  unpack(value);
  return value;
}

std::string text_line(Row value) {
  pack(value);
  return value.dump(-1, ' ', false, Row::error_handler_t::replace) + '\n';
}

std::string end_line(std::string_view before) { return std::string(kEnd) + Fingerprint().add(before).text() + "\"}\n"; }

std::string_view next_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end + 1);
  return line;
}

bool is_number(const Row& head, const char* key, std::uint32_t least, std::uint32_t most) {
  return head.contains(key) && head[key].is_number_unsigned() && head[key] >= least && head[key] <= most;
}
bool is_text(const Row& head, const char* key) { return head.contains(key) && head[key].is_string(); }
bool is_object(const Row& head, const char* key) { return head.contains(key) && head[key].is_object(); }

bool is_head(const Row& head) {
  return head.is_object() && is_text(head, "command") && is_text(head, "key") && is_text(head, "of") && is_object(head, "facts") &&
         is_object(head, "place") && is_number(head, "items", 0, kMostItems) && is_number(head, "parts", 1, kMostParts) &&
         is_number(head, "part", 1, head["parts"].get<std::uint32_t>());
}

// The program's own bytes: rows of two builds are no table.
const std::string& program() {
  static const std::string print = [] {
    std::ifstream stream("/proc/self/exe", std::ios::binary);
    return Fingerprint().add(std::string{std::istreambuf_iterator<char>(stream), {}}).text();
  }();
  return print;
}

}  // namespace

std::string key_of(const Work& work) {
  Row facts = work.facts;
  pack(facts);
  return Fingerprint().add(work.command).add("\n").add(facts.dump()).add("\n").add(work.of).add(std::to_string(work.items)).add(program())
      .text();
}

std::string text_of(const Part& part) {
  const Work& work = part.content.work;
  std::string text = text_line({{"weft_rows", kFormat}, {"command", work.command}, {"key", part.key}, {"part", part.shard.part},
                                {"parts", part.shard.parts}, {"items", work.items}, {"of", work.of}, {"facts", work.facts},
                                {"place", work.place}});
  for (const auto& [item, row] : part.content.rows) text += text_line({{"item", item}, {"row", row}});
  return text + end_line(text);
}

Result<Part> parse_part(std::string_view text) {
  if (text.substr(0, text.find('\n')).find("\"weft_rows\":") == text.npos) return fail("holds no rows of weft");
  const std::size_t end = text.rfind(kEnd);
  if (end == text.npos || text.substr(end) != end_line(text.substr(0, end)))
    return fail("is damaged: its fingerprint is not that of its rows");
  text = text.substr(0, end);
  const Row head = parse_line(next_line(text));
  if (!head.is_object() || head.value("weft_rows", Row()) != kFormat) return fail("is of another version of weft");
  if (!is_head(head)) return fail("is damaged: its first line does not say what it holds");
  Part part{{head["part"], head["parts"]}, head["key"], {{head["command"], head["facts"], head["place"], head["of"], head["items"]}, {}}};
  while (!text.empty()) {
    const Row line = parse_line(next_line(text));
    const bool good = line.is_object() && is_object(line, "row") && is_number(line, "item", 0, kMostItems);
    const std::uint32_t item = good ? line["item"].get<std::uint32_t>() : 0;
    if (!good || item >= part.content.work.items || item % part.shard.parts != part.shard.part - 1 ||
        !part.content.rows.emplace(item, line["row"]).second)
      return fail("is damaged: a line is no row of part ", part.shard.part, " of ", part.shard.parts);
  }
  return part;
}

Result<Part> load_part(const std::filesystem::path& file) {
  std::error_code problem;
  const std::uintmax_t bytes = std::filesystem::file_size(file, problem);
  if (problem) return fail(file.string(), ": cannot be read: ", problem.message());
  if (bytes > kMostBytes) return fail(file.string(), " has ", bytes, " bytes, more than the ", kMostBytes, " that rows may have");
  std::ifstream stream(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) return fail(file.string(), ": cannot be read");
  auto part = parse_part(text);
  if (!part) return fail(file.string(), " ", part.why());
  return part;
}

}  // namespace weft::command
