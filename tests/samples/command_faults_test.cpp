// The program `weft` on a machine that fails: no Vulkan, an old or a lost device, no memory, no disk, ctrl-C. Always a sentence, the
// exit code that README.md states, everything that was made in Vulkan destroyed, and no file half-written.
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/support/command_line.h"

namespace weft {
namespace {

class CommandFaults : public CommandLine {
 protected:
  // The next program finds the loader in `place` first.
  void use_loader(const std::string& place) { environment = {"LD_LIBRARY_PATH=" + place}; }
  void inject(const std::string& fault) {
    environment = {"LD_LIBRARY_PATH=" WEFT_FAULTY_LOADER, "WEFT_FAULT=" + fault, "WEFT_FAULT_REPORT=" + (folder / "report").string()};
  }

  void expect_refusal(const std::string& part) {
    const Outcome outcome = weft({"run", write("sheet.json", kSheet), "--out", out()});
    EXPECT_EQ(outcome.exit, 1);
    EXPECT_NE(outcome.error.find(part), std::string::npos) << outcome.error;
    EXPECT_EQ(std::count(outcome.error.begin(), outcome.error.end(), '\n'), 1) << outcome.error;
  }

  // What the faulty loader counted, as "calls", "failed" and "left".
  std::string reported(const char* key) {
    const std::string text = read(folder / "report");
    const std::string start = std::string(key) + ": ";
    const std::size_t at = text.find(start);
    return at == std::string::npos ? "no report" : text.substr(at + start.size(), text.find('\n', at) - at - start.size());
  }
  long calls() { return std::atol(read(folder / "report").c_str()); }

  // Nothing that is written is cut, and nothing temporary stays.
  void expect_whole_files() {
    if (!fs::exists(folder / "out")) return;
    for (const auto& entry : fs::recursive_directory_iterator(folder / "out")) {
      const std::string name = entry.path().filename().string(), text = read(entry.path());
      EXPECT_EQ(name.find(".part"), std::string::npos) << name;
      if (name.ends_with(".json")) { EXPECT_FALSE(nlohmann::json::parse(text, nullptr, false).is_discarded()) << name; }
      if (name.ends_with(".png")) { EXPECT_NE(text.find("IEND"), std::string::npos) << name; }
      if (name.ends_with(".csv")) { EXPECT_TRUE(text.ends_with('\n')) << name; }
    }
  }
};

TEST_F(CommandFaults, without_a_loader_it_says_what_to_install) {
  // What cannot be loaded stands for what is not there: a linker looks no further.
  for (const char* name : {"libvulkan.so.1", "libvulkan.so"}) write(name, "not a library");
  use_loader(folder);
  expect_refusal("no Vulkan loader (libvulkan.so.1) on this machine: on Debian, apt install libvulkan1");
}

TEST_F(CommandFaults, without_a_driver_it_says_what_to_install) {
  environment = {"VK_DRIVER_FILES=/nonexistent.json", "VK_ICD_FILENAMES=/nonexistent.json"};
  expect_refusal("apt install mesa-vulkan-drivers");
}

TEST_F(CommandFaults, an_old_device_is_named_with_what_it_lacks) {
  inject("old");
  expect_refusal("it has Vulkan 1.0.0, and Weft needs 1.1");
}

TEST_F(CommandFaults, a_device_without_features_gives_the_same_bits_and_draws_no_picture) {
  const std::vector<std::string> call = {"run", write("sheet.json", kSheet), "--frames", "3", "--no-picture", "--out", out()};
  const auto hash = [&] {
    const Outcome outcome = weft(call);
    EXPECT_EQ(outcome.exit, 0) << outcome.error;
    const std::string report = read(folder / "out" / "report.json");
    const std::size_t at = report.find("\"hash\"");
    return at == std::string::npos ? std::string() : report.substr(at, 28);
  };
  const std::string expected = hash();
  EXPECT_EQ(expected.size(), 28u);
  inject("lacking");
  EXPECT_EQ(hash(), expected);
  EXPECT_EQ(reported("left"), "");
  expect_refusal("cannot draw");
  EXPECT_NE(weft({"info"}).out.find("barriers of Vulkan 1.0, frames in order by fences"), std::string::npos);
}

TEST_F(CommandFaults, a_run_that_finds_no_memory_ends_with_a_sentence_and_frees_everything) {
  const std::vector<std::string> call = {"run", write("sheet.json", kSheet), "--frames", "2", "--out", out()};
  inject("memory");
  ASSERT_EQ(weft(call).exit, 0);
  EXPECT_EQ(reported("left"), "");
  const long all = calls();
  ASSERT_GT(all, 100);
  // faults_test.cpp fails at every call of the library in turn; here are those that make an instance and a device, and a few later.
  for (const long at : {0L, 1L, 2L, 3L, 4L, 5L, 6L, 7L, all / 4, all / 2, 3 * all / 4}) {
    fs::remove_all(folder / "out");
    inject("memory@" + std::to_string(at));
    const Outcome outcome = weft(call);
    const std::string where = std::to_string(at) + ", " + reported("failed");
    // Lists of what is optional may be empty, and a wait that fails is repeated.
    const bool optional = where.find("ExtensionProperties") != std::string::npos || where.find("vkWait") != std::string::npos;
    EXPECT_EQ(outcome.exit, optional ? 0 : 1) << where;
    EXPECT_EQ(outcome.error.find("VK_ERROR_OUT_OF_HOST_MEMORY") == std::string::npos, optional) << where << ": " << outcome.error;
    EXPECT_EQ(reported("left"), "") << where;
    expect_whole_files();
  }
}

// A checkpoint that fits and cannot be restored is not the caller's fault.
TEST_F(CommandFaults, a_checkpoint_for_which_there_is_no_memory_is_a_failure_and_no_bad_input) {
  std::vector<std::string> call = {
      "run", write("sheet.json", kSheet), "--frames", "1000000", "--no-picture", "--out", out(), "--checkpoint", "1"};
  const pid_t child = spawn(call);
  const auto file = [&] {
    std::error_code none;
    for (fs::directory_iterator at(folder / "out", none), end; !none && at != end; at.increment(none))
      if (at->path().extension() == ".snapshot") return at->path();
    return fs::path();
  };
  for (int tries = 0; tries < 3000 && file().empty(); ++tries) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  kill(child, SIGKILL);
  ASSERT_EQ(wait(child).exit, -SIGKILL);
  const std::string whole = read(file());
  std::ofstream(file(), std::ios::binary) << "no snapshot";
  inject("memory");
  EXPECT_EQ(weft(call).exit, 2);
  const long before = calls();   // that could fail until then
  std::ofstream(file(), std::ios::binary) << whole;
  inject("memory@" + std::to_string(before));
  const Outcome outcome = weft(call);
  EXPECT_EQ(outcome.exit, 1) << outcome.error;
  EXPECT_NE(outcome.error.find(".snapshot: "), std::string::npos) << outcome.error;
  EXPECT_NE(outcome.error.find("VK_ERROR_OUT_OF_HOST_MEMORY"), std::string::npos) << outcome.error;
  EXPECT_EQ(read(file()), whole) << "for another try";
}

// The last times of passes are read after the last frame.
TEST_F(CommandFaults, a_device_that_is_lost_after_the_last_frame_is_told_too) {
  const std::vector<std::string> call = {"run", write("sheet.json", kSheet), "--frames", "2", "--no-picture", "--out", out()};
  inject("lost");
  ASSERT_EQ(weft(call).exit, 0);
  // What notices a loss, from the end on: the simulation's destructor waits once more and cannot report.
  bool read = false;
  for (long at = calls() - 1; at >= calls() - 4 && !read; --at) {
    inject("lost@" + std::to_string(at));
    const Outcome outcome = weft(call);
    read = reported("failed") == "vkGetQueryPoolResults";
    if (!read) continue;
    EXPECT_EQ(outcome.exit, 1);
    EXPECT_NE(outcome.error.find("VK_ERROR_DEVICE_LOST"), std::string::npos) << outcome.error;
  }
  EXPECT_TRUE(read);
}

TEST_F(CommandFaults, a_lost_device_ends_every_command_with_a_sentence) {
  const std::string sheet = write("sheet.json", kSheet), hung = WEFT_SOURCE_DIR "/assets/scenes/hung.json";
  const std::vector<std::vector<std::string>> commands = {{"run", sheet, "--frames", "3"},
                                                          {"time", sheet, "--frames", "3", "--warm-up", "1"},
                                                          {"accuracy", sheet, "--quick", "--frames", "4", "--reference-cells", "0"},
                                                          {"contacts", hung, "--quick", "--frames", "4"},
                                                          {"harden", sheet, "--quick"},
                                                          {"effects", "--quick"},
                                                          {"implicit", "--quick"}};
  for (std::vector<std::string> call : commands) {
    call.insert(call.end(), {"--out", out()});
    for (const char* at : {"0", "5", "12"}) {
      fs::remove_all(folder / "out");
      inject(std::string("lost@") + at);
      const Outcome outcome = weft(call);
      EXPECT_EQ(outcome.exit, 1) << call[0] << ' ' << at;
      EXPECT_NE(outcome.error.find("VK_ERROR_DEVICE_LOST"), std::string::npos) << call[0] << ' ' << at << ": " << outcome.error;
      EXPECT_EQ(reported("left"), "") << call[0] << ' ' << at;
      expect_whole_files();
    }
  }
}

TEST_F(CommandFaults, a_full_disk_is_a_sentence_and_what_was_there_stays) {
  fs::create_directories(folder / "out");
  std::ofstream(folder / "out/sheet.png") << "before";
  disk_bytes = 8192;   // the picture and the mesh are larger, what is printed is not
  environment = {"XDG_CACHE_HOME=" + (folder / "cache").string()};
  const Outcome outcome = weft({"run", write("sheet.json", kSheet), "--frames", "2", "--out", out()});
  EXPECT_EQ(outcome.exit, 1);
  EXPECT_NE(outcome.error.find("sheet.png cannot be written: File too large\n"), std::string::npos) << outcome.error;
  EXPECT_EQ(read(folder / "out/sheet.png"), "before");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "out"), {}), 1);
}

TEST_F(CommandFaults, a_place_that_cannot_be_written_is_a_sentence) {
  const std::string sheet = write("sheet.json", kSheet);
  for (const std::string& place : {std::string("/proc/weft"), sheet, std::string("/dev/full"), std::string(300, 'x')}) {
    const Outcome outcome = weft({"run", sheet, "--frames", "1", "--out", place});
    EXPECT_EQ(outcome.exit, 1) << place;
    EXPECT_NE(outcome.error.find(place + ": cannot be made a folder"), std::string::npos) << outcome.error;
  }
}

TEST_F(CommandFaults, hard_cases_that_are_not_there_are_bad_input_before_anything_runs) {
  const Outcome empty = weft({"harden", folder.string(), "--out", out()});
  EXPECT_EQ(empty.exit, 2);
  EXPECT_NE(empty.error.find("free_fall.json"), std::string::npos) << empty.error;
  const std::string cases = WEFT_SOURCE_DIR "/assets/scenes/hard", plain = write("plain.md", "no table").string();
  const Outcome unmarked = weft({"harden", cases, "--readme", plain, "--out", out()});
  EXPECT_EQ(unmarked.exit, 2);
  EXPECT_NE(unmarked.error.find("plain.md: has no lines"), std::string::npos) << unmarked.error;
  EXPECT_FALSE(fs::exists(folder / "out/hard_cases.csv"));
}

TEST_F(CommandFaults, what_cannot_be_printed_is_a_failure) {
  if (!fs::exists("/dev/full")) return;
  fs::create_symlink("/dev/full", folder / "stdout");
  const pid_t child = spawn({"check", write("sheet.json", kSheet)});
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_EQ(read(folder / "stderr"), "weft: what was printed could not be written; is the disk full?\n");
}

TEST_F(CommandFaults, ctrl_C_ends_every_command_with_130_whole_files_and_nothing_left) {
  const std::string hung = WEFT_SOURCE_DIR "/assets/scenes/hung.json";
  const std::vector<std::vector<std::string>> commands = {{"run", hung, "--frames", "1000000"},
                                                          {"time", hung, "--frames", "1000000"},
                                                          {"accuracy", hung, "--frames", "1000"},
                                                          {"contacts", hung, "--frames", "1000000"},
                                                          {"harden", hung, "--frames", "100000"},
                                                          {"effects", "--frames", "1000000"},
                                                          {"implicit"}};
  for (std::vector<std::string> call : commands) {
    call.insert(call.end(), {"--out", out()});
    inject("none");
    const pid_t child = spawn(call);
    // Commands listen for it before they make their folder.
    for (int tries = 0; tries < 300 && !fs::exists(out()); ++tries) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    kill(child, SIGINT);
    const Outcome outcome = wait(child);
    EXPECT_EQ(outcome.exit, 130) << call[0] << ": " << outcome.error;
    EXPECT_NE(outcome.error.find("Interrupted"), std::string::npos) << call[0] << ": " << outcome.error;
    EXPECT_EQ(reported("left"), "") << call[0];
    expect_whole_files();
    fs::remove_all(folder / "out");
  }
}

}  // namespace
}  // namespace weft
