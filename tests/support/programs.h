// Small programs, run as a user runs them.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace weft {

class Programs : public testing::Test {
 protected:
  std::filesystem::path folder = std::filesystem::path(testing::TempDir()) /
                                 ("weft_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));

  void SetUp() override {
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  int run(const std::string& command) const {
    const std::string line = WEFT_BINARIES "/" + command + " >" + file("said") + " 2>&1";
    const int status = std::system(line.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string said() const {
    std::ifstream stream(folder / "said");
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  std::string file(const char* name) const { return std::string("'").append((folder / name).string()).append("'"); }
};

}  // namespace weft
