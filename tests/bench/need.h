// A value, or the end of the program.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <type_traits>
#include <utility>

#include "compute/result.h"

namespace weft::bench {

template <class T>
T need(Result<T> result) {
  if (result) {
    if constexpr (std::is_void_v<T>) return;
    else return std::move(*result);
  }
  std::fprintf(stderr, "weft_bench: %s\n", result.error().c_str());
  std::exit(1);
}

}  // namespace weft::bench
