// The command line of Weft: flags to options, and nothing else.
#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <iostream>

#include "engine/scene/faults.h"
#include "samples/weft/assignments.h"
#include "samples/weft/commands.h"
#include "samples/weft/console.h"
#include "samples/weft/shard.h"
#include "samples/weft/view.h"

namespace {

using namespace weft;
using namespace weft::command;

constexpr const char* kSceneOrMesh = "A scene (JSON) or a mesh (glTF, GLB, OBJ, PLY, STL, Collada, FBX)";

// "2ms", "2 ms" or "2".
std::optional<double> milliseconds(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const std::string_view unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
  if (error != std::errc() || !(value > 0) || !std::isfinite(value) || !(unit.empty() || unit == "ms" || unit == " ms"))
    return std::nullopt;
  return value;
}

void add_outside(CLI::App& command, bool& allow_outside) {
  command.add_flag("--allow-outside", allow_outside, "Read a glTF's buffers and images wherever it says they are, not only below its own folder");
}

// Of a command whose work is a list.
CLI::Option* add_farm(CLI::App& command, Farm& farm, std::string& shard) {
  command.add_flag("--fresh", farm.fresh, "Begin anew, whatever an earlier call has left in the folder");
  return command
      .add_option("--shard", shard, "Part K of N of the work, for several machines: leaves rows, of which weft merge makes what one writes")
      ->type_name("K/N");
}

// A command or an option that is not there, with the nearest that is; empty where something else is wrong.
std::string mistyped(const CLI::App& app) {
  const auto chosen = app.get_subcommands();
  const CLI::App& command = chosen.empty() ? app : *chosen.front();
  const std::vector<std::string> unknown = command.remaining();
  if (unknown.empty()) return "";
  const std::string wrong = unknown.front().substr(0, unknown.front().find('='));
  const bool option = wrong.starts_with('-');
  if (!option && !chosen.empty()) return "";
  std::vector<std::string> names;
  if (option)
    for (const CLI::Option* known : command.get_options())
      for (const std::string& name : known->get_lnames()) names.push_back("--" + name);
  else
    for (const CLI::App* known : app.get_subcommands([](const CLI::App*) { return true; })) names.push_back(known->get_name());
  return "there is no " + std::string(option ? "option \"" : "command \"") + printable(wrong) + '"' +
         suggestion(wrong, std::vector<std::string_view>(names.begin(), names.end()));
}

Exit obey(int count, char** arguments) {
  CLI::App app("Weft: cloth by position-based dynamics in Vulkan compute", "weft");
  app.require_subcommand(1);
  app.set_version_flag("--version", "weft 0.1.0");
  std::vector<std::string> sets;
  std::string file;
  bool allow_outside = false;
  Farm farm;
  std::string shard;

  constexpr unsigned kMostFrames = 1'000'000;
  std::vector<std::string> scenes, parts;
  RunOptions run_options;
  std::uint32_t frames = 0;
  bool no_picture = false;
  CLI::App* run_command = app.add_subcommand("run", "Simulate a scene; write a picture, times, figures and the final mesh");
  run_command
      ->add_option("scene", scenes, std::string(kSceneOrMesh) + "; of several each gets a folder of its own, and all a table")
      ->required()
      ->type_name("SCENE|MESH");
  CLI::Option* frames_option = run_command->add_option("--frames", frames, "How many frames; by default the scene's");
  frames_option->check(CLI::Range(0u, kMostFrames));
  run_command->add_option("--out", run_options.out, "Where files go")->type_name("DIR")->capture_default_str();
  add_set(*run_command, sets);
  add_outside(*run_command, allow_outside);
  CLI::Option* every_option = run_command->add_option("--every", run_options.every, "Draw every K-th frame too, as frame_0000.png");
  every_option->type_name("K")->check(CLI::Range(1u, kMostFrames));
  run_command->add_flag("--movie", run_options.movie, "Make an MP4 of the pictures of --every; needs the program ffmpeg")
      ->needs(every_option);
  run_command->add_flag("--no-picture", no_picture, "Draw nothing: needs no graphics queue")->excludes(every_option);
  run_command->add_flag("--check", run_options.check,
                        "Count where cloth crosses cloth or a mesh collider, at the start and after every frame");
  CLI::Option* checkpoint_option = run_command->add_option(
      "--checkpoint", run_options.checkpoint, "Leave a snapshot every K frames; the same command goes on with it after a kill");
  checkpoint_option->type_name("K")->check(CLI::Range(1u, kMostFrames));
  add_farm(*run_command, farm, shard);
  run_command
      ->add_option("--cache", run_options.caches,
                   "Write every frame's geometry for other programs, by the ending: .glb, .pc2, .mdd, .usda, or .ply and .obj with a file "
                   "a frame; in the folder of --out, as often as wanted")
      ->type_name("FILE")
      ->expected(1)
      ->take_all()
      ->allow_extra_args(false);
  run_command->add_option("--device", run_options.device, "Index or part of the name; weft info lists them");

  TimeOptions time_options;
  CLI::App* time_command = app.add_subcommand("time", "Time a scene pass by pass; write a table, CSV and a trace");
  time_command->add_option("scene", file, kSceneOrMesh)->required()->type_name("SCENE|MESH");
  time_command->add_option("--frames", time_options.frames, "Frames that are timed")
      ->check(CLI::Range(1u, kMostFrames))
      ->capture_default_str();
  time_command->add_option("--warm-up", time_options.warm_up, "Frames before these")
      ->check(CLI::Range(0u, kMostFrames))
      ->capture_default_str();
  time_command->add_option("--out", time_options.out, "Where files go")->type_name("DIR")->capture_default_str();
  add_set(*time_command, sets);
  add_outside(*time_command, allow_outside);
  time_command->add_option("--device", time_options.device, "Index or part of the name; weft info lists them");

  ContactOptions contact_options;
  CLI::App* contacts_command =
      app.add_subcommand("contacts", "Measure what contacts cost: a scene, or a sheet over its size and that of the hash's cells");
  contacts_command->add_option("scene", file, "A scene (JSON) whose cloths are grids; any with --price")->required()->type_name("SCENE");
  CLI::Option* price_option =
      contacts_command->add_flag("--price", contact_options.price, "The scene as it is: frames with contacts and without, in turns");
  contacts_command->add_option("--frames", contact_options.frames, "Frames of each size")
      ->check(CLI::Range(4u, kMostFrames))
      ->capture_default_str();
  contacts_command->add_flag("--quick", contact_options.quick, "Two small sizes only");
  add_farm(*contacts_command, farm, shard)->excludes(price_option);
  contacts_command->add_option("--out", contact_options.out, "Where files go")->type_name("DIR")->capture_default_str();
  add_set(*contacts_command, sets);
  contacts_command->add_option("--device", contact_options.device, "Index or part of the name; weft info lists them");

  DrapeOptions drape_options;
  CLI::App* drape_command =
      app.add_subcommand("drape", "Cusick's drape coefficient of a scene's cloths, beside published ones; a table, CSV and a plot");
  drape_command->add_option("scene", file, "A scene (JSON) whose cloths hang over the rim of what holds them")
      ->required()
      ->type_name("SCENE");
  std::uint32_t drape_frames = 0;
  CLI::Option* drape_frames_option =
      drape_command->add_option("--frames", drape_frames, "Frames until it is measured (default: the scene's)");
  drape_frames_option->check(CLI::Range(1u, kMostFrames));
  drape_command->add_option("--out", drape_options.out, "Where files go")->type_name("DIR")->capture_default_str();
  add_set(*drape_command, sets);
  add_outside(*drape_command, allow_outside);
  drape_command->add_option("--device", drape_options.device, "Index or part of the name; weft info lists them");

  EffectsOptions effects_options;
  CLI::App* effects_command = app.add_subcommand(
      "effects", "Tabulate what each effect adds to the barest cloth, alone and in pairs: passes, dispatches, bytes, instructions, time");
  CLI::Option* size_option = effects_command->add_option("--size", effects_options.size, "Cells along a side of the sheet");
  size_option->type_name("N")->check(CLI::Range(4u, 512u))->capture_default_str();
  CLI::Option* effects_frames_option = effects_command->add_option("--frames", effects_options.frames, "Frames with and without each");
  effects_frames_option->check(CLI::Range(2u, kMostFrames))->capture_default_str();
  effects_command
      ->add_flag("--quick", effects_options.quick, "12 cells and 4 frames; of the pairs only each effect with the next one in the list")
      ->excludes(size_option)
      ->excludes(effects_frames_option);
  add_farm(*effects_command, farm, shard);
  effects_command->add_option("--out", effects_options.out, "Where files go")->type_name("DIR")->capture_default_str();
  effects_command->add_option("--device", effects_options.device, "Index or part of the name; weft info lists them");

  AccuracyOptions accuracy_options;
  std::uint32_t accuracy_frames = 0, reference_cells = 0;
  std::string budget;
  CLI::App* accuracy_command =
      app.add_subcommand("accuracy", "Measure error over milliseconds for solvers, substeps, iterations and resolutions");
  accuracy_command->add_option("scene", file, kSceneOrMesh)->required()->type_name("SCENE|MESH");
  accuracy_command->add_flag("--quick", accuracy_options.quick, "A coarse sweep of under a minute");
  CLI::Option* accuracy_frames_option =
      accuracy_command->add_option("--frames", accuracy_frames, "Frames that each setting is run for: 48, quick 24");
  accuracy_frames_option->check(CLI::Range(4u, kMostFrames));
  CLI::Option* reference_option = accuracy_command->add_option(
      "--reference-cells", reference_cells,
      "Cells along the longest side up to which runs are compared with a reference: 32, quick 16; 0: with none");
  reference_option->check(CLI::Range(0u, 2048u));
  accuracy_command
      ->add_option("--sides", accuracy_options.sides, "Vertices along the longest side, instead of the scene's own: --sides 33,100,200")
      ->delimiter(',')
      ->check(CLI::Range(2u, 2049u));
  CLI::Option* budget_option =
      accuracy_command->add_option("--budget", budget, "Print the best setting that takes no longer than this a frame: --budget 2ms");
  CLI::Option* save_option =
      accuracy_command->add_flag("--save", accuracy_options.save, "Keep the curve where scenes with \"method\": \"auto\" find it");
  add_farm(*accuracy_command, farm, shard)->excludes(budget_option)->excludes(save_option);
  accuracy_command->add_option("--out", accuracy_options.out, "Where files go, and where a sweep that was interrupted goes on")
      ->type_name("DIR")
      ->capture_default_str();
  add_set(*accuracy_command, sets);
  add_outside(*accuracy_command, allow_outside);
  accuracy_command->add_option("--device", accuracy_options.device, "Index or part of the name; weft info lists them");

  ImplicitOptions implicit_options;
  CLI::App* implicit_command =
      app.add_subcommand("implicit", "Tabulate speed and error of the implicit method, on the processor and on the device");
  implicit_command->add_flag("--quick", implicit_options.quick, "Only 100 and 900 particles, 10 and 30 iterations");
  add_farm(*implicit_command, farm, shard);
  implicit_command->add_option("--out", implicit_options.out, "Where implicit.csv goes")->type_name("DIR")->capture_default_str();
  implicit_command->add_option("--device", implicit_options.device, "Index or part of the name; weft info lists them");

  HardenOptions harden_options;
  std::uint32_t harden_frames = 0;
  double band = 100 * harden_options.band;
  CLI::App* harden_command =
      app.add_subcommand("harden", "Run a scene, or the hard cases, through jittered starts, other rates, masses, places and sizes");
  harden_command
      ->add_option("scene", file, std::string(kSceneOrMesh) + "; or the folder of the hard cases, assets/scenes/hard")
      ->required()
      ->type_name("SCENE|FOLDER");
  CLI::Option* harden_frames_option = harden_command->add_option("--frames", harden_frames, "How many frames; by default the scene's");
  harden_frames_option->check(CLI::Range(2u, kMostFrames));
  harden_command
      ->add_option("--band", band,
                   "How far a perturbation may move the cloths' mean, in % of their size; their shape (rms of all particles) twice as far")
      ->type_name("%")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  harden_command->add_flag("--quick", harden_options.quick,
                           "Sixty frames and one or two perturbations of a kind; of the hard cases those that are small");
  harden_command->add_option("--only", harden_options.only, "Of the hard cases those whose name has this part");
  harden_command->add_option("--seed", harden_options.seed, "Of all cloths' starts (start.seed): whether what holds holds by chance");
  CLI::Option* readme_option =
      harden_command->add_option("--readme", harden_options.readme, "A file whose table of hard cases is replaced")->type_name("FILE");
  add_farm(*harden_command, farm, shard)->excludes(readme_option);
  harden_command->add_option("--out", harden_options.out, "Where harden.json or hard_cases.csv goes")
      ->type_name("DIR")
      ->capture_default_str();
  add_set(*harden_command, sets);
  add_outside(*harden_command, allow_outside);
  harden_command->add_option("--device", harden_options.device, "Index or part of the name; weft info lists them");

  MergeOptions merge_options;
  CLI::App* merge_command = app.add_subcommand("merge", "Make of all parts of a sweep (--shard) what one machine would have written");
  merge_command->add_option("parts", parts, "The rows of every part, NAME.K-of-N.rows")->required()->type_name("FILE");
  merge_command->add_option("--out", merge_options.out, "Where files go")->type_name("DIR")->capture_default_str();

  // Its own program has its flags, and is started before these are read.
  app.add_subcommand("view", "Look at a scene in a window while it is simulated; weft view --help tells how");
  CLI::App* info_command = app.add_subcommand("info", "List Vulkan devices and what they support");
  CLI::App* check_command = app.add_subcommand("check", "Name everything that is wrong with a scene or a mesh");
  check_command->add_option("file", file, kSceneOrMesh)->required()->type_name("FILE");
  add_outside(*check_command, allow_outside);

  try {
    app.parse(count, arguments);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error), kDone;  // --help, --version
    const std::string named = mistyped(app);
    complain("weft: " + (named.empty() ? error.what() : named) + "; weft --help tells what there is");
    return kBadInput;
  }

  std::vector<Assignment> assignments;
  if (const std::string fault = split(sets, assignments); !fault.empty()) {
    complain(fault);
    return kBadInput;
  }
  const CLI::Option* shard_option = app.get_subcommands().front()->get_option_no_throw("--shard");
  if (shard_option && *shard_option) {
    const auto part = parse_shard(shard);
    if (!part) {
      complain(part.error());
      return kBadInput;
    }
    farm.shard = *part;
  }
  const BufferFiles buffer_files = allow_outside ? BufferFiles::anywhere : BufferFiles::below_its_folder;
  if (*info_command) return info();
  if (*merge_command) {
    merge_options.parts.assign(parts.begin(), parts.end());
    return merge(merge_options);
  }
  if (*implicit_command) {
    implicit_options.farm = farm;
    return implicit(implicit_options);
  }
  if (*effects_command) {
    effects_options.farm = farm;
    return effects(effects_options);
  }
  if (*check_command) return check(file, buffer_files);
  if (*time_command) {
    time_options.file = file;
    time_options.buffer_files = buffer_files;
    time_options.assignments = std::move(assignments);
    return time(time_options);
  }
  if (*contacts_command) {
    contact_options.file = file;
    contact_options.farm = farm;
    contact_options.assignments = std::move(assignments);
    return contacts(contact_options);
  }
  if (*drape_command) {
    drape_options.file = file;
    drape_options.buffer_files = buffer_files;
    drape_options.assignments = std::move(assignments);
    if (*drape_frames_option) drape_options.frames = drape_frames;
    return drape(drape_options);
  }
  if (*harden_command) {
    harden_options.file = file;
    harden_options.farm = farm;
    harden_options.buffer_files = buffer_files;
    harden_options.assignments = std::move(assignments);
    harden_options.band = band / 100;
    if (*harden_frames_option) harden_options.frames = harden_frames;
    return harden(harden_options);
  }
  if (*accuracy_command) {
    accuracy_options.file = file;
    accuracy_options.farm = farm;
    accuracy_options.buffer_files = buffer_files;
    accuracy_options.assignments = std::move(assignments);
    if (*accuracy_frames_option) accuracy_options.frames = accuracy_frames;
    if (*reference_option) accuracy_options.reference_cells = reference_cells;
    if (*budget_option) {
      accuracy_options.budget_ms = milliseconds(budget);
      if (!accuracy_options.budget_ms) {
        complain("--budget " + budget + ": is not a time above 0 such as 2ms");
        return kBadInput;
      }
    }
    return accuracy(accuracy_options);
  }
  run_options.file = scenes.front();
  run_options.farm = farm;
  run_options.buffer_files = buffer_files;
  run_options.assignments = std::move(assignments);
  run_options.picture = !no_picture;
  if (*frames_option) run_options.frames = frames;
  const bool family = scenes.size() > 1 || farm.shard;
  if (family) return run_family({scenes.begin(), scenes.end()}, run_options);
  if (farm.fresh && run_options.checkpoint == 0) {
    complain("--fresh: goes with --checkpoint, --shard or several scenes: nothing else is gone on with");
    return kBadInput;
  }
  return run(run_options);
}

}  // namespace

int main(int count, char** arguments) {
  if (count > 1 && std::string_view(arguments[1]) == "view") return view(arguments + 1);
  expect_full_disks();
  const Exit exit = obey(count, arguments);
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout) return exit;
  complain("weft: what was printed could not be written; is the disk full?");
  return exit == kDone ? kFailed : exit;
}
