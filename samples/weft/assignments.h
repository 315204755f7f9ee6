// --set PATH=X, as every command that takes a scene has it.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

#include "engine/scene.h"

namespace weft::command {

/// One value a flag, as often as wanted: "--set a=1 b=2" must not swallow what follows.
void add_set(CLI::App& command, std::vector<std::string>& texts);

/// `path.to.value=X`; the path is checked where it is followed. Returns what is wrong, or nothing.
std::string split(const std::vector<std::string>& texts, std::vector<Assignment>& assignments);

}  // namespace weft::command
