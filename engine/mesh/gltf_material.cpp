// Materials of a glTF, with their textures and images: kept as they are for whoever writes the mesh back. Weft itself needs of them only
// how texture coordinates are taken.
#include <algorithm>
#include <cmath>

#include "engine/mesh/gltf.h"
#include "engine/mesh/materials.h"
#include "engine/mesh/parts.h"

namespace weft::parts {
namespace {

constexpr std::uint32_t kWrong = kNone - 1;
constexpr const char* kTransform = "KHR_texture_transform";

TextureCoordinates coordinates_in(GltfDocument& document, const json& info) {
  const json& transform = member(member(info, "extensions"), kTransform);
  const auto pair = [&](const char* key, std::array<double, 2>& values) {
    const json& list = document.list(transform, key);
    if (list.empty()) return;
    if (list.size() != 2 || !list[0].is_number() || !list[1].is_number())
      return document.say(kTransform, ": \"", key, "\" is not 2 numbers");
    values = {list[0].get<double>(), list[1].get<double>()};
  };
  TextureCoordinates coordinates;
  coordinates.set = document.natural(transform, "texCoord", document.natural(info, "texCoord", 0));
  pair("offset", coordinates.offset);
  pair("scale", coordinates.scale);
  if (has(transform, "rotation") && !transform["rotation"].is_number()) document.say(kTransform, ": \"rotation\" is not a number");
  else if (has(transform, "rotation")) coordinates.rotation = transform["rotation"].get<double>();
  return coordinates;
}

// By its first bytes, whatever the file calls it.
const char* picture_kind(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG")) return "image/png";
  if (bytes.starts_with("\xff\xd8\xff")) return "image/jpeg";
  if (bytes.starts_with("RIFF") && bytes.substr(0, 12).ends_with("WEBP")) return "image/webp";
  if (bytes.starts_with("\xabKTX 20\xbb")) return "image/ktx2";
  return nullptr;
}

// A list of the document's of which some entries are taken; each gets a number when it is first asked for.
class Taken {
 public:
  Taken(GltfDocument& document, const char* key) : document_(document), key_(key) {}
  // kNone, and a fault, beyond its end.
  std::uint32_t number(const json& index) {
    const std::size_t count = document_.list(document_.tree.root, key_).size();
    const std::uint64_t at = index.is_number_unsigned() ? index.get<std::uint64_t>() : kNone;
    if (at >= count) {
      document_.say("a number among its \"", key_, "\" is ", index.dump().substr(0, 40), ", and there are ", count);
      return kNone;
    }
    const auto [known, added] = numbers_.try_emplace(static_cast<std::uint32_t>(at), static_cast<std::uint32_t>(entries_.size()));
    if (added) entries_.push_back(known->first);
    return known->second;
  }
  std::size_t size() const { return entries_.size(); }
  json& operator[](std::size_t k) { return document_.tree.root[key_][entries_[k]]; }

 private:
  GltfDocument& document_;
  const char* key_;
  std::map<std::uint32_t, std::uint32_t> numbers_;
  std::vector<std::uint32_t> entries_;
};

Result<std::string> image_of(GltfDocument& document, const json& image, const std::filesystem::path& folder, BufferFiles buffer_files) {
  if (has(image, "uri")) return bytes_at(image["uri"].is_string() ? image["uri"].get<std::string>() : "", {}, folder, buffer_files);
  const json* view = document.entry(document.list(document.tree.root, "bufferViews"), image, "bufferView");
  return view ? Result<std::string>(std::string(document.view(*view, "image"))) : Result<std::string>(fail("it has no bytes"));
}

}  // namespace

Vec2 TextureCoordinates::at(Vec2 uv) const {
  if (offset == std::array{0.0, 0.0} && scale == std::array{1.0, 1.0} && rotation == 0) return uv;   // the same bits
  const double u = scale[0] * double(uv.x), v = scale[1] * double(uv.y), c = std::cos(rotation), s = std::sin(rotation);
  return {static_cast<float>(c * u + s * v + offset[0]), static_cast<float>(c * v - s * u + offset[1])};
}

void MaterialReader::set_aside() {
  if (fault_.empty()) fault_ = document_.fault;
  document_.fault.clear();
}

const json& MaterialReader::all() {
  const json& list = document_.list(document_.tree.root, "materials");
  if (!document_.fault.empty()) set_aside();
  return list;
}

std::uint32_t MaterialReader::number_of(const json& primitive) {
  if (!has(primitive, "material")) return kNone;
  const json& number = primitive["material"];
  const bool is_there = number.is_number_unsigned() && number.get<std::uint64_t>() < all().size();
  return is_there ? number.get<std::uint32_t>() : kWrong;
}

TextureCoordinates MaterialReader::coordinates_of(std::uint32_t material) {
  if (material >= kWrong) return {};
  const auto [known, added] = known_.try_emplace(material);
  if (!added) return known->second;
  const json* first = nullptr;
  for_textures(all()[material], [&](const std::string& name, const json& info) {
    if (!first || name == "baseColorTexture") first = &info;
  });
  if (!first) return {};
  const TextureCoordinates coordinates = coordinates_in(document_, *first);
  if (document_.fault.empty()) known->second = coordinates;
  else set_aside();
  return known->second;
}

std::shared_ptr<const Materials> MaterialReader::take(std::vector<std::uint32_t>& material_of, const std::filesystem::path& folder,
                                                      BufferFiles buffer_files) {
  Taken materials(document_, "materials"), textures(document_, "textures"), images(document_, "images");
  const std::size_t count = all().size();
  if (!fault_.empty()) document_.fault = fault_;
  for (std::uint32_t& material : material_of) {
    if (material == kWrong) document_.say("a primitive's \"material\" is not one of the ", count);
    if (material < kWrong) material = materials.number(material);
  }
  auto taken = std::make_shared<Materials>();
  taken->count = materials.size();
  JsonTree kept(json::object());
  for (const char* list : {"materials", "textures", "images"}) put(kept, list, json::array());
  for (std::size_t m = 0; m < materials.size() && document_.fault.empty(); ++m) {
    std::optional<TextureCoordinates> base;
    bool differs = false;
    for_textures(materials[m], [&](const std::string& name, const json& info) {
      if (!base || name == "baseColorTexture") base = coordinates_in(document_, info);
    });
    for_textures(materials[m], [&](const std::string&, json& info) {
      differs |= coordinates_in(document_, info) != *base;
      if (has(info["extensions"], kTransform)) {   // the coordinates have it in them
        take_apart(info["extensions"][kTransform]);
        info["extensions"].erase(kTransform);
      }
      if (info["extensions"].empty()) info.erase("extensions");
      info.erase("texCoord");
      info["index"] = textures.number(info["index"]);
    });
    differing_ += differs;
    kept.root["materials"].push_back(std::move(materials[m]));
  }
  for (std::size_t t = 0; t < textures.size() && document_.fault.empty(); ++t) {
    const auto renumber = [&](json& object) {
      if (has(object, "source")) object["source"] = images.number(object["source"]);
    };
    json& texture = textures[t];
    renumber(texture);
    if (has(texture, "extensions") && texture["extensions"].is_object())
      for (auto& extension : texture["extensions"]) renumber(extension);
    if (has(texture, "sampler")) document_.entry(document_.list(document_.tree.root, "samplers"), texture, "sampler");
    kept.root["textures"].push_back(std::move(texture));
  }
  std::size_t total = 0;
  for (std::size_t k = 0; k < images.size() && document_.fault.empty(); ++k) {
    Result<std::string> bytes = image_of(document_, images[k], folder, buffer_files);
    if (!bytes) document_.say("an image: ", bytes.error());
    else if (const char* kind = picture_kind(*bytes); !kind) document_.say("an image is neither PNG, JPEG, WebP nor KTX2");
    else if ((total += bytes->size()) > kMostBytes) document_.say("its images have more than ", kMostBytes, " bytes");
    else {
      JsonTree image = object_of("mimeType", kind, "bufferView", k);
      kept.root["images"].push_back(std::move(image.root));
      taken->images.push_back(std::move(*bytes));
    }
  }
  if (has(document_.tree.root, "samplers") && textures.size() > 0) put(kept, "samplers", std::move(document_.tree.root["samplers"]));
  if (document_.fault.empty() && taken->count > 0) {
    taken->text = kept.root.dump();
    return taken;
  }
  material_of.clear();
  return nullptr;
}

}  // namespace weft::parts
