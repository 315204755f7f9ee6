// OBJ: v, vt, vn and f. Materials, groups and curves stay outside; no other file is read. A damaged line is named by its number.
//
// Read here and not by assimp, which gives every corner of every face a vertex of its own: the numbers of the file's v lines, which
// anchors count, would be lost.
#include <array>
#include <bit>
#include <charconv>
#include <limits>
#include <map>

#include "engine/mesh/parts.h"

namespace weft::parts {
namespace {

/// Cuts the next line off a text.
std::string_view next_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

/// Takes off the backslash with which a line says that it goes on; false without one.
bool goes_on(std::string_view& line) {
  const std::size_t length = line.ends_with('\\') ? 1 : line.ends_with("\\\r") ? 2 : 0;
  line.remove_suffix(length);
  return length > 0;
}

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
class ObjReader {
 public:
  Result<Harvest> read(std::string_view text) {
    while (!text.empty() && fault_.empty()) {
      std::string_view line = next_line(text);
      ++line_number_;
      std::string joined;
      if (goes_on(line)) {
        joined = line;
        for (bool more = true; more && !text.empty(); ++line_number_) {
          line = next_line(text);
          more = goes_on(line);
          joined.append(" ").append(line);
        }
        line = joined;
      }
      take(line);
    }
    for (const Kind kind : {position, uv, normal})
      if (highest_[kind] > values_[kind].size())
        say_at(highest_line_[kind], " refers to ", kKeyword[kind], " number ", highest_[kind], " of ", values_[kind].size());
    if (fault_.empty() && faces_.empty()) return fail("it has no triangle; perhaps it is not an OBJ file");
    if (fault_.empty()) make_vertices();
    if (!fault_.empty()) return Error{fault_};
    make_triangles();
    return std::move(out_);
  }

 private:
  using Corner = std::array<std::uint32_t, 3>;   // by kind, counted from 1; 0 is none
  using Look = std::array<std::uint32_t, 6>;     // v, and the bits of its texture coordinate and normal: the same numbers look the same

  static Look look_of(std::uint32_t v, Vec2 at, Vec3 out) {
    const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
    return {v, bits(at.x), bits(at.y), bits(out.x), bits(out.y), bits(out.z)};
  }
  static Vec2 uv_of(Vec3 vt) { return {vt.x, 1 - vt.y}; }   // an OBJ's points up

  template <class... Parts>
  void say_at(std::size_t line, const Parts&... parts) {
    if (fault_.empty()) fault_ = fail("line ", line, parts...).message;
  }
  template <class... Parts>
  void say(const Parts&... parts) {
    say_at(line_number_, ": ", parts...);
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
    const std::size_t most = kind == position ? kMostVertices : kMostCornersOfAll;
    if (values_[kind].size() == most) return say("more than ", most, " entries of ", kKeyword[kind]);
    std::array<float, 3> numbers{};
    for (int k = 0; k < kKept[kind]; ++k) {
      const std::string_view word = next_word(line);
      double number = 0;
      if (word.empty() && k < kNeeded[kind]) return say(kKeyword[kind], " has ", k, " numbers; ", kNeeded[kind], " are needed");
      if (!word.empty() && !reads_as(word, number)) return say("\"", word.substr(0, 40), "\" is not a number");
      numbers[static_cast<std::size_t>(k)] = static_cast<float>(number);
    }
    values_[kind].push_back({numbers[0], numbers[1], numbers[2]});
  }

  void take_face(std::string_view line) {
    std::size_t count = 0;
    for (std::string_view word = next_word(line); !word.empty(); word = next_word(line))
      if (++count <= kMostCorners && !take_corner(word)) return;
    if (count < 3) return say("a face has ", count, " corners; 3 are needed");
    if (count > kMostCorners) return say("a face has ", count, " corners; at most ", kMostCorners, " can be read");
    if (corners_.size() > kMostCornersOfAll) return say("more than ", kMostCornersOfAll, " corners of faces");
    faces_.push_back(static_cast<std::uint32_t>(count));
  }

  bool take_corner(std::string_view word) {
    Corner& corner = corners_.emplace_back();
    std::string_view rest = word;
    for (const Kind kind : {position, uv, normal}) {
      const std::size_t slash = std::min(rest.find('/'), rest.size());
      const std::string_view index = rest.substr(0, slash);
      rest.remove_prefix(slash);
      if (kind != uv && index.empty()) break;
      if (!index.empty() && !take_index(kind, index, corner)) return false;
      if (rest.empty()) return true;
      if (kind == normal) break;
      rest.remove_prefix(1);
      if (rest.empty()) return true;   // "3/" is written by some programs for "3"
    }
    say("\"", word.substr(0, 40), "\" is not the corner of a face");
    return false;
  }

  bool take_index(Kind kind, std::string_view word, Corner& corner) {
    std::int64_t index = 0;
    const bool reads = reads_as(word, index);
    const auto count = static_cast<std::int64_t>(values_[kind].size());
    const std::int64_t absolute = index < 0 ? count + index + 1 : index;   // -1 is the latest so far
    if (!reads || absolute < 1 || absolute > kNone) {
      say("\"", word.substr(0, 40), "\" is not the index of a ", kKeyword[kind], "; there are ", count, " so far");
      return false;
    }
    corner[kind] = static_cast<std::uint32_t>(absolute);
    if (corner[kind] > highest_[kind]) {
      highest_[kind] = corner[kind];
      highest_line_[kind] = line_number_;
    }
    return true;
  }

  /// A vertex for each v, which looks as its first corner does, and a copy of it for each other look; corners_[.][position] becomes
  /// the vertex, counted from 0.
  void make_vertices() {
    RenderMesh& render = out_.render;
    const std::size_t own = out_.source_vertices = values_[position].size();
    const float missing = std::numeric_limits<float>::quiet_NaN();
    render.positions = std::move(values_[position]);
    render.normals.resize(own);
    render.uvs.assign(own, Vec2{missing, missing});
    std::vector<std::uint8_t> seen(own, 0);
    std::map<Look, std::uint32_t> copies;
    for (Corner& corner : corners_) {
      std::uint32_t& vertex = corner[position];
      const std::uint32_t v = --vertex;
      const Vec2 at = corner[uv] ? uv_of(values_[uv][corner[uv] - 1]) : Vec2{missing, missing};
      const Vec3 out = corner[normal] ? values_[normal][corner[normal] - 1] : Vec3{};
      if (seen[v]) {
        if (look_of(v, at, out) == look_of(v, render.uvs[v], render.normals[v])) continue;
        const auto [copy, added] = copies.try_emplace(look_of(v, at, out), static_cast<std::uint32_t>(render.positions.size()));
        vertex = copy->second;
        if (!added) continue;
        if (vertex == kMostVertices) return say("more than ", kMostVertices, " vertices with different normals or texture coordinates");
        render.positions.push_back(Vec3(render.positions[v]));
        render.normals.emplace_back();
        render.uvs.emplace_back();
      }
      seen[v] = 1;
      render.normals[vertex] = out;
      render.uvs[vertex] = at;
      out_.bad_normals += corner[normal] && (!finite(out) || out == Vec3{});
      out_.bad_uvs += corner[uv] && !finite(at);
    }
    render.tangents.resize(render.positions.size());
  }

  void make_triangles() {
    std::size_t first = 0;
    std::vector<Vec3> face;
    for (const std::uint32_t count : faces_) {
      const std::span<const Corner> corners = std::span(corners_).subspan(first, count);
      first += count;
      face.clear();
      for (const Corner& corner : corners) face.push_back(out_.render.positions[corner[position]]);
      const std::size_t cut = out_.render.triangles.size();
      out_.crossed_faces += !cut_face(face, out_.render.triangles);
      for (Triangle& triangle : std::span(out_.render.triangles).subspan(cut))
        for (std::uint32_t& v : triangle) v = corners[v][position];
    }
  }

  static constexpr std::size_t kMostCornersOfAll = std::size_t{6} * kMostVertices;   // a closed mesh has two triangles a vertex
  Harvest out_;
  std::string fault_;
  std::size_t line_number_ = 0;
  std::array<std::vector<Vec3>, 3> values_;   // by kind
  std::vector<Corner> corners_;
  std::vector<std::uint32_t> faces_;   // corners of each
  std::array<std::size_t, 3> highest_{}, highest_line_{};
};

}   // namespace

Result<Harvest> read_obj(std::string_view content) { return ObjReader().read(content); }

}   // namespace weft::parts
