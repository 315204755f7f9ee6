// The sweep behind `weft accuracy`: which settings are tried, and how one of them is measured.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "compute/device.h"
#include "engine/reference/curve.h"
#include "engine/scene.h"

namespace weft::command {

/// A solver in the sweep: its name, and what makes a scene use it, as `--set` takes it, separated by blanks.
struct SolverRow {
  std::string_view name, assignments;
};

/// To add a solver to the curve is to add a line. A row that a scene refuses is left out, and the page says why.
inline constexpr SolverRow kSolverRows[] = {
    {"jacobi", "solver.method=jacobi"},
    {"jacobi not over-relaxed", "solver.method=jacobi solver.relaxation=1"},
    {"jacobi on levels", "solver.method=jacobi solver.levels=true"},
    {"second order on levels", "solver.method=jacobi solver.levels=true solver.order=2"},
    {"count-averaged", "solver.method=jacobi solver.averaging=count solver.relaxation=1"},
    {"strands", "solver.method=strands"},
    {"gauss_seidel", "solver.method=gauss_seidel"},
    {"gauss_seidel on levels", "solver.method=gauss_seidel solver.levels=true"},
    {"chebyshev", "solver.method=chebyshev"},
    {"implicit", "solver.method=implicit"},
    {"implicit on levels", "solver.method=implicit solver.levels=true"},
    {"mass_spring", "solver.method=mass_spring"},
    {"verlet", "solver.method=verlet"},
};

struct SweepPlan {
  std::uint32_t frames = 60, warm_up = 10;   // frames of a run, and how many of them are not timed
  std::vector<std::uint32_t> cells;          // of the longest side, ascending; 0 for a scene of meshes
  std::vector<bool> tethers;
  std::vector<std::uint32_t> substeps, iterations;
  std::uint32_t most_passes = 0;             // substeps times iterations, of one iteration
  std::uint32_t most_iterated = 0;           // ... of several
  double most_particle_passes = 0;           // of a frame, times its particles; whatever those are,
  std::uint32_t free_passes = 0;             // so many passes are tried
  std::uint32_t reference_cells = 0;         // the largest resolution with a reference
  std::uint32_t most_steps = 0;              // a frame, of the finest reference
};

struct Setting {
  SolverRow row;
  std::uint32_t cells = 0;
  bool tethers = false;
  std::uint32_t substeps = 1, iterations = 1;
  double work = 0;   // about proportional to the time that it takes: particles times passes times frames

  bool operator==(const CurvePoint& point) const;   // whether the point is this setting's
};

/// `scene` at a resolution, with tethers or without, and nothing else changed. Grids keep the proportions of their cells.
Result<Scene> scene_at(const Scene& scene, std::uint32_t cells, bool tethers);

/// The scene of a setting. An error is why the scene refuses it.
Result<Scene> scene_of(const Scene& scene, const Setting& setting);

/// What is to be tried, cheapest first. `refused` gets a sentence for every row that has no setting.
std::vector<Setting> settings_of(const Scene& scene, const SweepPlan& plan, std::vector<std::string>& refused);

/// Measures one setting: a run from the scene's start, in which errors are measured in every frame and the wall clock in all
/// but the first; then a short one with timestamps. Strain is taken over the frames of the second half. Distances are taken to the
/// references in `folder`, which are made if they are missing and the setting has the resolution for them.
/// Errors: a run that could not be made; "interrupted".
Result<CurvePoint> measure(const compute::Device& device, const Scene& scene, const Setting& setting, const SweepPlan& plan,
                           const std::filesystem::path& folder, std::string& no_reference);

}  // namespace weft::command
