// glTF, stripped to its geometry before assimp sees it.
//
// assimp decodes accessors and primitives well, but it trusts lengths and references, follows materials, skins and animations that
// a cloth does not need, and recurses over nested JSON. So the document is read here, every range is checked, and only what
// passed is written into a new GLB in memory: a damaged file ends in a sentence, and external buffers and GLB chunks look alike.
#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>

#include "engine/mesh/parts.h"

namespace weft::parts {
namespace {

using json = nlohmann::json;

constexpr int kDeepestNesting = 64;                                        // brackets; glTF itself needs about ten
constexpr std::size_t kDeepestNodes = 256;                                 // a cloth's file has one or two levels
constexpr std::uint64_t kMostIndices = std::uint64_t{6} * kMostVertices;   // a closed triangle mesh has two triangles a vertex

std::uint32_t little_endian(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k) value |= std::uint32_t{static_cast<unsigned char>(bytes[at + k])} << (8 * k);
  return value;
}

void put_little_endian(std::string& bytes, std::size_t value) {
  for (int k = 0; k < 4; ++k) bytes.push_back(static_cast<char>(value >> (8 * k)));
}

bool nests_too_deeply(const std::string& text) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == '\\') ++i;
      quoted = c != '"';
    } else if (c == '"') {
      quoted = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kDeepestNesting) return true;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return false;
}

std::optional<std::string> decode_base64(std::string_view text) {
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    int value;
    if (c >= 'A' && c <= 'Z')
      value = c - 'A';
    else if (c >= 'a' && c <= 'z')
      value = c - 'a' + 26;
    else if (c >= '0' && c <= '9')
      value = c - '0' + 52;
    else if (c == '+')
      value = 62;
    else if (c == '/')
      value = 63;
    else if (c == '=')
      break;
    else
      return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    if (++count == 4) {
      for (const int shift : {16, 8, 0}) bytes.push_back(static_cast<char>(bits >> shift));
      bits = 0;
      count = 0;
    }
  }
  if (count >= 2) bytes.push_back(static_cast<char>(bits >> (6 * count - 8)));
  if (count == 3) bytes.push_back(static_cast<char>(bits >> 2));
  return bytes;
}

std::string decode_percent(const std::string& text) {
  const auto digit = [](char c) {
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
  };
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() && digit(text[i + 1]) >= 0 && digit(text[i + 2]) >= 0) {
      plain.push_back(static_cast<char>(digit(text[i + 1]) * 16 + digit(text[i + 2])));
      i += 2;
    } else {
      plain.push_back(text[i]);
    }
  }
  return plain;
}

/// Copies a document's geometry and remembers the first fault. After a fault its numbers are 0 and its lists empty, so callers
/// need to look only once, at the end.
class GltfStripper {
 public:
  GltfStripper(const json& document, const std::string* chunk, const std::filesystem::path& folder)
      : document_(document), chunk_(chunk), folder_(folder) {}

  Result<std::string> strip() {
    if (!version_is_2()) return fail("it is not a glTF 2.0 document: \"asset.version\" does not start with 2");
    for (const json& name : list(document_, "extensionsRequired"))
      if (!name.is_string() || !harmless(name.get<std::string>())) say("it needs the extension ", name.dump(), ", which is not read");
    copy_buffers();
    copy_meshes();
    copy_nodes();
    if (!fault_.empty()) return Error{fault_};
    out_["asset"]["version"] = "2.0";
    out_["scene"] = 0;
    out_["buffers"] = json::array({{{"byteLength", bytes_.size()}}});
    std::string text = out_.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string glb = "glTF";
    for (const std::size_t value : {std::size_t{2}, 12 + 8 + text.size() + 8 + bytes_.size(), text.size()}) put_little_endian(glb, value);
    glb += "JSON" + text;
    put_little_endian(glb, bytes_.size());
    glb.append("BIN\0", 4);
    return glb + bytes_;
  }

 private:
  template <class... Parts>
  void say(const Parts&... parts) {
    if (fault_.empty()) fault_ = fail(parts...).message;
  }

  static bool harmless(const std::string& extension) {
    return extension.starts_with("KHR_materials_") || extension == "KHR_texture_transform" || extension == "KHR_texture_basisu" ||
           extension == "KHR_lights_punctual" || extension == "EXT_texture_webp";
  }

  const json& list(const json& object, const char* key) {
    static const json empty = json::array();
    const auto found = object.is_object() ? object.find(key) : object.end();
    if (!object.is_object() || found == object.end()) return empty;
    if (!found->is_array()) say("\"", key, "\" is not a list");
    return found->is_array() ? *found : empty;
  }

  std::uint64_t natural(const json& object, const char* key, std::uint64_t missing) {
    if (!object.is_object() || !object.contains(key)) return missing;
    const json& value = object[key];
    if (value.is_number_unsigned() && value.get<std::uint64_t>() < std::uint64_t{1} << 40) return value.get<std::uint64_t>();
    say("\"", key, "\" is ", value.dump().substr(0, 40), ", not a whole number from 0");
    return 0;
  }

  bool version_is_2() const {
    const json* version = document_.contains("asset") && document_["asset"].is_object() && document_["asset"].contains("version")
                              ? &document_["asset"]["version"]
                              : nullptr;
    return version && version->is_string() && version->get<std::string>().starts_with("2.");
  }

  /// An entry of a list by an index found under `key`; nothing (and a fault) when it points past the end.
  const json* entry(const json& from, const json& object, const char* key) {
    const std::uint64_t index = natural(object, key, kNone);
    if (index < from.size()) return &from[index];
    say("\"", key, "\" points to ", index == kNone ? std::string("nothing") : std::to_string(index), " of a list of ", from.size());
    return nullptr;
  }

  void copy_buffers() {
    for (const json& buffer : list(document_, "buffers")) {
      const std::size_t number = buffer_size_.size();
      const std::uint64_t wanted = natural(buffer, "byteLength", 0);
      std::string bytes;
      if (buffer.is_object() && buffer.contains("uri")) {
        const std::string uri = buffer["uri"].is_string() ? buffer["uri"].get<std::string>() : std::string();
        if (uri.starts_with("data:")) {
          const std::size_t comma = uri.find(";base64,");
          std::optional<std::string> decoded =
              comma == std::string::npos ? std::nullopt : decode_base64(std::string_view(uri).substr(comma + 8));
          if (!decoded) say("buffer ", number, " is not base64");
          bytes = std::move(decoded).value_or("");
        } else {
          Result<std::string> read = read_file(folder_ / decode_percent(uri));
          if (!read) say("buffer ", number, ": ", read.error());
          bytes = read ? std::move(*read) : std::string();
        }
      } else if (number == 0 && chunk_) {
        bytes = *chunk_;
      }
      if (bytes.size() < wanted) say("buffer ", number, " is cut short: it has ", bytes.size(), " of ", wanted, " bytes");
      bytes.resize(std::min<std::size_t>(bytes.size(), wanted));
      buffer_size_.push_back(bytes.size());
      buffer_start_.push_back(bytes_.size());
      bytes_ += bytes;
      bytes_.resize((bytes_.size() + 3) / 4 * 4, '\0');
    }
    if (bytes_.size() > 0xf0000000u) say("its buffers have ", bytes_.size(), " bytes; at most ", 0xf0000000u, " are allowed");
  }

  /// Copies an accessor and its view; returns its new number, or nothing after a fault. `count` receives the number of elements.
  std::optional<std::size_t> copy_accessor(const json& object, const char* key, const char* type, bool indices, std::uint64_t& count) {
    count = 0;
    const json* accessor = entry(list(document_, "accessors"), object, key);
    if (!accessor) return std::nullopt;
    if (accessor->is_object() && accessor->contains("sparse")) say("the accessor of \"", key, "\" is sparse, which is not read");
    const std::uint64_t component = natural(*accessor, "componentType", 0);
    const std::size_t size = component == 5121 ? 1 : component == 5123 ? 2 : 4;
    const bool right_component = indices ? component == 5121 || component == 5123 || component == 5125 : component == 5126;
    if (!right_component)
      say("the accessor of \"", key, "\" has the component type ", component, "; ",
          indices ? "5121, 5123 and 5125 (integers)" : "only 5126 (float)", " can be read");
    if (!accessor->is_object() || accessor->value("type", json()) != type) say("the accessor of \"", key, "\" is not a ", type);
    const std::size_t width = std::strcmp(type, "SCALAR") == 0 ? 1 : static_cast<std::size_t>(type[3] - '0');
    const json* view = entry(list(document_, "bufferViews"), *accessor, "bufferView");
    if (!view) return std::nullopt;
    const std::uint64_t buffer = natural(*view, "buffer", 0), view_offset = natural(*view, "byteOffset", 0),
                        view_size = natural(*view, "byteLength", 0);
    const std::uint64_t offset = natural(*accessor, "byteOffset", 0), elements = natural(*accessor, "count", 0);
    const std::uint64_t stride = natural(*view, "byteStride", 0), step = stride ? stride : size * width;
    if (buffer >= buffer_size_.size() || view_offset + view_size > buffer_size_[buffer])
      say("the buffer view of \"", key, "\" reaches past the end of its buffer: ", view_offset, " + ", view_size, " bytes");
    if (step < size * width || step > 252)
      say("the buffer view of \"", key, "\" has a stride of ", step, " bytes, outside ", size * width, " ... 252");
    if (elements > kMostIndices)
      say("the accessor of \"", key, "\" has ", elements, " elements; at most ", kMostIndices, " are allowed");
    else if (elements > 0 && offset + (elements - 1) * step + size * width > view_size)
      say("the accessor of \"", key, "\" reaches past the end of its buffer view: ", elements, " elements in ", view_size, " bytes");
    if (!fault_.empty()) return std::nullopt;

    count = elements;
    json new_view{{"buffer", 0}, {"byteOffset", buffer_start_[buffer] + view_offset}, {"byteLength", view_size}};
    if (stride) new_view["byteStride"] = stride;
    out_["bufferViews"].push_back(std::move(new_view));
    const std::size_t number = out_["bufferViews"].size() - 1;
    out_["accessors"].push_back(
        {{"bufferView", number}, {"byteOffset", offset}, {"componentType", component}, {"count", elements}, {"type", type}});
    return number;
  }

  /// assimp drops triangles with bad indices without a word.
  void check_indices(const json& accessor, std::uint64_t count, std::uint64_t vertices) {
    if (count > kMostIndices) return;
    const json& view = out_["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    const std::size_t component = accessor["componentType"].get<std::size_t>(), size = component == 5121 ? 1 : component == 5123 ? 2 : 4;
    const std::size_t start = view["byteOffset"].get<std::size_t>() + accessor["byteOffset"].get<std::size_t>(),
                      step = view.value("byteStride", size);
    for (std::size_t i = 0; i < count; ++i) {
      std::uint32_t index = 0;
      for (std::size_t k = 0; k < size; ++k) index |= std::uint32_t{static_cast<unsigned char>(bytes_[start + i * step + k])} << (8 * k);
      if (index < vertices) continue;
      say("index ", i, " is ", index, ", past the last of ", vertices, " vertices");
      return;
    }
  }

  void copy_meshes() {
    out_["meshes"] = json::array();
    for (const json& mesh : list(document_, "meshes")) {
      json primitives = json::array();
      for (const json& primitive : list(mesh, "primitives")) {
        const json attributes = primitive.is_object() ? primitive.value("attributes", json::object()) : json::object();
        json copy{{"mode", natural(primitive, "mode", 4)}};
        if (copy["mode"] > 6) say("a primitive has the mode ", copy["mode"].dump(), "; the highest is 6");
        std::uint64_t vertices = 0, indices = 0;
        const auto position = copy_accessor(attributes, "POSITION", "VEC3", false, vertices);
        if (!position) return;
        copy["attributes"]["POSITION"] = *position;
        for (const auto& [name, type] : {std::pair{"NORMAL", "VEC3"}, std::pair{"TANGENT", "VEC4"}, std::pair{"TEXCOORD_0", "VEC2"}}) {
          if (!attributes.contains(name)) continue;
          std::uint64_t count = 0;
          const auto accessor = copy_accessor(attributes, name, type, false, count);
          if (accessor && count != vertices) say("a primitive has ", vertices, " positions but ", count, " of ", name);
          if (!accessor || !fault_.empty()) return;
          copy["attributes"][name] = *accessor;
        }
        indices = vertices;
        if (fault_.empty() && primitive.contains("indices")) {
          const auto accessor = copy_accessor(primitive, "indices", "SCALAR", true, indices);
          if (!accessor) return;
          copy["indices"] = *accessor;
          check_indices(out_["accessors"][*accessor], indices, vertices);
        }
        vertex_total_ += vertices;
        index_total_ += indices;
        if (vertex_total_ > kMostVertices) say("it has ", vertex_total_, " vertices or more; at most ", kMostVertices, " are allowed");
        if (index_total_ > kMostIndices) say("it has ", index_total_, " indices or more; at most ", kMostIndices, " are allowed");
        if (vertices > 0 && indices > 0) primitives.push_back(std::move(copy));
      }
      mesh_kept_.push_back(primitives.empty() ? kNone : static_cast<std::uint32_t>(out_["meshes"].size()));
      if (!primitives.empty()) out_["meshes"].push_back({{"primitives", std::move(primitives)}});
    }
  }

  void copy_nodes() {
    const json& nodes = list(document_, "nodes");
    std::vector<std::size_t> parent(nodes.size(), kNone);
    json copies = json::array(), roots = json::array();
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      json copy = json::object();
      for (const auto& [key, length] :
           {std::pair{"matrix", 16u}, std::pair{"translation", 3u}, std::pair{"rotation", 4u}, std::pair{"scale", 3u}}) {
        const json& numbers = list(nodes[n], key);
        if (numbers.empty()) continue;
        if (numbers.size() != length || !std::ranges::all_of(numbers, [](const json& x) { return x.is_number(); }))
          say("node ", n, ": \"", key, "\" is not ", length, " numbers");
        copy[key] = numbers;
      }
      if (nodes[n].is_object() && nodes[n].contains("mesh")) {
        const std::uint64_t mesh = natural(nodes[n], "mesh", 0);
        if (mesh >= mesh_kept_.size())
          say("node ", n, ": \"mesh\" points to ", mesh, " of ", mesh_kept_.size());
        else if (mesh_kept_[mesh] != kNone)
          copy["mesh"] = mesh_kept_[mesh];
      }
      for (const json& child : list(nodes[n], "children")) {
        const std::uint64_t c = child.is_number_unsigned() ? child.get<std::uint64_t>() : kNone;
        if (c >= nodes.size() || parent[c] != kNone) {
          say("node ", n, " has the child ", child.dump().substr(0, 40), ", which does not exist or has another parent");
          continue;
        }
        parent[c] = n;
        copy["children"].push_back(c);
      }
      copies.push_back(std::move(copy));
    }
    for (std::size_t n = 0; n < parent.size(); ++n) {
      std::size_t steps = 0;
      for (std::size_t up = n; up != kNone && steps <= kDeepestNodes; up = parent[up]) ++steps;
      if (steps > kDeepestNodes) say("node ", n, " lies below itself or deeper than ", kDeepestNodes, " levels");
    }

    const json& scenes = list(document_, "scenes");
    if (!scenes.empty()) {
      const json* scene = document_.contains("scene") ? entry(scenes, document_, "scene") : &scenes[0];
      for (const json& root : list(scene ? *scene : scenes[0], "nodes")) {
        if (root.is_number_unsigned() && root.get<std::uint64_t>() < nodes.size())
          roots.push_back(root);
        else
          say("its scene has the node ", root.dump().substr(0, 40), " of ", nodes.size());
      }
    } else {
      for (std::size_t n = 0; n < parent.size(); ++n)
        if (parent[n] == kNone) roots.push_back(n);
      // A file of meshes without nodes is a library in glTF's words; every mesh is shown once.
      for (std::size_t m = 0; nodes.empty() && m < out_["meshes"].size(); ++m) {
        copies.push_back({{"mesh", m}});
        roots.push_back(m);
      }
    }
    if (roots.empty() || out_["meshes"].empty()) say("it has no triangle in its scene");
    out_["nodes"] = std::move(copies);
    out_["scenes"] = json::array({{{"nodes", std::move(roots)}}});
  }

  const json& document_;
  const std::string* chunk_;   // the GLB's second chunk, if there is one
  const std::filesystem::path& folder_;
  json out_;
  std::string bytes_, fault_;
  std::vector<std::size_t> buffer_start_, buffer_size_;
  std::vector<std::uint32_t> mesh_kept_;
  std::uint64_t vertex_total_ = 0, index_total_ = 0;
};

}   // namespace

Result<std::string> gltf_geometry(const std::string& content, const std::filesystem::path& folder) {
  std::string text = content, chunk;
  bool has_chunk = false;
  if (content.starts_with("glTF")) {
    if (content.size() < 20) return fail("it is cut short: ", content.size(), " bytes, and a GLB's header alone has 20");
    if (const std::uint32_t version = little_endian(content, 4); version != 2)
      return fail("it is GLB version ", version, "; only 2 can be read");
    if (const std::uint32_t size = little_endian(content, 8); size > content.size())
      return fail("it is cut short: it has ", content.size(), " of ", size, " bytes");
    const std::size_t text_size = little_endian(content, 12);
    if (text_size > content.size() - 20 || content.compare(16, 4, "JSON") != 0)
      return fail("its first chunk is not JSON or is ", text_size, " bytes long, more than the file has");
    text = content.substr(20, text_size);
    const std::size_t next = 20 + (text_size + 3) / 4 * 4;
    if (next + 8 <= content.size() && content.compare(next + 4, 4, std::string("BIN\0", 4)) == 0) {
      const std::size_t size = little_endian(content, next);
      if (size > content.size() - next - 8) return fail("its second chunk is ", size, " bytes long, more than the file has");
      chunk = content.substr(next + 8, size);
      has_chunk = true;
    }
  }
  if (nests_too_deeply(text)) return fail("its brackets nest deeper than ", kDeepestNesting, " levels");
  const json document = json::parse(text, nullptr, false);
  if (document.is_discarded() || !document.is_object()) return fail("it is not a JSON document, or is cut short");
  return GltfStripper(document, has_chunk ? &chunk : nullptr, folder).strip();
}

}   // namespace weft::parts
