// Work in parts, for several machines that know nothing of each other: --shard K/N.
//
// A sweep is a list of items in a fixed order, each of which can be measured by itself; item i belongs to part i mod N, both counted from
// 0. What was measured of an item is its row, plain values. Part K of N keeps its rows in one file, COMMAND.K-of-N.rows, written anew,
// whole, after every item: a part that was stopped or killed goes on with the items whose rows it has not. Tables, plots and pages are
// made from the rows of all items, by the command itself where it was given no --shard, and by `weft merge`: one piece of code.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compute/device.h"
#include "samples/weft/commands.h"
#include "samples/weft/outputs.h"

namespace weft::command {

using Row = nlohmann::json;

/// "3/8": part 3 of 8. Errors: anything else, parts that there are not, more than kMostParts.
inline constexpr std::uint32_t kMostParts = 100'000;
Result<Shard> parse_shard(std::string_view text);

/// What is to be measured. Parts of one work agree in all of this but `place`, and in the program.
struct Work {
  std::string command;
  Row facts;                    // what tables say besides the rows; a JSON object
  Row place = Row::object();    // what may differ from part to part: dates, where files are; tables get that of the first part
  std::string of = {};          // the scenes, by their bytes: fingerprint_of
  std::uint32_t items = 0;
};

/// Rows of some of the items.
struct Rows {
  Work work;
  std::map<std::uint32_t, Row> rows;
  bool all() const { return rows.size() == work.items; }
};

/// A scene, with the bytes of all other files that it reads; with no curves of devices.
std::string fingerprint_of(const Scene& scene, const std::filesystem::path& file);

/// The items of a command, and what is made of them.
struct Labour {
  std::function<Result<Row>(std::uint32_t item)> measure;   // what it returns after an interruption is dropped
  std::function<Exit(const Rows&)> conclude;                // writes tables; of fewer rows where it was interrupted
  std::function<std::uint32_t(std::uint32_t item)> cost = [](std::uint32_t) { return 1u; };   // for the time that is left
  std::string unit = "rows";
  bool kept = false;            // rows stay when the work is done, and the next call has nothing to measure
};

/// Calls a conclude; rows of whole files of which someone wrote the lines himself are a complaint and kBadInput.
Exit concluded(const Rows& rows, const std::filesystem::path& file, const std::function<Exit(const Rows&)>& conclude);

/// What a command, or a part of it, is going to write, as prepare_outputs takes it: tables or rows.
std::vector<std::string> outputs_of(std::string_view command, const std::optional<Shard>& shard, std::vector<std::string> tables);

/// Measures what has no row yet, then concludes where it is not one part of several. Complains itself. Exit codes: conclude's; those of an
/// interruption; kBadInput for rows in `out` that are of other work.
Exit work_through(const Work& work, const Labour& labour, const Farm& farm, const std::filesystem::path& out);

/// The rows of all parts. Errors, each with the file's name: one that cannot be read or is damaged; parts of other work or of another
/// number of parts; a part that is missing, twice there, or not done.
Result<Rows> gather(const std::vector<std::filesystem::path>& parts);

}  // namespace weft::command
