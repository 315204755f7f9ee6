// `weft drape`: the drape coefficients of a scene's cloths, which hang over the rim of what holds them, beside published ones.
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "engine/image.h"
#include "engine/simulation.h"
#include "samples/weft/commands.h"
#include "samples/weft/console.h"
#include "samples/weft/drape_measure.h"
#include "samples/weft/files.h"
#include "samples/weft/outputs.h"
#include "samples/weft/plot.h"
#include "samples/weft/subject.h"

namespace weft::command {

namespace {

// Measured coefficients of cloth of each kind: discs of 30 cm over plates of 18 cm. Leather's are from its source; the others as later
// works cite them.
struct Published {
  const char* preset;
  double least, most;
  const char* source;
};
constexpr Published kPublished[] = {
    {"silk", 0.20, 0.40, "light woven silks: Matsudaira and Yang 2003, Textile Research Journal 73(3)"},
    {"cotton", 0.48, 0.72, "one plain weave at 18 to 32 picks/cm: Analysis of a Fabric Drape Profile, Fibres and Textiles 1/2018"},
    {"denim", 0.77, 0.89, "cotton and polyester of 220 to 250 g/m2 in six weaves: the same 1/2018; none of denim itself is known"},
    {"leather", 0.4735, 0.699, "sheep garment leather of 0.64 to 0.96 mm: Memon et al. 2021, Materials 14(16), 4553"},
};

struct DrapeRow {
  std::string cloth, preset;
  double area_density, bend, shear;   // kg/m^2, N m, N/m
  double bending_length;              // m: (B / (rho g))^(1/3), Peirce 1930
  double coefficient;
  const Published* published = nullptr;
};

const Published* published(const std::string& preset) {
  for (const Published& row : kPublished)
    if (row.preset == preset) return &row;
  return nullptr;
}

std::vector<DrapeRow> rows_of(const Simulation& simulation, std::span<const gpu::vec4> positions) {
  const CookedFabric& fabric = simulation.fabric();
  std::vector<DrapeRow> rows;
  for (std::size_t k = 0; k < fabric.cloths.size(); ++k) {
    const Cloth& cloth = simulation.scene().cloths[k];
    const double gravity = std::abs(double(simulation.scene().gravity.y));
    rows.push_back({cloth.name, cloth.fabric.preset, cloth.fabric.area_density, cloth.fabric.bend, cloth.fabric.shear,
                    std::cbrt(cloth.fabric.bend / (cloth.fabric.area_density * gravity)),
                    drape_coefficient(fabric, fabric.cloths[k], fabric.positions, positions).value_or(0), published(cloth.fabric.preset)});
  }
  return rows;
}

void print(const std::vector<DrapeRow>& rows) {
  std::printf("%-12s %8s %12s %10s %12s %8s   %s\n", "cloth", "g/m2", "bend N m", "shear N/m", "bend. length", "drape", "published");
  for (const DrapeRow& row : rows) {
    std::printf("%-12s %8.4g %12.3g %10.4g %9.3g mm %6.1f %%", row.cloth.c_str(), 1000 * row.area_density, row.bend, row.shear,
                1000 * row.bending_length, 100 * row.coefficient);
    if (const Published* one = row.published)
      std::printf("   %.0f to %.0f %%, it %s: %s", 100 * one->least, 100 * one->most,
                  row.coefficient < one->least ? "is limper" : row.coefficient > one->most ? "is stiffer" : "fits", one->source);
    std::printf("\n");
  }
}

std::string csv(const std::vector<DrapeRow>& rows) {
  std::string text =
      "cloth,preset,area_density_kg_m2,bend_N_m,shear_N_m,bending_length_m,drape_coefficient,published_least,published_most\n";
  for (const DrapeRow& row : rows) {
    char line[256];
    std::snprintf(line, sizeof line, ",%g,%g,%g,%g,%g,", row.area_density, row.bend, row.shear, row.bending_length, row.coefficient);
    text += quoted(row.cloth) + "," + quoted(row.preset) + line;
    if (row.published) text += std::to_string(row.published->least) + "," + std::to_string(row.published->most) + "\n";
    else text += ",\n";
  }
  return text;
}

Drawing drape_plot(const std::vector<DrapeRow>& rows) {
  Panel panel{"Cusick's drape coefficient", "bending length (mm)", "of the free ring (%)", {}, {}};
  Series ends{"published, least and most", {120, 120, 120}, {}};
  std::size_t colour = 0;
  for (const DrapeRow& row : rows) {
    const double length = 1000 * row.bending_length;
    if (!std::isfinite(length)) continue;   // without gravity nothing drapes
    if (row.coefficient > 0) panel.series.push_back({row.cloth, series_colour(colour++), {{length, 100 * row.coefficient}}});
    if (!row.published) continue;
    for (const double end : {row.published->least, row.published->most}) ends.points.push_back({length, 100 * end});
  }
  panel.series.push_back(std::move(ends));
  return plot({panel}, 1);
}

constexpr const char *kTable = "drape.csv", *kPlot = "drape.svg", *kPicture = "drape.png";
const std::vector<std::string> kFiles = {kTable, kPlot, kPicture};

}  // namespace

Exit drape(const DrapeOptions& options) {
  const Result<Scene> scene = load_subject(options.file, options.assignments, options.buffer_files);
  if (!scene) {
    complain(scene.error());
    return kBadInput;
  }
  listen_for_interrupts();
  if (const Exit exit = prepare_outputs(options.out, kFiles, inputs_of(options.file, *scene)); exit != kDone) return exit;
  compute::DeviceChoice choice;
  choice.name = options.device;
  const auto device = compute::Device::create(choice);
  if (!device) return failed(device.error());
  Started started = start(**device, *scene, false);
  if (!started.simulation) return started.exit;
  const CookedFabric& fabric = started.simulation->fabric();
  for (std::size_t k = 0; k < fabric.cloths.size(); ++k) {
    if (drape_coefficient(fabric, fabric.cloths[k], fabric.positions, fabric.positions)) continue;
    complain(options.file.string() + ": cloth '" + scene->cloths[k].name +
             "' does not start flat with a part of it held and a part free: what drapes hangs over the rim of a plate that holds it");
    return kBadInput;
  }
  const std::uint32_t frames = options.frames.value_or(scene->frames);
  Progress progress("draping", frames, "frames");
  for (std::uint32_t frame = 0; frame < frames && !interrupted(); ++frame) {
    if (const auto advance = started.simulation->advance(1 / scene->solver.rate); !advance) return failed(advance.error());
    progress.step();
  }
  const auto positions = started.simulation->read_positions();
  if (!positions) return failed(positions.error());
  const std::vector<DrapeRow> rows = rows_of(*started.simulation, *positions);
  print(rows);
  if (const Result<void> written = write_text(options.out / kTable, csv(rows)); !written) return failed(written.error());
  if (const Result<void> written = write_text(options.out / kPlot, svg(drape_plot(rows))); !written) return failed(written.error());
  if (const Result<void> written = write_png(options.out / kPicture, picture(drape_plot(rows))); !written) return failed(written.error());
  std::printf("Written: %s, %s, %s in %s\n", kTable, kPlot, kPicture, options.out.string().c_str());
  return interrupted() ? stopped(": the frames are fewer than were asked for") : kDone;
}

}  // namespace weft::command
