// A box on the floor, pulled by a sheet: cloth attached to a rigid body that the program itself steps.
//
// Two corners of the sheet are grabbed at two corners of the box. Every frame the program moves these grabs to where the box has them and
// gives the box what they were pulled by (Simulation::take_pulls), each impulse where it acts. The far edge of the sheet walks away. Frames
// are short, 240 a second, because the box learns of the cloth's pull a frame late: that takes damping from the hooks, which have some to
// spare.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>

#include "engine/simulation.h"

namespace {

using namespace weft;

constexpr double kRate = 240;   // Hz
constexpr Vec3 kHalf{0.15f, 0.1f, 0.2f};   // m: half the box's sides
constexpr float kMass = 1, kFriction = 0.3f;   // kg; of the floor

// A box that slides on the floor and turns about the vertical, with Coulomb friction.
struct Box {
  Vec3 centre{0, kHalf.y, 0}, velocity;   // m, m/s
  float angle = 0, spin = 0;              // rad, rad/s

  Vec3 arm(Vec3 own) const {   // from the centre to a place of its own
    const float c = std::cos(angle), s = std::sin(angle);
    return {c * own.x + s * own.z, own.y, c * own.z - s * own.x};
  }

  void push(Vec3 impulse, Vec3 arm) {
    constexpr float kInertia = kMass / 3 * (kHalf.x * kHalf.x + kHalf.z * kHalf.z);
    velocity = velocity + (1 / kMass) * Vec3{impulse.x, 0, impulse.z};
    spin += cross(arm, impulse).y / kInertia;
  }

  void step(float seconds) {
    constexpr float kArm = 0.15f;   // m: of the friction that resists turning
    const float speed = length(velocity), rubs = kFriction * 9.81f * seconds;
    velocity = std::max(0.0f, 1 - rubs / std::max(speed, 1e-6f)) * velocity;
    spin -= std::clamp(spin, -rubs / kArm, rubs / kArm);
    centre = centre + seconds * velocity;
    angle += seconds * spin;
  }

  ColliderPose pose() const { return {.centre = centre, .rotation = rotation_about({0, 1, 0}, angle * 180 / std::numbers::pi)}; }
};

constexpr std::array kHooks = {Vec3{kHalf.x + 0.01f, 0, -kHalf.z}, Vec3{kHalf.x + 0.01f, 0, kHalf.z}};   // on the box, in its own axes

// A sheet from the box's front to a bar that begins to walk after half a second, at 0.5 m/s.
Scene towed() {
  Scene scene;
  scene.solver.rate = kRate;
  scene.solver.substeps = 4;
  scene.reactions = true;
  scene.grabs = kHooks.size();
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{.size = {0.8f, 2 * kHalf.z}, .cells_x = 32, .cells_y = 16};
  cloth.fabric = *fabric_preset("denim");
  cloth.transform.translate = {kHooks[0].x + 0.4f, kHalf.y, 0};
  Anchor& bar = cloth.anchors.emplace_back();
  bar.box = Anchor::Box{{kHooks[0].x + 0.799f, -1, -1}, {kHooks[0].x + 0.801f, 1, 1}};
  bar.keys = {{0.5, {}, {0, 1, 0}, 0}, {4.5, {2, 0, 0}, {0, 1, 0}, 0}};
  Collider& box = scene.colliders.emplace_back();
  box.shape = ColliderShape::box;
  box.centre = Box().centre;
  box.size = 2 * kHalf;
  scene.colliders.emplace_back();   // the floor
  return scene;
}

int complain(const std::string& why) { return std::fprintf(stderr, "%s\n", why.c_str()), EXIT_FAILURE; }

}  // namespace

int main(int count, char** arguments) {
  const int seconds = count > 1 ? std::atoi(arguments[1]) : 6;
  const Scene scene = towed();
  const auto device = compute::Device::create();
  if (!device) return complain(device.error());
  const auto cloth = Simulation::create(**device, scene);
  if (!cloth) return complain(cloth.error());

  Box box;
  std::array<std::uint32_t, kHooks.size()> grabs;
  for (std::size_t k = 0; k < kHooks.size(); ++k) {
    const auto held = (*cloth)->grab_near(box.centre + kHooks[k], {.stiffness = 1000, .damping = 20, .force = 1000});
    if (!held) return complain(held.error());
    grabs[k] = held->grab;
  }
  std::printf("%6s %9s %9s %9s %9s\n", "s", "x m", "m/s", "degrees", "N");
  for (int second = 1; second <= seconds; ++second) {
    float pulled = 0;   // N s in this second
    for (int frame = 0; frame < static_cast<int>(kRate); ++frame) {
      for (std::size_t k = 0; k < kHooks.size(); ++k)
        if (const auto moved = (*cloth)->move_grab(grabs[k], box.centre + box.arm(kHooks[k])); !moved) return complain(moved.error());
      if (const auto moved = (*cloth)->move_collider(0, box.pose()); !moved) return complain(moved.error());
      if (const auto advance = (*cloth)->advance(1 / kRate); !advance) return complain(advance.error());
      const auto pulls = (*cloth)->take_pulls();
      for (std::size_t k = 0; k < kHooks.size(); ++k) {
        box.push(pulls[grabs[k]].impulse, box.arm(kHooks[k]));
        pulled += pulls[grabs[k]].impulse.x;
      }
      const Reaction given = (*cloth)->take_reactions()[0];   // where the sheet lies on the box
      box.push(given.impulse, {});
      box.step(static_cast<float>(1 / kRate));
    }
    std::printf("%6d %9.3f %9.3f %9.2f %9.3f\n", second, box.centre.x, length(box.velocity), box.angle * 180 / std::numbers::pi, pulled);
  }
  std::printf("friction holds the box with up to %.3f N, and the cloth has %zu particles\n", kFriction * kMass * 9.81,
              (*cloth)->fabric().positions.size());
  return EXIT_SUCCESS;
}
