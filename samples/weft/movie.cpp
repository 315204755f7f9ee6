// The pictures go into ffmpeg's standard input one after another, so that their names and what else is in the folder do not matter.
#include "samples/weft/movie.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "compute/part_file.h"
#include "compute/text.h"

extern char** environ;

namespace weft::command {

namespace {

namespace fs = std::filesystem;

std::string reason(int code) { return std::generic_category().message(code); }

// A program with a pipe into its standard input, and no output but its errors.
struct Encoder {
  pid_t child = -1;
  int input = -1;
};

Result<Encoder> spawn(std::vector<std::string> words) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return fail(ErrorKind::other, words[0], " cannot be started: ", reason(errno));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  Encoder encoder{-1, ends[1]};
  const int code = posix_spawnp(&encoder.child, pointers[0], &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[0]);
  if (code == 0) return encoder;
  close(ends[1]);
  return fail(ErrorKind::other, words[0], " cannot be started: ", reason(code));
}

bool write_all(int to, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(to, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace

bool has_ffmpeg() {
  const char* path = std::getenv("PATH");
  std::string_view folders = path ? path : "";
  while (!folders.empty()) {
    const std::string_view folder = folders.substr(0, folders.find(':'));
    folders.remove_prefix(std::min(folder.size() + 1, folders.size()));
    if (access((fs::path(folder) / "ffmpeg").c_str(), X_OK) == 0) return true;
  }
  return false;
}

Result<void> write_movie(const fs::path& file, std::span<const fs::path> pictures, double rate) {
  const fs::path part = part_of(file);
  const Result<Encoder> ffmpeg =
      spawn({"ffmpeg", "-nostdin", "-y", "-loglevel", "error", "-f", "image2pipe", "-c:v", "png", "-framerate", rounded_text(rate, 9), "-i",
             "pipe:0", "-pix_fmt", "yuv420p", "-f", "mp4", part.string()});
  if (!ffmpeg) return ffmpeg.why();
  const auto before = std::signal(SIGPIPE, SIG_IGN);   // an ffmpeg that ends early is told of by its exit code
  std::string fault;
  for (const fs::path& picture : pictures) {
    std::ifstream stream(picture, std::ios::binary);
    if (!stream) fault = picture.string() + ", a picture of the movie, cannot be read";
    if (!stream || !write_all(ffmpeg->input, std::string{std::istreambuf_iterator<char>(stream), {}})) break;
  }
  close(ffmpeg->input);
  int status = 0;
  while (waitpid(ffmpeg->child, &status, 0) < 0 && errno == EINTR) {}
  std::signal(SIGPIPE, before);
  std::error_code problem, ignored;
  const bool good = fault.empty() && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  if (good) fs::rename(part, file, problem);
  if (good && !problem) return {};
  fs::remove(part, ignored);
  if (!fault.empty()) return fail(ErrorKind::other, fault);
  if (problem) return fail(ErrorKind::other, file.string(), " cannot be written: ", problem.message());
  return fail(ErrorKind::other, file.string(), " is not written: ffmpeg ",
              WIFEXITED(status) ? "ended with the code " + std::to_string(WEXITSTATUS(status)) : "was killed");
}

}  // namespace weft::command
