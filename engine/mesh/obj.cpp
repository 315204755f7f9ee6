// OBJ, stripped to its geometry before assimp sees it, for the same reasons as glTF: a damaged line is named here by its
// number, indices are checked and made absolute, and materials, groups, curves, lines and points stay outside.
#include <array>
#include <charconv>
#include <optional>

#include "engine/mesh/parts.h"

namespace weft::parts {
namespace {

/// Cuts the next word off a line; empty at its end.
std::string_view next_word(std::string_view& line) {
  const std::size_t begin = line.find_first_not_of(" \t\r\v\f");
  if (begin == std::string_view::npos) return line = {};
  const std::size_t end = std::min(line.find_first_of(" \t\r\v\f", begin), line.size());
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

template <class Number>
bool reads_as(std::string_view word, Number& number) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), number);
  return code == std::errc() && end == word.data() + word.size();
}

enum Kind : std::size_t { position, uv, normal };
constexpr std::array<const char*, 3> kKeyword{"v", "vt", "vn"};
constexpr std::array<int, 3> kNeeded{3, 1, 3}, kKept{3, 2, 3};

/// Goes through the lines once; the first fault ends it.
class ObjStripper {
 public:
  Result<ObjGeometry> strip(std::string_view text) {
    while (!text.empty() && fault_.empty()) {
      ++line_number_;
      const std::size_t end = std::min(text.find('\n'), text.size());
      std::string joined;   // a backslash at the end continues a line
      std::string_view line = text.substr(0, end);
      text.remove_prefix(std::min(end + 1, text.size()));
      while (line.ends_with('\\') || line.ends_with("\\\r")) {
        joined.assign(line.substr(0, line.rfind('\\'))).append(" ");
        const std::size_t more = std::min(text.find('\n'), text.size());
        joined.append(text.substr(0, more));
        text.remove_prefix(std::min(more + 1, text.size()));
        ++line_number_;
        if (more == 0) break;
        line = joined;
      }
      take(joined.empty() ? line : std::string_view(joined));
    }
    for (const Kind kind : {position, uv, normal})
      if (fault_.empty() && highest_[kind] > count_[kind])
        fault_ =
            fail("line ", highest_line_[kind], " refers to ", kKeyword[kind], " number ", highest_[kind], " of ", count_[kind]).message;
    if (!fault_.empty()) return Error{fault_};
    if (face_count_ == 0) return fail("it has no triangle; perhaps it is not an OBJ file");
    return std::move(out_);
  }

 private:
  template <class... Parts>
  void say(const Parts&... parts) {
    if (fault_.empty()) fault_ = fail("line ", line_number_, ": ", parts...).message;
  }

  void take(std::string_view line) {
    line = line.substr(0, std::min(line.find('#'), line.size()));
    const std::string_view keyword = next_word(line);
    for (const Kind kind : {position, uv, normal})
      if (keyword == kKeyword[kind]) return take_numbers(kind, line);
    if (keyword == "f") return take_face(line);
    if (keyword != "l" && keyword != "p") return;
    std::size_t corners = 0;
    while (!next_word(line).empty()) ++corners;
    if (keyword == "p")
      out_.points += corners;
    else if (corners > 1)
      out_.lines += corners - 1;
  }

  void take_numbers(Kind kind, std::string_view line) {
    if (++count_[kind] > kMostNumbers) return say("more than ", kMostNumbers, " entries of ", kKeyword[kind]);
    out_.text += kKeyword[kind];
    for (int k = 0; k < kKept[kind]; ++k) {
      const std::string_view word = next_word(line);
      double number = 0;
      if (word.empty() && k < kNeeded[kind]) return say(kKeyword[kind], " has ", k, " numbers; ", kNeeded[kind], " are needed");
      if (!word.empty() && !reads_as(word, number)) return say("\"", word.substr(0, 40), "\" is not a number");
      out_.text.append(" ").append(word.empty() ? "0" : word);
    }
    out_.text += '\n';
  }

  void take_face(std::string_view line) {
    std::string face = "f";
    std::size_t corners = 0;
    for (std::string_view corner = next_word(line); !corner.empty(); corner = next_word(line), ++corners) {
      face += ' ';
      std::string_view rest = corner;
      for (const Kind kind : {position, uv, normal}) {
        const std::size_t slash = std::min(rest.find('/'), rest.size());
        const std::string_view word = rest.substr(0, slash);
        rest.remove_prefix(slash);
        if (kind != uv && word.empty()) return say("\"", corner.substr(0, 40), "\" is not the corner of a face");
        if (!word.empty() && !append_index(kind, word, face)) return;
        if (rest.empty() || kind == normal) break;
        rest.remove_prefix(1);
        if (rest.empty()) break;   // "3/" is written by some programs for "3"
        face += '/';
      }
      if (!rest.empty()) return say("\"", corner.substr(0, 40), "\" is not the corner of a face");
    }
    if (corners < 3) return say("a face has ", corners, " corners; 3 are needed");
    corner_total_ += corners;
    if (corner_total_ > std::uint64_t{6} * kMostVertices) return say("more than ", 6 * kMostVertices, " corners of faces");
    ++face_count_;
    out_.text.append(face).append("\n");
  }

  bool append_index(Kind kind, std::string_view word, std::string& face) {
    std::int64_t index = 0;
    const bool reads = reads_as(word, index);
    const auto count = static_cast<std::int64_t>(count_[kind]);
    const std::int64_t absolute = index < 0 ? count + index + 1 : index;   // -1 is the latest so far
    if (!reads || absolute < 1) {
      say("\"", word.substr(0, 40), "\" is not the index of a ", kKeyword[kind], "; there are ", count, " so far");
      return false;
    }
    if (static_cast<std::uint64_t>(absolute) > highest_[kind]) {
      highest_[kind] = static_cast<std::uint64_t>(absolute);
      highest_line_[kind] = line_number_;
    }
    face += std::to_string(absolute);
    return true;
  }

  static constexpr std::uint64_t kMostNumbers = std::uint64_t{3} * kMostVertices;   // vt and vn may be one a corner
  ObjGeometry out_;
  std::string fault_;
  std::size_t line_number_ = 0, face_count_ = 0;
  std::uint64_t corner_total_ = 0;
  std::array<std::uint64_t, 3> count_{}, highest_{};
  std::array<std::size_t, 3> highest_line_{};
};

}   // namespace

Result<ObjGeometry> obj_geometry(std::string_view content) { return ObjStripper().strip(content); }

}   // namespace weft::parts
