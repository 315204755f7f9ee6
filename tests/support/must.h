// A value, or the end of the test.
#pragma once

#include <gtest/gtest.h>

#include <stdexcept>
#include <utility>

#include "compute/result.h"

namespace weft {

/// The value; without one the test fails with the sentence.
template <class T>
T must(Result<T> result) {
  EXPECT_TRUE(result) << result.error();
  if (!result) throw std::runtime_error(result.error());   // ends the test; GoogleTest reports it
  return std::move(*result);
}
inline void must(Result<void> result) {
  if (!result) throw std::runtime_error(result.error());
}

}  // namespace weft
