// A file that is written piece by piece, over hours perhaps, and has its name only when it is whole.
//
// Until then it lies beside its place as a part, as with write_file (compute/file.h). Pieces may be written in any order, and more than
// once. A part that is kept has the one name NAME.part, under which a program that was killed finds it again and goes on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "compute/result.h"

namespace weft {

/// NAME.part: of a file whose part is kept.
std::filesystem::path part_of(const std::filesystem::path& file);

class PartFile {
 public:
  /// A part without a byte. `kept`: it is NAME.part, replaces one that is there, and stays if it is not finished. Errors: as write_file's.
  static Result<PartFile> create(const std::filesystem::path& file, bool kept);
  /// The part that was kept of `file`, or, where there is none, the finished file, which becomes the part again with the first write.
  /// Errors: neither is there as a regular file; it cannot be opened.
  static Result<PartFile> reopen(const std::filesystem::path& file);
  PartFile(PartFile&&) = default;
  PartFile& operator=(PartFile&&) = delete;
  /// Removes the part if it is neither finished nor kept.
  ~PartFile();

  /// Errors: the system's reason, as "No space left on device".
  Result<void> write(std::uint64_t offset, std::span<const std::byte> bytes);
  /// Whether these bytes are there; false, too, beyond the end and where they cannot be read.
  bool holds(std::uint64_t offset, std::span<const std::byte> bytes);
  /// Gives the part, of `size` bytes, its name; what is beyond them is cut off. Nothing can be written then. Errors: as write_file's.
  Result<void> finish(std::uint64_t size);

 private:
  struct Close {
    void operator()(std::FILE* stream) const { std::fclose(stream); }
  };
  PartFile(std::filesystem::path file, std::filesystem::path target, std::filesystem::path path, std::FILE* stream, bool kept);
  bool seek(std::uint64_t offset);

  std::filesystem::path file_, target_, path_;   // as it was named; what that leads to; what is written
  std::unique_ptr<std::FILE, Close> stream_;
  bool kept_;
};

}  // namespace weft
