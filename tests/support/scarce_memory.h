// Memory that runs out at a chosen allocation: `operator new` of the whole program, which throws std::bad_alloc when a test says so.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <exception>
#include <optional>
#include <string>

#include "compute/result.h"

namespace weft::test {

/// While one lives, the `at`-th allocation (from 1) of its thread fails, or that and all that follow. Those of a Vulkan driver and of
/// layers never fail: what these do then is not Weft's.
class ScarceMemory {
 public:
  enum class Lasts { once, for_good };
  ScarceMemory(long at, Lasts lasts);
  ~ScarceMemory();
  ScarceMemory(const ScarceMemory&) = delete;
  ScarceMemory& operator=(const ScarceMemory&) = delete;

  long allocations() const;   // so far
  bool failed() const;        // one of them
};

/// Does `work` with every of the first hundred allocations failing in turn, and with at most `most` of those that follow, first alone and
/// then with all after it, until it needs no more. A failing call must say so in a sentence, or have done without that memory.
/// `prepare` makes what `work` gets before each; `after` has it last, with memory again, and whether the work was done.
template <class Prepare, class Work, class After>
void at_every_allocation(long most, Prepare&& prepare, Work&& work, After&& after) {
  long total = 0;
  const auto attempt = [&](long at, ScarceMemory::Lasts lasts) {
    auto prepared = prepare();
    std::optional<Result<void>> done;
    std::string thrown;
    bool failed = false;
    {
      ScarceMemory scarce(at, lasts);
      try {
        done.emplace(work(prepared));
      } catch (const std::exception& problem) {
        thrown = problem.what();
      }
      failed = scarce.failed();
      total = scarce.allocations();
    }
    const std::string where = "allocation " + std::to_string(at) + (lasts == ScarceMemory::Lasts::once ? " alone" : " and all after it");
    EXPECT_EQ(thrown, "") << where << ": an exception";
    if (!done) return;
    if (!*done) {
      EXPECT_TRUE(failed) << where << ": " << done->error();
      EXPECT_FALSE(done->error().empty()) << where << ": no sentence";
      EXPECT_EQ(done->kind(), ErrorKind::memory) << where << ": " << done->error();
    }
    SCOPED_TRACE(where);
    after(prepared, bool(*done));
  };
  attempt(0, ScarceMemory::Lasts::once);   // none fails
  const long all = total, step = std::max(1L, (all - 100) / std::max(1L, most));
  for (long at = 1; at <= all && !testing::Test::HasFailure(); at += at < 100 ? 1 : step)
    for (const auto lasts : {ScarceMemory::Lasts::once, ScarceMemory::Lasts::for_good}) attempt(at, lasts);
}

}  // namespace weft::test
