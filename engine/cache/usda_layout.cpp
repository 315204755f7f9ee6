// USD as text: one Mesh, whose points, normals and extent have a sample a frame.
//
// A sample has the same length in every frame: a number takes the room of the longest there is, and spaces fill it. So all samples of an
// attribute, which must stand together, have their places before the first is known.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "compute/text.h"
#include "engine/cache/halves.h"
#include "engine/cache/layout.h"
#include "engine/mesh/glb.h"
#include "engine/mesh/number_text.h"

namespace weft::caching {
namespace {

constexpr std::size_t kTuple = 3 * parts::kNumberLength + 5;   // "(x,y,z),"
constexpr std::size_t kCode = 10;                              // digits of a time code
constexpr std::string_view kClosing = "    }\n";

// [(x,y,z),(x,y,z)], spaces behind every tuple; the comma after the last becomes the bracket.
void add_list(std::string& text, std::span<const Vec3> list) {
  const std::size_t start = text.size() + 1;
  text.resize(start + list.size() * kTuple);
  text[start - 1] = '[';
  in_halves(list.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      char *place = text.data() + start + k * kTuple, *at = place;
      *at++ = '(';
      for (const float number : {list[k].x, list[k].y, list[k].z}) *(at = parts::put_number(number, at))++ = ',';
      at[-1] = ')';
      *at = k + 1 == list.size() ? ']' : ',';
      std::fill(at + 1, place + kTuple, ' ');   // numbers may leave digits behind their ends
    }
  });
  if (list.empty()) text.push_back(']');
}

std::array<Vec3, 2> extent_of(std::span<const Vec3> positions) {
  Vec3 low = positions.front(), high = low;
  for (const Vec3& p : positions) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return {low, high};
}

// What a prim may be called.
std::string identifier(std::string_view name) {
  std::string plain;
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  for (const char c : name) plain.push_back(is_digit(c) || is_letter(c) ? c : '_');
  if (plain.empty() || is_digit(plain[0])) plain.insert(0, "_");
  return plain;
}

std::string number_of(double value) { return rounded_text(value, 17); }

class Samples : public Layout {
 public:
  Samples(const RenderMesh& mesh, const CacheOptions& options) : frames_(options.frames), points_(mesh.positions.size()) {
    const auto declared = [](const char* type, const char* name, std::span<const Vec3> rest, const char* more) {
      std::string text = std::string("    ") + type + " " + name + " = ";
      add_list(text, rest);
      return text + more + "\n    " + type + " " + name + ".timeSamples = {\n";
    };
    std::string head = head_of(mesh, options);
    const std::array<Vec3, 2> extent = extent_of(mesh.positions);
    blocks_.push_back({head + declared("float3[]", "extent", extent, ""), extent.size()});
    blocks_.push_back({std::string(kClosing) + declared("point3f[]", "points", mesh.positions, ""), points_});
    if (!mesh.normals.empty())
      blocks_.push_back({std::string(kClosing) +
                             declared("normal3f[]", "normals", mesh.normals, " (\n        interpolation = \"vertex\"\n    )"),
                         points_});
    std::uint64_t offset = 0;
    for (Block& block : blocks_) {
      block.offset = offset;
      offset += block.before.size() + frames_ * sample_bytes(block);
    }
    end_ = offset;
  }

  std::uint64_t bytes() const override { return end_ + kEnd.size(); }

  Result<void> put_frameless(const Put& put) const override {
    for (const Block& block : blocks_)
      if (auto done = put(block.offset, bytes_of(block.before)); !done) return done;
    return put(end_, bytes_of(kEnd));
  }

  Result<void> put_frame(std::uint32_t frame, const CacheFrame& content, const Put& put) const override {
    const std::array<Vec3, 2> extent = extent_of(content.positions);
    const std::array<std::span<const Vec3>, 3> lists = {extent, content.positions, content.normals};
    std::string& text = text_;
    for (std::size_t k = 0; k < blocks_.size(); ++k) {
      text = std::to_string(frame + 1);
      text.insert(0, kCode - text.size(), ' ');
      text += ": ";
      add_list(text, lists[k]);
      text += ",\n";
      const Block& block = blocks_[k];
      if (auto done = put(block.offset + block.before.size() + frame * sample_bytes(block), bytes_of(text)); !done) return done;
    }
    return {};
  }

 private:
  struct Block {   // an attribute with its samples
    std::string before;
    std::size_t entries;
    std::uint64_t offset = 0;
  };
  static constexpr std::string_view kEnd = "    }\n}\n";

  static std::uint64_t sample_bytes(const Block& block) { return kCode + 2 + 1 + block.entries * kTuple + 2; }

  static std::string head_of(const RenderMesh& mesh, const CacheOptions& options) {
    const std::string name = identifier(options.name), rate = number_of(options.rate);
    std::string text = "#usda 1.0\n(\n    defaultPrim = \"" + name + "\"\n    doc = \"Weft\"\n    endTimeCode = " +
                       std::to_string(options.frames) + "\n    framesPerSecond = " + rate +
                       "\n    metersPerUnit = 1\n    startTimeCode = 1\n    timeCodesPerSecond = " + rate +
                       "\n    upAxis = \"Y\"\n)\n\ndef Mesh \"" + name +
                       "\"\n{\n    uniform bool doubleSided = 1\n    uniform token orientation = \"rightHanded\"\n"
                       "    uniform token subdivisionScheme = \"none\"\n    int[] faceVertexCounts = [";
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) text += t == 0 ? "3" : ",3";
    text += "]\n    int[] faceVertexIndices = [";
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (const std::uint32_t v : mesh.triangles[t]) text += std::to_string(v) + ',';
    text.back() = ']';
    text += '\n';
    if (mesh.uvs.empty()) return text;
    text += "    texCoord2f[] primvars:st = [";
    for (const Vec2& uv : mesh.uvs) {
      parts::add_number(text += '(', uv.x);
      parts::add_number(text += ',', 1 - uv.y);   // USD's points up
      text += "),";
    }
    text.back() = ']';
    return text + " (\n        interpolation = \"vertex\"\n    )\n";
  }

  std::uint64_t frames_, points_, end_ = 0;
  std::vector<Block> blocks_;
  mutable std::string text_;   // of a sample: its room is kept for the next one
};

}  // namespace

LayoutResult usda_layout(const std::filesystem::path& file, const RenderMesh& mesh, const CacheOptions& options) {
  if (mesh.triangles.empty()) return fail(file.string(), " is not written: a mesh without a triangle has nothing to draw");
  return std::unique_ptr<Layout>(new Samples(mesh, options));
}

}  // namespace weft::caching
