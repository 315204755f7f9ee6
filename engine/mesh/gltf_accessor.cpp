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

constexpr std::uint64_t kMostDense = std::uint64_t{256} << 20;   // bytes of all sparse accessors: much for real files

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
  const std::uint64_t offset = document.natural(place, "byteOffset", 0);
  const std::uint64_t stride = document.natural(*view, "byteStride", 0), step = stride ? stride : size;
  const std::string_view bytes = document.view(*view, key);
  if (step < size || step > 252) say("the buffer view of \"", key, "\" has a stride of ", step, " bytes, outside ", size, " ... 252");
  if (count > kMostIndices)
    say("the accessor of \"", key, "\" has ", count, " elements; at most ", kMostIndices, " are allowed");
  else if (count > 0 && offset + (count - 1) * step + size > bytes.size())
    say("the accessor of \"", key, "\" reaches past the end of its buffer view: ", count, " elements in ", bytes.size(), " bytes");
  if (!document.fault.empty()) return {};
  return {bytes.data() + offset, step, count, component, has(place, "normalized") && place["normalized"] == true};
}

struct Element {
  std::uint64_t component = 0;
  std::size_t width = 0;
  std::size_t size() const { return width * (component <= 5121 ? 1 : component <= 5123 ? 2 : 4); }
};

Element kind_of(GltfDocument& document, const json& accessor, const char* key, std::string_view type, Components components) {
  const std::uint64_t component = document.natural(accessor, "componentType", 0);
  check_component(document, key, component, components);
  if (!has(accessor, "type") || !is_text(accessor["type"], type)) document.say("the accessor of \"", key, "\" is not a ", type);
  return {component, type == "SCALAR" ? std::size_t{1} : type == "MAT4" ? 16 : static_cast<std::size_t>(type.back() - '0')};
}

// What a sparse accessor comes to: its elements, or zeros, and what it changes of them. `bytes` is where they lie.
Accessor changed(GltfDocument& document, const json& described, const char* key, Element kind, std::uint64_t count, std::string& bytes) {
  const json &sparse = described["sparse"], &places = member(sparse, "indices"), &changes = member(sparse, "values");
  const std::uint64_t changed = document.natural(sparse, "count", 0), index_kind = document.natural(places, "componentType", 0);
  check_component(document, key, index_kind, Components::indices);
  Accessor base;
  if (has(described, "bufferView")) base = elements(document, described, key, count, kind.width, kind.component);
  if (!document.fault.empty()) return {};
  const Accessor indices = elements(document, places, key, changed, 1, index_kind);
  const Accessor changed_to = elements(document, changes, key, changed, kind.width, kind.component);
  if (!document.fault.empty()) return {};
  const std::size_t size = kind.size();
  bytes.assign(static_cast<std::size_t>(count) * size, '\0');
  for (std::size_t k = 0; k < base.count; ++k) std::memcpy(bytes.data() + k * size, base.bytes + k * base.step, size);
  for (std::size_t k = 0; k < indices.count && document.fault.empty(); ++k) {
    const std::uint32_t at = indices.index(k);
    if (at >= count || (k > 0 && at <= indices.index(k - 1)))
      document.say("the sparse accessor of \"", key, "\" changes element ", at, " of ", count, ", or not after the one before");
    else
      std::memcpy(bytes.data() + at * size, changed_to.bytes + k * changed_to.step, size);
  }
  return {bytes.data(), size, count, kind.component, has(described, "normalized") && described["normalized"] == true};
}

const json* described_by(GltfDocument& document, const json& object, const char* key) {
  return document.entry(document.list(document.tree.root, "accessors"), object, key);
}

}  // namespace

std::string_view GltfDocument::view(const json& view, std::string_view name) {
  const std::uint64_t buffer = natural(view, "buffer", 0), offset = natural(view, "byteOffset", 0), size = natural(view, "byteLength", 0);
  if (buffer < buffers.size() && offset + size <= buffers[buffer].size())
    return std::string_view(buffers[buffer]).substr(static_cast<std::size_t>(offset), static_cast<std::size_t>(size));
  say("the buffer view of \"", name, "\" reaches past the end of its buffer: ", offset, " + ", size, " bytes");
  return {};
}

Accessor accessor(GltfDocument& document, const json& object, const char* key, std::string_view type, Components components) {
  const json* described = described_by(document, object, key);
  if (!described) return {};
  const Element kind = kind_of(document, *described, key, type, components);
  const std::uint64_t count = document.natural(*described, "count", 0);
  if (!has(*described, "sparse")) return elements(document, *described, key, count, kind.width, kind.component);
  const auto [dense, is_new] = document.dense.try_emplace(described);
  if (!is_new) return {dense->second.data(), kind.size(), count, kind.component, has(*described, "normalized") && (*described)["normalized"] == true};
  // A few words of a document can ask for all of these.
  if (count > kMostDense || (document.dense_bytes += count * kind.size()) > kMostDense)
    document.say("its sparse accessors have more than ", kMostDense, " bytes");
  if (!document.fault.empty()) return {};
  return changed(document, *described, key, kind, count, dense->second);
}

std::vector<Vec3> vectors(GltfDocument& document, const json& object, const char* key) {
  const json* described = described_by(document, object, key);
  if (!described) return {};
  const std::uint64_t count = document.natural(*described, "count", 0);
  if (count > kMostVertices)
    document.say("the accessor of \"", key, "\" has ", count, " elements; at most ", kMostVertices, " are allowed");
  const Element kind = kind_of(document, *described, key, "VEC3", Components::numbers);
  if (!document.fault.empty()) return {};
  std::string bytes;
  const Accessor read = has(*described, "sparse") ? changed(document, *described, key, kind, count, bytes)
                                                  : elements(document, *described, key, count, kind.width, kind.component);
  if (!document.fault.empty()) return {};
  std::vector<Vec3> values(read.count);
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = read.vector(k);
  return values;
}

}  // namespace weft::parts
