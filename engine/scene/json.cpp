// JSON text to values, in three steps: how deep it nests (so that brackets cannot exhaust anything), whether it is well
// formed and names no key twice (with line and column when it is not), and only then the values.
#include "engine/scene/json.h"

#include <algorithm>
#include <set>

#include "engine/scene/faults.h"

namespace weft {

namespace {

using nlohmann::json;

std::string place(std::string_view text, std::size_t at) {
  at = std::min(at, text.size());
  const std::string_view before = text.substr(0, at);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t newline = before.rfind('\n');
  const std::size_t column = newline == std::string_view::npos ? at + 1 : at - newline;
  return "line " + std::to_string(line) + ", column " + std::to_string(column) + ": ";
}

// Brackets inside strings do not nest. Malformed text is not this function's business: the parser finds it.
Result<void> check_depth(std::string_view text) {
  std::size_t depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\')
        ++i;
      else if (c == '"')
        in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kDeepestNesting)
        return fail(place(text, i), "lists and objects nest deeper than ", kDeepestNesting, " levels, the most a scene may have");
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    }
  }
  return {};
}

// Listens to the parser, keeps the first complaint, and watches for a key that stands twice in one object, which JSON
// libraries let pass by forgetting the first.
class Listener final : public nlohmann::json_sax<json> {
 public:
  explicit Listener(std::string_view text) : text_(text) {}
  std::string complaint;

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_array(std::size_t) override { return true; }
  bool end_array() override { return true; }
  bool start_object(std::size_t) override {
    keys_.emplace_back();
    return true;
  }
  bool end_object() override {
    keys_.pop_back();
    return true;
  }
  bool key(string_t& name) override {
    if (keys_.back().insert(name).second) return true;
    complaint = "the key \"" + printable(name) + "\" stands twice in one object";
    return false;
  }
  bool parse_error(std::size_t position, const std::string& token, const json::exception& error) override {
    constexpr int kNumberOverflow = 406;
    // The parser counts from 1 and points behind the token that it could not use.
    const std::size_t at = position > 0 ? position - 1 : 0;
    complaint = place(text_, at);
    if (error.id == kNumberOverflow) {
      complaint = place(text_, position >= token.size() ? position - token.size() : 0) + "the number " + printable(ascii(token)) +
                  " is beyond what a double holds (1.8e308)";
    } else if (at >= text_.size()) {
      complaint += "the text ends too early: is the file cut short?";
    } else {
      complaint += "this is not JSON: " + reason(error.what());
    }
    return false;
  }

 private:
  static std::string ascii(std::string_view text) {
    std::string plain(text);
    for (char& c : plain)
      if (static_cast<unsigned char>(c) >= 0x80) c = '?';
    return plain;
  }

  static std::string reason(std::string_view what) {
    constexpr std::string_view kStart = "syntax error ";
    if (const std::size_t start = what.find(kStart); start != std::string_view::npos) what.remove_prefix(start + kStart.size());
    return printable(ascii(what), 200);
  }

  std::string_view text_;
  std::vector<std::set<std::string>> keys_;
};

}  // namespace

Result<JsonTree> parse_json(std::string_view text) {
  if (text.size() > kLargestSceneBytes)
    return fail("scene: ", text.size(), " bytes are more than ", kLargestSceneBytes, ", the most a scene may have");
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) return fail("scene: is empty");
  if (Result<void> depth = check_depth(text); !depth) return depth.take_error();
  Listener listener(text);
  if (!json::sax_parse(text, &listener)) {
    if (listener.complaint.empty()) listener.complaint = "scene: is not JSON";
    return Error{listener.complaint};
  }
  JsonTree value = parsed_json(text);
  if (value.root.is_discarded()) return fail("scene: is not JSON");
  return value;
}

std::string_view kind_of(const json& value) {
  switch (value.type()) {
    case json::value_t::null: return "null";
    case json::value_t::object: return "an object";
    case json::value_t::array: return "a list";
    case json::value_t::string: return "text";
    case json::value_t::boolean: return "a truth value";
    default: return "a number";
  }
}

std::string shown(const json& value) {
  if (value.is_object() || value.is_array()) return std::string(kind_of(value)) + " of " + std::to_string(value.size());
  if (const auto* text = value.get_ptr<const std::string*>()) return '"' + printable(*text) + '"';
  return value.dump();
}

}  // namespace weft
