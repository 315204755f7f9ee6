// Rigid bodies stepped by Bullet (Coumans, bulletphysics.org), coupled with cloth both ways: a collider of Weft's follows a body, and the
// body takes what cloth gave this collider.
//
// Neither library knows the other. In a frame Weft goes first, with the collider on its way to where the body is (pose_of). What the cloth
// gave it then changes the body's velocity (take; btRigidBody::applyImpulse for what pulls at a place of it), and Bullet moves the body by
// that, by gravity and by its own contacts (step). Both use metres, kilograms and seconds; Bullet's numbers are floats in Debian's library.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <btBulletDynamicsCommon.h>

#include "engine/collider_pose.h"
#include "engine/reaction.h"

namespace weft {

inline btVector3 to_bullet(Vec3 v) { return {v.x, v.y, v.z}; }
inline Vec3 from_bullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

inline ColliderPose pose_of(const btRigidBody& body) {
  const btQuaternion turn = body.getOrientation();
  return {.centre = from_bullet(body.getCenterOfMassPosition()), .rotation = {turn.x(), turn.y(), turn.z(), turn.w()}};
}

/// Both impulses act about the collider's centre, which is the body's centre of mass.
inline void take(btRigidBody& body, const Reaction& given) {
  body.applyCentralImpulse(to_bullet(given.impulse));
  body.applyTorqueImpulse(to_bullet(given.angular_impulse));
}

/// Bullet's world and what it does not own itself. On one thread, so that it has the same bits every time.
class RigidBodies {
 public:
  explicit RigidBodies(Vec3 gravity) { world_.setGravity(to_bullet(gravity)); }

  /// A mass (kg) of 0 is a body that never moves. The reference stays valid as long as this object.
  btRigidBody& add(std::unique_ptr<btCollisionShape> shape, float mass, Vec3 centre) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape->calculateLocalInertia(mass, inertia);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shape.get(), inertia);
    info.m_startWorldTransform.setOrigin(to_bullet(centre));
    btRigidBody& body = *bodies_.emplace_back(std::make_unique<btRigidBody>(info));
    body.setActivationState(DISABLE_DEACTIVATION);   // a body that sleeps does not move, whatever it is given
    world_.addRigidBody(&body);
    shapes_.push_back(std::move(shape));
    return body;
  }

  void step(double seconds) { world_.stepSimulation(static_cast<btScalar>(seconds), 0); }   // 0: one step, of just this length

 private:
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broad_phase_;
  btSequentialImpulseConstraintSolver solver_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broad_phase_, &solver_, &configuration_};   // last: it goes before what it points at
};

}  // namespace weft
