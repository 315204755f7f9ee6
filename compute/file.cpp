#include "compute/file.h"

#include <cerrno>
#include <cstdio>
#include <random>
#include <string>
#include <system_error>

namespace weft {

Result<void> write_file(const std::filesystem::path& file, std::span<const std::byte> bytes) {
  const auto refuse = [&](const std::string& reason) { return fail(ErrorKind::other, file.string(), " cannot be written: ", reason); };
  std::error_code problem;
  // A rename would put a file in the place of a device or a pipe; a link to a file stays a link.
  const std::filesystem::path target = std::filesystem::exists(file, problem) ? std::filesystem::canonical(file, problem) : file;
  const auto status = std::filesystem::status(target, problem);
  if (std::filesystem::is_directory(status)) return refuse("it is a folder");
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) return refuse("it is no regular file");

  std::filesystem::path part = target;
  part += '.' + std::to_string(std::random_device{}()) + ".part";
  const auto reason = [](int code) { return std::generic_category().message(code); };
  std::FILE* stream = std::fopen(part.string().c_str(), "wbx");   // x: never somebody else's file
  if (stream == nullptr) return refuse(reason(errno));
  errno = 0;
  int code = std::fwrite(bytes.data(), 1, bytes.size(), stream) == bytes.size() ? 0 : errno != 0 ? errno : EIO;
  errno = 0;
  if (std::fclose(stream) != 0 && code == 0) code = errno != 0 ? errno : EIO;   // the last bytes are written here
  if (code == 0) {
    std::filesystem::rename(part, target, problem);
    if (!problem) return {};
  }
  const std::string why = code != 0 ? reason(code) : problem.message();
  std::filesystem::remove(part, problem);
  return refuse(why);
}

}  // namespace weft
