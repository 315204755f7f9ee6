// write_file: all of a file or nothing, whatever happens on the way.
#include "compute/file.h"
#include "compute/part_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <iterator>
#include <string>
#include <thread>

#include "tests/support/mesh_files.h"

namespace weft {
namespace {

using test::Folder;
using test::slurp;

Result<void> write(const std::filesystem::path& file, const std::string& text) { return write_file(file, std::as_bytes(std::span(text))); }

std::ptrdiff_t entries(const std::filesystem::path& folder) { return std::distance(std::filesystem::directory_iterator(folder), {}); }

/// No file of this process may grow beyond `bytes`: to it the disk is full.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit small{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
  }
  ~FullDisk() { setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_{};
};

TEST(File, a_file_is_made_and_replaced_and_nothing_else_is_left) {
  const Folder folder;
  ASSERT_TRUE(write(folder / "text", "first, and longer"));
  ASSERT_TRUE(write(folder / "text", "second"));
  EXPECT_EQ(slurp(folder / "text"), "second");
  EXPECT_EQ(entries(folder / ""), 1);
}

TEST(File, a_full_disk_is_a_sentence_and_what_was_there_stays) {
  const Folder folder;
  ASSERT_TRUE(write(folder / "text", "before"));
  for (const std::size_t size : {5'000, 1'000'000}) {   // within the stream's buffer, so that closing fails, and beyond it
    const FullDisk disk(4096);
    const Result<void> written = write(folder / "text", std::string(size, 'x'));
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error(), (folder / "text").string() + " cannot be written: File too large");
  }
  EXPECT_EQ(slurp(folder / "text"), "before");
  EXPECT_EQ(entries(folder / ""), 1);
}

// The system's signal for a file that outgrows its limit kills in the middle of a write.
TEST(File, a_program_that_is_killed_while_it_writes_leaves_what_was_there_and_the_next_write_works) {
  const Folder folder;
  ASSERT_TRUE(write(folder / "text", "before"));
  const pid_t child = fork();
  if (child == 0) {
    const rlimit small{65'536, 65'536}, no_core{0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    setrlimit(RLIMIT_FSIZE, &small);
    std::signal(SIGXFSZ, SIG_DFL);
    (void)write(folder / "text", std::string(1'000'000, 'x'));
    _exit(0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(slurp(folder / "text"), "before");
  EXPECT_EQ(entries(folder / ""), 2) << "and the part that was written";
  ASSERT_TRUE(write(folder / "text", "after"));
  EXPECT_EQ(slurp(folder / "text"), "after");
}

TEST(File, a_part_has_its_name_when_it_is_whole_and_a_link_stays_a_link) {
  const Folder folder;
  folder.write("there", "old, and longer");
  std::filesystem::create_symlink("there", folder / "link");
  const auto put = [](PartFile& part, std::uint64_t offset, const std::string& text) {
    return part.write(offset, std::as_bytes(std::span(text)));
  };
  {
    Result<PartFile> part = PartFile::create(folder / "link", false);
    ASSERT_TRUE(part) << part.error();
    ASSERT_TRUE(put(*part, 4, "later"));
    EXPECT_EQ(entries(folder / ""), 3);
  }
  EXPECT_EQ(entries(folder / ""), 2) << "the part is gone";
  folder.write("there.part", "of an earlier run");
  Result<PartFile> part = PartFile::create(folder / "link", true);
  ASSERT_TRUE(part) << part.error();
  ASSERT_TRUE(put(*part, 4, "later, cut off"));
  ASSERT_TRUE(put(*part, 0, "new "));
  EXPECT_EQ(slurp(folder / "link"), "old, and longer");
  ASSERT_TRUE(part->finish(9));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(slurp(folder / "there"), "new later");
  EXPECT_EQ(entries(folder / ""), 2);
}

TEST(File, a_part_that_was_kept_is_found_again_and_one_in_the_wrong_place_is_a_sentence) {
  const Folder folder;
  EXPECT_EQ(PartFile::reopen(folder / "file").error(), (folder / "file.part").string() + " is not there");
  { const Result<PartFile> part = PartFile::create(folder / "file", true); }
  EXPECT_TRUE(std::filesystem::exists(folder / "file.part"));
  EXPECT_TRUE(PartFile::reopen(folder / "file"));
  EXPECT_FALSE(std::filesystem::exists(folder / "file"));
  std::filesystem::remove(folder / "file.part");
  std::filesystem::create_directory(folder / "file.part");
  EXPECT_EQ(PartFile::create(folder / "file", true).error(), (folder / "file.part").string() + " cannot be written: File exists");
  std::filesystem::create_directory(folder / "taken");
  EXPECT_EQ(PartFile::create(folder / "taken", false).error(), (folder / "taken").string() + " cannot be written: it is a folder");
}

TEST(File, a_folder_in_which_nothing_can_be_made_is_a_sentence) {
  const Folder folder;
  EXPECT_EQ(write(folder / "missing/text", "x").error(),
            (folder / "missing/text").string() + " cannot be written: No such file or directory");
  EXPECT_FALSE(write("/proc/weft", "x")) << "which holds for root too";
}

TEST(File, what_is_no_regular_file_is_not_replaced) {
  const Folder folder;
  std::filesystem::create_directory(folder / "folder");
  EXPECT_NE(write(folder / "folder", "x").error().find("it is a folder"), std::string::npos);
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_NE(write(folder / "pipe", "x").error().find("it is no regular file"), std::string::npos);
  EXPECT_TRUE(std::filesystem::is_fifo(folder / "pipe"));
}

TEST(File, a_link_stays_a_link) {
  const Folder folder;
  folder.write("there", "old");
  std::filesystem::create_symlink("there", folder / "link");
  ASSERT_TRUE(write(folder / "link", "newer"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(slurp(folder / "there"), "newer");
}

TEST(File, a_link_that_is_to_be_replaced_is_and_what_it_leads_to_is_not_touched) {
  const Folder folder;
  folder.write("there", "old");
  for (const char* target : {"there", "nowhere", "link", "/proc"}) {
    std::filesystem::create_symlink(target, folder / "link");
    const auto bytes = std::as_bytes(std::span("x", 1));
    ASSERT_TRUE(write_file(folder / "link", bytes, Link::replace)) << target;
    EXPECT_TRUE(std::filesystem::is_regular_file(std::filesystem::symlink_status(folder / "link"))) << target;
    EXPECT_EQ(slurp(folder / "link"), "x") << target;
    std::filesystem::remove(folder / "link");
  }
  EXPECT_EQ(slurp(folder / "there"), "old");
  EXPECT_EQ(entries(folder / ""), 1);
}

TEST(File, a_probe_says_what_a_write_would_say_and_leaves_nothing) {
  const Folder folder;
  folder.write("there", "old");
  std::filesystem::create_directory(folder / "folder");
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  std::filesystem::create_symlink("missing/text", folder / "link");
  for (const char* name : {"new", "there", "folder", "pipe", "missing/text", "link", "there/text"}) {
    const Result<void> probed = probe_file(folder / name);
    EXPECT_EQ(entries(folder / ""), 4) << name;
    EXPECT_EQ(slurp(folder / "there"), "old") << name;
    std::error_code none;
    const bool was_there = std::filesystem::exists(std::filesystem::symlink_status(folder / name, none));
    const Result<void> written = write(folder / name, std::string(name) == "there" ? "old" : "x");
    EXPECT_EQ(bool(probed), bool(written)) << name;
    if (!probed && !written) { EXPECT_EQ(probed.error(), written.error()) << name; }
    if (!was_there) std::filesystem::remove(folder / name, none);
  }
  const FullDisk disk(2048);
  EXPECT_EQ(probe_file(folder / "new").error(), (folder / "new").string() + " cannot be written: File too large");
}

TEST(File, of_two_that_write_at_once_one_wins_whole) {
  const Folder folder;
  const std::string texts[] = {std::string(300'000, 'a'), std::string(200'000, 'b')};
  for (int round = 0; round < 20; ++round) {
    std::thread other([&] { EXPECT_TRUE(write(folder / "text", texts[0])); });
    EXPECT_TRUE(write(folder / "text", texts[1]));
    other.join();
    const std::string left = slurp(folder / "text");
    EXPECT_TRUE(left == texts[0] || left == texts[1]);
  }
  EXPECT_EQ(entries(folder / ""), 1);
}

}  // namespace
}  // namespace weft
