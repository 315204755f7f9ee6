// Parts: worked through, and put together.
#include "samples/weft/shard.h"

#include <charconv>
#include <cstdio>
#include <fstream>
#include <iterator>

#include "engine/scene/faults.h"
#include "samples/weft/console.h"
#include "samples/weft/files.h"
#include "samples/weft/rows_file.h"

namespace weft::command {

namespace {

std::string rows_name(std::string_view command, const std::optional<Shard>& shard) {
  std::string name(command);
  if (shard) name += '.' + std::to_string(shard->part) + "-of-" + std::to_string(shard->parts);
  return name + ".rows";
}

std::vector<std::uint32_t> items_of(const Shard& shard, std::uint32_t items) {
  std::vector<std::uint32_t> list;
  for (std::uint32_t item = shard.part - 1; item < items; item += shard.parts) list.push_back(item);
  return list;
}

// Rows that an earlier call has left, or none.
Result<Part> begun(const std::filesystem::path& file, Part fresh, bool anew) {
  if (anew || !is_there(file)) return fresh;
  auto part = load_part(file);
  if (!part) return fail(part.why(), "; --fresh begins anew");
  if (part->key != fresh.key || part->shard != fresh.shard)
    return fail(file.string(), ": is of another scene, device, program or other options; choose another --out, or begin anew with --fresh");
  return part;
}

// What is said of work that was stopped.
std::string stopped_at(const Part& part, std::size_t items, const std::filesystem::path& file) {
  const std::size_t rows = part.content.rows.size();
  if (rows == 0) return " before the first of " + std::to_string(items) + " rows was whole; the same command goes on from here";
  return " after " + std::to_string(rows) + " of " + std::to_string(items) + " rows, which are in " + file.string() +
         "; the same command goes on from here";
}

}  // namespace

Result<Shard> parse_shard(std::string_view text) {
  Shard shard;
  const char *first = text.data(), *last = first + text.size();
  const auto part = std::from_chars(first, last, shard.part);
  const bool slash = part.ec == std::errc() && part.ptr != last && *part.ptr == '/';
  const auto parts = slash ? std::from_chars(part.ptr + 1, last, shard.parts) : part;
  if (!slash || parts.ec != std::errc() || parts.ptr != last)
    return fail("--shard ", text, ": is not K/N, such as 3/8 for the third of eight parts");
  if (shard.parts < 1 || shard.parts > kMostParts)
    return fail("--shard ", text, ": there are 1 to ", kMostParts, " parts, not ", shard.parts);
  if (shard.part < 1 || shard.part > shard.parts) return fail("--shard ", text, ": parts are counted from 1 to ", shard.parts);
  return shard;
}

std::string fingerprint_of(const Scene& scene, const std::filesystem::path& file) {
  Fingerprint print;
  print.add(scene_text(scene));
  const auto inputs = inputs_of(file, scene);
  for (const Input& input : inputs) {
    if (&input == &inputs.front() || input.file.parent_path() == curve_file("").parent_path()) continue;
    std::ifstream stream(input.file, std::ios::binary);
    print.add(input.as).add(std::string{std::istreambuf_iterator<char>(stream), {}});
  }
  return print.text();
}

std::vector<std::string> outputs_of(std::string_view command, const std::optional<Shard>& shard, std::vector<std::string> tables) {
  if (shard) tables.clear();
  tables.push_back(rows_name(command, shard));
  return tables;
}

Exit concluded(const Rows& rows, const std::filesystem::path& file, const std::function<Exit(const Rows&)>& conclude) try {
  return conclude(rows);
} catch (const Row::exception& fault) {
  complain(file.string() + ": a row or a fact is not one of weft " + rows.work.command + ": " + printable(fault.what(), 200));
  return kBadInput;
}

Exit work_through(const Work& work, const Labour& labour, const Farm& farm, const std::filesystem::path& out) {
  const Shard shard = farm.shard.value_or(Shard());
  const std::filesystem::path file = out / rows_name(work.command, farm.shard);
  auto found = begun(file, {shard, key_of(work), {work, {}}}, farm.fresh);
  if (!found) {
    complain(found.error());
    return kBadInput;
  }
  Part& part = *found;
  const std::vector<std::uint32_t> items = items_of(shard, work.items);
  if (farm.shard) std::printf("Part %u of %u: %zu of %u rows\n", shard.part, shard.parts, items.size(), work.items);
  if (!part.content.rows.empty())
    std::printf("Going on: %zu of %zu rows are in %s\n", part.content.rows.size(), items.size(), file.string().c_str());
  std::fflush(stdout);
  {
    std::uint32_t total = 0;
    for (const std::uint32_t item : items) total += part.content.rows.contains(item) ? 0 : labour.cost(item);
    Progress progress(work.command, total, labour.unit);
    for (const std::uint32_t item : items) {
      if (interrupted()) break;
      if (part.content.rows.contains(item)) continue;
      auto row = labour.measure(item);
      if (interrupted()) break;   // a row that was cut short is measured again
      if (!row) return row.error().empty() ? kFailed : failed(row.error());
      part.content.rows.emplace(item, std::move(*row));
      if (const Result<void> written = write_text(file, text_of(part)); !written) return failed(written.error());
      progress.step(labour.cost(item));
    }
  }
  if (farm.shard) {
    if (interrupted()) return stopped(stopped_at(part, items.size(), file));
    if (items.empty())   // more parts than items: this one is done, too
      if (const Result<void> written = write_text(file, text_of(part)); !written) return failed(written.error());
    std::printf("Written: %s; weft merge makes the table of all %u parts\n", file.string().c_str(), shard.parts);
    return kDone;
  }
  if (interrupted() && part.content.rows.empty()) return stopped(stopped_at(part, items.size(), file));
  const Exit exit = concluded(part.content, file, labour.conclude);
  if (interrupted()) return exit == kBadInput ? exit : stopped(stopped_at(part, items.size(), file));
  std::error_code ignored;
  if (!labour.kept) std::filesystem::remove(file, ignored);
  return exit;
}

Result<Rows> gather(const std::vector<std::filesystem::path>& files) {
  std::map<std::uint32_t, std::pair<std::filesystem::path, Part>> parts;
  for (const std::filesystem::path& file : files) {
    auto part = load_part(file);
    if (!part) return part.take_error();
    if (!parts.empty()) {
      const auto& [other, first] = parts.begin()->second;
      if (part->shard.parts != first.shard.parts)
        return fail(file.string(), ": is one of ", part->shard.parts, " parts, and ", other.string(), " one of ", first.shard.parts);
      if (part->key != first.key)
        return fail(file.string(), ": is not a part of the same work as ", other.string(),
                    ": another command, scene, device, program or other options");
    }
    const std::uint32_t number = part->shard.part;
    const auto [known, is_new] = parts.try_emplace(number, file, std::move(*part));
    if (!is_new) return fail(file.string(), ": is part ", number, ", which ", known->second.first.string(), " is already");
  }
  if (parts.empty()) return fail("there is no part to merge");
  const Shard any = parts.begin()->second.second.shard;
  std::string missing;
  std::uint32_t count = 0;
  for (std::uint32_t k = 1; k <= any.parts; ++k)
    if (!parts.contains(k) && ++count <= 10) missing += (missing.empty() ? "" : ", ") + std::to_string(k);
  if (count > 0)
    return fail("of ", any.parts, " parts ", count, count == 1 ? " is" : " are", " missing: ", missing, count > 10 ? ", ..." : "");
  Rows all;
  for (auto& [number, named] : parts) {
    auto& [file, part] = named;
    const std::size_t items = items_of(part.shard, part.content.work.items).size();
    if (part.content.rows.size() < items)
      return fail(file.string(), ": is not done: it has ", part.content.rows.size(), " of its ", items, " rows; --shard ", number, "/",
                  any.parts, " goes on with it");
    if (number == 1) all.work = part.content.work;
    all.rows.merge(part.content.rows);
  }
  return all;
}

}  // namespace weft::command
