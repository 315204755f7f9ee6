// Accessors of a glTF: every range is checked before anything of it is read.
#include <algorithm>
#include <bit>

#include "engine/mesh/gltf.h"
#include "engine/mesh/parts.h"

namespace weft::parts {

static_assert(std::endian::native == std::endian::little, "accessors are read as they lie in memory");

double Accessor::number(std::size_t element, std::size_t k) const {
  const char* at = bytes + element * step;
  const auto whole = [&]<class T>(T) {
    T value;
    std::memcpy(&value, at + k * sizeof value, sizeof value);
    // glTF 2.0, 3.11: the least of a signed type counts as the next one.
    return is_normalized ? std::max(double(value) / double(std::numeric_limits<T>::max()), -1.0) : double(value);
  };
  switch (component) {
    case 5120: return whole(std::int8_t{});
    case 5121: return whole(std::uint8_t{});
    case 5122: return whole(std::int16_t{});
    case 5123: return whole(std::uint16_t{});
    case 5125: return whole(std::uint32_t{});
    default: break;
  }
  float value;
  std::memcpy(&value, at + k * sizeof value, sizeof value);
  return double(value);
}

namespace {

void check_component(GltfDocument& document, const char* key, std::uint64_t component, Components components) {
  const bool small = component == 5120 || component == 5121 || component == 5122 || component == 5123;
  const bool right = components == Components::floats    ? component == 5126
                     : components == Components::numbers ? component == 5126 || small
                                                         : component == 5121 || component == 5123 || component == 5125;
  if (!right)
    document.say("the accessor of \"", key, "\" has the component type ", component, "; ",
                 components == Components::floats    ? "only 5126 (float)"
                 : components == Components::numbers ? "5120 to 5123 (integers) and 5126 (float)"
                                                     : "5121, 5123 and 5125 (integers)",
                 " can be read");
}

// `count` elements of so many numbers, from where `place` says in the buffer view that it names.
Accessor elements(GltfDocument& document, const json& place, const char* key, std::uint64_t count, std::size_t width,
                  std::uint64_t component) {
  const auto say = [&](const auto&... parts) { document.say(parts...); };
  if (!has(place, "bufferView")) say("the accessor of \"", key, "\" has no \"bufferView\", and so nothing that can be read");
  const json* view = document.entry(document.list(document.tree.root, "bufferViews"), place, "bufferView");
  if (!view) return {};
  const std::size_t size = width * (component <= 5121 ? 1 : component <= 5123 ? 2 : 4);
  const std::uint64_t buffer = document.natural(*view, "buffer", 0), view_offset = document.natural(*view, "byteOffset", 0),
                      view_size = document.natural(*view, "byteLength", 0);
  const std::uint64_t offset = document.natural(place, "byteOffset", 0);
  const std::uint64_t stride = document.natural(*view, "byteStride", 0), step = stride ? stride : size;
  if (buffer >= document.buffers.size() || view_offset + view_size > document.buffers[buffer].size())
    say("the buffer view of \"", key, "\" reaches past the end of its buffer: ", view_offset, " + ", view_size, " bytes");
  if (step < size || step > 252) say("the buffer view of \"", key, "\" has a stride of ", step, " bytes, outside ", size, " ... 252");
  if (count > kMostIndices)
    say("the accessor of \"", key, "\" has ", count, " elements; at most ", kMostIndices, " are allowed");
  else if (count > 0 && offset + (count - 1) * step + size > view_size)
    say("the accessor of \"", key, "\" reaches past the end of its buffer view: ", count, " elements in ", view_size, " bytes");
  if (!document.fault.empty()) return {};
  return {document.buffers[buffer].data() + view_offset + offset, step, count, component,
          has(place, "normalized") && place["normalized"] == true};
}

Accessor dense(GltfDocument& document, const json& accessor, const char* key, std::string_view type, Components components) {
  const std::uint64_t component = document.natural(accessor, "componentType", 0);
  check_component(document, key, component, components);
  if (!has(accessor, "type") || !is_text(accessor["type"], type)) document.say("the accessor of \"", key, "\" is not a ", type);
  const std::size_t width = type == "SCALAR" ? 1 : type == "MAT4" ? 16 : static_cast<std::size_t>(type.back() - '0');
  return elements(document, accessor, key, document.natural(accessor, "count", 0), width, component);
}

}  // namespace

Accessor accessor(GltfDocument& document, const json& object, const char* key, std::string_view type, Components components) {
  const json* accessor = document.entry(document.list(document.tree.root, "accessors"), object, key);
  if (!accessor) return {};
  if (has(*accessor, "sparse")) document.say("the accessor of \"", key, "\" is sparse, which is not read");
  return dense(document, *accessor, key, type, components);
}

std::vector<Vec3> vectors(GltfDocument& document, const json& object, const char* key) {
  const json* described = document.entry(document.list(document.tree.root, "accessors"), object, key);
  if (!described) return {};
  const bool is_sparse = has(*described, "sparse");
  const std::uint64_t count = document.natural(*described, "count", 0);
  if (count > kMostVertices)
    document.say("the accessor of \"", key, "\" has ", count, " elements; at most ", kMostVertices, " are allowed");
  Accessor base;   // zeros, where a sparse one has none
  if (!is_sparse || has(*described, "bufferView")) base = dense(document, *described, key, "VEC3", Components::floats);
  if (!document.fault.empty()) return {};
  std::vector<Vec3> values(static_cast<std::size_t>(count));
  for (std::size_t k = 0; k < base.count; ++k) values[k] = base.at<Vec3>(k);
  if (!is_sparse) return values;
  const json& sparse = (*described)["sparse"];
  static const json none = json::object();
  const json &places = has(sparse, "indices") ? sparse["indices"] : none, &changes = has(sparse, "values") ? sparse["values"] : none;
  const std::uint64_t changed = document.natural(sparse, "count", 0), kind = document.natural(places, "componentType", 0);
  check_component(document, key, kind, Components::indices);
  check_component(document, key, document.natural(*described, "componentType", 0), Components::floats);
  if (!document.fault.empty()) return {};
  const Accessor indices = elements(document, places, key, changed, 1, kind), changed_to = elements(document, changes, key, changed, 3, 5126);
  for (std::size_t k = 0; k < indices.count && document.fault.empty(); ++k) {
    const std::uint32_t at = indices.index(k);
    if (at >= count || (k > 0 && at <= indices.index(k - 1)))
      document.say("the sparse accessor of \"", key, "\" changes element ", at, " of ", count, ", or not after the one before");
    else
      values[at] = changed_to.at<Vec3>(k);
  }
  return values;
}

}  // namespace weft::parts
