// Work in parts: the program `weft` with --shard, and `weft merge`.
#include <algorithm>
#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <thread>

#include "tests/support/command_line.h"

namespace weft {
namespace {

using nlohmann::json;

class Shards : public CommandLine {
 protected:
  /// A part that is asked to stop as soon as `file` is there.
  Outcome stop(const std::vector<std::string>& call, const fs::path& file, int signal) {
    const pid_t child = spawn(call);
    for (int tries = 0; tries < 30'000 && !fs::exists(file); ++tries) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    kill(child, signal);
    return wait(child);
  }

  void expect_refusal(const std::vector<fs::path>& parts, const std::string& sentence) {
    std::vector<std::string> call = {"merge", "--out", out("refused")};
    call.insert(call.end(), parts.begin(), parts.end());
    const Outcome outcome = weft(call);
    EXPECT_EQ(outcome.exit, 2) << sentence;
    EXPECT_NE(outcome.error.find(sentence), std::string::npos) << outcome.error;
    EXPECT_FALSE(fs::exists(folder / "refused"));
  }
};

constexpr const char* kOneCorner =
    R"({"name": "sheet", "contacts": false, "cloths": [{"grid": {"cells": [6, 6], "upright": true}, "anchors": [{"corners": ["low_high"]}]}]})";

// A table without its clocks.
json timeless(const std::string& text) {
  json report = json::parse(text, nullptr, false);
  if (report.is_object())
    for (json& row : report["rows"]) row.erase("wall_seconds");
  return report;
}
std::string without_last_column(const std::string& table) { return std::regex_replace(table, std::regex(",[^,\n]*\n"), "\n"); }

TEST_F(Shards, a_merge_of_parts_that_were_stopped_and_killed_is_the_table_of_one_machine) {
  const std::string sheet = write("sheet.json", kSheet);
  const auto call = [&](const char* where, std::vector<std::string> more = {}) {
    std::vector<std::string> words = {"harden", sheet, "--quick", "--frames", "150", "--out", out(where)};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  const fs::path first = folder / "parts/harden.1-of-2.rows", second = folder / "parts/harden.2-of-2.rows";
  const Outcome stopped = stop(call("parts", {"--shard", "1/2"}), first, SIGTERM);
  EXPECT_EQ(stopped.exit, 75) << stopped.error;
  EXPECT_NE(stopped.error.find("Stopped by SIGTERM after "), std::string::npos) << stopped.error;
  EXPECT_EQ(stop(call("parts", {"--shard", "2/2"}), second, SIGKILL).exit, -SIGKILL);
  const std::string begun = read(first);
  expect_refusal({first, second}, "harden.1-of-2.rows: is not done: it has ");

  const Outcome other = weft(call("parts", {"--shard", "1/2", "--band", "3"}));
  EXPECT_EQ(other.exit, 2);
  EXPECT_NE(other.error.find("is of another scene, device, program or other options"), std::string::npos) << other.error;
  for (const char* shard : {"1/2", "2/2"}) {
    const Outcome resumed = weft(call("parts", {"--shard", shard}));
    EXPECT_EQ(resumed.exit, 0) << resumed.error;
    EXPECT_NE(resumed.out.find("Going on: "), std::string::npos) << resumed.out;
  }
  const std::string whole = read(first);
  EXPECT_EQ(whole.rfind(begun.substr(0, begun.rfind("{\"fingerprint\"")), 0), 0u) << "rows that were there stay, bit for bit";
  EXPECT_EQ(weft(call("parts", {"--shard", "1/2"})).exit, 0);
  EXPECT_EQ(read(first), whole) << "what is done is not done again";

  const Outcome one = weft(call("one")), merged = weft({"merge", second, first, "--out", out("merged")});
  EXPECT_EQ(one.exit, 1) << "two starts fold in other ways in so many frames";
  EXPECT_EQ(merged.exit, 1) << "what did not hold is told by the merge, not by a part";
  for (const Outcome& outcome : {one, merged}) EXPECT_NE(outcome.out.find("NOT HELD: "), std::string::npos) << outcome.out;
  const json table = timeless(read(folder / "merged/harden.json"));
  EXPECT_EQ(table["rows"].size(), 16u);
  EXPECT_EQ(table, timeless(read(folder / "one/harden.json")));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "one"), {}), 1) << "rows of work that is over are gone";

  // What is no whole set of parts is refused, with the name of what is wrong.
  expect_refusal({first}, "of 2 parts 1 is missing: 2");
  expect_refusal({first, first}, "is part 1, which ");
  expect_refusal({first, out("nothing.rows")}, "nothing.rows: cannot be read: No such file");
  expect_refusal({first, sheet}, "sheet.json holds no rows of weft");
  expect_refusal({first, folder}, "cannot be read");
  std::string changed = whole;
  changed[whole.size() / 2] ^= 1;
  expect_refusal({write("changed.rows", changed), second}, "changed.rows is damaged: its fingerprint is not that of its rows");
  expect_refusal({write("cut.rows", whole.substr(0, whole.size() * 2 / 3)), second}, "cut.rows is damaged");
  ASSERT_EQ(weft(call("others", {"--shard", "2/3"})).exit, 0);
  expect_refusal({first, folder / "others/harden.2-of-3.rows"}, "is one of 3 parts, and ");
  ASSERT_EQ(weft(call("others", {"--shard", "16/17", "--band", "3"})).exit, 0);
  ASSERT_EQ(weft(call("others", {"--shard", "17/17"})).exit, 0) << "a part without an item";
  expect_refusal({folder / "others/harden.17-of-17.rows", folder / "others/harden.16-of-17.rows"}, "is not a part of the same work as ");
}

TEST_F(Shards, an_accuracy_sweep_goes_on_where_it_was_interrupted_and_leaves_a_page_that_stands_alone) {
  const std::vector<std::string> call = {"accuracy", write("sheet.json", kOneCorner), "--quick", "--frames", "4", "--budget", "1000ms", "--out",
                                         out()};
  const pid_t child = spawn(call);
  const fs::path csv = folder / "out/curve.csv", rows = folder / "out/accuracy.rows";
  for (int tries = 0; tries < 600 && !fs::exists(rows); ++tries) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  kill(child, SIGINT);
  EXPECT_EQ(wait(child).exit, 130);
  const std::string begun = read(csv);
  const auto lines = std::count(begun.begin(), begun.end(), '\n');
  ASSERT_GT(lines, 7) << "six facts, the header and a point\n" << begun;

  const Outcome outcome = weft(call);
  ASSERT_EQ(outcome.exit, 0) << outcome.error;
  EXPECT_NE(outcome.out.find("Going on: " + std::to_string(lines - 7) + " of "), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("Within 1000 ms: "), std::string::npos) << outcome.out;
  const std::string whole = read(csv), page = read(folder / "out/curve.html");
  EXPECT_EQ(whole.rfind(begun, 0), 0u) << "what was measured stays";
  EXPECT_GT(std::count(whole.begin(), whole.end(), '\n'), lines);
  EXPECT_NE(page.find("<svg"), std::string::npos);
  EXPECT_NE(page.find("data:image/png;base64,iVBOR"), std::string::npos);
  for (const char* elsewhere : {"src=\"http", "href=\"http", "<script", "@import"})
    EXPECT_EQ(page.find(elsewhere), std::string::npos) << elsewhere;
  EXPECT_EQ(read(folder / "out/curve.svg").rfind("<svg", 0), 0u);
  EXPECT_EQ(read(folder / "out/curve.png").substr(1, 3), "PNG");

  // A merge of all parts, here of one, makes the same pages, and a part measures what the whole does but for its times.
  const Outcome merged = weft({"merge", rows.string(), "--out", out("merged")});
  EXPECT_EQ(merged.exit, 0) << merged.error;
  for (const char* name : {"curve.csv", "curve.svg", "curve.png", "curve.html"})
    EXPECT_EQ(read(folder / "merged" / name), read(folder / "out" / name)) << name;
  ASSERT_EQ(weft({"accuracy", (folder / "sheet.json").string(), "--quick", "--frames", "4", "--out", out(), "--shard", "20/30"}).exit, 0);
  const auto points = [](const std::string& text) {
    const std::regex times("(\n[^\n,]*(,[^,]*){6})(,[^,]*){3}|,[^,]*(,[^,]*\n)$");   // of frames, and of passes, before dispatches
    std::map<int, std::string> found;
    std::istringstream lines(text);
    for (std::string at; std::getline(lines, at);)
      if (const json row = json::parse(at, nullptr, false); row.contains("row"))
        found[row["item"]] = std::regex_replace(row["row"].value("point", "none"), times, "$1$4");
    return found;
  };
  const auto all = points(read(rows)), some = points(read(folder / "out/accuracy.20-of-30.rows"));
  ASSERT_EQ(some.size(), 3u);
  for (const auto& [item, point] : some) EXPECT_EQ(point, all.at(item)) << item;

  const Outcome other = weft({"accuracy", (folder / "sheet.json").string(), "--quick", "--frames", "5", "--out", out()});
  EXPECT_EQ(other.exit, 2) << "points of different sweeps make no curve";
  EXPECT_NE(other.error.find("--fresh"), std::string::npos) << other.error;
}

TEST_F(Shards, a_family_of_scenes_leaves_the_caches_and_the_table_of_one_machine_though_a_long_run_was_put_back) {
  const std::string sheet = write("sheet.json", kSheet);
  const std::string falling = write("falling.json", R"({"name": "falling", "frames": 400, "contacts": true,
    "cloths": [{"grid": {"cells": [8, 8]}, "anchors": [{"corners": ["low_low"]}]}], "colliders": [{"centre": [0, -0.5, 0]}]})");
  const auto call = [&](const char* where, std::vector<std::string> more = {}) {
    std::vector<std::string> words = {"run", falling, sheet, "--set", "frames=400", "--no-picture", "--checkpoint", "20",
                                      "--cache", "it.pc2", "--out", out(where)};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  const Outcome stopped = stop(call("parts", {"--shard", "1/2"}), folder / "parts/falling/falling.snapshot", SIGUSR1);
  EXPECT_EQ(stopped.exit, 75) << stopped.error;
  EXPECT_NE(stopped.error.find("Stopped by SIGUSR1 after "), std::string::npos) << stopped.error;
  const Outcome resumed = weft(call("parts", {"--shard", "1/2"}));
  EXPECT_EQ(resumed.exit, 0) << resumed.error;
  EXPECT_NE(resumed.out.find("Going on after frame "), std::string::npos) << resumed.out;
  EXPECT_EQ(weft(call("parts", {"--shard", "2/2"})).exit, 0);
  ASSERT_EQ(weft({"merge", out("parts/run.1-of-2.rows"), out("parts/run.2-of-2.rows"), "--out", out("parts")}).exit, 0);
  const Outcome more = weft(call("parts", {"--shard", "2/2", "--cache", "more.pc2"}));
  EXPECT_EQ(more.exit, 2) << "another cache is other work: " << more.out;
  ASSERT_EQ(weft(call("one")).exit, 0);
  const std::string table = read(folder / "parts/runs.csv");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 3) << table;
  EXPECT_EQ(without_last_column(table), without_last_column(read(folder / "one/runs.csv")));
  for (const char* cache : {"falling/it.pc2", "sheet/it.pc2"}) {
    EXPECT_GT(read(folder / "one" / cache).size(), 300'000u) << cache;
    EXPECT_EQ(read(folder / "parts" / cache), read(folder / "one" / cache)) << cache;
  }
}

TEST_F(Shards, what_is_no_part_is_a_sentence_and_exit_code_2) {
  const std::string sheet = write("sheet.json", kSheet), same = (fs::create_directory(folder / "b"), write("b/sheet.json", kSheet));
  for (const char* shard : {"0/3", "4/3", "1/0", "x", "3", "3/", "/3", "1/3x", "-1/3", "+1/3", " 1/3", "1//3", "99999999999/3",
                            "1/99999999999", "1/100001", ""}) {
    const Outcome outcome = weft({"harden", sheet, "--shard", shard, "--out", out()});
    EXPECT_EQ(outcome.exit, 2) << shard;
    EXPECT_EQ(outcome.error.rfind(std::string("--shard ") + shard + ": ", 0), 0u) << outcome.error;
  }
  const std::vector<std::vector<std::string>> calls = {
      {"run", sheet, same}, {"run", sheet, "--fresh"}, {"run", sheet, "--shard", "1/1", "--cache", "/tmp/a.pc2"},
      {"run", sheet, out("no.json")}, {"contacts", sheet, "--price", "--shard", "1/2"}, {"accuracy", sheet, "--save", "--shard", "1/2"},
      {"time", sheet, "--shard", "1/2"}, {"merge"}};
  for (const std::vector<std::string>& call : calls) {
    const Outcome outcome = weft(call);
    EXPECT_EQ(outcome.exit, 2) << call[0] << ' ' << call.back();
    EXPECT_GT(outcome.error.size(), 10u) << call[0];
  }
}

}  // namespace
}  // namespace weft
