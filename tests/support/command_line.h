// The program `weft`, run as its users run it: what it is given, and what it leaves.
#pragma once

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#ifndef WEFT_BINARIES
#define WEFT_BINARIES "bin"
#endif

namespace weft {

namespace fs = std::filesystem;

inline std::string read(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

struct Outcome {
  int exit = -1;
  std::string out, error;
};

class CommandLine : public testing::Test {
 protected:
  /// "NAME=VALUE" for the next program.
  std::vector<std::string> environment;
  /// No file of the next program may grow beyond this: to it the disk is full. 0: as large as it likes.
  rlim_t disk_bytes = 0;
  /// The next program is started as shells start what runs in the background: deaf to ctrl-C,
  /// and to what asks a program to stop.
  bool deaf = false;
  fs::path folder = fs::temp_directory_path() / ("weft_command_line_" + std::to_string(std::random_device{}()));

  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }

  fs::path write(const char* name, const std::string& text) {
    std::ofstream(folder / name, std::ios::binary) << text;
    return folder / name;
  }

  pid_t spawn(const std::vector<std::string>& arguments) {
    const pid_t child = fork();
    if (child != 0) return child;
    const auto redirect = [&](const char* name, int to) { dup2(fileno(std::fopen((folder / name).c_str(), "wb")), to); };
    redirect("stdout", STDOUT_FILENO);
    redirect("stderr", STDERR_FILENO);
    for (std::string& variable : environment) putenv(variable.data());
    // The tests themselves may run where they are ignored.
    for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) std::signal(signal, deaf ? SIG_IGN : SIG_DFL);
    if (const rlimit full{disk_bytes, disk_bytes}; disk_bytes > 0) setrlimit(RLIMIT_FSIZE, &full);
    std::vector<char*> pointers;
    std::string program = WEFT_BINARIES "/weft";
    pointers.push_back(program.data());
    std::vector<std::string> copies = arguments;
    for (std::string& copy : copies) pointers.push_back(copy.data());
    pointers.push_back(nullptr);
    execv(program.c_str(), pointers.data());
    _exit(127);
  }

  Outcome wait(pid_t child) {
    int status = 0;
    waitpid(child, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), read(folder / "stdout"), read(folder / "stderr")};
  }

  Outcome weft(const std::vector<std::string>& arguments) { return wait(spawn(arguments)); }

  std::string out(const char* name = "out") { return (folder / name).string(); }
};

inline constexpr const char* kSheet =
    R"({"name": "sheet", "contacts": false, "cloths": [{"grid": {"cells": [8, 8]}, "anchors": [{"corners": ["low_low"]}]}], )"
    R"("colliders": [{"centre": [0, -1, 0]}]})";

}  // namespace weft
