// `weft contacts`: what contacts cost, pass by pass, over the size of a sheet; what it saves to use found pairs again; and whether
// the automatic cell of the spatial hash is the right one. With --price what they cost a scene as it is.
#include <algorithm>
#include <cstdio>
#include <optional>
#include <span>
#include <utility>

#include "engine/image.h"
#include "samples/weft/commands.h"
#include "samples/weft/console.h"
#include "samples/weft/contact_costs.h"
#include "samples/weft/contact_price.h"
#include "samples/weft/files.h"
#include "samples/weft/merge.h"
#include "samples/weft/outputs.h"
#include "samples/weft/plot.h"
#include "samples/weft/shard.h"
#include "samples/weft/subject.h"

namespace weft::command {

namespace {

constexpr std::uint32_t kSizes[] = {30, 50, 100, 150, 200, 300}, kQuickSizes[] = {30, 60};   // vertices along a side
constexpr double kCells[] = {0.6, 0.8, 1, 1.25, 1.6, 2.2, 3};   // times the automatic choice ...
constexpr std::size_t kAutomatic = 2;                           // ... which is this one
constexpr std::uint32_t kRepeats = 4;   // of the series over all cells; the fastest counts, since other programs use the machine too
constexpr std::uint32_t kCellSize = 100, kQuickCellSize = 50;   // vertices along a side when cells are compared
constexpr std::uint32_t kCellFrames = 20;

void print_heading(const ContactCosts& costs) {
  std::printf("%5s", "n");
  for (const PassCost& pass : costs.passes) std::printf(" %12s", pass.name.c_str());
  std::printf(" %10s %9s %8s %8s %8s %7s %7s\n", "ms/search", "searches", "search", "contacts", "solve", "share", "saved");
}

// The share of searches saved, against one in every substep.
double saved(const ContactCosts& costs) { return costs.substeps > 0 ? 1 - static_cast<double>(costs.searches) / costs.substeps : 0; }
double share(const ContactCosts& costs) { return (costs.search + costs.contacts) / (costs.search + costs.contacts + costs.solve); }

void print_row(const ContactCosts& costs) {
  std::printf("%5u", costs.vertices);
  for (const PassCost& pass : costs.passes) std::printf(" %12.3f", pass.ms);
  std::printf(" %10.2f %9u %8.2f %8.2f %8.2f %5.0f %% %5.1f %%\n", costs.per_search(), costs.searches, costs.search, costs.contacts,
              costs.solve, 100 * share(costs), 100 * saved(costs));
  std::fflush(stdout);
}

std::string csv(const std::vector<ContactCosts>& rows) {
  std::string text =
      "vertices,edge_m,cell_m,substeps,searches,pairs_most,pairs_lost,ms_per_search,"
      "search_ms_per_frame,contacts_ms_per_frame,solve_ms_per_frame";
  if (!rows.empty())
    for (const PassCost& pass : rows[0].passes) text.append(",").append(pass.name).append("_ms_per_search");
  text += "\n";
  for (const ContactCosts& row : rows) {
    char line[256];
    std::snprintf(line, sizeof line, "%u,%g,%g,%u,%u,%u,%u,%g,%g,%g,%g", row.vertices, row.edge, row.cell, row.substeps, row.searches,
                  row.pairs_most, row.pairs_overflowed, row.per_search(), row.search, row.contacts, row.solve);
    text += line;
    for (const PassCost& pass : row.passes) text.append(",").append(std::to_string(pass.ms));
    text += "\n";
  }
  return text;
}

// Milliseconds a search over the cell's size, in edges.
Drawing cell_plot(const std::vector<ContactCosts>& rows) {
  const ContactCosts& chosen = rows[kAutomatic];
  Series all{"any cell", series_colour(0), {}};
  Series automatic{"the automatic choice", series_colour(4), {{chosen.cell / chosen.edge, chosen.per_search()}}};
  for (const ContactCosts& row : rows) all.points.push_back({row.cell / row.edge, row.per_search()});
  char title[64];
  std::snprintf(title, sizeof title, "a search, %u x %u vertices", chosen.vertices, chosen.vertices);
  return plot({{title, "cell (edges)", "ms", {all, automatic}, {}}}, 1);
}

// The fastest search of several with each of kCells, in turns.
Result<std::vector<ContactCosts>> compare_cells(const compute::Device& device, const Scene& scene, std::uint32_t size) {
  auto automatic = contact_costs(device, scene, size, kCellFrames, 0);
  if (!automatic) return automatic.take_error();
  std::vector<ContactCosts> cells(std::size(kCells), *automatic);
  Progress progress("comparing cells", kRepeats * std::size(kCells), "runs");
  for (std::uint32_t repeat = 0; repeat < kRepeats && !interrupted(); ++repeat)
    for (std::size_t k = 0; k < std::size(kCells); ++k) {
      auto costs = contact_costs(device, scene, size, kCellFrames, kCells[k] * automatic->cell);
      if (!costs) return costs.take_error();
      if (repeat == 0 || costs->per_search() < cells[k].per_search()) cells[k] = std::move(*costs);
      progress.step();
    }
  return cells;
}

Exit compare_prices(const compute::Device& device, const Scene& scene, const ContactOptions& options) {
  const auto prices = contact_prices(device, scene, options.frames);
  if (!prices) return failed(prices.error());
  print(*prices, scene.name + " on " + device.name());
  if (const Result<void> written = write_text(options.out / "price.csv", csv(*prices)); !written) return failed(written.error());
  std::printf("Written: price.csv in %s\n", options.out.string().c_str());
  return interrupted() ? stopped(": the frames are fewer than were asked for") : kDone;
}

constexpr const char *kSizesFile = "contacts.csv", *kCellsFile = "cells.csv", *kCellsPlot = "cells.svg", *kCellsPicture = "cells.png";
const std::vector<std::string> kContactFiles = {kSizesFile, kCellsFile, kCellsPlot, kCellsPicture};

std::vector<std::uint32_t> sizes_of(bool quick) {
  const auto sizes = quick ? std::span<const std::uint32_t>(kQuickSizes) : std::span<const std::uint32_t>(kSizes);
  return {sizes.begin(), sizes.end()};
}

void print_cells(const std::vector<ContactCosts>& cells) {
  const ContactCosts& chosen = cells[kAutomatic];
  std::printf("%12s %12s %12s   %u x %u vertices\n", "cell m", "edges", "ms/search", chosen.vertices, chosen.vertices);
  double best = chosen.per_search();
  for (const ContactCosts& costs : cells) {
    std::printf("%12.4g %12.3g %12.3f%s\n", costs.cell, costs.cell / costs.edge, costs.per_search(),
                &costs == &chosen ? "   the automatic choice" : "");
    best = std::min(best, costs.per_search());
  }
  std::printf("the automatic choice takes %.2f times as long as the best\n", chosen.per_search() / best);
}

// The last row is that of the cells, which are compared in turns on one machine.
Exit conclude_contacts(const Rows& all, const std::filesystem::path& out) {
  std::vector<ContactCosts> rows;
  std::optional<std::vector<ContactCosts>> cells;
  for (const auto& [item, row] : all.rows) {
    if (item + 1 < all.work.items) rows.push_back(row.at("size").get<ContactCosts>());
    else cells = row.at("cells").get<std::vector<ContactCosts>>();
  }
  if (const Result<void> written = write_text(out / kSizesFile, csv(rows)); !written) return failed(written.error());
  if (!cells || cells->size() != std::size(kCells)) return kDone;   // it was interrupted before
  std::printf("a search grows with n^%.2f\n", growth(rows));
  print_cells(*cells);
  if (const Result<void> written = write_text(out / kCellsFile, csv(*cells)); !written) return failed(written.error());
  if (const Result<void> written = write_text(out / kCellsPlot, svg(cell_plot(*cells))); !written) return failed(written.error());
  if (const Result<void> written = write_png(out / kCellsPicture, picture(cell_plot(*cells))); !written) return failed(written.error());
  std::printf("Written: %s, %s, %s, %s in %s\n", kSizesFile, kCellsFile, kCellsPlot, kCellsPicture, out.string().c_str());
  return kDone;
}

Exit compare_sizes(const compute::Device& device, const Scene& scene, const ContactOptions& options) {
  std::printf("%s on %s: ms a search, pass by pass; then ms a frame\n", scene.name.c_str(), device.name().c_str());
  const std::vector<std::uint32_t> sizes = sizes_of(options.quick);
  bool headed = false;
  Labour labour;
  labour.measure = [&](std::uint32_t item) -> Result<Row> {
    if (item == sizes.size()) {
      const auto cells = compare_cells(device, scene, options.quick ? kQuickCellSize : kCellSize);
      return cells ? Result<Row>(Row{{"cells", *cells}}) : fail(cells.why());
    }
    const auto costs = contact_costs(device, scene, sizes[item], options.frames, 0);
    if (!costs) return fail(costs.why());
    if (!std::exchange(headed, true)) print_heading(*costs);
    print_row(*costs);
    return Row{{"size", *costs}};
  };
  labour.conclude = [&](const Rows& all) { return conclude_contacts(all, options.out); };
  Work work{"contacts", {{"device", device.name()}, {"frames", options.frames}, {"quick", options.quick}}};
  work.of = fingerprint_of(scene, options.file);
  work.items = static_cast<std::uint32_t>(sizes.size()) + 1;
  return work_through(work, labour, options.farm, options.out);
}

}  // namespace

Exit contacts(const ContactOptions& options) {
  const Result<Scene> scene = load_subject(options.file, options.assignments);
  if (!scene) {
    complain(scene.error());
    return kBadInput;
  }
  for (const Cloth& cloth : scene->cloths)
    if (!cloth.grid && !options.price) {
      complain(options.file.string() + ": cloth '" + cloth.name + "' is a mesh: sizes are compared on grids only");
      return kBadInput;
    }
  listen_for_interrupts();
  const std::vector<std::string> names =
      options.price ? std::vector<std::string>{"price.csv"} : outputs_of("contacts", options.farm.shard, kContactFiles);
  if (const Exit exit = prepare_outputs(options.out, names, inputs_of(options.file, *scene)); exit != kDone) return exit;
  compute::DeviceChoice choice;
  choice.name = options.device;
  const auto device = compute::Device::create(choice);
  if (!device) return failed(device.error());
  return options.price ? compare_prices(**device, *scene, options) : compare_sizes(**device, *scene, options);
}

Mergeable merged_contacts() {
  return {"contacts", kContactFiles, [](const Rows& all, const std::filesystem::path& out) {
            bool headed = false;
            for (const auto& [item, row] : all.rows) {
              if (item + 1 == all.work.items) break;
              const auto costs = row.at("size").get<ContactCosts>();
              if (!std::exchange(headed, true)) print_heading(costs);
              print_row(costs);
            }
            return conclude_contacts(all, out);
          }};
}

}  // namespace weft::command
