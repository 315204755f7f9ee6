// A fork costs about a millisecond, and a child in which other threads do not run may still ask for memory (glibc sees to its locks), which
// is all that readers do. It ends by _exit: no destructor of the parent's runs twice.
#include "engine/mesh/apart.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <string_view>

namespace weft::parts {
namespace {

constexpr char kDone = 'd', kFailed = 'f', kMemory = 'm';

std::size_t own_bytes() {   // of address space
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

void limit(int what, rlim_t most) {
  rlimit bound{};
  if (getrlimit(static_cast<__rlimit_resource>(what), &bound) != 0) return;
  bound.rlim_cur = std::min(most, bound.rlim_max);
  setrlimit(static_cast<__rlimit_resource>(what), &bound);
}

bool send(int pipe, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = write(pipe, bytes.data(), bytes.size());
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

[[noreturn]] void be_child(int pipe, Bounds bounds, [[maybe_unused]] std::size_t own,
                           const std::function<Result<std::string>()>& work) {
  pipe = fcntl(pipe, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);   // not one of those that are given away below
  sigset_t nobody;   // the caller's thread may hear no signals, and no bound would end this
  sigemptyset(&nobody);
  sigprocmask(SIG_SETMASK, &nobody, nullptr);
  for (const int signal : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGXCPU, SIGALRM, SIGPIPE, SIGTERM, SIGINT})
    std::signal(signal, SIG_DFL);
  const int nowhere = open("/dev/null", O_RDWR);   // readers print what they think of a file
  for (const int shown : {STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, shown);
#if !defined(WEFT_SANITIZED) && !defined(__SANITIZE_ADDRESS__)   // which needs terabytes, and pipes to look at types
  limit(RLIMIT_AS, own + bounds.memory);
  limit(RLIMIT_NOFILE, 0);
#endif
  limit(RLIMIT_CPU, bounds.seconds);
  alarm(6 * bounds.seconds);   // on a busy machine, and where it waits for what another thread held
  limit(RLIMIT_CORE, 0);
  try {
    const Result<std::string> done = work();
    const bool is_memory = !done && done.kind() == ErrorKind::memory;
    const std::string_view bytes = done ? *done : done.error();
    const auto size = static_cast<std::uint64_t>(bytes.size());
    std::string head(1, done ? kDone : is_memory ? kMemory : kFailed);
    head.append(reinterpret_cast<const char*>(&size), sizeof size);
    send(pipe, head) && send(pipe, bytes);
  } catch (...) {
    send(pipe, std::string_view(&kMemory, 1));
  }
  _exit(0);
}

constexpr std::size_t kHead = 1 + sizeof(std::uint64_t);

// How many bytes come after the head.
std::uint64_t announced(const std::string& bytes) {
  std::uint64_t size = 0;
  std::memcpy(&size, bytes.data() + 1, sizeof size);
  return size;
}

// All that was announced, or what comes until the other end is closed: a process that another thread forks meanwhile may keep it open.
std::string received(int pipe) {
  std::string bytes;
  char some[1 << 16];
  for (;;) {
    const ssize_t count = read(pipe, some, sizeof some);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return bytes;
    bytes.append(some, static_cast<std::size_t>(count));
    if (bytes.size() >= kHead && bytes.size() - kHead >= announced(bytes)) return bytes;
  }
}

// Closes and waits, whatever happens.
struct Child {
  pid_t process;
  int pipe, status = 0;
  void end() {
    if (pipe >= 0) close(pipe);
    pipe = -1;
    while (process > 0 && waitpid(process, &status, 0) < 0 && errno == EINTR) {}
    process = 0;
  }
  ~Child() { end(); }
};

}  // namespace

Result<std::string> apart(const char* who, Bounds bounds, const std::function<Result<std::string>()>& work) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return fail(ErrorKind::other, who, " cannot be given a process of its own: ", std::strerror(errno));
  const std::size_t own = own_bytes();
  const pid_t process = fork();
  if (process == 0) {
    close(ends[0]);
    be_child(ends[1], bounds, own, work);
  }
  const int why = errno;
  close(ends[1]);
  Child child{process, ends[0]};
  if (process < 0) return fail(ErrorKind::other, who, " cannot be given a process of its own: ", std::strerror(why));
  std::string bytes = received(ends[0]);
  child.end();
  if (bytes.starts_with(kMemory)) return fail(who, " needs more than ", bounds.memory >> 20, " MiB of memory for it");
  if (bytes.size() < kHead || bytes.size() - kHead != announced(bytes)) {
    if (WIFSIGNALED(child.status) && (WTERMSIG(child.status) == SIGXCPU || WTERMSIG(child.status) == SIGALRM))
      return fail(who, " did not come to an end in ", bounds.seconds, " s");
    return fail(who, " crashed on it", WIFSIGNALED(child.status) ? std::string(": ") + strsignal(WTERMSIG(child.status)) : std::string());
  }
  const bool is_done = bytes.front() == kDone;
  bytes.erase(0, kHead);
  if (!is_done) return Error{std::move(bytes)};
  return bytes;
}

}  // namespace weft::parts
