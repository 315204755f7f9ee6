// The counts travel as JSON in the snapshot's note: one file cannot disagree with itself.
#include "samples/weft/checkpoint.h"

#include <nlohmann/json.hpp>
#include <string>

namespace weft::command {

namespace {

using nlohmann::json;

std::string text_of(const Tally& tally) {
  json note = {{"frames", tally.frames}, {"clamped_seconds", tally.clamped}};
  if (tally.intersections) note["intersections"] = {tally.intersections->max, tally.intersections->final};
  return note.dump();
}

std::optional<Tally> tally_of(const std::vector<std::byte>& bytes) {
  const auto* first = reinterpret_cast<const char*>(bytes.data());
  const json note = json::parse(first, first + bytes.size(), nullptr, false);
  if (!note.is_object() || !note.contains("frames") || !note["frames"].is_number_unsigned() || !note.contains("clamped_seconds") ||
      !note["clamped_seconds"].is_number())
    return std::nullopt;
  Tally tally{note["frames"], note["clamped_seconds"], std::nullopt};
  const json crossed = note.value("intersections", json());
  if (crossed.is_array() && crossed.size() == 2 && crossed[0].is_number_unsigned() && crossed[1].is_number_unsigned())
    tally.intersections = Intersections{crossed[0], crossed[1]};
  return tally;
}

}  // namespace

Result<void> write_checkpoint(const std::filesystem::path& file, const Simulation& simulation, const Tally& tally) {
  Result<Snapshot> snapshot = simulation.save();
  if (!snapshot) return snapshot.take_error();
  const std::string text = text_of(tally);
  const auto bytes = std::as_bytes(std::span(text));
  snapshot->note.assign(bytes.begin(), bytes.end());
  return save_snapshot(file, *snapshot);
}

Result<Checkpoint> load_checkpoint(const std::filesystem::path& file, const Simulation& simulation, bool checked) {
  Result<Snapshot> snapshot = load_snapshot(file);
  if (!snapshot) return snapshot.take_error();
  const std::optional<Tally> tally = tally_of(snapshot->note);
  if (!tally) return fail(file.string(), ": the snapshot is not one that a run has left");
  if (checked && !tally->intersections) return fail(file.string(), ": the run that left it did not count where cloth crosses");
  if (const Result<void> good = simulation.fits(*snapshot); !good) return fail(file.string(), ": ", good.why());
  return Checkpoint{std::move(*snapshot), *tally};
}

}  // namespace weft::command
