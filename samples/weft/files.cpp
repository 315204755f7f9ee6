// Writing text, and the folders of saved files.
#include "samples/weft/files.h"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <span>

namespace weft::command {

Result<void> write_text(const std::filesystem::path& file, std::string_view text, Link link) {
  return write_file(file, std::as_bytes(std::span(text)), link);
}

Result<void> make_folder(const std::filesystem::path& folder) {
  if (folder.empty()) return {};   // of a file without a folder: the one that the program is in
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!is_folder(folder)) return fail(folder.string(), ": cannot be made a folder: ", error ? error.message() : "a file is there");
  return {};
}

bool is_folder(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_directory(path, error);
}

bool is_there(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::exists(path, error);
}

namespace {

// A file among those that can be made again; empty where no home is known.
std::filesystem::path cached(const std::string& name) {
  const auto in = [](const char* variable, const char* rest) {
    const char* value = std::getenv(variable);
    const std::filesystem::path place = value ? value : "";
    return place.is_absolute() ? place / rest : std::filesystem::path();   // relative ones are to be ignored: XDG base directories
  };
  std::filesystem::path folder = in("XDG_CACHE_HOME", "weft");
  if (folder.empty()) folder = in("HOME", ".cache/weft");
  return folder.empty() ? folder : folder / name;
}

}  // namespace

std::filesystem::path pipeline_cache() { return cached("pipelines"); }
std::filesystem::path curve_file(std::string_view device) { return cached("curve-" + file_name(device) + ".csv"); }

Fingerprint& Fingerprint::add(const void* bytes, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) hash_ = (hash_ ^ static_cast<const unsigned char*>(bytes)[i]) * 0x100000001b3u;
  return *this;
}

std::string Fingerprint::text() const {
  std::array<char, 17> digits;
  std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(hash_));
  return digits.data();
}

std::string file_name(std::string_view name) {
  std::string plain(name.substr(0, 100));
  for (char& c : plain)
    if (static_cast<unsigned char>(c) < 0x20 || c == '/' || c == '\\') c = '_';
  return plain.empty() || plain[0] == '.' ? "scene" + plain : plain;
}

std::string quoted(std::string text) {
  if (text.find_first_of(",\"\n") == text.npos) return text;
  for (std::size_t at = 0; (at = text.find('"', at)) != text.npos; at += 2) text.insert(at, 1, '"');
  return '"' + text + '"';
}

}  // namespace weft::command
