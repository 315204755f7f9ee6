// A glTF's container: the chunks of a GLB, the JSON, and the buffers. A damaged file ends in a sentence; what a document may make the
// program read and hold is bounded.
#include <optional>

#include "engine/mesh/gltf.h"
#include "engine/mesh/outline.h"
#include "engine/mesh/parts.h"

namespace weft::parts {
namespace {

std::uint32_t little_endian(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k) value |= std::uint32_t{static_cast<unsigned char>(bytes[at + k])} << (8 * k);
  return value;
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

/// The file that a buffer names. Unless others are allowed it must lie below the folder, links followed.
Result<std::filesystem::path> found(const std::filesystem::path& folder, const std::string& uri, BufferFiles buffer_files) {
  std::error_code code;
  const auto root = std::filesystem::canonical(folder.empty() ? "." : folder, code);
  const auto file = code ? root : std::filesystem::weakly_canonical(root / decode_percent(uri), code);
  if (code) return fail("\"", uri.substr(0, 200), "\" cannot be found: ", code.message());
  const bool is_below = std::mismatch(root.begin(), root.end(), file.begin(), file.end()).first == root.end();
  if (!is_below && buffer_files != BufferFiles::anywhere)
    return fail("\"", uri.substr(0, 200), "\" lies outside the folder of the glTF, below which alone buffers are read unless others are ",
                "allowed (weft --allow-outside)");
  return file;
}

std::string text_of(const json& object, const char* key) {
  return object[key].is_string() ? object[key].get<std::string>() : std::string();
}

void read_buffers(GltfDocument& document, const std::string* chunk, const std::filesystem::path& folder, BufferFiles buffer_files) {
  std::uint64_t total = 0;
  for (const json& buffer : document.list(document.tree.root, "buffers")) {
    const std::size_t number = document.buffers.size();
    const std::uint64_t wanted = document.natural(buffer, "byteLength", 0);
    total += wanted;
    if (total > kMostBytes) return document.say("its buffers have ", total, " bytes or more; at most ", kMostBytes, " are allowed");
    const bool is_fallback = has(member(buffer, "extensions"), "EXT_meshopt_compression") && !has(buffer, "uri");
    Result<std::string> bytes = has(buffer, "uri")                      ? bytes_at(text_of(buffer, "uri"), wanted, folder, buffer_files)
                                : number == 0 && chunk && !is_fallback ? Result<std::string>(chunk->substr(0, wanted))
                                                                        : Result<std::string>(std::string());
    if (!bytes) return document.say("buffer ", number, ": ", bytes.error());
    if (is_fallback) {   // for who cannot unpack: what is in it is unpacked, and no view of it is read
      document.buffers.emplace_back();
      total -= wanted;
      continue;
    }
    if (bytes->size() < wanted) return document.say("buffer ", number, " is cut short: it has ", bytes->size(), " of ", wanted, " bytes");
    bytes->resize(wanted);
    document.buffers.push_back(std::move(*bytes));
  }
}

bool version_is_2(const json& root) {
  const auto asset = root.find("asset");
  if (asset == root.end() || !asset->is_object()) return false;
  const auto version = asset->find("version");
  return version != asset->end() && version->is_string() && version->get<std::string>().starts_with("2.");
}

}   // namespace

Result<std::string> bytes_at(const std::string& uri, std::optional<std::size_t> first_bytes, const std::filesystem::path& folder,
                             BufferFiles buffer_files) {
  if (!uri.starts_with("data:")) {
    const Result<std::filesystem::path> file = found(folder, uri, buffer_files);
    return file ? read_file(*file, first_bytes) : Result<std::string>(Error{file.why()});
  }
  const std::size_t comma = uri.find(";base64,");
  std::optional<std::string> decoded = comma == std::string::npos ? std::nullopt : decode_base64(std::string_view(uri).substr(comma + 8));
  if (!decoded) return fail("it is not base64");
  return std::move(*decoded);
}

const json& GltfDocument::list(const json& object, const char* key) {
  static const json empty = json::array();
  if (!object.is_object()) return empty;
  const auto found = object.find(key);
  if (found == object.end()) return empty;
  if (!found->is_array()) say("\"", key, "\" is not a list");
  return found->is_array() ? *found : empty;
}

std::uint64_t GltfDocument::natural(const json& object, const char* key, std::uint64_t missing) {
  if (!object.is_object() || !object.contains(key)) return missing;
  const json& value = object[key];
  if (value.is_number_unsigned() && value.get<std::uint64_t>() < std::uint64_t{1} << 40) return value.get<std::uint64_t>();
  say("\"", key, "\" is ", value.dump().substr(0, 40), ", not a whole number from 0");
  return 0;
}

const json* GltfDocument::entry(const json& from, const json& object, const char* key) {
  const std::uint64_t index = natural(object, key, kNone);
  if (index < from.size()) return &from[index];
  say("\"", key, "\" points to ", index == kNone ? std::string("nothing") : std::to_string(index), " of a list of ", from.size());
  return nullptr;
}

Result<GltfDocument> open_gltf(const std::string& content, const std::filesystem::path& folder, BufferFiles buffer_files) {
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
  if (std::string fault = outline_fault(text); !fault.empty()) return Error{std::move(fault)};
  GltfDocument document;
  document.tree = parsed_json(text);
  if (document.tree.root.is_discarded() || !document.tree.root.is_object()) return fail("it is not a JSON document, or is cut short");
  if (!version_is_2(document.tree.root)) return fail("it is not a glTF 2.0 document: \"asset.version\" does not start with 2");
  read_buffers(document, has_chunk ? &chunk : nullptr, folder, buffer_files);
  if (document.fault.empty()) unpack_gltf(document);
  return document;
}

}   // namespace weft::parts
