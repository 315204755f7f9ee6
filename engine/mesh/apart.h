// Work in a process of its own, for other people's readers of anyone's files. Where one of them crashes, runs on or takes more memory
// than it may, a sentence says so and nothing else has happened. Internal.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "compute/result.h"

namespace weft::parts {

struct Bounds {
  std::size_t memory;   // bytes, beyond those that this process has
  unsigned seconds;     // of one core
};

/// What `work` returns, as the bytes that a forked process sent back. It sees what this one has, changes nothing here, and opens no file.
/// `who` begins the sentences about it. Errors: those of `work`; that it did not come to an end within its bounds.
Result<std::string> apart(const char* who, Bounds bounds, const std::function<Result<std::string>()>& work);

}  // namespace weft::parts
