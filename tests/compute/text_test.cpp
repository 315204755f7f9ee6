// What Weft says and writes does not follow the locale of its host.
#include "compute/text.h"

#include <gtest/gtest.h>

#include <clocale>
#include <locale>
#include <sstream>
#include <string>
#include <vector>

#include "compute/result.h"
#include "engine/export.h"
#include "engine/figures.h"
#include "engine/mesh.h"
#include "engine/reference/choice.h"
#include "engine/scene.h"
#include "tests/support/mesh_files.h"

namespace weft {
namespace {

using test::Folder;
using test::slurp;

struct Comma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

/// A host that writes 1.234,5; its C library too, where the system has such a locale.
class CommaHost {
 public:
  CommaHost() : before_(std::locale::global(std::locale(std::locale::classic(), new Comma))) {
    for (const char* name : {"de_DE.UTF-8", "de_DE", "fr_FR.UTF-8", "nl_NL.UTF-8"})
      if (std::setlocale(LC_NUMERIC, name) != nullptr) break;
  }
  ~CommaHost() {
    std::locale::global(before_);
    std::setlocale(LC_NUMERIC, "C");
  }

 private:
  std::locale before_;
};

// Everything without a device that makes text of numbers, or numbers of text.
std::vector<std::string> everything() {
  const Folder folder;
  std::vector<std::string> all = {fail("0.5 is ", 0.5, ", ", 0.25f, " and ", 1234567, " of ", std::uint64_t{12345678}).message,
                                  rounded_text(1234.5678, 6), rounded_text(1e-7 / 3, 3)};
  const auto wrong = parse_scene(R"({"frames": 1234567890123, "gravity": [0, -1e200, 0.5], "solver": {"relaxation": 3.5, "rate": -0.5},
      "cloths": [{"grid": {"cells": [100, 100]}, "anchors": [{"vertices": [1234567]}], "fabric": {"area_density": -1234.5}}]})", {}, {});
  all.push_back(wrong ? "" : wrong.error());
  const auto relaxed = parse_scene(R"({"solver": {"relaxation": 1.75}, "cloths": [{"grid": {}}]})", {}, {});
  all.push_back(relaxed ? "" : relaxed.error());

  const Scene scene = parse_scene(R"({"contacts": true, "gravity": [0, -9.81, 0.125], "solver": {"method": "auto", "budget_ms": 2.5},
      "cloths": [{"grid": {"cells": [40, 40]}, "anchors": [{"corners": ["low_low"]}]}]})", {}, {}).value();
  all.push_back(scene_text(scene));
  std::string note;
  const auto chosen = with_choice(scene, 12345, builtin_curve(), note);
  all.push_back(note);
  all.push_back(curve_csv(parse_curve(curve_csv(builtin_curve())).value()));
  const auto fabric = cook(*chosen, make_meshes(*chosen).value());
  all.push_back(summary_of(*chosen, *fabric));
  for (const std::string& said : fabric->notes) all.push_back(said);
  Counts counts;
  counts.contacts_most = counts.detections = counts.truncated = counts.unconverged = counts.contacts_overflowed = 12345;
  counts.tracking_error = 0.00125f;
  counts.residual = 0.0125f;
  for (const Method method : {Method::jacobi, Method::implicit}) {
    Scene run = *chosen;
    run.solver.method = method;
    for (const std::string& said : remarks_on(run, *fabric, counts)) all.push_back(said);
  }

  const std::string obj = "v 0 0 0\nv 1.5 0 0\nv 0 1.25 0\nv 1.5 1.25 0.0625\nf 1 2 4\nf 1 4 3\n";
  const auto mesh = load_mesh(folder.write("sheet.obj", obj));
  for (const Vec3& p : mesh->points) all.push_back(rounded_text(double(p.x) + 10 * double(p.y) + 100 * double(p.z), 9));
  const std::vector<Vec3> positions(1234, Vec3{0.5f, 1.5f, 2.5f});
  const std::vector<float> strain(positions.size(), 0.5f);
  EXPECT_TRUE(write_ply(folder / "sheet.ply", positions, {}, strain, std::vector<Triangle>(1234, Triangle{0, 1, 1233})));
  EXPECT_TRUE(write_glb(folder / "sheet.glb", mesh->render));
  for (const char* name : {"sheet.ply", "sheet.glb"}) all.push_back(slurp(folder / name));
  return all;
}

TEST(Text, says_the_same_whatever_the_locale_of_the_host) {
  const std::vector<std::string> plain = everything();
  const CommaHost host;
  std::ostringstream proof;
  proof << 1234.5;
  ASSERT_EQ(proof.str(), "1.234,5");
  const std::vector<std::string> abroad = everything();
  ASSERT_EQ(plain.size(), abroad.size());
  for (std::size_t i = 0; i < plain.size(); ++i) EXPECT_EQ(plain[i], abroad[i]);
}

}  // namespace
}  // namespace weft
