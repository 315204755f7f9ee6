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
  kPutBack = 75,       // EX_TEMPFAIL of sysexits.h, after SIGTERM or SIGUSR1: the same command goes on when a queue starts it again
  kInterrupted = 130,  // 128 + SIGINT, as shells count
};

/// Prints an error that is the machine's fault.
Exit failed(std::string_view sentence);

/// Part `part` of `parts`, from 1.
struct Shard {
  std::uint32_t part = 1, parts = 1;
  bool operator==(const Shard&) const = default;
};

/// Of commands that work through a list: samples/weft/shard.h.
struct Farm {
  std::optional<Shard> shard;   // none: all of it, and tables
  bool fresh = false;           // do not go on with what is in `out`
};

struct RunOptions {
  std::filesystem::path file;   // scene or mesh
  std::filesystem::path out = "out";
  std::optional<std::uint32_t> frames;   // none: the scene's
  std::uint32_t every = 0;      // 0: only the final frame is drawn
  bool picture = true;
  bool movie = false;           // of the pictures of `every`
  bool check = false;           // count crossings of cloth at every frame
  std::uint32_t checkpoint = 0; // frames between snapshots that the run can go on from; 0: none
  Farm farm;                    // its shard is of a family
  std::vector<std::filesystem::path> caches;   // animated geometry: engine/cache.h; relative ones lie in `out`
  std::string device;           // as compute::DeviceChoice::name
  BufferFiles buffer_files = BufferFiles::below_its_folder;
  std::vector<Assignment> assignments;
};
Exit run(const RunOptions& options);
/// A family of scenes, each in a folder of its own below `out`. `common.file` is not looked at.
Exit run_family(const std::vector<std::filesystem::path>& files, const RunOptions& common);

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
  std::vector<std::uint32_t> sides;   // vertices along the longest side, at which grids are measured; none: chosen
  std::optional<double> budget_ms;   // print the best setting that fits
  Farm farm;
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
  Farm farm;
  std::string device;
  std::vector<Assignment> assignments;
};
Exit contacts(const ContactOptions& options);

struct DrapeOptions {
  std::filesystem::path file;   // a scene whose cloths hang over the rim of what holds them
  std::filesystem::path out = "out/drape";
  std::optional<std::uint32_t> frames;   // none: the scene's
  std::string device;
  BufferFiles buffer_files = BufferFiles::below_its_folder;
  std::vector<Assignment> assignments;
};
Exit drape(const DrapeOptions& options);

struct EffectsOptions {
  std::filesystem::path out = "out/effects";
  std::uint32_t size = 100;     // cells along a side of the sheet
  std::uint32_t frames = 60;    // of each side
  bool quick = false;           // a small sheet, and of the pairs each effect with the next one
  Farm farm;
  std::string device;
};
Exit effects(const EffectsOptions& options);

struct ImplicitOptions {
  std::filesystem::path out = "out";
  bool quick = false;           // four rows a processor instead of 56
  Farm farm;
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
  std::optional<std::uint32_t> seed;     // of all cloths' starts; none: the scene's
  std::filesystem::path readme; // whose table of hard cases is replaced; empty: none
  Farm farm;
  std::string device;
  BufferFiles buffer_files = BufferFiles::below_its_folder;
  std::vector<Assignment> assignments;
};
Exit harden(const HardenOptions& options);

struct MergeOptions {
  std::vector<std::filesystem::path> parts;
  std::filesystem::path out = "out";
};
Exit merge(const MergeOptions& options);

Exit info();
Exit check(const std::filesystem::path& file, BufferFiles buffer_files);

}  // namespace weft::command
