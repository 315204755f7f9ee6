// What a command says while it works, and how it hears that it is to stop.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include "samples/weft/commands.h"

namespace weft::command {

/// One or more sentences to stderr, a line each.
void complain(std::string_view sentences);

/// From now on a file at the system's limit of size is an error like a full disk, and does not end the program.
void expect_full_disks();

/// From now on the first ctrl-C only sets interrupted(); the second ends the program. SIGTERM and SIGUSR1, by which queues ask for the
/// machine, set it too, however often they come. A signal that the program was started to ignore, as shells start what runs in the
/// background, is ignored still.
void listen_for_interrupts();
bool interrupted();

/// After an interruption: complains "Interrupted" or "Stopped by SIGTERM", and how the sentence goes on. Returns kInterrupted or kPutBack.
Exit stopped(std::string_view sentence);

/// A bar on stderr where that is a terminal that can move its cursor, and a few plain lines where it is not or NO_COLOR is set. The
/// time left is estimated from what is done.
class Progress {
 public:
  Progress(std::string_view what, std::uint32_t total, std::string_view unit = "frames");
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void step(std::uint32_t by = 1);

 private:
  void draw();

  using Clock = std::chrono::steady_clock;
  std::string what_, unit_;
  std::uint32_t total_, done_ = 0, quarters_ = 0;
  bool terminal_;
  Clock::time_point start_ = Clock::now(), drawn_ = start_;
};

}  // namespace weft::command
