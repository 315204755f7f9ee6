// A box on the floor, pulled by a sheet: cloth attached to a rigid body that Bullet steps.
//
// Two corners of the sheet are grabbed at two corners of the box. Every frame the program moves these grabs to where the box has them and
// gives the box what they were pulled by (Simulation::take_pulls), each impulse where it acts. The far edge of the sheet walks away. Frames
// are short, 240 a second, because the box learns of the cloth's pull a frame late: that takes damping from the hooks, which have some to
// spare.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>

#include "engine/simulation.h"
#include "samples/rigid_bodies.h"

namespace {

using namespace weft;

constexpr double kRate = 240;   // Hz
constexpr Vec3 kHalf{0.15f, 0.1f, 0.2f};   // m: half the box's sides
constexpr Vec3 kStart{0, kHalf.y, 0};   // m
constexpr float kMass = 1, kFriction = 0.3f;   // kg; of the box on the floor

constexpr std::array kHooks = {Vec3{kHalf.x + 0.01f, 0, -kHalf.z}, Vec3{kHalf.x + 0.01f, 0, kHalf.z}};   // on the box, in its own axes

// A sheet from the box's front to a bar that begins to walk after half a second, at 0.5 m/s.
Scene towed() {
  Scene scene;
  scene.solver.rate = kRate;
  scene.solver.substeps = 4;
  scene.reactions = true;
  scene.contacts.enabled = false;   // taut cloth does not meet itself, and all that it pulls with goes to the box
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
  box.centre = kStart;
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

  RigidBodies bodies(scene.gravity);
  btRigidBody& floor = bodies.add(std::make_unique<btBoxShape>(btVector3(20, 1, 20)), 0, {0, -1, 0});
  btRigidBody& box = bodies.add(std::make_unique<btBoxShape>(to_bullet(kHalf)), kMass, kStart);
  floor.setFriction(1);   // Bullet multiplies the two
  box.setFriction(kFriction);
  const auto arm = [&](Vec3 own) { return box.getWorldTransform().getBasis() * to_bullet(own); };   // from the centre to a place of its own

  std::array<std::uint32_t, kHooks.size()> grabs;
  for (std::size_t k = 0; k < kHooks.size(); ++k) {
    const auto held = (*cloth)->grab_near(kStart + kHooks[k], {.stiffness = 1000, .damping = 20, .force = 1000});
    if (!held) return complain(held.error());
    grabs[k] = held->grab;
  }
  std::printf("%6s %9s %9s %9s %9s %9s\n", "s", "x m", "m/s", "degrees", "N", "up N");
  for (int second = 1; second <= seconds; ++second) {
    Vec3 taken;   // N s in this second
    for (int frame = 0; frame < static_cast<int>(kRate); ++frame) {
      for (std::size_t k = 0; k < kHooks.size(); ++k) {
        const Vec3 hook = from_bullet(box.getCenterOfMassPosition() + arm(kHooks[k]));
        if (const auto moved = (*cloth)->move_grab(grabs[k], hook); !moved) return complain(moved.error());
      }
      if (const auto moved = (*cloth)->move_collider(0, pose_of(box)); !moved) return complain(moved.error());
      if (const auto advance = (*cloth)->advance(1 / kRate); !advance) return complain(advance.error());
      const auto pulls = (*cloth)->take_pulls();
      for (std::size_t k = 0; k < kHooks.size(); ++k) {
        box.applyImpulse(to_bullet(pulls[grabs[k]].impulse), arm(kHooks[k]));
        taken = taken + pulls[grabs[k]].impulse;
      }
      const Reaction given = (*cloth)->take_reactions()[0];   // where the sheet lies on the box
      take(box, given);
      taken = taken + given.impulse;
      bodies.step(1 / kRate);
    }
    const btVector3 front = box.getWorldTransform().getBasis().getColumn(0);
    std::printf("%6d %9.3f %9.3f %9.2f %9.3f %9.3f\n", second, box.getCenterOfMassPosition().x(), box.getLinearVelocity().length(),
                std::atan2(-front.z(), front.x()) * 180 / std::numbers::pi_v<float>, taken.x, taken.y);
  }
  std::printf("friction holds the box with up to %.3f N, and the cloth has %zu particles\n", kFriction * kMass * 9.81,
              (*cloth)->fabric().positions.size());
  return EXIT_SUCCESS;
}
