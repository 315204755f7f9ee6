// A glTF's document, its buffers, and how values are taken out of it; internal to the sources that read glTF.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "compute/result.h"

namespace weft::parts {

using json = nlohmann::json;

/// A document and the first fault that was found in it. After a fault its numbers are 0 and its lists empty, so callers need to look
/// only once, at the end.
struct GltfDocument {
  json root;
  std::vector<std::string> buffers;   // each as long as the document says
  std::string fault;

  template <class... Parts>
  void say(const Parts&... parts) {
    if (fault.empty()) fault = fail(parts...).message;
  }

  const json& list(const json& object, const char* key);
  std::uint64_t natural(const json& object, const char* key, std::uint64_t missing);

  /// An entry of a list by an index found under `key`; nothing (and a fault) when it points past the end.
  const json* entry(const json& from, const json& object, const char* key);
};

/// Reads the document of a glTF or GLB, and its buffers: those in it and those in files below `folder`. Faults of buffers stay in it.
/// Errors: not JSON, too large or nested too deeply, cut short, another version than 2.
Result<GltfDocument> open_gltf(const std::string& content, const std::filesystem::path& folder);

}   // namespace weft::parts
