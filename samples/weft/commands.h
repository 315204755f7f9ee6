// The commands of `weft`, one source file each. A command prints its own errors, a sentence each, and returns an exit code.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/scene.h"

namespace weft::command {

enum Exit : int {
  kDone = 0,
  kFailed = 1,         // the machine's fault: no device, a full disk
  kBadInput = 2,       // the caller's: a scene, a mesh or a flag
  kInterrupted = 130,  // 128 + SIGINT, as shells count
};

/// Prints an error that is the machine's fault.
Exit failed(std::string_view sentence);

struct RunOptions {
  std::filesystem::path file;   // scene or mesh
  std::filesystem::path out = "out";
  std::optional<std::uint32_t> frames;   // none: the scene's
  std::uint32_t every = 0;      // 0: only the final frame is drawn
  bool picture = true;
  bool movie = false;           // of the pictures of `every`
  bool check = false;           // count crossings of cloth at every frame
  std::uint32_t checkpoint = 0; // frames between snapshots that the run can go on from; 0: none
  bool fresh = false;           // do not go on with what is in `out`
  std::vector<std::filesystem::path> caches;   // animated geometry: engine/cache.h; relative ones lie in `out`
  std::string device;           // as compute::DeviceChoice::name
  BufferFiles buffer_files = BufferFiles::below_its_folder;
  std::vector<Assignment> assignments;
};
Exit run(const RunOptions& options);

struct TimeOptions {
  std::filesystem::path file;
  std::filesystem::path out = "out";
  std::uint32_t frames = 120;
  std::uint32_t warm_up = 30;
  std::string device;
  BufferFiles buffer_files = BufferFiles::below_its_folder;
  std::vector<Assignment> assignments;
};
Exit time(const TimeOptions& options);

struct AccuracyOptions {
  std::filesystem::path file;
  std::filesystem::path out = "out/accuracy";
  bool quick = false;           // a sweep of under a minute
  std::optional<std::uint32_t> frames;   // none: chosen
  std::optional<std::uint32_t> reference_cells;
  std::optional<double> budget_ms;   // print the best setting that fits
  bool fresh = false;           // do not go on with what is in `out`
  bool save = false;            // save the curve for scenes whose solver is "auto"
  std::string device;
  BufferFiles buffer_files = BufferFiles::below_its_folder;
  std::vector<Assignment> assignments;
};
Exit accuracy(const AccuracyOptions& options);

struct ContactOptions {
  std::filesystem::path file;
  std::filesystem::path out = "out/contacts";
  std::uint32_t frames = 120;
  bool quick = false;           // two small sizes only
  bool price = false;           // the scene as it is, with contacts over without, and nothing else
  std::string device;
  std::vector<Assignment> assignments;
};
Exit contacts(const ContactOptions& options);

struct EffectsOptions {
  std::filesystem::path out = "out/effects";
  std::uint32_t size = 100;     // cells along a side of the sheet
  std::uint32_t frames = 60;    // of each side
  bool quick = false;           // a small sheet, and of the pairs each effect with the next one
  std::string device;
};
Exit effects(const EffectsOptions& options);

struct ImplicitOptions {
  std::filesystem::path out = "out";
  bool quick = false;           // four rows a processor instead of 56
  std::string device;
};
Exit implicit(const ImplicitOptions& options);

struct HardenOptions {
  std::filesystem::path file;   // a scene or a mesh, or the folder of the hard cases
  std::filesystem::path out = "out/harden";
  std::optional<std::uint32_t> frames;   // none: the scene's
  double band = 0.02;           // of the cloths' size: how far a perturbation may move their mean
  bool quick = false;
  std::string only;             // of the hard cases those whose name has this part
  std::filesystem::path readme; // whose table of hard cases is replaced; empty: none
  std::string device;
  BufferFiles buffer_files = BufferFiles::below_its_folder;
  std::vector<Assignment> assignments;
};
Exit harden(const HardenOptions& options);

Exit info();
Exit check(const std::filesystem::path& file, BufferFiles buffer_files);

}  // namespace weft::command
