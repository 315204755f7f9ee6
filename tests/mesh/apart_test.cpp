// Whatever work in a process of its own does, the caller goes on with a sentence.
#include "engine/mesh/apart.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <csignal>
#include <fstream>
#include <vector>

namespace weft {
namespace {

using parts::apart;
using parts::Bounds;

constexpr Bounds kBounds{std::size_t{64} << 20, 1};

TEST(Apart, what_it_returns_comes_back_however_long) {
  const std::string long_one(3'000'001, '\0');
  const auto done = apart("a reader", kBounds, [&]() -> Result<std::string> { return long_one + "end"; });
  ASSERT_TRUE(done) << done.error();
  EXPECT_EQ(*done, long_one + "end");
  const auto nothing = apart("a reader", kBounds, []() -> Result<std::string> { return std::string(); });
  ASSERT_TRUE(nothing) << nothing.error();
  EXPECT_EQ(*nothing, "");
}

TEST(Apart, a_sentence_comes_back_as_one) {
  const auto refused = apart("a reader", kBounds, []() -> Result<std::string> { return fail("line ", 3, " is wrong"); });
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error(), "line 3 is wrong");
}

TEST(Apart, a_crash_an_endless_loop_and_greed_are_sentences) {
  const auto ends = [](const std::function<void()>& badly) {
    return apart("a reader", kBounds, [&]() -> Result<std::string> {
             badly();
             return std::string("done");
           }).why().message;
  };
  EXPECT_EQ(ends([] { std::raise(SIGKILL); }), "a reader crashed on it: Killed");
  EXPECT_EQ(ends([] { std::raise(SIGABRT); }).substr(0, 22), "a reader crashed on it");
  EXPECT_EQ(ends([] { _exit(3); }), "a reader crashed on it");
  EXPECT_EQ(ends([] { throw std::bad_alloc(); }), "a reader needs more than 64 MiB of memory for it");
  EXPECT_EQ(ends([] { for (volatile bool runs = true; runs;) {} }), "a reader did not come to an end in 1 s");
#ifndef WEFT_SANITIZED
  EXPECT_EQ(ends([] { std::vector<char> much(std::size_t{1} << 30); }), "a reader needs more than 64 MiB of memory for it");
#endif
}

TEST(Apart, it_changes_nothing_here_and_opens_no_file) {
  int number = 1;
  const auto done = apart("a reader", kBounds, [&]() -> Result<std::string> {
    number = 2;
    return std::string(std::ifstream(__FILE__) || std::ifstream("/proc/self/statm") ? "open" : "closed");
  });
  ASSERT_TRUE(done) << done.error();
#ifndef WEFT_SANITIZED   // the sanitizers open pipes
  EXPECT_EQ(*done, "closed");
#endif
  EXPECT_EQ(number, 1);
}

// Threads that leave signals to others, and daemons.
TEST(Apart, it_is_bounded_and_heard_where_signals_are_blocked_and_streams_are_closed) {
  sigset_t all, before;
  sigfillset(&all);
  ASSERT_EQ(pthread_sigmask(SIG_SETMASK, &all, &before), 0);
  const int kept[] = {dup(STDIN_FILENO), dup(STDOUT_FILENO), dup(STDERR_FILENO)};
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) close(stream);
  const auto done = apart("a reader", kBounds, []() -> Result<std::string> { return std::string("heard"); });
  const auto endless = apart("a reader", kBounds, []() -> Result<std::string> {
    for (volatile bool runs = true; runs;) {}
    return std::string();
  });
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    dup2(kept[stream], stream);
    close(kept[stream]);
  }
  ASSERT_EQ(pthread_sigmask(SIG_SETMASK, &before, nullptr), 0);
  ASSERT_TRUE(done) << done.error();
  EXPECT_EQ(*done, "heard");
  EXPECT_EQ(endless.error(), "a reader did not come to an end in 1 s");
}

}  // namespace
}  // namespace weft
