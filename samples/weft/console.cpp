// Sentences, interrupts and a progress bar.
#include "samples/weft/console.h"

#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "samples/weft/commands.h"

namespace weft::command {

namespace {

// A signal handler can reach nothing but static storage.
volatile std::sig_atomic_t g_signal = 0;   // the first that came

void on_signal(int signal) {
  if (g_signal == 0) g_signal = signal;
  if (signal == SIGINT) std::signal(SIGINT, SIG_DFL);
}

// Whether what is written to stderr may move a cursor. NO_COLOR (no-color.org) asks for plain text.
bool shows_bars() {
  const char *terminal = std::getenv("TERM"), *plain = std::getenv("NO_COLOR");
  const bool moves = terminal && *terminal && std::string_view(terminal) != "dumb";
  return isatty(STDERR_FILENO) != 0 && moves && !(plain && *plain);
}

}  // namespace

void complain(std::string_view sentences) {
  std::fprintf(stderr, "%.*s\n", static_cast<int>(sentences.size()), sentences.data());
}

Exit failed(std::string_view sentence) {
  complain(sentence);
  return kFailed;
}

void expect_full_disks() {
#ifdef SIGXFSZ
  std::signal(SIGXFSZ, SIG_IGN);
#endif
}

void listen_for_interrupts() {
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1})
    if (std::signal(signal, SIG_IGN) != SIG_IGN) std::signal(signal, on_signal);
}
bool interrupted() { return g_signal != 0; }

Exit stopped(std::string_view sentence) {
  const bool asked = g_signal == SIGTERM || g_signal == SIGUSR1;
  const std::string why = !asked ? "Interrupted" : g_signal == SIGTERM ? "Stopped by SIGTERM" : "Stopped by SIGUSR1";
  complain(why + std::string(sentence));
  return asked ? kPutBack : kInterrupted;
}

Progress::Progress(std::string_view what, std::uint32_t total, std::string_view unit)
    : what_(what), unit_(unit), total_(total), terminal_(shows_bars()) {
  if (terminal_) draw();
}

Progress::~Progress() {
  if (!terminal_) return;
  draw();
  std::fputc('\n', stderr);
}

void Progress::step(std::uint32_t by) {
  done_ += by;
  if (terminal_) {
    constexpr auto kPause = std::chrono::milliseconds(100);
    if (Clock::now() - drawn_ >= kPause) draw();
  } else if (total_ > 0 && std::uint64_t{done_} * 4 / total_ > quarters_) {
    quarters_ = static_cast<std::uint32_t>(std::uint64_t{done_} * 4 / total_);
    std::fprintf(stderr, "%s: %u of %u %s\n", what_.c_str(), done_, total_, unit_.c_str());
  }
}

void Progress::draw() {
  constexpr int kWidth = 30;
  drawn_ = Clock::now();
  const int filled = total_ == 0 ? kWidth : static_cast<int>(std::uint64_t{done_} * kWidth / total_);
  const double seconds = std::chrono::duration<double>(drawn_ - start_).count();
  const double left = done_ == 0 ? 0 : seconds / done_ * (total_ - done_);
  std::fprintf(stderr, "\r%s [%.*s%*s] %u/%u, %.0f s left \033[K", what_.c_str(), filled, "##############################", kWidth - filled,
               "", done_, total_, left);
  std::fflush(stderr);
}

}  // namespace weft::command
