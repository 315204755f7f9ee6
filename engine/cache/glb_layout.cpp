// A GLB whose mesh has a morph target a frame: at the time of frame k the weight of target k is 1 and all others are 0; in between two
// weights blend. At the time 0 all are 0, and the mesh is at rest.
//
//     "glTF"  text  mesh at rest  times  weights, a row a time  differences of frame 1, of frame 2 ...
//
// The text comes first and has each target's bounds: room is left for them, and spaces fill what they do not need.
#include <algorithm>
#include <cassert>
#include <charconv>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "engine/cache/layout.h"
#include "engine/mesh/glb.h"

namespace weft::caching {
namespace {

constexpr std::uint64_t kMostTargets = 32767;   // their table of weights takes 4 GiB
constexpr std::size_t kBoundedRecord = 272, kRecord = 120;   // bytes of an accessor's text, at most

template <class Number>
void add_json(std::string& text, Number number) {
  char digits[32];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, number).ptr);
}

class Morphs : public Layout {
 public:
  Morphs(const std::filesystem::path& file, const RenderMesh& mesh, const CacheOptions& options)
      : rest_(mesh.positions), normals_(mesh.normals), frames_(options.frames), rate_(options.rate), file_(file.string()),
        name_(options.name) {}

  // What must be known of the file's length comes first, so that no list is made of what is too long.
  Result<void> plan(glb::Scene scene) {
    static_rest_ = std::move(scene.binary);
    tables_ = 4 * (frames_ + 1) + 4 * frames_ * (frames_ + 1);
    const std::uint64_t least = static_rest_.size() + tables_ + frames_ * frame_bytes();
    if (frames_ > kMostTargets || least > glb::kMostBytes) return too_large(least);
    binary_ = least;

    const std::size_t times = scene.accessors.root.size(), view = scene.views.root.size();
    JsonTree input = object_of("bufferView", view, "componentType", glb::kFloat, "count", frames_ + 1, "type", "SCALAR", "min",
                               list_of(nlohmann::json(0)), "max", list_of(nlohmann::json(time_of(frames_))));
    JsonTree output = object_of("bufferView", view, "byteOffset", 4 * (frames_ + 1), "componentType", glb::kFloat, "count",
                                frames_ * (frames_ + 1), "type", "SCALAR");
    JsonTree tables = object_of("buffer", 0, "byteOffset", static_rest_.size(), "byteLength", tables_);
    JsonTree differences = object_of("buffer", 0, "byteOffset", static_rest_.size() + tables_, "byteLength", frames_ * frame_bytes(),
                                     "byteStride", sizeof(Vec3), "target", glb::kVertexTarget);
    for (JsonTree* accessor : {&input, &output}) scene.accessors.root.push_back(std::move(accessor->root));
    for (JsonTree* added : {&tables, &differences}) scene.views.root.push_back(std::move(added->root));
    view_ = view + 1;
    for (nlohmann::json& primitive : scene.primitives.root) {   // each has the same
      JsonTree targets(nlohmann::json::array());
      std::size_t accessor = times + 2;
      for (std::uint64_t k = 0; k < frames_; ++k) {
        JsonTree target = object_of("POSITION", accessor++);
        if (!normals_.empty()) put(target, "NORMAL", accessor++);
        targets.root.push_back(std::move(target.root));
      }
      primitive["targets"] = std::move(targets.root);
    }
    JsonTree sampler = object_of("input", times, "output", times + 1, "interpolation", "LINEAR");
    JsonTree channel = object_of("sampler", 0, "target", object_of("node", 0, "path", "weights"));
    JsonTree animation = object_of("channels", list_of(std::move(channel)), "samplers", list_of(std::move(sampler)));
    JsonTree document = glb::document_of(scene, binary_, name_);
    put(document, "animations", list_of(std::move(animation)));

    before_ = "{\"accessors\":" + scene.accessors.root.dump();
    before_.pop_back();   // ], which follows the frames' accessors
    after_ = "]," + document.root.dump().substr(1);
    const std::uint64_t length = before_.size() + frames_ * record_bytes() + after_.size();
    text_ = (length + 3) / 4 * 4;
    after_.append(text_ - length, ' ');
    return bytes() > glb::kMostBytes ? too_large(bytes()) : Result<void>{};
  }

  std::uint64_t bytes() const override { return binary_start() + binary_; }

  Result<void> put_frameless(const Put& put) const override {
    const auto at = [&](std::uint64_t offset, const std::string& text) { return put(offset, bytes_of(text)); };
    if (auto done = at(0, glb::head_of(text_, binary_) + before_); !done) return done;
    const std::uint64_t after = glb::kHeadBytes + before_.size() + frames_ * record_bytes();
    if (auto done = at(after, after_ + glb::binary_head_of(binary_) + static_rest_); !done) return done;
    std::vector<float> row;
    for (std::uint64_t k = 0; k <= frames_; ++k) row.push_back(time_of(k));
    std::uint64_t offset = binary_start() + static_rest_.size();
    for (std::uint64_t k = 0; k <= frames_; ++k) {
      if (auto done = put(offset, std::as_bytes(std::span(row))); !done) return done;
      offset += 4 * row.size();
      row.assign(frames_, 0);
      if (k > 0) row[k - 1] = 1;
    }
    return put(offset, std::as_bytes(std::span(row)));
  }

  Result<void> put_frame(std::uint32_t frame, const CacheFrame& content, const Put& put) const override {
    const std::uint64_t offset = frame * frame_bytes();
    std::vector<Vec3> differences;
    differences.reserve(rest_.size() + normals_.size());
    constexpr float large = std::numeric_limits<float>::infinity();
    Vec3 low{large, large, large}, high{-large, -large, -large};
    for (std::size_t v = 0; v < rest_.size(); ++v) {
      const Vec3 d = content.positions[v] - rest_[v];
      low = {std::min(low.x, d.x), std::min(low.y, d.y), std::min(low.z, d.z)};
      high = {std::max(high.x, d.x), std::max(high.y, d.y), std::max(high.z, d.z)};
      differences.push_back(d);
    }
    for (std::size_t v = 0; v < normals_.size(); ++v) differences.push_back(content.normals[v] - normals_[v]);

    std::string record = accessor_at(offset) + ",\"min\":[" + numbers(low) + "],\"max\":[" + numbers(high) + "]}";
    assert(record.size() <= kBoundedRecord);
    record.resize(kBoundedRecord, ' ');
    if (!normals_.empty()) record += accessor_at(offset + rest_.size() * sizeof(Vec3)) + "}";
    record.resize(record_bytes(), ' ');
    if (auto done = put(glb::kHeadBytes + before_.size() + frame * record_bytes(), bytes_of(record)); !done) return done;
    return put(binary_start() + static_rest_.size() + tables_ + offset, std::as_bytes(std::span(differences)));
  }

 private:
  std::uint64_t frame_bytes() const { return (rest_.size() + normals_.size()) * sizeof(Vec3); }
  std::uint64_t record_bytes() const { return normals_.empty() ? kBoundedRecord : kBoundedRecord + kRecord; }
  std::uint64_t binary_start() const { return glb::kHeadBytes + text_ + glb::kBinaryHeadBytes; }
  float time_of(std::uint64_t frame) const { return static_cast<float>(static_cast<double>(frame) / rate_); }

  std::string accessor_at(std::uint64_t offset) const {
    std::string text = ",{\"bufferView\":";
    add_json(text, view_);
    text += ",\"byteOffset\":";
    add_json(text, offset);
    text += ",\"componentType\":5126,\"type\":\"VEC3\",\"count\":";
    add_json(text, rest_.size());
    return text;
  }
  // As doubles: the text of a float would be read as another double.
  static std::string numbers(Vec3 p) {
    std::string text;
    add_json(text, static_cast<double>(p.x));
    for (const float next : {p.y, p.z}) add_json(text += ',', static_cast<double>(next));
    return text;
  }
  Error too_large(std::uint64_t needed) const {
    const bool many = frames_ > kMostTargets;
    return fail(file_, " is not written: ", frames_, " frames of ", rest_.size(), " vertices take ", many ? "more than " : "",
                many ? glb::kMostBytes : needed, " bytes, and a GLB has at most ", glb::kMostBytes,
                "; a .usda, a .pc2 or a .mdd has no such limit");
  }

  std::vector<Vec3> rest_, normals_;
  std::uint64_t frames_, tables_ = 0, binary_ = 0, text_ = 0;   // bytes of the times and weights, of all arrays, of the text
  double rate_;
  std::string file_, name_;
  std::string static_rest_, before_, after_;   // the arrays at rest; the text before the frames' accessors, and after them
  std::size_t view_ = 0;                       // of the differences
};

}  // namespace

LayoutResult glb_layout(const std::filesystem::path& file, const RenderMesh& mesh, const CacheOptions& options) {
  Result<glb::Scene> scene = glb::scene_of(file, mesh);
  if (!scene) return scene.take_error();
  auto layout = std::make_unique<Morphs>(file, mesh, options);
  if (Result<void> planned = layout->plan(std::move(*scene)); !planned) return planned.take_error();
  return std::unique_ptr<Layout>(std::move(layout));
}

}  // namespace weft::caching
