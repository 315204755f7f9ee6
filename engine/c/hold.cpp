// See engine/c/weft.h: anchors, pins, hands, gravity and air.
#include "engine/c/inside.h"

using weft::fail;
using weft::Result;
using namespace weft::c;

namespace {

void tell(const weft::Grabbed& held, weft_grabbed* grabbed) {
  *grabbed = {held.distance, held.grab, held.cloth, {held.point.x, held.point.y, held.point.z}};
}

weft::Grip grip_of(const weft_grip* grip) {
  return grip != nullptr ? weft::Grip{grip->stiffness, grip->damping, grip->force} : weft::Grip();
}

}  // namespace

weft_status weft_set_gravity(weft_simulation* simulation, const float gravity[3], weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(gravity);
    return simulation->simulation->set_gravity(vector(gravity));
  });
}

weft_status weft_set_wind(weft_simulation* simulation, const float wind[3], weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(wind);
    return simulation->simulation->set_wind(vector(wind));
  });
}

weft_status weft_move_air_field(weft_simulation* simulation, uint32_t field, const float centre[3], const float velocity[3],
                                weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(centre);
    WEFT_GIVEN(velocity);
    return simulation->simulation->move_air_field(field, vector(centre), vector(velocity));
  });
}

uint32_t weft_anchor_count(const weft_simulation* simulation) {
  return simulation != nullptr ? static_cast<std::uint32_t>(simulation->simulation->fabric().anchors.size()) : 0;
}

weft_status weft_anchor_vertices(const weft_simulation* simulation, uint32_t* vertices, size_t anchors, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_LIST(vertices, anchors);
    if (auto good = room(anchors, weft_anchor_count(simulation), "anchors"); !good) return good;
    for (const weft::AnchorTarget& anchor : simulation->simulation->fabric().anchors) *vertices++ = anchor.vertex;
    return {};
  });
}

weft_status weft_move_anchors(weft_simulation* simulation, uint32_t first, const float* xyz, uint32_t count, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_LIST(xyz, count);
    return simulation->simulation->move_anchors(first, vectors(xyz, count));
  });
}

weft_status weft_pin(weft_simulation* simulation, const uint32_t* vertices, uint32_t count, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_LIST(vertices, count);
    return simulation->simulation->pin({vertices, count});
  });
}

weft_status weft_release(weft_simulation* simulation, const uint32_t* vertices, uint32_t count, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_LIST(vertices, count);
    return simulation->simulation->release({vertices, count});
  });
}

weft_status weft_move_pins(weft_simulation* simulation, const uint32_t* vertices, const float* xyz, uint32_t count, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_LIST(vertices, count);
    WEFT_LIST(xyz, count);
    return simulation->simulation->move_pins({vertices, count}, vectors(xyz, count));
  });
}

weft_status weft_grab(weft_simulation* simulation, const float origin[3], const float direction[3], const weft_grip* grip,
                      weft_grabbed* grabbed, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(origin);
    WEFT_GIVEN(direction);
    WEFT_GIVEN(grabbed);
    auto found = simulation->simulation->grab(vector(origin), vector(direction), grip_of(grip));
    if (!found) return found.take_error();
    *grabbed = {0, WEFT_NOTHING, WEFT_NOTHING, {}};
    if (*found) tell(**found, grabbed);
    return {};
  });
}

weft_status weft_cut(weft_simulation* simulation, const float origin[3], const float a[3], const float b[3], uint32_t* count,
                     weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(origin);
    WEFT_GIVEN(a);
    WEFT_GIVEN(b);
    auto cut = simulation->simulation->cut(vector(origin), vector(a), vector(b));
    if (!cut) return cut.take_error();
    if (count != nullptr) *count = *cut;
    return {};
  });
}

uint32_t weft_splits(const weft_simulation* simulation) { return simulation != nullptr ? simulation->simulation->splits() : 0; }

weft_status weft_grab_near(weft_simulation* simulation, const float point[3], const weft_grip* grip, weft_grabbed* grabbed,
                           weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(point);
    WEFT_GIVEN(grabbed);
    auto held = simulation->simulation->grab_near(vector(point), grip_of(grip));
    if (!held) return held.take_error();
    tell(*held, grabbed);
    return {};
  });
}

uint32_t weft_grab_count(const weft_simulation* simulation) {
  return simulation != nullptr ? simulation->simulation->scene().grabs : 0;
}

weft_status weft_move_grab(weft_simulation* simulation, uint32_t grab, const float target[3], weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    WEFT_GIVEN(target);
    return simulation->simulation->move_grab(grab, vector(target));
  });
}

weft_status weft_let_go(weft_simulation* simulation, uint32_t grab, weft_error* error) {
  return done(error, [&]() -> Result<void> {
    WEFT_GIVEN(simulation);
    return simulation->simulation->let_go(grab);
  });
}
