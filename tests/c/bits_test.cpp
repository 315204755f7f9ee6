// The C interface does what the C++ interface does, bit for bit: two simulations on one device, one behind each, are told the same.
#include <gtest/gtest.h>
#include <weft.h>

#include <cstring>
#include <filesystem>

#include "compute/buffer.h"
#include "engine/scene/reader.h"
#include "engine/simulation.h"
#include "tests/support/on_device.h"

namespace weft {
namespace {

// A sheet and a cushion made in code, with all that a host may say of them while they run.
constexpr const char* kScene =
    R"({"solver":{"substeps":2},"pins":2,"grabs":2,"reactions":true,"contacts":true,
        "air":{"wind":[1,0,0],"fields":[{"shape":"sphere","centre":[0,0.5,0],"velocity":[2,0,0]}]},
        "cloths":[
          {"name":"sheet","mesh":"sheet","transform":{"translate":[0,0.5,0],"scale":1.5},"maps":{"mass":"_HEAVY"},
           "skin":{"takes_targets":true},"inertia":{"linear":0.5},
           "motion_constraints":{"max_distance":0.4,"max_distance_map":"COLOR_0.g"},"anchors":[{"vertices":[0,8]}]},
          {"name":"cushion","mesh":"cushion","pressure":{"rest_pressure":500},"transform":{"translate":[2,0,0]}}],
        "colliders":[
          {"shape":"sphere","radius":0.2,"centre":[0,0.25,0],"resizes":true},
          {"shape":"mesh","mesh":"sleeper.glb","skin":{},"centre":[6,0,0]},
          {"shape":"mesh","mesh":"cushion","skin":{"takes_targets":true},"centre":[-6,0,0]}]})";

struct Made {
  RenderMesh render;
  weft_mesh* mesh = nullptr;

  Made() = default;
  Made(const Made&) = delete;
  ~Made() { weft_mesh_destroy(mesh); }
  void finish() {
    weft_error error;
    const float* uv = render.uvs.empty() ? nullptr : &render.uvs[0].x;
    EXPECT_EQ(weft_mesh_create(&render.positions[0].x, render.positions.size(), render.triangles[0].data(), render.triangles.size(), uv,
                               &mesh, &error), WEFT_OK) << error.sentence;
  }
};

class CBits : public compute::OnDevice {
 protected:
  void SetUp() override {
    OnDevice::SetUp();
    const weft_borrowed lent{reinterpret_cast<void*>(device().vk().vkGetInstanceProcAddr), device().instance(), device().physical(),
                             device().handle(), device().queue(), nullptr, device().queue_family()};
    ASSERT_EQ(weft_device_borrow(&lent, &lent_, &error), WEFT_OK) << error.sentence;
    const RenderMesh grid = make_grid({.cells_x = 8, .cells_y = 8}).render;
    sheet.render = {grid.positions, {}, {}, grid.uvs, grid.triangles};
    cushion.render.positions = {{0.3f, 0, 0}, {-0.3f, 0, 0}, {0, 0.2f, 0}, {0, -0.2f, 0}, {0, 0, 0.3f}, {0, 0, -0.3f}};
    cushion.render.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    for (Made* made : {&sheet, &cushion}) made->finish();
    for (std::size_t k = 0; k < grid.positions.size(); ++k) {
      heavy.push_back(1 + 0.01f * static_cast<float>(k));
      green.insert(green.end(), {0.5f, 0.25f + 0.005f * static_cast<float>(k)});
    }
    told(weft_mesh_set_attribute(sheet.mesh, "_HEAVY", heavy.data(), 1, heavy.size(), &error));
    told(weft_mesh_set_attribute(sheet.mesh, "COLOR_0", green.data(), 2, heavy.size(), &error));
    create();
  }
  void TearDown() override {
    simulation.reset();
    device().wait_idle();   // Simulation's destructor says why
    weft_simulation_destroy(c);
    weft_device_destroy(lent_);
    OnDevice::TearDown();
  }

  // By hand what the library does with named meshes.
  void create() {
    const std::filesystem::path folder = WEFT_ASSETS "/generated";
    const std::string names[] = {"sheet", "cushion"};
    auto scene = parse_scene_with(kScene, {folder, names}, {});
    ASSERT_TRUE(scene) << scene.error();
    std::vector<Mesh> meshes;
    for (const Made* made : {&sheet, &cushion}) meshes.push_back(weld_mesh(made->render).value());
    for (std::size_t k = 0; k < heavy.size(); ++k) {
      meshes[0].attributes["_HEAVY"].push_back({heavy[k], 0, 0, 0});
      meshes[0].attributes["COLOR_0"].push_back({green[2 * k], green[2 * k + 1], 0, 0});
    }
    for (std::size_t k = 0; k < 2; ++k) transform_mesh(meshes[k], scene->cloths[k].transform);
    meshes.push_back(load_mesh(folder / "sleeper.glb").value());
    meshes.push_back(weld_mesh(cushion.render).value());
    auto made = Simulation::create(device(), *scene, std::move(meshes));
    ASSERT_TRUE(made) << made.error();
    simulation = std::move(*made);
    const weft_named_mesh named[] = {{"cushion", cushion.mesh}, {"sheet", sheet.mesh}};
    weft_options options{};
    options.size = sizeof options;
    options.meshes = named;
    options.mesh_count = 2;
    told(weft_simulation_create_with(lent_, kScene, folder.c_str(), &options, &c, &error));
  }

  void told(weft_status status) { ASSERT_EQ(status, WEFT_OK) << error.sentence; }
  template <class T>
  void told(const Result<T>& done) {
    ASSERT_TRUE(done) << done.error();
  }
  // All of the state, with what is said for the next frame.
  void same() {
    auto snapshot = simulation->save();
    ASSERT_TRUE(snapshot) << snapshot.error();
    const std::vector<std::byte> wanted = snapshot_bytes(*snapshot);
    void* bytes = nullptr;
    std::size_t size = 0;
    told(weft_save(c, &bytes, &size, &error));
    ASSERT_EQ(size, wanted.size());
    EXPECT_EQ(std::memcmp(bytes, wanted.data(), size), 0);
    EXPECT_EQ(weft_fits(c, bytes, size, &error), WEFT_OK) << error.sentence;
    weft_free(bytes);
  }
  void frame() {
    same();
    told(simulation->advance(1.0 / 60));
    told(weft_advance(c, 1.0 / 60, nullptr, &error));
    same();
  }
  static void expect_same(const Reaction& a, const weft_reaction& b) {
    EXPECT_EQ(std::memcmp(&a, &b, sizeof b), 0);
    static_assert(sizeof a == sizeof b);
  }

  weft_error error{};
  weft_device* lent_ = nullptr;
  Made sheet, cushion;
  std::vector<float> heavy, green;
  std::unique_ptr<Simulation> simulation;
  weft_simulation* c = nullptr;
};

TEST_F(CBits, every_call_of_c_does_what_that_of_cpp_does_to_the_same_bits) {
  frame();
  // Parts.
  ASSERT_EQ(weft_part_count(c), 4u);
  weft_part part{};
  told(weft_get_part(c, 2, &part, &error));
  const ColliderMesh& body = simulation->fabric().collider_meshes[0];
  EXPECT_TRUE(part.kind == WEFT_MESH_COLLIDER && part.of == 1 && part.first_vertex == body.first_vertex && part.vertices == body.vertices);
  const auto morphs = static_cast<std::uint32_t>(simulation->meshes()[2].skin->morphs.size());
  EXPECT_TRUE(part.joints == 1 && part.morphs == morphs && morphs > 0);
  EXPECT_EQ(weft_morph_name(c, 2, 0), simulation->meshes()[2].skin->morphs[0].name);
  EXPECT_STREQ(weft_joint_name(c, 2, 0), "");

  // Air, colliders, gas.
  const float centre[] = {0.1f, 0.4f, 0}, velocity[] = {0, 0, 3};
  told(simulation->move_air_field(0, {0.1f, 0.4f, 0}, {0, 0, 3}));
  told(weft_move_air_field(c, 0, centre, velocity, &error));
  told(simulation->resize_collider(0, {.radius = 0.25}));
  const weft_size size{0.25, 0.5, 0.5, {1, 1, 1}};
  told(weft_resize_collider(c, 0, &size, &error));
  told(simulation->inflate(1, 1.5));
  told(weft_inflate(c, 1, 1.5, &error));
  const ColliderPose poses[] = {{{0, 0.3f, 0}}, {{6, 0.1f, 0}, {0, 1, 0}, rotation_about({0, 1, 0}, 20)}};
  weft_pose c_poses[2];
  for (int k = 0; k < 2; ++k) {
    const auto& [p, n, r] = poses[k];
    c_poses[k] = {{p.x, p.y, p.z}, {n.x, n.y, n.z}, {r.x, r.y, r.z, r.w}};
  }
  told(simulation->move_colliders(0, poses));
  told(weft_move_colliders(c, 0, c_poses, 2, &error));
  frame();
  weft_size now{};
  told(weft_collider_size(c, 0, &now, &error));
  EXPECT_EQ(now.radius, 0.25);
  told(simulation->place_collider(0, poses[0]));
  told(weft_place_collider(c, 0, &c_poses[0], &error));

  // Characters.
  const Affine map{{1, 0, 0}, {0, 0.9f, 0.1f}, {0, -0.1f, 0.9f}, {0, 0.05f, 0}};
  const weft_affine c_map{{1, 0, 0}, {0, 0.9f, 0.1f}, {0, -0.1f, 0.9f}, {0, 0.05f, 0}};
  told(simulation->set_pose(0, {&map, 1}));
  told(weft_set_pose(c, 0, &c_map, 1, &error));
  told(simulation->set_body_pose(1, {&map, 1}));
  told(weft_set_body_pose(c, 1, &c_map, 1, &error));
  const std::vector<float> weights(morphs, 0.3f);
  told(simulation->set_body_morphs(1, weights));
  told(weft_set_body_morphs(c, 1, weights.data(), morphs, &error));
  told(simulation->set_morphs(0, {}));
  told(weft_set_morphs(c, 0, nullptr, 0, &error));
  told(simulation->limit_motion(0, 0.5, 0.8));
  told(weft_limit_motion(c, 0, 0.5, 0.8, &error));
  const MovingFrame first{{0, 0, 0}}, second{{0.2f, 0, 0}, rotation_about({0, 1, 0}, 10)};
  const Rotation& q = second.rotation;
  const weft_frame c_first{{0, 0, 0}, {0, 0, 0, 1}}, c_second{{0.2f, 0, 0}, {q.x, q.y, q.z, q.w}};
  told(simulation->move_frame(0, first));
  told(weft_move_frame(c, 0, &c_first, &error));
  frame();
  told(simulation->move_frame(0, second));
  told(weft_move_frame(c, 0, &c_second, &error));
  frame();
  told(simulation->teleport(0, second, first));
  told(weft_teleport(c, 0, &c_second, &c_first, &error));
  frame();

  // Targets from a buffer of the host's.
  const std::uint32_t vertices = 81;
  std::vector<Vec4> there(vertices);
  for (std::uint32_t k = 0; k < vertices; ++k) there[k] = {0.01f * static_cast<float>(k), 0.6f, 0, 0};
  const compute::BufferRequest request{"targets", there.size() * sizeof(Vec4), compute::kStorage};
  auto arena = compute::Arena::create(device(), compute::Memory::upload, "targets", {&request, 1});
  told(arena);
  std::memcpy((*arena)[0].mapped, there.data(), there.size() * sizeof(Vec4));
  TargetBuffer targets{(*arena)[0].handle, 0, VK_NULL_HANDLE, 0, vertices};
  weft_target_buffer c_targets{reinterpret_cast<std::uint64_t>((*arena)[0].handle), 0, 0, 0, vertices};
  told(simulation->set_targets(0, targets));
  told(weft_set_targets(c, 0, &c_targets, &error));
  targets.vertices = c_targets.vertices = 6;
  told(simulation->set_body_targets(2, targets));
  told(weft_set_body_targets(c, 2, &c_targets, &error));
  frame();

  // Hands, and what cloth does.
  const Grip grip{500, 3, 30};
  const weft_grip c_grip{500, 3, 30};
  const float point[] = {0, 0.5f, 0}, target[] = {0.1f, 0.8f, 0};
  const auto held = simulation->grab_near({0, 0.5f, 0}, grip);
  told(held);
  weft_grabbed c_held{};
  told(weft_grab_near(c, point, &c_grip, &c_held, &error));
  EXPECT_TRUE(c_held.grab == held->grab && c_held.distance == held->distance && c_held.point[1] == held->point.y);
  told(simulation->move_grab(held->grab, {0.1f, 0.8f, 0}));
  told(weft_move_grab(c, c_held.grab, target, &error));
  frame();
  weft_reaction reactions[3], pulls[2];
  told(weft_take_reactions(c, reactions, 3, &error));
  const auto of_colliders = simulation->take_reactions();
  for (std::size_t k = 0; k < 3; ++k) expect_same(of_colliders[k], reactions[k]);
  EXPECT_EQ(weft_grab_count(c), 2u);
  told(weft_take_pulls(c, pulls, 2, &error));
  const auto of_hands = simulation->take_pulls();
  for (std::size_t k = 0; k < 2; ++k) expect_same(of_hands[k], pulls[k]);
  EXPECT_NE(pulls[c_held.grab].impulse[1], 0);

  // Particles.
  const std::size_t count = weft_particle_count(c);
  ASSERT_EQ(count, simulation->fabric().positions.size());
  std::vector<gpu::vec4> positions(count), velocities(count);
  told(weft_read_particles(c, &positions[0].x, count, &error));
  told(weft_read_velocities(c, &velocities[0].x, count, &error));
  for (gpu::vec4& x : positions) x.y += 0.01f;
  for (gpu::vec4& v : velocities) v.x += 0.5f;
  told(simulation->write_positions(positions));
  told(simulation->write_velocities(velocities));
  told(weft_write_particles(c, &positions[0].x, count, &error));
  told(weft_write_velocities(c, &velocities[0].x, count, &error));
  std::vector<std::uint32_t> particles(weft_positions(c).count), anchors(weft_anchor_count(c));
  told(weft_vertex_particles(c, particles.data(), particles.size(), &error));
  EXPECT_EQ(particles[8], simulation->fabric().surface_rows[8].x);
  told(weft_anchor_vertices(c, anchors.data(), anchors.size(), &error));
  EXPECT_EQ(anchors, (std::vector<std::uint32_t>{0, 8}));
  told(simulation->reserve_contacts(1 << 14));
  told(weft_reserve_contacts(c, 1 << 14, &error));
  frame();
  const Counts counts = simulation->counts();
  const weft_quality quality = weft_get_quality(c);
  EXPECT_TRUE(quality.crossings_most == counts.crossings_most && quality.tracking_error == counts.tracking_error);

  // A frame that waits on the GPU: for a timeline that the CPU signals afterwards.
  if (device().features().timeline_semaphore) {
    const VkSemaphoreTypeCreateInfo timeline{VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO, nullptr, VK_SEMAPHORE_TYPE_TIMELINE, 0};
    const VkSemaphoreCreateInfo create{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, &timeline, 0};
    VkSemaphore semaphore = VK_NULL_HANDLE;
    ASSERT_EQ(device().vk().vkCreateSemaphore(device().handle(), &create, nullptr, &semaphore), VK_SUCCESS);
    const weft_wait wait{reinterpret_cast<std::uint64_t>(semaphore), 1, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT};
    told(weft_submit_after(c, 1.0 / 60, &wait, 1, nullptr, &error));
    std::uint64_t value = 0;
    device().vk().vkGetSemaphoreCounterValue(device().handle(), reinterpret_cast<VkSemaphore>(weft_ready_semaphore(c)), &value);
    EXPECT_LT(value, weft_ready_value(c));
    const VkSemaphoreSignalInfo signal{VK_STRUCTURE_TYPE_SEMAPHORE_SIGNAL_INFO, nullptr, semaphore, 1};
    ASSERT_EQ(device().vk().vkSignalSemaphore(device().handle(), &signal), VK_SUCCESS);
    told(simulation->submit(1.0 / 60));
    same();
    device().wait_idle();
    device().vk().vkDestroySemaphore(device().handle(), semaphore, nullptr);
  }

  char* text = nullptr;
  told(weft_scene_text(c, &text, &error));
  EXPECT_EQ(text, scene_text(simulation->scene()));
  weft_free(text);
  told(weft_notes(c, &text, &error));
  std::string notes;
  for (const std::string& note : simulation->fabric().notes) notes += note + '\n';
  EXPECT_EQ(text, notes);
  weft_free(text);
}

}  // namespace
}  // namespace weft
