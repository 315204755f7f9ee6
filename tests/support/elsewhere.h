// Code beneath Weft, in which memory is not scarce (scarce_memory.h).
#pragma once

#include <utility>

namespace weft::test {

/// While one lives, its thread is in a driver, or in a test's own wrapper of one.
class Elsewhere {
 public:
  Elsewhere() { ++depth; }
  ~Elsewhere() { --depth; }
  Elsewhere(const Elsewhere&) = delete;
  Elsewhere& operator=(const Elsewhere&) = delete;

  static inline thread_local int depth = 0;
};

/// While one lives there, its thread is in Weft again.
class Weft {
 public:
  Weft() { std::swap(depth_, Elsewhere::depth); }
  ~Weft() { std::swap(depth_, Elsewhere::depth); }
  Weft(const Weft&) = delete;
  Weft& operator=(const Weft&) = delete;

 private:
  int depth_ = 0;
};

}  // namespace weft::test
