// How many dispatches a frame has: a GPU charges for each, whether there is anything to do or not. The numbers are exact, so that whoever
// adds one has to say so here.
#include <gtest/gtest.h>

#include "engine/solve/solver.h"
#include "tests/support/sheets.h"

namespace weft {
namespace {

using Dispatches = GpuTest;

struct Counted {
  std::size_t without, few, many;   // contacts: off, few of them, many
  std::size_t seldom, calm, none;   // few, and detections are seldom; what is kinematic is at rest, besides; and nothing has met
  std::size_t idle_costs;           // the same, as on the software driver
  std::size_t paired, still;        // no detection is expected: of those that have met, and where nothing has
};

struct Frame {
  bool few = false, seldom = false, rest = false, none = false;   // FrameInput's
  bool idle_costs = false, still = false;
};

// Of a frame of ten substeps, as often as a frame's structure lists them.
std::size_t dispatches_of(const compute::Device& device, const Scene& scene, const Frame& frame) {
  const CookedFabric fabric = must(cook(scene, must(make_meshes(scene))));
  Solver solver = must(Solver::create(device, {}, scene, fabric, {.idle_costs = frame.idle_costs}));
  FrameInput input;
  input.substeps = 10;
  input.few_contacts = frame.few;
  input.seldom_detections = frame.seldom;
  input.kinematics_rest = frame.rest;
  input.no_contacts = input.has_no_candidates = frame.none;
  input.is_still = frame.still;
  return solver.frame(input).size();
}

Counted count(const compute::Device& device, Scene scene) {
  scene.contacts.enabled = false;
  const std::size_t without = dispatches_of(device, scene, {});
  scene.contacts.enabled = true;
  const auto with = [&](const Frame& frame) { return dispatches_of(device, scene, frame); };
  return {without,
          with({.few = true}),
          with({}),
          with({.few = true, .seldom = true}),
          with({.few = true, .seldom = true, .rest = true}),
          with({.few = true, .seldom = true, .rest = true, .none = true}),
          with({.few = true, .seldom = true, .rest = true, .none = true, .idle_costs = true}),
          with({.few = true, .seldom = true, .rest = true, .still = true}),
          with({.few = true, .seldom = true, .rest = true, .none = true, .still = true})};
}

TEST_F(Dispatches, of_a_frame_are_as_many_as_these) {
  Scene free = sheet(8);
  free.solver.method = Method::jacobi;
  free.colliders = {plane(-1)};
  const Counted fallen = count(device(), free);
  EXPECT_EQ(fallen.without, 22u) << "stretch and bending in each substep, a prediction, a surface";
  EXPECT_EQ(fallen.few, 22u + 10 * (9 + 1 + 2)) << "a detection, untangling, contacts in one workgroup, and the end of those with candidates";
  EXPECT_EQ(fallen.many, 22u + 10 * (9 + 1 + 4 * 3 + 2 * WEFT_SLIDES + 1 + WEFT_WIDE_ROUNDS + 1 + 1)) << "contacts pass by pass";
  EXPECT_EQ(fallen.seldom, 22u + 10 * (4 + 1 + 2)) << "a detection by one workgroup, its search and its pairs; what is prepared";
  EXPECT_EQ(fallen.calm, 22u + 10 * (2 + 2)) << "nothing that could have crossed: the search tests and prepares what it finds";
  EXPECT_EQ(fallen.none, 22u + 10 * (2 + 1)) << "contacts' one workgroup ends the substep of those that it may find";
  EXPECT_EQ(fallen.idle_costs, 22u + 10 * (14 + 2)) << "a pass for each kind: idle threads cost more than dispatches";
  EXPECT_EQ(fallen.paired, 22u + 10 * (2 + 2)) << "what empties lists, what is prepared, contacts, and the end of those with candidates";
  EXPECT_EQ(fallen.still, 22u) << "nothing but the cloth";
  Scene hung = free;
  hung.cloths[0].anchors.push_back(held_at({Corner::low_high, Corner::high_high}));
  const Counted held = count(device(), hung);
  EXPECT_EQ(held.without, 22u) << "anchors that do not move";
  EXPECT_EQ(held.few, fallen.few + 10) << "anchors, which cloth may hold back";
  EXPECT_EQ(held.many, fallen.many + 10);
  EXPECT_EQ(held.seldom, fallen.seldom + 10);
  EXPECT_EQ(held.calm, fallen.calm) << "anchors that are where they should be";
  EXPECT_EQ(held.none, fallen.none);
  EXPECT_EQ(held.still, 22u);
}

// Links are swept through up to five times where anchors go by a good part of a link in a substep.
TEST_F(Dispatches, of_links_are_more_where_anchors_are_hasty) {
  const auto count_at = [&](Method method, float haste, std::uint32_t iterations = 1) {
    Scene scene = sheet(24);
    scene.solver.iterations = iterations;
    scene.solver.method = method;
    const CookedFabric fabric = must(cook(scene, must(make_meshes(scene))));
    Solver solver = must(Solver::create(device(), {}, scene, fabric, {}));
    std::size_t links = 0;
    FrameInput input;
    input.substeps = 10;
    input.haste = haste;
    for (const Solver::Step& step : solver.frame(input)) links += solver.plan().passes[step.pass].pass->sweeps != nullptr;
    return links;
  };
  for (const auto& [method, once] : {std::pair(Method::jacobi, 10u), {Method::strands, 30u}}) {
    EXPECT_EQ(count_at(method, 0), once);
    EXPECT_EQ(count_at(method, 0.05f), once);
    EXPECT_EQ(count_at(method, 0.06f), 2 * once);
    EXPECT_EQ(count_at(method, 1), 5 * once);
  }
  EXPECT_EQ(count_at(Method::gauss_seidel, 1), 5 * count_at(Method::gauss_seidel, 0));
  EXPECT_EQ(count_at(Method::jacobi, 1, 2), 20u) << "as many as are asked for";
}

// As shaders/README.md says: it is a matter of time; the software driver has no passes for it.
TEST_F(Dispatches, one_workgroup_does_detections_of_sheets_up_to_a_size) {
  const auto can = [&](std::uint32_t cells, bool idle_costs = false) {
    Scene scene = sheet(cells);
    scene.contacts.enabled = true;
    const CookedFabric fabric = must(cook(scene, must(make_meshes(scene))));
    return must(Solver::create(device(), {}, scene, fabric, {.idle_costs = idle_costs})).can_detect_alone();
  };
  EXPECT_TRUE(can(100));
  EXPECT_FALSE(can(258));
  EXPECT_FALSE(can(20, true));
}

}  // namespace
}  // namespace weft
