// What a command is going to write, looked at before it works: hours of frames are not to end at a folder that cannot be written, nor a
// texture to become the picture of the cloth that has it.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "engine/scene.h"
#include "samples/weft/commands.h"

namespace weft::command {

/// A file that a command reads, and what names it: "cloths[0].mesh".
struct Input {
  std::filesystem::path file;
  std::string as;
};

/// All files of a scene: its own, `file`; meshes with the buffers of a glTF; textures; the curves of "method": "auto".
std::vector<Input> inputs_of(const std::filesystem::path& file, const Scene& scene);

/// Makes the folder of --out, and finds out whether all of `names` can be written there and none of them is, by whatever path or link, a
/// file that is read. Complains about what it finds: bad input where something would be overwritten, a failure where nothing can be
/// written.
Exit prepare_outputs(const std::filesystem::path& folder, std::span<const std::string> names, std::span<const Input> inputs);

}  // namespace weft::command
