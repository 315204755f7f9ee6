// A ball falls into a hammock, swings it and comes to rest: a rigid body that Bullet steps, coupled with cloth both ways.
//
// Every frame the ball is a collider on its way to where Bullet has moved it, and gets back what the cloth was given there: impulse and
// angular impulse, momentum for momentum (Simulation::take_reactions). Frames are short, 240 a second, because the ball learns of the
// cloth's answer a frame late.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "engine/simulation.h"
#include "samples/rigid_bodies.h"

namespace {

using namespace weft;

constexpr double kRate = 240;   // Hz
constexpr float kRadius = 0.15f, kMass = 2;   // m, kg
constexpr Vec3 kStart{0.15f, 0.6f, 0.05f};   // m
constexpr float kDrag = 1;   // 1/s: what rolls through folds loses speed

// Two metres of denim between two beams, which come closer in the first half second so that it sags.
Scene hammock() {
  Scene scene;
  scene.solver.rate = kRate;
  scene.solver.substeps = 4;
  scene.reactions = true;
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{.size = {2, 1}, .cells_x = 48, .cells_y = 24};
  cloth.fabric = *fabric_preset("denim");
  for (const float end : {-1.0f, 1.0f})
    for (const float side : {-1.0f, 1.0f}) {   // by its corners: what hangs from whole ends is a trough, and a ball rolls out of it
      Anchor& corner = cloth.anchors.emplace_back();
      corner.box = Anchor::Box{{end - 0.01f, -1, 0.45f * side - 0.07f}, {end + 0.01f, 1, 0.45f * side + 0.07f}};
      corner.keys = {{0, {}, {0, 1, 0}, 0}, {0.5, {-0.15f * end, 0, 0}, {0, 1, 0}, 0}};
    }
  Collider& ball = scene.colliders.emplace_back();
  ball.shape = ColliderShape::sphere;
  ball.radius = kRadius;
  ball.centre = kStart;
  return scene;
}

int complain(const std::string& why) { return std::fprintf(stderr, "%s\n", why.c_str()), EXIT_FAILURE; }

}  // namespace

int main(int count, char** arguments) {
  const int seconds = count > 1 ? std::atoi(arguments[1]) : 8;
  const Scene scene = hammock();
  const auto device = compute::Device::create();
  if (!device) return complain(device.error());
  const auto cloth = Simulation::create(**device, scene);
  if (!cloth) return complain(cloth.error());

  RigidBodies bodies(scene.gravity);
  btRigidBody& ball = bodies.add(std::make_unique<btSphereShape>(kRadius), kMass, kStart);
  ball.setDamping(1 - std::exp(-kDrag), 0);   // to Bullet the part of its speed that a body loses in a second
  std::printf("%6s %9s %9s %9s %9s\n", "s", "height m", "aside m", "top m/s", "N");
  for (int second = 1; second <= seconds; ++second) {
    float up = 0;        // N s that the cloth gave in this second
    float fastest = 0;   // m/s, of the ball in it
    for (int frame = 0; frame < static_cast<int>(kRate); ++frame) {
      if (const auto moved = (*cloth)->move_collider(0, pose_of(ball)); !moved) return complain(moved.error());
      if (const auto advance = (*cloth)->advance(1 / kRate); !advance) return complain(advance.error());
      const Reaction given = (*cloth)->take_reactions()[0];
      up += given.impulse.y;
      take(ball, given);
      bodies.step(1 / kRate);
      fastest = std::max(fastest, ball.getLinearVelocity().length());
    }
    const Vec3 centre = pose_of(ball).centre;
    std::printf("%6d %9.3f %9.3f %9.3f %9.2f\n", second, centre.y, std::hypot(centre.x, centre.z), fastest, up);
  }
  std::printf("the ball weighs %.2f N, and the cloth has %zu particles\n", -kMass * scene.gravity.y, (*cloth)->fabric().positions.size());
  return EXIT_SUCCESS;
}
