// Tearing and cutting on the device: what tears comes apart, the same in all ways to run a frame, and nothing else changes.
#include <gtest/gtest.h>

#include <map>

#include "tests/effects/tear/torn.h"
#include "tests/support/every_method.h"
#include "tests/support/ways.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

using Tears = GpuTest;

// A sheet held along its left and right rim, of which the right one moves away, until it must tear.
Scene ripped(std::uint32_t cells = 12) {
  Scene scene = without_contacts();
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{{1, 1}, cells, cells, Topology::diagonal, true};
  cloth.tear = Tear{.strain = 0.3};
  cloth.anchors.emplace_back().box = Anchor::Box{{-0.501f, -9, -9}, {-0.499f, 9, 9}};
  Anchor& right = cloth.anchors.emplace_back();
  right.box = Anchor::Box{{0.499f, -9, -9}, {0.501f, 9, 9}};
  right.keys.resize(2);
  right.keys[1].time = 0.5;
  right.keys[1].translate = {0.8f, 0, 0};
  return scene;
}

// A free sheet in no gravity, which turns.
Scene turning() {
  Scene scene = sheet(12);
  scene.gravity = {};
  scene.cloths[0].tear = Tear{.strain = 100};
  scene.cloths[0].start.velocity = {0.3f, 0.2f, 0.1f};
  return scene;
}

double longest_drawn_edge(const Simulation& simulation) {
  const auto at = must(simulation.read_vertex_positions());
  double longest = 0;
  for (const Triangle& t : simulation.meshes()[0].render.triangles)
    for (int k = 0; k < 3; ++k) longest = std::max(longest, double(length(at[t[k]] - at[t[(k + 1) % 3]])));
  return longest;
}

// What failed in a system before (F16): the constraint was gone and the triangle still drawn, right across the tear.
TEST_F(Tears, part_cloth_and_what_is_drawn_of_it) {
  for (const Method method : {Method::by_default, Method::jacobi, Method::strands, Method::gauss_seidel})
    for (const bool contacts : {false, true}) {
      if (contacts && method != Method::by_default && method != Method::gauss_seidel) continue;
      SCOPED_TRACE(testing::Message() << "method " << int(method) << (contacts ? ", contacts" : ""));
      Scene scene = ripped();
      scene.cloths[0].tear->spare = 169;
      scene.solver.method = method;
      scene.contacts.enabled = contacts;
      auto simulation = must(Simulation::create(device(), scene));
      const auto vertices = must(simulation->read_vertex_positions()).size();
      const double mass = 0.12;
      run(*simulation, 1.2);
      const Mesh& mesh = simulation->meshes()[0];
      EXPECT_GT(pieces(mesh), 1u);
      EXPECT_LT(simulation->splits(), 60u) << "not to shreds";
      EXPECT_EQ(simulation->counts().splits, simulation->splits());
      EXPECT_EQ(simulation->counts().splits_refused, 0u);
      EXPECT_EQ(simulation->counts().non_finite, 0u);
      EXPECT_EQ(must(simulation->read_vertex_positions()).size(), vertices);
      EXPECT_LT(longest_drawn_edge(*simulation), 1.6 * std::sqrt(2.0) / 12) << "a triangle is drawn across the tear";
      EXPECT_LT(strain_of(*simulation).max, 0.6);
      double sum = 0;
      for (const gpu::vec4& p : must(simulation->read_positions()))
        if (p.w > 0) sum += 1 / double(p.w);
      EXPECT_LT(sum, mass);
      EXPECT_GT(sum, 0.9 * mass) << "all but what is held";
    }
}

TEST_F(Tears, are_the_same_bits_in_all_ways_to_run_a_frame) {
  for (const bool contacts : {false, true}) {
    Scene scene = ripped();
    scene.contacts.enabled = contacts;
    scene.pins = 2;
    scene.grabs = 1;
    std::map<Way, std::uint64_t> hashes;
    for (const Way way : kWays) {
      auto simulation = must(Simulation::create(device(), scene));
      must(simulation->reserve_contacts(60000));
      const auto held = must(simulation->grab_near({0.1f, 0.2f, 0}));
      for (int frame = 0; frame < 40; ++frame) {
        if (frame == 5) must(simulation->pin(std::vector<std::uint32_t>{84}));
        if (frame == 12) must(simulation->release(std::vector<std::uint32_t>{84, 0}));
        if (frame == 20) must(simulation->move_grab(held.grab, {0.1f, 0.3f, 0.2f}));
        if (frame == 26) must(simulation->let_go(held.grab));
        run_frame(device(), *simulation, way);
      }
      EXPECT_GT(simulation->splits(), 0u);
      hashes[way] = hash_of(*simulation);
    }
    EXPECT_EQ(hashes[Way::submit], hashes[Way::advance]);
    EXPECT_EQ(hashes[Way::record], hashes[Way::advance]);
  }
}

// Two frames under way, as hosts have them: submit alone keeps to that by itself.
TEST_F(Tears, recorded_with_two_frames_under_way_are_those_of_one) {
  const Scene scene = ripped();
  auto one = must(Simulation::create(device(), scene)), two = must(Simulation::create(device(), scene));
  for (int frame = 0; frame < 30; ++frame) must(one->advance(kFrame));
  auto pool = must(compute::CommandPool::create(device(), "host"));
  std::array<VkCommandBuffer, 3> buffers{};
  std::array<compute::OwnedFence, 3> done;
  for (std::size_t k = 0; k < 3; ++k) buffers[k] = must(pool.allocate("host")), done[k] = must(compute::create_fence(device(), "host"));
  for (std::size_t frame = 0; frame < 30; ++frame) {
    const std::size_t k = frame % 3;
    if (frame >= 3) {   // while a frame is recorded the two before it may be under way
      must(compute::wait_for(device(), done[k].get()));
      const VkFence fence = done[k].get();
      ASSERT_EQ(device().vk().vkResetFences(device().handle(), 1, &fence), VK_SUCCESS);
    }
    const VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO, nullptr,
                                         VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT, nullptr};
    ASSERT_EQ(device().vk().vkBeginCommandBuffer(buffers[k], &begin), VK_SUCCESS);
    must(two->record(buffers[k], kFrame));
    ASSERT_EQ(device().vk().vkEndCommandBuffer(buffers[k]), VK_SUCCESS);
    const VkCommandBufferSubmitInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO, nullptr, buffers[k], 0};
    const VkSubmitInfo2 work{VK_STRUCTURE_TYPE_SUBMIT_INFO_2, nullptr, 0, 0, nullptr, 1, &commands, 0, nullptr};
    must(device().submit(work, done[k].get()));
  }
  device().wait_idle();
  EXPECT_GT(one->splits(), 0u);
  EXPECT_EQ(hash_of(*two), hash_of(*one));
}

TEST_F(Tears, of_more_recorded_frames_than_it_can_know_of_are_an_error) {
  auto simulation = must(Simulation::create(device(), ripped(4)));
  must(compute::run_once(device(), "host", [&](VkCommandBuffer commands) {
    for (int frame = 0; frame < 3; ++frame) must(simulation->record(commands, kFrame));
    const auto fourth = simulation->record(commands, kFrame);
    ASSERT_FALSE(fourth);
    EXPECT_EQ(fourth.error(), "record: the 3rd last frame that was recorded is not done after 2 s; of a scene with cloth that tears at "
                              "most 2 recorded frames may be under way");
  }));
  must(simulation->advance(kFrame));   // and it goes on
}

TEST_F(Tears, are_saved_and_restored_wherever_they_are) {
  for (const bool contacts : {false, true}) {
    Scene scene = ripped();
    scene.contacts.enabled = contacts;
    auto simulation = must(Simulation::create(device(), scene));
    const Snapshot whole = must(simulation->save());
    for (int frame = 0; frame < 17; ++frame) must(simulation->advance(kFrame));
    std::vector<std::unique_ptr<Simulation>> others;
    for (int frame = 0; frame < 6; ++frame) {   // before, at and after looks
      must(simulation->advance(kFrame));
      others.push_back(resumed(device(), *simulation, scene));
      EXPECT_EQ(must(others.back()->read_vertex_positions()), must(simulation->read_vertex_positions()));
      for (auto& other : std::span(others).first(others.size() - 1)) must(other->advance(kFrame));
    }
    EXPECT_GT(simulation->splits(), 0u);
    for (auto& other : others) {
      EXPECT_EQ(hash_of(*other), hash_of(*simulation));
      EXPECT_EQ(other->splits(), simulation->splits());
    }
    // And back to when it was whole.
    for (int frame = 0; frame < 20; ++frame) must(simulation->advance(kFrame));
    const std::uint64_t then = hash_of(*simulation);
    const auto drawn = must(simulation->read_vertex_positions());
    must(simulation->restore(whole));
    EXPECT_EQ(simulation->splits(), 0u);
    EXPECT_EQ(pieces(simulation->meshes()[0]), 1u);
    for (int frame = 0; frame < 43; ++frame) must(simulation->advance(kFrame));
    EXPECT_EQ(hash_of(*simulation), then);
    EXPECT_EQ(must(simulation->read_vertex_positions()), drawn);
  }
}

// A particle that is new has the material of the one that it was one with, whatever the map says at the cloth's first.
TEST_F(Tears, of_cloth_that_a_map_varies_are_restored_where_nothing_is_torn_yet) {
  Scene scene = ripped();
  scene.cloths[0].maps.friction = "_ROUGH";
  const auto made = [&] {
    std::vector<Mesh> meshes(1, make_grid(*scene.cloths[0].grid));
    for (const Vec3 p : meshes[0].points) meshes[0].attributes["_ROUGH"].push_back({p.x < -0.4f ? 0.5f : 1.0f, 0, 0, 1});
    return must(Simulation::create(device(), scene, std::move(meshes)));
  };
  auto simulation = made(), fresh = made();
  run(*simulation, 0.6);
  ASSERT_GT(simulation->splits(), 0u);
  must(fresh->restore(must(simulation->save())));
  run(*simulation, 0.1);
  run(*fresh, 0.1);
  EXPECT_EQ(hash_of(*fresh), hash_of(*simulation));
}

TEST_F(Tears, in_a_damaged_snapshot_are_refused) {
  const Scene scene = ripped();
  auto simulation = must(Simulation::create(device(), scene));
  run(*simulation, 0.6);
  ASSERT_GT(simulation->splits(), 0u);
  const Snapshot good = must(simulation->save());
  const auto said = [&](auto change) {
    Snapshot bad = good;
    change(bad);
    const auto refused = simulation->restore(bad);
    return refused ? std::string("restored") : refused.error();
  };
  EXPECT_EQ(said([](Snapshot& s) { s.splits[0].cloth = 7; }), "the snapshot is damaged: it has a split of cloth 7, which does not tear");
  EXPECT_EQ(said([](Snapshot& s) { s.splits[0].point = 100000; }).find("the snapshot is damaged: cloths[0]: a split: 100000 is not"), 0u);
  EXPECT_EQ(said([](Snapshot& s) { s.splits[0].corners = {1u << 30}; }).find("the snapshot is damaged: cloths[0]: a split: corner"), 0u);
  EXPECT_NE(said([](Snapshot& s) { s.splits.pop_back(); }), "restored");   // masses are others
  EXPECT_EQ(said([](Snapshot&) {}), "restored");
}

TEST_F(Tears, cut_conserves_momentum_and_lets_the_pieces_go) {
  auto simulation = must(Simulation::create(device(), turning()));
  run(*simulation, 0.1);
  const auto momentum = [&] {
    const auto at = must(simulation->read_positions()), v = must(simulation->read_velocities());
    Eigen::Vector3d sum = Eigen::Vector3d::Zero(), spin = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < at.size(); ++i) {
      if (at[i].w == 0) continue;
      const Eigen::Vector3d x(at[i].x, at[i].y, at[i].z), p = Eigen::Vector3d(v[i].x, v[i].y, v[i].z) / at[i].w;
      sum += p;
      spin += x.cross(p);
    }
    return std::pair(sum, spin);
  };
  const auto before = momentum();
  const auto drawn = must(simulation->read_vertex_positions());
  const RenderMesh whole = simulation->meshes()[0].render;
  const std::uint32_t count = must(simulation->cut({0.02f, 2, 0.03f}, {-1, -2, -0.3f}, {1, -2, 0.4f}));
  EXPECT_GE(count, 13u);
  EXPECT_EQ(simulation->splits(), count);
  EXPECT_EQ(pieces(simulation->meshes()[0]), 2u);
  const auto after = momentum();
  EXPECT_LT((after.first - before.first).norm(), 1e-6 * before.first.norm());
  EXPECT_LT((after.second - before.second).norm(), 1e-6);
  // At once everything is where it was, the doubled vertices as well.
  const auto now = must(simulation->read_vertex_positions());
  const RenderMesh& torn = simulation->meshes()[0].render;
  for (std::size_t t = 0; t < torn.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) ASSERT_EQ(now[torn.triangles[t][k]], drawn[whole.triangles[t][k]]);
  EXPECT_EQ(simulation->splits_of(0).size(), count);
  // Another simulation splits as this one did.
  auto other = must(Simulation::create(device(), turning()));
  run(*other, 0.1);
  EXPECT_EQ(must(other->split(0, simulation->splits_of(0))), count);
  must(simulation->advance(kFrame));
  must(other->advance(kFrame));
  EXPECT_EQ(hash_of(*other), hash_of(*simulation));
}

TEST_F(Tears, cut_hung_cloth_falls) {
  Scene scene = ripped();
  scene.cloths[0].anchors.resize(1);
  scene.cloths[0].tear->strain = 5;
  auto simulation = must(Simulation::create(device(), scene));
  run(*simulation, 0.2);
  ASSERT_GT(must(simulation->cut({0, 0, 3}, {0, 2, -3}, {0, -2, -3})), 0u);
  ASSERT_EQ(pieces(simulation->meshes()[0]), 2u);
  // Of the piece that nothing holds: the height of its centre of mass (m), and its velocity (m/s).
  const auto free_piece = [&] {
    const Mesh& mesh = simulation->meshes()[0];
    const auto piece = pieces_of(mesh);
    const std::uint32_t held = piece[mesh.point_of[simulation->fabric().anchors[0].vertex]];
    const auto at = must(simulation->read_positions()), v = must(simulation->read_velocities());
    double mass = 0, height = 0, momentum = 0;
    const auto& order = std::as_const(simulation->fabric().own).of<TearLists>().orders[0];
    for (std::uint32_t k = 0; k < order.size(); ++k) {
      if (piece[order[k]] == held) continue;
      mass += 1 / double(at[k].w);
      height += at[k].y / double(at[k].w);
      momentum += v[k].y / double(at[k].w);
    }
    return std::pair(height / mass, momentum / mass);
  };
  const auto [height, speed] = free_piece();
  run(*simulation, 0.5);
  // Free flight, with the fabric's damping: v' = -g - d v.
  const double d = scene.cloths[0].fabric.damping, t = 0.5, end = -9.81 / d;
  const double falls = end * t + (speed - end) * (1 - std::exp(-d * t)) / d;
  EXPECT_NEAR(free_piece().first - height, falls, 0.01 * std::abs(falls)) << "the right half falls freely";
  const auto after = must(simulation->read_vertex_positions());
  for (std::uint32_t v = 0; v < 169; v += 13) EXPECT_EQ(after[v], simulation->meshes()[0].render.positions[v]) << "what is held stays";
}

TEST_F(Tears, without_spare_vertices_are_counted_and_left_out) {
  Scene scene = ripped();
  scene.cloths[0].tear->spare = 3;
  auto simulation = must(Simulation::create(device(), scene));
  run(*simulation, 1);
  EXPECT_EQ(simulation->splits(), 3u);
  EXPECT_GT(simulation->counts().splits_refused, 0u);
  EXPECT_EQ(simulation->counts().non_finite, 0u);
}

TEST_F(Tears, that_nobody_asked_for_are_refused_by_a_sentence) {
  auto whole = must(Simulation::create(device(), sheet(4)));
  EXPECT_EQ(whole->cut({0, 1, 0}, {0, -1, 0}, {1, -1, 0}).error(),
            "the scene has no cloth that tears (its key \"tear\"), and none that can be cut");
  EXPECT_EQ(whole->split(0, {}).error(), "cloth 0 does not tear (its key \"tear\"), or is none of the scene's 1");
  EXPECT_EQ(whole->splits(), 0u);
  auto simulation = must(Simulation::create(device(), turning()));
  EXPECT_EQ(simulation->cut({0, NAN, 0}, {0, -1, 0}, {1, -1, 0}).error(), "the blade is not finite, or 1e+10 m away or more");
  EXPECT_EQ(simulation->cut({0, 1, 0}, {0, -1, 0}, {0, -2, 0}).error(), "the blade's two directions are one, or of length 0");
  EXPECT_EQ(must(simulation->cut({9, 1, 0}, {0, -1, 0}, {1, -1, 0})), 0u);
  const std::vector<Split> bad = {{5, {0}}};
  EXPECT_EQ(simulation->split(0, bad).error().find("cloths[0]: a split"), 0u);
  const auto refused = [&](auto change) {
    Scene scene = turning();
    change(scene);
    return Simulation::create(device(), scene).error();
  };
  EXPECT_EQ(refused([](Scene& s) { s.solver.method = Method::implicit; }),
            "solver.method: \"implicit\" solves cloth that stays whole, and cloths[0].tear is there: "
            "\"jacobi\", \"strands\" and \"gauss_seidel\" go with it");
  EXPECT_EQ(refused([](Scene& s) { s.cloths[0].motion_constraints.emplace(); }),
            "cloths[0].tear: does not go with a skin or motion constraints: leave tear or these away");
  EXPECT_EQ(refused([](Scene& s) { s.cloths[0].tear->strain = 0; }), "cloths[0].tear.strain: 0 is less than 0.01");
  EXPECT_EQ(refused([](Scene& s) { s.cloths[0].tear->map = "_WEAK"; }).find("cloths[0]: tear.map: "), 0u);
}

}  // namespace
}  // namespace weft
