// See engine/c/weft.h: colliders, and what cloth does to them.
#include "engine/c/inside.h"

using weft::fail;
using weft::Result;
using namespace weft::c;

namespace {

weft::ColliderPose pose_of(const weft_pose& pose) {
  const float* r = pose.rotation;
  return {vector(pose.centre), vector(pose.normal), {r[0], r[1], r[2], r[3]}};
}

// What has been taken is told once: room for it is looked at before.
template <class Take>
Result<void> take(weft_simulation* simulation, weft_reaction* reactions, std::size_t given, std::size_t there, const char* what,
                  Take taken) {
  if (!simulation->simulation->scene().reactions) return fail("the scene does not ask for reactions (its key \"reactions\")");
  if (auto good = room(given, there, what); !good) return good;
  for (const weft::Reaction& one : (simulation->simulation.get()->*taken)()) {
    put(one.impulse, reactions->impulse);
    put(one.angular_impulse, reactions->angular_impulse);
    ++reactions;
  }
  return {};
}

}  // namespace

uint32_t weft_collider_count(const weft_simulation* simulation) {
  return simulation != nullptr ? static_cast<std::uint32_t>(simulation->simulation->scene().colliders.size()) : 0;
}

weft_status weft_move_collider(weft_simulation* simulation, uint32_t collider, const weft_pose* pose, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(pose);
    return simulation->simulation->move_collider(collider, pose_of(*pose));
  });
}

weft_status weft_move_colliders(weft_simulation* simulation, uint32_t first, const weft_pose* poses, uint32_t count, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_LIST(poses, count);
    std::vector<weft::ColliderPose> all;
    for (const weft_pose& pose : std::span(poses, count)) all.push_back(pose_of(pose));
    return simulation->simulation->move_colliders(first, all);
  });
}

weft_status weft_place_collider(weft_simulation* simulation, uint32_t collider, const weft_pose* pose, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(pose);
    return simulation->simulation->place_collider(collider, pose_of(*pose));
  });
}

weft_status weft_collider_pose(weft_simulation* simulation, uint32_t collider, weft_pose* pose, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(pose);
    const auto poses = simulation->simulation->colliders();
    if (collider >= poses.size()) return fail("there is no collider ", collider, ", but ", poses.size());
    const auto& [centre, normal, r] = poses[collider];
    *pose = {{centre.x, centre.y, centre.z}, {normal.x, normal.y, normal.z}, {r.x, r.y, r.z, r.w}};
    return {};
  });
}

weft_status weft_resize_collider(weft_simulation* simulation, uint32_t collider, const weft_size* size, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(size);
    return simulation->simulation->resize_collider(collider, {size->radius, size->radius_end, size->length, vector(size->sides)});
  });
}

weft_status weft_collider_size(weft_simulation* simulation, uint32_t collider, weft_size* size, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(size);
    const auto sizes = simulation->simulation->collider_sizes();
    if (collider >= sizes.size()) return fail("there is no collider ", collider, ", but ", sizes.size());
    const auto& [radius, radius_end, length, sides] = sizes[collider];
    *size = {radius, radius_end, length, {sides.x, sides.y, sides.z}};
    return {};
  });
}

weft_status weft_take_reactions(weft_simulation* simulation, weft_reaction* reactions, size_t colliders, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_LIST(reactions, colliders);
    return take(simulation, reactions, colliders, weft_collider_count(simulation), "colliders", &weft::Simulation::take_reactions);
  });
}

weft_status weft_take_pulls(weft_simulation* simulation, weft_reaction* pulls, size_t grabs, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_LIST(pulls, grabs);
    return take(simulation, pulls, grabs, weft_grab_count(simulation), "grabs", &weft::Simulation::take_pulls);
  });
}
