// Work on long lists in two threads. Internal.
#pragma once

#include <cstddef>
#include <system_error>
#include <thread>

namespace weft::caching {

/// Calls `work(first, last)` for both halves of 0 ... count, the second in a thread of its own where the list is long. `work` must not throw.
template <class Work>
void in_halves(std::size_t count, const Work& work) {
  constexpr std::size_t kLong = 4096;   // below, a thread takes longer to start
  const std::size_t half = count / 2;
  if (count < kLong || std::thread::hardware_concurrency() < 2) return work(0, count);
  std::jthread second;
  try {
    second = std::jthread([&] { work(half, count); });
  } catch (const std::system_error&) {   // there is none to be had
    return work(0, count);
  }
  work(0, half);
}

}  // namespace weft::caching
