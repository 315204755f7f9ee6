#include "compute/file.h"

#include <array>
#include <cerrno>
#include <cstdio>
#include <random>
#include <string>
#include <system_error>

namespace weft {

namespace {

namespace fs = std::filesystem;

Error refuse(const fs::path& file, const std::string& reason) {
  return fail(ErrorKind::other, file.string(), " cannot be written: ", reason);
}

// Makes a new file beside the target; nothing is left of it after an error.
Result<fs::path> write_part(const fs::path& file, const fs::path& target, std::span<const std::byte> bytes) {
  fs::path part = target;
  part += '.' + std::to_string(std::random_device{}()) + ".part";
  const auto reason = [](int code) { return std::generic_category().message(code); };
  std::FILE* stream = std::fopen(part.string().c_str(), "wbx");   // x: never somebody else's file
  if (stream == nullptr) return refuse(file, reason(errno));
  errno = 0;
  int code = std::fwrite(bytes.data(), 1, bytes.size(), stream) == bytes.size() ? 0 : errno != 0 ? errno : EIO;
  errno = 0;
  if (std::fclose(stream) != 0 && code == 0) code = errno != 0 ? errno : EIO;   // the last bytes are written here
  if (code == 0) return part;
  std::error_code ignored;
  fs::remove(part, ignored);
  return refuse(file, reason(code));
}

}  // namespace

// A rename would put a file in the place of a device or a pipe.
Result<fs::path> file_target(const fs::path& file, Link link) {
  std::error_code problem;
  const bool follow = link == Link::follow && fs::exists(file, problem);
  const fs::path target = follow ? fs::canonical(file, problem) : file;
  const fs::file_status status = fs::symlink_status(target, problem);
  if (fs::is_directory(status)) return refuse(file, "it is a folder");
  if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_symlink(status)) return refuse(file, "it is no regular file");
  return target;
}

Result<void> write_file(const fs::path& file, std::span<const std::byte> bytes, Link link) {
  const Result<fs::path> target = file_target(file, link);
  if (!target) return target.why();
  const Result<fs::path> part = write_part(file, *target, bytes);
  if (!part) return part.why();
  std::error_code problem, ignored;
  fs::rename(*part, *target, problem);
  if (!problem) return {};
  fs::remove(*part, ignored);
  return refuse(file, problem.message());
}

Result<void> probe_file(const fs::path& file, Link link) {
  const Result<fs::path> target = file_target(file, link);
  if (!target) return target.why();
  const std::array<std::byte, 4096> page{};   // a full disk may still make a file without a byte
  const Result<fs::path> part = write_part(file, *target, page);
  if (!part) return part.why();
  std::error_code ignored;
  fs::remove(*part, ignored);
  return {};
}

}  // namespace weft
