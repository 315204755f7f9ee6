// `weft run` of several scenes: each run leaves its files in a folder of its own, and runs.csv is a table of them all. A family's items are
// its scenes; a long run within it goes on by its checkpoint.
#include <algorithm>
#include <cstdio>

#include "compute/text.h"
#include "samples/weft/console.h"
#include "samples/weft/files.h"
#include "samples/weft/merge.h"
#include "samples/weft/outputs.h"
#include "samples/weft/run.h"
#include "samples/weft/shard.h"
#include "samples/weft/subject.h"

namespace weft::command {

namespace {

namespace fs = std::filesystem;

constexpr const char* kRunsTable = "runs.csv";

std::string folder_of(const fs::path& file) { return file_name(file.stem().string()); }

// What is wrong with the call; empty where nothing is.
std::string contradiction(const std::vector<fs::path>& files, const RunOptions& common) {
  std::map<std::string, fs::path> known;
  for (const fs::path& file : files)
    if (const auto [other, is_new] = known.try_emplace(folder_of(file), file); !is_new)
      return file.string() + ": its folder in --out would be that of " + other->second.string() + ": give the scenes different names";
  for (const fs::path& cache : common.caches)
    if (cache.is_absolute()) return "--cache " + cache.string() + ": is one file for a family of scenes; give a name without a folder";
  return "";
}

Row row_of(const std::string& name, const Figures& figures, std::uint32_t frames) {
  char hash[17];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(figures.hash));
  Row row = {{"name", name}, {"frames", frames}, {"particles", figures.particles}, {"strain_mean", figures.strain.mean},
             {"strain_rms", figures.strain.rms}, {"strain_max", figures.strain.max}, {"non_finite", figures.counts.non_finite},
             {"hash", hash}, {"ms_median", figures.frame ? figures.frame->median : 0.0}};
  if (figures.intersections) row["crossings_max"] = figures.intersections->max;
  return row;
}

Exit conclude_family(const Rows& all, const fs::path& out) {
  TextStream text;
  text.precision(9);
  text << "run,frames,particles,strain_mean,strain_rms,strain_max,non_finite,crossings_max,hash,ms_median\n";
  for (const auto& [item, row] : all.rows) {
    text << quoted(row.at("name").get<std::string>()) << ',' << row.at("frames").get<std::uint32_t>() << ','
         << row.at("particles").get<std::uint64_t>();
    for (const char* key : {"strain_mean", "strain_rms", "strain_max"}) text << ',' << row.at(key).get<double>();
    text << ',' << row.at("non_finite").get<std::uint32_t>() << ',';
    if (row.contains("crossings_max")) text << row.at("crossings_max").get<std::uint64_t>();
    text << ',' << row.at("hash").get<std::string>() << ',' << row.at("ms_median").get<double>() << '\n';
  }
  if (const Result<void> written = write_text(out / kRunsTable, text.str()); !written) return failed(written.error());
  std::printf("Written: %s of %zu runs in %s\n", kRunsTable, all.rows.size(), out.string().c_str());
  return kDone;
}

}  // namespace

Exit run_family(const std::vector<fs::path>& files, const RunOptions& common) {
  std::vector<Input> inputs;
  Work work{"run", {{"checked", common.check}}};
  // What else each run is to leave.
  work.of = std::to_string(common.every) + (common.picture ? "p" : "") + (common.movie ? "m" : "");
  for (const fs::path& cache : common.caches) work.of += ' ' + cache.string();
  std::string faults = contradiction(files, common);
  for (const fs::path& file : files) {
    auto scene = load_subject(file, common.assignments, common.buffer_files);
    if (!scene) {
      faults += (faults.empty() ? "" : "\n") + (files.size() > 1 ? file.string() + ": " : "") + scene.error();
      continue;
    }
    if (common.frames) scene->frames = *common.frames;
    work.of += fingerprint_of(*scene, file);
    for (Input& input : inputs_of(file, *scene)) inputs.push_back(std::move(input));
  }
  if (!faults.empty()) {
    complain(faults);
    return kBadInput;
  }
  listen_for_interrupts();
  if (const Exit exit = prepare_outputs(common.out, outputs_of("run", common.farm.shard, {kRunsTable}), inputs); exit != kDone) return exit;
  {
    compute::DeviceChoice choice;
    choice.name = common.device;
    const auto device = compute::Device::create(choice);
    if (!device) return failed(device.error());
    work.facts["device"] = (*device)->name();
  }
  work.items = static_cast<std::uint32_t>(files.size());
  Exit told = kDone;
  Labour labour;
  labour.unit = "scenes";
  labour.measure = [&](std::uint32_t item) -> Result<Row> {
    RunOptions one = common;
    one.file = files[item];
    one.out = common.out / folder_of(files[item]);
    Figures figures;
    if (told = run(one, figures); told != kDone) return fail("");   // it has complained itself
    return row_of(folder_of(files[item]), figures, figures.frames);
  };
  labour.conclude = [&](const Rows& all) { return conclude_family(all, common.out); };
  const Exit exit = work_through(work, labour, common.farm, common.out);
  return exit == kFailed && told == kBadInput ? told : exit;
}

Mergeable merged_family() { return {"run", {kRunsTable}, conclude_family}; }

}  // namespace weft::command
