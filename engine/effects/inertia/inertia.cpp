// What is taken out of the motion that cloth feels.
//
// In a frame of t seconds a moving frame turns about its place by R, by the angle a about the axis k, and its place moves with the velocity
// V. With S = sin a [k]x and Q = (1 - cos a) [k]x^2 it is R = 1 + S + Q (Rodrigues), so that what it carries at r from its place goes with
// V + (S + Q) r / t, and what it carried there came with V + (S - Q) r / t. From one frame (0) to the next (1) velocities of what is
// carried therefore change by
//     V1 - V0            its acceleration:          what is felt is the linear part,
//     (S1/t1 - S0/t0) r  its angular acceleration:  the angular part,
//     (Q1/t1 + Q0/t0) r  towards the axis:          the centrifugal part;
// and what moves relative to it turns along, by R0 (that it does not is felt as the Coriolis force, which goes with the angular part). Of
// each a particle is given 1 - its factor: with 0 it moves relative to the frame as if that stood still, and with 1 as it does in the
// world. (After NvCloth's linear, angular and centrifugal inertia, which scale fictitious forces in a cloth's own space.)
#include "engine/effects/inertia/inertia.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "engine/cook/cook_state.h"
#include "engine/effects/effect.h"
#include "engine/effects/skin/skin.h"
#include "engine/mesh/parts.h"

namespace weft {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

using parts::wide;
Vector3d wide(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

Matrix3d cross_with(const Vector3d& k) {
  Matrix3d m;
  m << 0, -k.z(), k.y(), k.z(), 0, -k.x(), -k.y(), k.x(), 0;
  return m;
}

// Of a turn, over its time: S/t and Q/t.
struct Turning {
  Eigen::AngleAxisd turn;
  Matrix3d across, inwards;
  explicit Turning(const FrameMotion& m) : turn(wide(m.turn)) {
    const Matrix3d k = cross_with(turn.axis());
    across = std::sin(turn.angle()) / m.seconds * k;
    inwards = (1 - std::cos(turn.angle())) / m.seconds * k * k;
  }
};

gpu::vec3 packed(const Vector3d& v) { return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())}; }

}  // namespace

FrameMotion motion_between(const MovingFrame& from, const MovingFrame& to, double seconds) {
  const Eigen::Quaterniond turn = wide(to.rotation) * wide(from.rotation).conjugate();
  const auto speed = [&](float a, float b) { return (double(b) - double(a)) / seconds; };
  return {{speed(from.place.x, to.place.x), speed(from.place.y, to.place.y), speed(from.place.z, to.place.z)},
          parts::narrow(turn),
          seconds};
}

gpu::FrameChange change_of(const Inertia& inertia, const MovingFrame& at, const FrameMotion& before, const FrameMotion& next) {
  const double linear = 1 - inertia.linear, angular = 1 - inertia.angular, centrifugal = 1 - inertia.centrifugal;
  const Turning a(before), b(next);
  const Matrix3d along = Eigen::AngleAxisd(angular * a.turn.angle(), a.turn.axis()).toRotationMatrix() - Matrix3d::Identity();
  const Matrix3d n = angular * (b.across - a.across) + centrifugal * (b.inwards + a.inwards) - along * (a.across - a.inwards);
  gpu::FrameChange change{};
  change.centre = {at.place.x, at.place.y, at.place.z};
  change.b = packed(linear * (wide(next.velocity) - wide(before.velocity)) - along * wide(before.velocity));
  for (int k = 0; k < 3; ++k) {
    change.m[k] = packed(along.row(k));
    change.n[k] = packed(n.row(k));
  }
  return change;
}

namespace effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::frame_changes};

constexpr Pass kPasses[] = {{.name = "inertia", .stage = Stage::frame_begin, .threads = {lengths::particles}}};

Result<void> cook(cooking::CookState& state, const cooking::ClothInput& input) {
  CookedFabric& fabric = state.fabric();
  if (!input.cloth.inertia) return {};
  auto& lists = fabric.own.of<InertiaLists>();
  lists.joints.resize(fabric.cloths.size(), kNone);
  lists.places.resize(fabric.cloths.size());
  const std::string& name = input.cloth.inertia->joint;
  if (name.empty()) return {};
  if (!is_skinned(input.cloth)) return fail("inertia.joint: the cloth has no skin (its key \"skin\") whose joint it could go with");
  if (!input.mesh.skin) return fail("inertia.joint: the mesh has no skin, and so no joint \"", name, '"');
  const auto& joints = input.mesh.skin->joints;
  const auto at = std::ranges::find(joints, name, &Skin::Joint::name);
  if (at == joints.end()) {
    std::string names;
    for (const Skin::Joint& joint : joints) names += (names.empty() ? "\"" : ", \"") + joint.name + '"';
    return fail("inertia.joint: the mesh has no joint \"", name, "\"; it has ", names);
  }
  const auto k = static_cast<std::size_t>(at - joints.begin());
  const Eigen::Affine3d to_joint = wide(at->inverse_bind);
  const Vector3d place = to_joint.linear().fullPivLu().solve(-to_joint.translation());   // where the joint's axes have their origin
  lists.places.back() = input.mesh.skin->place * parts::narrow(place);
  lists.joints.back() = static_cast<std::uint32_t>(k);   // until the skin has cooked: of its own
  return {};
}

// The skin's joints are known now.
void lay_out(cooking::CookState& state) {
  CookedFabric& fabric = state.fabric();
  if (std::as_const(fabric.own).of<InertiaLists>().joints.empty()) return;
  auto& lists = fabric.own.of<InertiaLists>();
  lists.joints.resize(fabric.cloths.size(), kNone);
  lists.places.resize(fabric.cloths.size());
  for (const SkinnedMesh& skinned : std::as_const(fabric.own).of<SkinLists>().meshes)
    if (!skinned.is_collider && lists.joints[skinned.index] != kNone) lists.joints[skinned.index] += skinned.first_joint;
}

}  // namespace

constinit const Effect inertia{
    .name = "inertia",
    .key = "inertia",
    .called_for =
        [](const Scene& scene, const CookedFabric&) {
          return std::ranges::any_of(scene.cloths, [](const Cloth& c) { return c.inertia.has_value(); });
        },
    .buffers = kBuffers,
    .passes = kPasses,
    .reference = Reference::absent,
    .cook = cook,
    .lay_out = lay_out,
};

}  // namespace effects
}  // namespace weft
