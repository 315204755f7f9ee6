// See engine/c/weft.h: characters: skins, moving frames, and what keeps cloth near them; gas.
#include "engine/c/inside.h"

using weft::fail;
using weft::Result;
using namespace weft::c;

namespace {

static_assert(sizeof(weft_affine) == sizeof(weft::Affine));

std::vector<weft::Affine> maps(const weft_affine* joints, std::size_t count) {
  std::vector<weft::Affine> all;
  for (const weft_affine& m : std::span(joints, count)) all.push_back({vector(m.x), vector(m.y), vector(m.z), vector(m.origin)});
  return all;
}

weft::TargetBuffer buffer_of(const weft_target_buffer& targets) {
  return {reinterpret_cast<VkBuffer>(targets.positions), targets.positions_offset, reinterpret_cast<VkBuffer>(targets.normals),
          targets.normals_offset, targets.vertices};
}

weft::MovingFrame frame_of(const weft_frame& frame) {
  const float* r = frame.rotation;
  return {vector(frame.place), {r[0], r[1], r[2], r[3]}};
}

}  // namespace

weft_status weft_set_pose(weft_simulation* simulation, uint32_t cloth, const weft_affine* joints, uint32_t count, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_LIST(joints, count);
    return simulation->simulation->set_pose(cloth, maps(joints, count));
  });
}

weft_status weft_set_body_pose(weft_simulation* simulation, uint32_t collider, const weft_affine* joints, uint32_t count,
                               weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_LIST(joints, count);
    return simulation->simulation->set_body_pose(collider, maps(joints, count));
  });
}

weft_status weft_set_morphs(weft_simulation* simulation, uint32_t cloth, const float* weights, uint32_t count, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_LIST(weights, count);
    return simulation->simulation->set_morphs(cloth, {weights, count});
  });
}

weft_status weft_set_body_morphs(weft_simulation* simulation, uint32_t collider, const float* weights, uint32_t count,
                                 weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_LIST(weights, count);
    return simulation->simulation->set_body_morphs(collider, {weights, count});
  });
}

weft_status weft_set_targets(weft_simulation* simulation, uint32_t cloth, const weft_target_buffer* targets, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(targets);
    return simulation->simulation->set_targets(cloth, buffer_of(*targets));
  });
}

weft_status weft_set_body_targets(weft_simulation* simulation, uint32_t collider, const weft_target_buffer* targets, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(targets);
    return simulation->simulation->set_body_targets(collider, buffer_of(*targets));
  });
}

weft_status weft_move_frame(weft_simulation* simulation, uint32_t cloth, const weft_frame* frame, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(frame);
    return simulation->simulation->move_frame(cloth, frame_of(*frame));
  });
}

weft_status weft_teleport(weft_simulation* simulation, uint32_t cloth, const weft_frame* from, const weft_frame* to, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(from);
    WEFT_GIVEN(to);
    return simulation->simulation->teleport(cloth, frame_of(*from), frame_of(*to));
  });
}

weft_status weft_limit_motion(weft_simulation* simulation, uint32_t cloth, double scale, double stiffness, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    return simulation->simulation->limit_motion(cloth, scale, stiffness);
  });
}

weft_status weft_inflate(weft_simulation* simulation, uint32_t cloth, double amount, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    return simulation->simulation->inflate(cloth, amount);
  });
}
