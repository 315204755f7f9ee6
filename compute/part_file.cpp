#include "compute/part_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <random>
#include <system_error>
#include <utility>

#include "compute/file.h"

namespace weft {

namespace {

namespace fs = std::filesystem;

Error unwritten(const fs::path& file, int code) {
  return fail(ErrorKind::other, file.string(), " cannot be written: ", std::generic_category().message(code != 0 ? code : EIO));
}

}  // namespace

fs::path part_of(const fs::path& file) {
  fs::path part = file;
  return part += ".part";
}

PartFile::PartFile(fs::path file, fs::path target, fs::path path, std::FILE* stream, bool kept)
    : file_(std::move(file)), target_(std::move(target)), path_(std::move(path)), stream_(stream), kept_(kept) {
  std::setvbuf(stream, nullptr, _IONBF, 0);   // pieces are large, and a kill must not take what was written
}

PartFile::~PartFile() {
  if (!stream_) return;
  stream_.reset();
  std::error_code ignored;
  if (!kept_) fs::remove(path_, ignored);
}

Result<PartFile> PartFile::create(const fs::path& file, bool kept) {
  const Result<fs::path> target = file_target(file);
  if (!target) return target.why();
  fs::path path = part_of(*target);
  if (!kept) path = *target, path += '.' + std::to_string(std::random_device{}()) + ".part";
  std::error_code problem;
  const fs::file_status there = fs::symlink_status(path, problem);
  if (fs::is_regular_file(there) || fs::is_symlink(there)) fs::remove(path, problem);   // of a run that is begun anew
  std::FILE* stream = std::fopen(path.string().c_str(), "w+bx");
  if (stream == nullptr) return unwritten(kept ? path : file, errno);
  return PartFile(file, *target, std::move(path), stream, kept);
}

Result<PartFile> PartFile::reopen(const fs::path& file) {
  const Result<fs::path> target = file_target(file);
  if (!target) return target.why();
  std::error_code ignored;
  for (const fs::path& path : {part_of(*target), *target}) {
    if (!fs::is_regular_file(fs::symlink_status(path, ignored))) continue;
    std::FILE* stream = std::fopen(path.string().c_str(), "r+b");
    if (stream == nullptr) return unwritten(path, errno);
    return PartFile(file, *target, path, stream, true);
  }
  return fail(part_of(file).string(), " is not there");
}

bool PartFile::seek(std::uint64_t offset) {
  if (offset > static_cast<std::uint64_t>(INT64_MAX)) return errno = EFBIG, false;
#if defined(_WIN32)
  return _fseeki64(stream_.get(), static_cast<std::int64_t>(offset), SEEK_SET) == 0;
#else
  return fseeko(stream_.get(), static_cast<off_t>(offset), SEEK_SET) == 0;
#endif
}

Result<void> PartFile::write(std::uint64_t offset, std::span<const std::byte> bytes) {
  if (path_ == target_) {   // a name is only ever of a whole file
    std::error_code problem;
    fs::rename(path_, part_of(target_), problem);
    if (problem) return unwritten(part_of(file_), problem.value());
    path_ = part_of(target_);
  }
  errno = 0;
  if (!seek(offset) || std::fwrite(bytes.data(), 1, bytes.size(), stream_.get()) != bytes.size()) return unwritten(file_, errno);
  return {};
}

bool PartFile::holds(std::uint64_t offset, std::span<const std::byte> bytes) {
  if (!seek(offset)) return false;
  std::array<std::byte, 65536> there;
  while (!bytes.empty()) {
    const std::size_t count = std::min(bytes.size(), there.size());
    if (std::fread(there.data(), 1, count, stream_.get()) != count || std::memcmp(there.data(), bytes.data(), count) != 0) return false;
    bytes = bytes.subspan(count);
  }
  return true;
}

Result<void> PartFile::finish(std::uint64_t size) {
  errno = 0;
  const int closed = std::fclose(stream_.release());
  int code = closed == 0 ? 0 : errno != 0 ? errno : EIO;
  std::error_code problem, ignored;
  if (code == 0 && fs::file_size(path_, problem) != size) fs::resize_file(path_, size, problem);
  if (code == 0 && !problem && path_ != target_) fs::rename(path_, target_, problem);
  if (problem) code = problem.value();
  if (code == 0) return {};
  if (!kept_) fs::remove(path_, ignored);
  return unwritten(file_, code);
}

}  // namespace weft
