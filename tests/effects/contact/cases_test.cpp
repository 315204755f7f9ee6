// The promise that cloth never crosses cloth, in hard cases: at every frame an independent checker
// (engine/reference/intersections.h), which shares nothing with the passes, must find nothing, and no contact may overflow.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <numbers>
#include <string>

#include "compute/commands.h"
#include "engine/reference/intersections.h"
#include "tests/support/mesh_files.h"
#include "tests/support/printing.h"
#include "tests/support/sheets.h"
#include "tests/support/ways.h"

namespace weft {
namespace {

using ContactCase = GpuTest;

std::uint64_t crossings_of(const Simulation& simulation) {
  std::vector<Vec3> places;
  for (const gpu::vec4& p : must(simulation.read_positions())) places.push_back({p.x, p.y, p.z});
  return count_crossings(places, std::span(simulation.fabric().triangles).first(simulation.fabric().cloth_triangles));
}

// Runs a scene in turns in all three ways, or `only_advance`, and looks at every frame. Prints the strain that it cost.
void run_without_crossing(Simulation& simulation, int frames, bool only_advance = false) {
  Strain worst, last;
  for (int frame = 0; frame < frames; ++frame) {
    if (only_advance || frame % 3 == 0) must(simulation.advance(kFrame));
    else if (frame % 3 == 1) must(simulation.submit(kFrame));
    else must(compute::run_once(simulation.device(), "host", [&](VkCommandBuffer commands) { must(simulation.record(commands, kFrame)); }));
    ASSERT_EQ(crossings_of(simulation), 0u) << "after frame " << frame;
    last = strain_of(simulation);
    worst = {std::max(worst.mean, last.mean), 0, std::max(worst.max, last.max)};
  }
  if (frames > 1)
    std::printf("%d frames without a crossing; strain %.3g / %.3g %% at the end, %.3g / %.3g %% in the worst frames\n", frames,
                100 * last.mean, 100 * last.max, 100 * worst.mean, 100 * worst.max);
  EXPECT_EQ(simulation.counts().contacts_overflowed, 0u);
  EXPECT_EQ(simulation.counts().non_finite, 0u);
}

// What scenes with contacts begin with: a sheet of `size` metres, `cells` a side, with its middle at `centre`.
Cloth cloth_of(Vec2 size, std::uint32_t cells, Vec3 centre, Topology topology = Topology::diagonal) {
  Cloth cloth;
  cloth.grid = Grid{size, cells, cells, topology, false};
  cloth.transform.translate = centre;
  cloth.fabric.thickness = 0.002;
  return cloth;
}

Scene scene_with(std::vector<Cloth> cloths) {
  Scene scene;
  scene.contacts.enabled = true;
  scene.cloths = std::move(cloths);
  return scene;
}

// Two opposite edges turn against each other, two full turns each, and come together as the cloth shortens. The same as
// assets/scenes/twist.json, with fewer vertices and contact iterations for time's sake.
Scene twist(std::uint32_t vertices, Topology topology, double seconds) {
  Cloth cloth = cloth_of({1, 0.3f}, vertices - 1, {0, 0, 0}, topology);
  cloth.fabric.thickness = 0.001;
  cloth.tethers = false;
  for (const float side : {-1.0f, 1.0f}) {
    Anchor anchor;
    anchor.box = Anchor::Box{{0.5f * side - 1e-3f, -1, -1}, {0.5f * side + 1e-3f, 1, 1}};
    Key start, end;
    start.axis = end.axis = {1, 0, 0};
    end.time = seconds;
    end.degrees = 720 * side;
    end.translate = {-0.1f * side, 0, 0};
    anchor.keys = {start, end};
    cloth.anchors.push_back(anchor);
  }
  return scene_with({cloth});
}

class Twist : public GpuTest, public testing::WithParamInterface<std::pair<std::uint32_t, Topology>> {};

TEST_P(Twist, four_full_turns_never_cross) {
  const auto [vertices, topology] = GetParam();
  constexpr double kSeconds = 4;
  const auto simulation = must(Simulation::create(device(), twist(vertices, topology, kSeconds)));
  run_without_crossing(*simulation, static_cast<int>(60 * kSeconds) + 15);
  EXPECT_GT(simulation->counts().contacts_most, 1000u) << "the scene wound up nothing";
}

INSTANTIATE_TEST_SUITE_P(Sizes, Twist,
                         testing::Values(std::pair(24u, Topology::diagonal), std::pair(20u, Topology::centre)),
                         [](const auto& info) {
                           return std::to_string(info.param.first) + (info.param.second == Topology::diagonal ? "_diagonal" : "_centre");
                         });

// Every sheet is turned a little against the one below, so that no two of them lie vertex on vertex.
TEST_F(ContactCase, ten_sheets_dropped_on_each_other_stay_apart_in_order_and_come_to_rest) {
  std::vector<Cloth> cloths;
  for (int k = 0; k < 10; ++k) {
    Cloth cloth = cloth_of({0.4f, 0.4f}, 12, {0, 0.02f + 0.02f * static_cast<float>(k), 0});
    cloth.transform.degrees = 7 * k;
    cloth.fabric.damping = 1;
    cloths.push_back(cloth);
  }
  Scene scene = scene_with(cloths);
  scene.colliders.push_back(plane(0, 0.6));
  const auto simulation = must(Simulation::create(device(), scene));
  run_without_crossing(*simulation, 100);
  const auto positions = must(simulation->read_positions());
  double below = 0;
  for (const ClothRange& range : simulation->fabric().cloths) {
    const std::vector<gpu::vec4> own(positions.begin() + range.first_particle, positions.begin() + range.first_particle + range.particles);
    const double height = centre_of_mass(own).y;
    EXPECT_GT(height, below + 0.0005);
    below = height;
  }
  EXPECT_LT(below, 0.04);   // ten times 2 mm and a fold or two
  EXPECT_LT(top_speed(*simulation), 0.2);
}

TEST_F(ContactCase, a_sheet_folded_over_a_sphere_onto_the_floor_never_crosses) {
  Scene scene = scene_with({cloth_of({1, 1}, 32, {0.1f, 0.75f, 0})});
  scene.colliders.push_back(plane(0));
  scene.colliders.push_back(sphere({0, 0.25f, 0}, 0.15));
  const auto simulation = must(Simulation::create(device(), scene));
  run_without_crossing(*simulation, 120);
  EXPECT_GT(simulation->counts().contacts_most, 1000u);
}

TEST_F(ContactCase, a_gltf_mesh_collapses_onto_the_floor_without_crossing_itself) {
  const std::filesystem::path file = std::filesystem::path(WEFT_SOURCE_DIR) / "../shared/data/flamenco_cloth/CustomCloth.gltf";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  float lowest = INFINITY;
  for (const Vec3& p : must(load_mesh(file)).points) lowest = std::min(lowest, p.y);
  Cloth cloth;
  cloth.mesh = file.string();
  Scene scene = scene_with({cloth});
  scene.colliders.push_back(plane(lowest - 0.01f));
  const auto simulation = must(Simulation::create(device(), scene));
  run_without_crossing(*simulation, 40);
  EXPECT_GT(simulation->counts().contacts_most, 100u);
  double reached = INFINITY;
  for (const gpu::vec4& p : must(simulation->read_positions())) reached = std::min<double>(reached, p.y);
  EXPECT_LT(reached, lowest - 0.005) << "it did not reach the floor";
  EXPECT_GT(reached, lowest - 0.0101);
}

// A strip of two pieces that share no vertex in their file stands on its edge above the floor, a little oblique, and crumples.
TEST_F(ContactCase, a_mesh_with_a_seam_crumples_without_crossing_itself) {
  constexpr int kAcross = 12, kUp = 24;
  constexpr float kCell = 0.02f;   // m
  std::vector<float> places;
  std::vector<std::uint16_t> corners;
  for (const int piece : {0, 1}) {   // left and right of the seam
    const auto first = static_cast<int>(places.size() / 3), columns = kAcross / 2 + 1;
    for (int j = 0; j <= kUp; ++j)
      for (int i = 0; i < columns; ++i)
        for (const float x :
             {kCell * static_cast<float>(i + piece * kAcross / 2), kCell * static_cast<float>(j), 0.001f * static_cast<float>(j * j) / kUp})
          places.push_back(x);
    for (int j = 0; j < kUp; ++j)
      for (int i = 0; i + 1 < columns; ++i) {
        const int a = first + j * columns + i, c = a + columns;
        for (const int corner : {a, a + 1, c + 1, a, c + 1, c}) corners.push_back(static_cast<std::uint16_t>(corner));
      }
  }
  const test::Folder folder;
  test::Gltf gltf;
  gltf.primitive(gltf.vec3(places))["indices"] = gltf.indices16(corners);
  Cloth cloth;
  cloth.mesh = gltf.write(folder).string();
  cloth.fabric.thickness = 0.002;
  for (const bool contacts : {true, false}) {
    Scene scene = scene_with({cloth});
    scene.colliders.push_back(plane(-0.01f));
    scene.contacts.enabled = contacts;
    const auto simulation = must(Simulation::create(device(), scene));
    EXPECT_EQ(simulation->fabric().positions.size(), (kAcross + 1u) * (kUp + 1u)) << "the seam is one";
    EXPECT_EQ(simulation->positions().count, (kAcross + 2u) * (kUp + 1u)) << "and drawn with two sides";
    if (contacts) {
      run_without_crossing(*simulation, 50);
      EXPECT_GT(simulation->counts().contacts_most, 1000u);
    } else {
      std::uint64_t crossings = 0;
      for (int frame = 0; frame < 50; ++frame) {
        must(simulation->advance(kFrame));
        crossings += crossings_of(*simulation);
      }
      EXPECT_GT(crossings, 0u) << "nothing had to be kept apart";
    }
  }
}

// F4: contact reactions that are not barycentric do not conserve momentum. A strip is bent into a U and its arms are thrown at
// each other, one faster than the other.
TEST_F(ContactCase, a_free_folded_sheet_keeps_its_momentum) {
  Scene scene = scene_with({cloth_of({0.6f, 0.3f}, 30, {0, 0, 0})});
  scene.gravity = {0, 0, 0};
  scene.cloths[0].fabric.damping = 0;
  const auto simulation = must(Simulation::create(device(), scene));
  auto pose = must(simulation->read_positions());
  auto speed = pose;
  const double radius = 0.02;
  double momentum_sum = 0;
  for (std::size_t i = 0; i < pose.size(); ++i) {
    const gpu::vec4 rest = pose[i];
    const double s = rest.x, half = radius * std::numbers::pi / 2;   // along the strip: an arc of half a turn in the middle
    const double angle = std::clamp(s / half, -1.0, 1.0) * std::numbers::pi / 2;
    const double arm = std::max(0.0, std::abs(s) - half);
    pose[i] = {static_cast<float>(radius * std::cos(angle) - arm), static_cast<float>(radius * std::sin(angle)), rest.z, rest.w};
    const double y = s > half ? -1.5 : s < -half ? 0.5 : 0;
    speed[i] = {0, static_cast<float>(y * std::min(1.0, arm / 0.1)), 0, 0};
    momentum_sum += std::abs(speed[i].y) / rest.w;
  }
  must(simulation->write_positions(pose));
  must(simulation->write_velocities(speed));
  const auto momentum = [&] {
    const auto v = must(simulation->read_velocities());
    Point sum;
    for (std::size_t i = 0; i < v.size(); ++i) sum = {sum.x + v[i].x / pose[i].w, sum.y + v[i].y / pose[i].w, sum.z + v[i].z / pose[i].w};
    return sum;
  };
  const Point before = momentum();
  run_without_crossing(*simulation, 60);
  EXPECT_LT(distance(before, momentum()), 1e-5 * momentum_sum);
  EXPECT_GT(simulation->counts().contacts_most, 100u) << "the arms did not meet";
}

// On a flat sheet no pair is within the detection margin, so contacts have nothing to change.
class Hanging : public GpuTest, public testing::WithParamInterface<std::uint32_t> {};

TEST_P(Hanging, a_flat_sheet_stretches_as_it_does_without_contacts) {
  Strain strain[2];
  for (const bool contacts : {false, true}) {
    Scene scene;
    Cloth& cloth = scene.cloths.emplace_back();
    cloth.grid = Grid{{10, 10}, GetParam(), GetParam(), Topology::diagonal, true};
    cloth.tether_slack = 0;   // it stays flat
    cloth.anchors.push_back(held_at({Corner::low_high, Corner::high_high}));
    scene.contacts.enabled = contacts;
    const auto simulation = must(Simulation::create(device(), scene));
    run(*simulation, 1);
    strain[contacts] = strain_of(*simulation);
    EXPECT_EQ(simulation->counts().contacts_overflowed, 0u);
    EXPECT_EQ(simulation->counts().detections > 0, contacts);
    EXPECT_LT(simulation->counts().detections, 60u) << "of 600 substeps";
  }
  EXPECT_NEAR(strain[1].mean / strain[0].mean, 1, 0.01);
  EXPECT_NEAR(strain[1].rms / strain[0].rms, 1, 0.01);
  EXPECT_NEAR(strain[1].max / strain[0].max, 1, 0.01);
}

INSTANTIATE_TEST_SUITE_P(Sizes, Hanging, testing::Values(30u, 100u, 200u, 300u), testing::PrintToStringParamName());

// The sphere goes through, or drags along what it can; the cloth may be torn about but not through itself.
TEST_F(ContactCase, a_collider_through_cloth_at_five_metres_a_frame_makes_it_cross_nowhere) {
  Scene scene = scene_with({cloth_of({1, 1}, 40, {0, 0, 0})});
  scene.cloths[0].anchors.push_back(held_at({Corner::low_low, Corner::high_low}));
  scene.colliders.push_back(sphere({0, 2.5f, 0}, 0.2));
  const auto simulation = must(Simulation::create(device(), scene));
  run_without_crossing(*simulation, 5);
  for (int pass = 0; pass < 4; ++pass) {
    ColliderPose pose;
    pose.centre = {0.1f * static_cast<float>(pass), pass % 2 == 0 ? -2.5f : 2.5f, 0};
    must(simulation->move_collider(0, pose));
    run_without_crossing(*simulation, 1);
  }
  run_without_crossing(*simulation, 60);
  EXPECT_LT(top_speed(*simulation), 100);
}

// A sheet that is held everywhere and driven into a free one with its edge first, by 0.8 m.
Scene driven_into_a_free_one(std::uint32_t free_cells, std::uint32_t held_cells, double speed) {
  Scene scene = scene_with({cloth_of({1, 1}, free_cells, {0, 0, 0}), cloth_of({0.3f, 0.3f}, held_cells, {0, 0.3f, 0})});
  scene.gravity = {0, 0, 0};
  Cloth& held = scene.cloths[1];
  held.grid->upright = true;
  held.transform.axis = {0, 1, 0};
  held.transform.degrees = 20;
  Anchor& anchor = held.anchors.emplace_back();
  anchor.box = Anchor::Box{{-9, -9, -9}, {9, 9, 9}};
  anchor.keys.resize(2);
  anchor.keys[0].time = 0.1;
  anchor.keys[1].time = 0.1 + 0.8 / speed;
  anchor.keys[1].translate = {0, -0.8f, 0};
  return scene;
}

double lowest_of_the_free_one(const Simulation& simulation) {
  double lowest = 0;
  const auto places = must(simulation.read_positions());
  for (std::size_t i = 0; i < simulation.fabric().cloths[1].first_particle; ++i) lowest = std::min(lowest, double(places[i].y));
  return lowest;
}

// At 8 m/s, coarse and fine, in all three ways. It goes by 13 mm in a substep, and waited for whole ones where a corner of the triangle
// that it meets first belonged to another cluster and was not told to make way (final_track.glsl), and at 28 cells where pairs still
// crossed after four rounds of contact_limit, so that all particles fell back.
TEST_F(ContactCase, a_held_sheet_carries_a_free_one_along_at_eight_metres_a_second) {
  constexpr std::pair<std::uint32_t, std::uint32_t> kCells[] = {{12, 10}, {20, 10}, {20, 20}, {24, 10}, {24, 30}, {28, 20},
                                                                {28, 30}, {36, 20}, {36, 30}, {48, 10}, {48, 20}};
  for (const auto& [free_cells, held_cells] : kCells) {
    SCOPED_TRACE(free_cells);
    const auto simulation = must(Simulation::create(device(), driven_into_a_free_one(free_cells, held_cells, 8)));
    run_without_crossing(*simulation, 24);
    const double waits = simulation->counts().tracking_error;
    EXPECT_LT(waits, 0.001) << "it waited for the cloth in front of it";
    RecordProperty("waits_m_" + std::to_string(free_cells) + "_" + std::to_string(held_cells), std::to_string(waits));
    EXPECT_LT(lowest_of_the_free_one(*simulation), -0.65) << "the free sheet is in front of the held one's edge";
  }
}

// Anchors that a host drives need no keys. Where it drives them from the first frame on as keys would, nothing differs.
TEST_F(ContactCase, what_a_host_drives_does_what_keys_do) {
  const Scene keyed = driven_into_a_free_one(24, 30, 8);
  Scene bare = keyed;
  bare.cloths[1].anchors[0].keys.clear();
  const auto by_keys = must(Simulation::create(device(), keyed));
  std::vector<std::unique_ptr<Simulation>> by_host;
  for (std::size_t k = 0; k < std::size(kWays); ++k) by_host.push_back(must(Simulation::create(device(), bare)));
  for (int frame = 1; frame <= 16; ++frame) {
    must(by_keys->advance(kFrame));
    for (std::size_t k = 0; k < std::size(kWays); ++k) {
      must(by_host[k]->move_anchors(0, anchor_targets(keyed, by_keys->fabric(), frame * kFrame)));
      run_frame(device(), *by_host[k], kWays[k]);
    }
  }
  const auto expected = must(by_keys->read_positions());
  for (std::size_t k = 0; k < std::size(kWays); ++k) {
    SCOPED_TRACE(k == 0 ? "advance" : k == 1 ? "submit" : "record");
    EXPECT_LT(lowest_of_the_free_one(*by_host[k]), -0.5);
    EXPECT_LT(by_host[k]->counts().tracking_error, 0.001);
    const auto places = must(by_host[k]->read_positions());
    EXPECT_EQ(std::memcmp(places.data(), expected.data(), places.size() * sizeof(gpu::vec4)), 0);
  }
}

// Strain runs a cell an iteration, so the free sheet is torn at what carries it along, but nothing crosses. At 28 cells it did, and at 40 the
// held sheet waited by 12 mm, while triangles that had turned out of the way were taken to be in it (parting.glsl).
TEST_F(ContactCase, a_held_sheet_carries_a_free_one_along_by_nearly_a_cell_a_substep) {
  constexpr std::pair<std::uint32_t, std::uint32_t> kCells[] = {{24, 10}, {28, 30}, {36, 20}, {40, 30}, {48, 10}};
  for (const auto& [free_cells, held_cells] : kCells) {
    SCOPED_TRACE(free_cells);
    const double speed = 0.98 * 600 / free_cells;   // m/s: cells of the free sheet, 10 substeps in each of 60 frames
    const auto simulation = must(Simulation::create(device(), driven_into_a_free_one(free_cells, held_cells, speed)));
    run_without_crossing(*simulation, 24);
    EXPECT_LT(lowest_of_the_free_one(*simulation), -0.65) << "the free sheet is in front of the held one's edge";
    const double waits = simulation->counts().tracking_error;
    EXPECT_LT(waits, 0.001) << "of 0.02 to 0.04 m that it goes in a substep";
    RecordProperty("waits_m_" + std::to_string(free_cells), std::to_string(waits));
  }
}

double lowest_of(const Simulation& simulation) {
  double lowest = INFINITY;
  for (const gpu::vec4& p : must(simulation.read_positions())) lowest = std::min(lowest, double(p.y) + simulation.origin().y);
  return lowest;
}

// Two sheets on the floor, pressed ten centimetres below it by a sphere: there is no right answer until the sphere has gone.
TEST_F(ContactCase, what_is_impossible_ends_when_it_ends) {
  for (const std::uint32_t cells : {16u, 24u}) {
    SCOPED_TRACE(cells);
    Scene scene = scene_with({cloth_of({0.6f, 0.6f}, cells, {0, 0.004f, 0}), cloth_of({0.6f, 0.6f}, cells, {0, 0.012f, 0})});
    scene.cloths[1].transform.axis = {0, 1, 0};
    scene.cloths[1].transform.degrees = 20;
    scene.colliders = {plane(0), sphere({0, 0.3f, 0}, 0.2)};
    const auto simulation = must(Simulation::create(device(), scene));
    for (int frame = 0; frame < 75; ++frame) {   // down in a quarter of a second, up again in another
      const double down = std::clamp(std::min(frame + 1, 45 - frame) / 15.0, 0.0, 1.0);
      ColliderPose pose;
      pose.centre = {0, static_cast<float>(0.3 - 0.2 * down), 0};
      must(simulation->move_collider(1, pose));
      run_without_crossing(*simulation, 1);
      if (frame == 29) {
        EXPECT_LT(lowest_of(*simulation), -0.05) << "it is no hard case";
        EXPECT_GT(strain_of(*simulation).max, 1) << "it is no hard case";
      }
    }
    EXPECT_GT(lowest_of(*simulation), 0);
    EXPECT_LT(strain_of(*simulation).max, 0.6);
    EXPECT_LT(strain_of(*simulation).mean, 0.08);
  }
}

// F3: bins and lists that overflow without a word.
TEST_F(ContactCase, a_frame_that_overflowed_is_repeated_with_more_capacity_and_ends_the_same) {
  std::uint64_t hashes[2];
  for (const std::uint32_t capacity : {16u, 1u << 20}) {
    Scene scene = twist(24, Topology::diagonal, 1);
    scene.contacts.capacity = capacity;
    const auto simulation = must(Simulation::create(device(), scene));
    run_without_crossing(*simulation, 70, true);
    EXPECT_GT(simulation->counts().contacts_most, 100u);
    hashes[capacity > 16] = hash_of(*simulation);
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST_F(ContactCase, submitted_frames_that_overflowed_are_safe_and_say_so) {
  Scene scene = twist(24, Topology::diagonal, 1);
  scene.contacts.capacity = 16;
  const auto simulation = must(Simulation::create(device(), scene));
  for (int frame = 0; frame < 70; ++frame) {
    must(simulation->submit(kFrame));
    ASSERT_EQ(crossings_of(*simulation), 0u) << "after frame " << frame;
  }
  EXPECT_GT(simulation->counts().contacts_overflowed, 0u);
  EXPECT_EQ(simulation->counts().non_finite, 0u);
}

// A sheet is thrown at another, so fast that pairs overflow before there can be more room for them.
TEST_F(ContactCase, recorded_frames_that_overflow_are_safe_and_say_so) {
  for (const std::uint32_t capacity : {1u, 8u, 64u, 512u}) {
    SCOPED_TRACE(capacity);
    Scene scene = scene_with({cloth_of({0.3f, 0.3f}, 8, {0, 0, 0}), cloth_of({0.3f, 0.3f}, 7, {0.01f, 0.1f, 0.02f})});
    scene.cloths[1].transform.degrees = 10;
    scene.contacts.capacity = capacity;
    const auto simulation = must(Simulation::create(device(), scene));
    auto speed = must(simulation->read_velocities());
    for (std::size_t i = simulation->fabric().cloths[1].first_particle; i < speed.size(); ++i) speed[i].y = -20;
    must(simulation->write_velocities(speed));
    for (int frame = 0; frame < 20; ++frame) {
      must(compute::run_once(device(), "host", [&](VkCommandBuffer commands) { must(simulation->record(commands, kFrame)); }));
      ASSERT_EQ(crossings_of(*simulation), 0u) << "after frame " << frame;
    }
    const auto positions = must(simulation->read_positions());
    const auto height = [&](std::size_t cloth) {
      const ClothRange& range = simulation->fabric().cloths[cloth];
      return centre_of_mass({positions.begin() + range.first_particle, positions.begin() + range.first_particle + range.particles}).y;
    };
    EXPECT_GT(height(1), height(0)) << "one is through the other";
    EXPECT_GT(simulation->counts().contacts_overflowed, 0u);
    EXPECT_EQ(simulation->counts().non_finite, 0u);
  }
}

TEST_F(ContactCase, the_same_scene_twice_is_the_same_to_the_bit) {
  std::uint64_t hashes[3];
  for (int run = 0; run < 3; ++run) {
    SimulationOptions options;
    options.gather_storage = run == 1;
    options.workgroup = run == 2 ? 64 : 0;
    const auto simulation = must(Simulation::create(device(), twist(20, Topology::centre, 1), options));
    run_without_crossing(*simulation, 40);
    hashes[run] = hash_of(*simulation);
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
}

}  // namespace
}  // namespace weft
