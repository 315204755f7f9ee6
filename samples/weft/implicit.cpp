// `weft implicit`: the table of the particle system that Weft's implicit method grew out of (2006): frames a second for 10 to 70
// iterations, 100 to 10,000 particles, conjugate gradients, without coarse levels and on them, and Jacobi, on the processor and on the
// device, and beside each the residual that it left.
//
// A sheet of 1 m by 1 m with 24 springs a particle is held at two corners and falls; a frame is one step of 0.01 s. Errors are taken
// at one pose for all, that of a converged solver after a fifth of a second, in one step: the part of the residual that
// is left, and the distance from where the converged step goes (rms over the particles). Times are medians over the frames after it,
// wall clock; those on the processor are of one thread in double precision.
#include <chrono>
#include <cmath>
#include <cstdio>

#include "compute/text.h"
#include "engine/reference/implicit.h"
#include "engine/simulation.h"
#include "samples/weft/commands.h"
#include "samples/weft/console.h"
#include "samples/weft/files.h"
#include "samples/weft/merge.h"
#include "samples/weft/outputs.h"
#include "samples/weft/report.h"
#include "samples/weft/shard.h"

namespace weft::command {

// In the namespace of Row's own: what makes rows of these has to be found.
struct ImplicitOutcome {
  double frames_a_second = 0;
  double residual = 0;
  double distance = 0;   // m
  std::uint32_t stopped = 0, non_finite = 0;
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ImplicitOutcome, frames_a_second, residual, distance, stopped, non_finite)

struct ImplicitRow {
  std::uint32_t particles = 0, iterations = 0, solver = 0;   // into kSolvers
  ImplicitOutcome processor, device;
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ImplicitRow, particles, iterations, solver, processor, device)

namespace {

using Outcome = ImplicitOutcome;
using reference::Columns;
using reference::ImplicitEquations;
using reference::ImplicitSystem;

struct LinearSolver {
  const char* name;
  Linear linear;
  bool levels;
};
constexpr LinearSolver kSolvers[] = {{"cg", Linear::cg, false}, {"cg on levels", Linear::cg, true}, {"jacobi", Linear::jacobi, false}};
constexpr auto kSolverCount = static_cast<std::uint32_t>(std::size(kSolvers));

constexpr double kStep = 0.01;                // s
constexpr int kStepsBefore = 20;
constexpr double kTimed = 0.25;               // s, and at least this many steps:
constexpr std::size_t kLeastTimed = 5, kMostTimed = 100;

Scene sheet(std::uint32_t side, const LinearSolver& solver, std::uint32_t iterations) {
  Scene scene;
  scene.contacts.enabled = false;   // springs that the equations are of, and nothing else
  scene.solver.rate = 1 / kStep;
  scene.solver.substeps = 1;
  scene.solver.iterations = iterations;
  scene.solver.method = Method::implicit;
  scene.solver.linear = solver.linear;
  scene.solver.levels = solver.levels;
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{{1, 1}, side - 1, side - 1, Topology::diagonal, false};
  cloth.springs = Springs{{500, 0.01}, {500, 0.01}, {5, 0.001}};
  cloth.tethers = false;
  cloth.anchors.emplace_back().corners = {Corner::low_low, Corner::high_low};
  return scene;
}

// The pose at which errors are taken, rounded to floats so that both processors have the same, and the answer there.
struct Subject {
  Columns positions, velocities;
  ImplicitEquations equations;
  Columns exact;   // m/s
};

Result<ImplicitSystem> system_of(const Scene& scene) {
  const auto meshes = make_meshes(scene);
  if (!meshes) return fail(meshes.why());
  const auto fabric = cook(scene, *meshes);
  if (!fabric) return fail(fabric.why());
  return ImplicitSystem::create(scene, *fabric);
}

Result<Subject> subject_of(std::uint32_t side) {
  auto system = system_of(sheet(side, kSolvers[0], 1));
  if (!system) return system.take_error();
  constexpr std::uint32_t kMany = 5000;
  for (int k = 0; k < kStepsBefore; ++k) {
    const ImplicitEquations equations = system->assemble();
    system->move(equations, solve_conjugate_gradients(equations, kMany, 1e-6));
  }
  system->positions = system->positions.cast<float>().cast<double>();
  system->velocities = system->velocities.cast<float>().cast<double>();
  Subject subject{system->positions, system->velocities, system->assemble(), {}};
  subject.exact = solve_conjugate_gradients(subject.equations, kMany, 1e-10).change;
  return subject;
}

void judge(const Subject& subject, const Columns& change, Outcome& outcome) {
  outcome.residual = subject.equations.residual(change);
  outcome.distance = kStep * (change - subject.exact).norm() / std::sqrt(static_cast<double>(change.cols()));
}

// Steps a second, by the median step. `step` says whether it succeeded.
template <class F>
Result<double> speed_of(F&& step) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> seconds;
  for (double total = 0; seconds.size() < kMostTimed && (seconds.size() < kLeastTimed || total < kTimed); total += seconds.back()) {
    const Clock::time_point start = Clock::now();
    if (Result<void> done = step(); !done) return done.take_error();
    seconds.push_back(std::chrono::duration<double>(Clock::now() - start).count());
  }
  return 1 / spread_of(seconds).median;
}

Result<Outcome> on_processor(const Scene& scene, const Subject& subject) {
  auto system = system_of(scene);
  if (!system) return system.take_error();
  system->positions = subject.positions;
  system->velocities = subject.velocities;
  Outcome outcome;
  judge(subject, system->solve(system->assemble()).change, outcome);
  const Result<double> speed = speed_of([&]() -> Result<void> {
    system->step();
    return {};
  });
  outcome.frames_a_second = *speed;
  outcome.stopped = static_cast<std::uint32_t>(system->report().stopped);
  outcome.non_finite = !system->positions.allFinite();
  return outcome;
}

std::vector<gpu::vec4> wide(const Columns& values) {
  std::vector<gpu::vec4> made;
  for (Eigen::Index i = 0; i < values.cols(); ++i)
    made.push_back({static_cast<float>(values(0, i)), static_cast<float>(values(1, i)), static_cast<float>(values(2, i)), 0});
  return made;
}

Result<Outcome> on_device(const compute::Device& device, const Scene& scene, const Subject& subject) {
  SimulationOptions options;
  options.pipeline_cache = pipeline_cache();
  auto created = Simulation::create(device, scene, options);
  if (!created) return created.take_error();
  Simulation& simulation = **created;
  const auto step = [&]() -> Result<void> {
    auto advance = simulation.advance(kStep);
    return advance ? Result<void>() : Result<void>(advance.take_error());
  };
  // Twice: the first frame of a process compiles.
  Outcome outcome;
  for (int k = 0; k < 2; ++k) {
    if (auto done = simulation.write_positions(wide(subject.positions)); !done) return done.take_error();
    if (auto done = simulation.write_velocities(wide(subject.velocities)); !done) return done.take_error();
    if (auto done = step(); !done) return done.take_error();
  }
  const auto velocities = simulation.read_velocities();
  if (!velocities) return fail(velocities.why());
  Columns change(3, velocities->size());
  for (std::size_t i = 0; i < velocities->size(); ++i)
    change.col(static_cast<Eigen::Index>(i)) << (*velocities)[i].x, (*velocities)[i].y, (*velocities)[i].z;
  judge(subject, subject.equations.filtered(change - subject.equations.flight), outcome);
  const Result<double> speed = speed_of(step);
  if (!speed) return fail(speed.why());
  outcome.frames_a_second = *speed;
  outcome.stopped = simulation.counts().stopped;
  outcome.non_finite = simulation.counts().non_finite;
  return outcome;
}

const char* name_of(const ImplicitRow& row) { return kSolvers[std::min(row.solver, kSolverCount - 1)].name; }

void print(const ImplicitRow& row) {
  std::printf("%9u %-12s %10u %10.4g %10.4g %12.2e %12.2e %12.2e %12.2e%s\n", row.particles, name_of(row), row.iterations,
              row.processor.frames_a_second, row.device.frames_a_second, row.processor.residual, row.device.residual,
              row.processor.distance, row.device.distance, row.device.residual > ImplicitSystem::kConverged ? "  not converged" : "");
  std::fflush(stdout);
}

std::string csv_of(const std::vector<ImplicitRow>& rows) {
  TextStream text;
  text << "particles,solver,iterations,processor,frames_per_second,residual,rms_distance_m,stopped,non_finite\n";
  for (const ImplicitRow& row : rows)
    for (const bool device : {false, true}) {
      const Outcome& o = device ? row.device : row.processor;
      text << row.particles << ',' << name_of(row) << ',' << row.iterations << ',' << (device ? "vulkan" : "cpu") << ','
           << o.frames_a_second << ',' << o.residual << ',' << o.distance << ',' << o.stopped << ',' << o.non_finite << '\n';
    }
  return text.str();
}

const ImplicitRow* find(const std::vector<ImplicitRow>& rows, std::uint32_t particles, std::uint32_t iterations) {   // by cg
  for (const ImplicitRow& row : rows)
    if (row.particles == particles && row.solver == 0 && row.iterations == iterations) return &row;
  return nullptr;
}

// The findings about the system of 2006, checked for this one.
void summarise(const std::vector<ImplicitRow>& rows) {
  std::uint32_t wins = 0, largest = 0, non_finite = 0;
  for (const ImplicitRow& row : rows) {
    non_finite += row.processor.non_finite + row.device.non_finite;
    largest = std::max(largest, row.particles);
    if (row.solver != 0 || row.iterations != 30) continue;
    if (row.device.frames_a_second <= row.processor.frames_a_second) wins = 0;
    else if (wins == 0) wins = row.particles;
  }
  if (wins > 0) std::printf("With 30 iterations of conjugate gradients the device is faster from %u particles on.\n", wins);
  else std::printf("With 30 iterations of conjugate gradients the device is not faster at %u particles.\n", largest);
  const ImplicitRow *few = find(rows, largest, 10), *many = find(rows, largest, 70);
  if (few && many)
    std::printf("At %u particles 70 iterations take %.1f times as long as 10 on the processor and %.1f times on the device.\n", largest,
                few->processor.frames_a_second / many->processor.frames_a_second,
                few->device.frames_a_second / many->device.frames_a_second);
  std::printf("Not finite: %u\n", non_finite);
}

constexpr const char* kImplicitTable = "implicit.csv";

Exit conclude_implicit(const Rows& all, const std::filesystem::path& out) {
  std::printf("%9s %-12s %10s %10s %10s %12s %12s %12s %12s\n%33s %21s %25s %25s\n", "particles", "solver", "iterations", "CPU fps",
              "Vulkan fps", "CPU", "Vulkan", "CPU", "Vulkan", "", "", "residual left", "rms distance, m");
  std::vector<ImplicitRow> rows;
  for (const auto& [item, row] : all.rows) print(rows.emplace_back(row.get<ImplicitRow>()));
  summarise(rows);
  if (const Result<void> written = write_text(out / kImplicitTable, csv_of(rows)); !written) return failed(written.error());
  std::printf("Written: %s in %s\n", kImplicitTable, out.string().c_str());
  return kDone;
}

}  // namespace

Exit implicit(const ImplicitOptions& options) {
  listen_for_interrupts();
  const std::vector<std::string> names = outputs_of("implicit", options.farm.shard, {kImplicitTable});
  if (const Exit exit = prepare_outputs(options.out, names, {}); exit != kDone) return exit;
  compute::DeviceChoice choice;
  choice.name = options.device;
  const auto device = compute::Device::create(choice);
  if (!device) return failed(device.error());
  const std::vector<std::uint32_t> sides =
      options.quick ? std::vector<std::uint32_t>{10, 30} : std::vector<std::uint32_t>{10, 20, 30, 40, 50, 60, 100};
  const std::vector<std::uint32_t> iterations =
      options.quick ? std::vector<std::uint32_t>{10, 30} : std::vector<std::uint32_t>{10, 30, 50, 70};

  std::printf("%s; a frame is one step of %g s\n", (*device)->name().c_str(), kStep);
  const auto counts = static_cast<std::uint32_t>(iterations.size());
  std::uint32_t side = 0;
  std::optional<Subject> subject;   // of that side
  Labour labour;
  labour.measure = [&](std::uint32_t item) -> Result<Row> {
    if (side != sides[item / (kSolverCount * counts)]) {
      side = sides[item / (kSolverCount * counts)];
      auto made = subject_of(side);
      if (!made) return made.take_error();
      subject = std::move(*made);
    }
    const std::uint32_t solver = item / counts % kSolverCount;
    const Scene scene = sheet(side, kSolvers[solver], iterations[item % counts]);
    const auto processor = on_processor(scene, *subject), vulkan = on_device(**device, scene, *subject);
    if (!processor || !vulkan) return fail((processor ? vulkan : processor).why());
    return Row(ImplicitRow{side * side, iterations[item % counts], solver, *processor, *vulkan});
  };
  labour.conclude = [&](const Rows& all) { return conclude_implicit(all, options.out); };
  Work work{"implicit", {{"device", (*device)->name()}, {"quick", options.quick}}};
  work.items = static_cast<std::uint32_t>(sides.size()) * kSolverCount * counts;
  return work_through(work, labour, options.farm, options.out);
}

Mergeable merged_implicit() { return {"implicit", {kImplicitTable}, conclude_implicit}; }

}  // namespace weft::command
