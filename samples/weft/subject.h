// What a command works on: a scene file, or a bare mesh with the scene that a bare mesh gets.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/mesh.h"
#include "engine/scene.h"
#include "engine/simulation.h"
#include "samples/weft/commands.h"

namespace weft::command {

/// By its ending: those that can be read, and others that a mesh may have.
bool is_mesh(const std::filesystem::path& file);

/// Loads a scene, or the default scene of a mesh, and applies assignments. Every error is the input's.
Result<Scene> load_subject(const std::filesystem::path& file, std::span<const Assignment> assignments,
                           BufferFiles buffer_files = BufferFiles::below_its_folder);

/// The keys of an appearance that name a texture, and the textures.
std::vector<std::pair<std::string, std::string>> maps_of(const Appearance& looks);

/// Textures and meshes that cannot be read, one sentence each with its JSON path.
std::vector<std::string> file_faults(const Scene& scene);

/// That cloth crosses cloth or a mesh collider as it starts, in a scene whose contacts are to keep them apart; empty where it does not.
/// It takes a third of the time that creating a simulation does, which is why the library leaves it to its callers.
std::string crossing_note(const Scene& scene, const CookedFabric& fabric);

/// A simulation, or the exit code after the complaint: a scene that cannot be cooked is bad input, the rest is the machine.
struct Started {
  std::unique_ptr<Simulation> simulation;
  Exit exit = kDone;
};
Started start(const compute::Device& device, const Scene& scene, bool timings);

}  // namespace weft::command
