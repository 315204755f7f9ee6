// Skins: where an animation has their joints and the weights of their morph targets, and what a skin must be like.
//
// Between the times of a channel its value stays (step), goes in a straight line (linear; a rotation along the shorter arc, by spherical
// interpolation), or along a cubic Hermite spline with the tangents that the file has (glTF 2.0, appendix C).
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/finite.h"
#include "engine/mesh/parts.h"

namespace weft {
namespace {

using Eigen::Affine3d;
using Eigen::Quaterniond;
using Eigen::Vector4d;
using parts::narrow;
using parts::wide;

Vector4d four(const Vec4& v) { return {v.x, v.y, v.z, v.w}; }

// A quaternion as glTF has it, the real part last; none that has no length.
Quaterniond turn(const Vector4d& q) {
  const double size = q.norm();
  return size > 1e-12 ? Quaterniond(q.w() / size, q.x() / size, q.y() / size, q.z() / size) : Quaterniond::Identity();
}

Vector4d value_at(const Skin::Channel& channel, double time) {
  const bool cubic = channel.interpolation == Skin::Interpolation::cubic;
  const auto value = [&](std::size_t k) { return four(channel.values[cubic ? 3 * k + 1 : k]); };
  const auto next = std::upper_bound(channel.times.begin(), channel.times.end(), time);
  if (next == channel.times.begin()) return value(0);
  const auto k = static_cast<std::size_t>(next - channel.times.begin()) - 1;
  if (next == channel.times.end() || channel.interpolation == Skin::Interpolation::step) return value(k);
  const double span = double(channel.times[k + 1]) - double(channel.times[k]), t = (time - double(channel.times[k])) / span;
  const Vector4d a = value(k), b = value(k + 1);
  if (cubic) {
    const Vector4d out = span * four(channel.values[3 * k + 2]), in = span * four(channel.values[3 * k + 3]);
    const double t2 = t * t, t3 = t2 * t;
    return (2 * t3 - 3 * t2 + 1) * a + (t3 - 2 * t2 + t) * out + (3 * t2 - 2 * t3) * b + (t3 - t2) * in;
  }
  if (channel.moves != Skin::Moves::rotation) return (1 - t) * a + t * b;
  const Quaterniond q = turn(a).slerp(t, turn(b));
  return {q.x(), q.y(), q.z(), q.w()};
}

Result<void> check_tree(const Skin& skin) {
  for (std::size_t n = 0; n < skin.nodes.size(); ++n)
    if (const std::uint32_t parent = skin.nodes[n].parent; parent != kNone && parent >= n)
      return fail("skin.nodes[", n, "]: its parent, ", parent, ", does not come before it");
  if ((skin.joints.empty() && skin.morphs.empty()) || skin.joints.size() > 65535)
    return fail("skin.joints: ", skin.joints.size(), " are not 1 to 65535");
  for (std::size_t k = 0; k < skin.joints.size(); ++k)
    if (skin.joints[k].node >= skin.nodes.size())
      return fail("skin.joints[", k, "]: node ", skin.joints[k].node, " is not one of the ", skin.nodes.size());
  return {};
}

Result<void> check_weights(const Skin& skin, std::size_t points) {
  if (skin.joints.empty()) points = 0;
  if (skin.weights.size() != points || skin.joints_of.size() != points)
    return fail("skin: has weights of ", skin.weights.size(), " and joints of ", skin.joints_of.size(), " points, and there are ", points);
  constexpr double kOff = 1e-3;   // of the sum of rounded weights
  for (std::size_t p = 0; p < points; ++p) {
    double sum = 0;
    for (std::size_t k = 0; k < Skin::kInfluences; ++k) {
      if (skin.joints_of[p][k] >= skin.joints.size())
        return fail("skin.joints_of[", p, "]: joint ", skin.joints_of[p][k], " is not one of the ", skin.joints.size());
      if (!(skin.weights[p][k] >= 0)) return fail("skin.weights[", p, "]: ", skin.weights[p][k], " is less than 0, or not a number");
      sum += double(skin.weights[p][k]);
    }
    if (!(std::abs(sum - 1) <= kOff)) return fail("skin.weights[", p, "]: their sum is ", sum, ", not 1");
  }
  return {};
}

Result<void> check_morphs(const Skin& skin, std::size_t points) {
  if (skin.morphs.size() > kMostMorphs) return fail("skin.morphs: ", skin.morphs.size(), " are more than ", kMostMorphs);
  for (std::size_t m = 0; m < skin.morphs.size(); ++m) {
    const Skin::Morph& morph = skin.morphs[m];
    const auto fault = [&](const auto&... what) { return fail("skin.morphs[", m, "]: ", what...); };
    if (!std::isfinite(morph.weight)) return fault("its weight is not finite");
    if (morph.deltas.size() != morph.points.size() || (!morph.normal_deltas.empty() && morph.normal_deltas.size() != morph.points.size()))
      return fault("moves ", morph.points.size(), " points, and has ", morph.deltas.size(), " deltas and ", morph.normal_deltas.size(),
                   " of normals");
    for (std::size_t k = 0; k < morph.points.size(); ++k) {
      if (morph.points[k] >= points || (k > 0 && morph.points[k] <= morph.points[k - 1]))
        return fault("point ", morph.points[k], " is not one of the ", points, ", or not after the one before");
      if (!is_finite(morph.deltas[k]) || (!morph.normal_deltas.empty() && !is_finite(morph.normal_deltas[k])))
        return fault("the delta of point ", morph.points[k], " is not finite, or of ", kTooLarge, " m or more");
    }
  }
  return {};
}

Result<void> check_animations(const Skin& skin) {
  for (std::size_t a = 0; a < skin.animations.size(); ++a)
    for (std::size_t c = 0; c < skin.animations[a].channels.size(); ++c) {
      const Skin::Channel& channel = skin.animations[a].channels[c];
      const auto fault = [&](const auto&... what) { return fail("skin.animations[", a, "].channels[", c, "]: ", what...); };
      const bool is_weight = channel.moves == Skin::Moves::weight;
      if (const std::size_t count = is_weight ? skin.morphs.size() : skin.nodes.size(); channel.node >= count)
        return fault(is_weight ? "morph target " : "node ", channel.node, " is not one of the ", count);
      if (channel.times.empty()) return fault("has no times");
      const std::size_t wanted = channel.times.size() * (channel.interpolation == Skin::Interpolation::cubic ? 3 : 1);
      if (channel.values.size() != wanted) return fault("has ", channel.values.size(), " values, and its times need ", wanted);
      for (std::size_t k = 0; k < channel.times.size(); ++k)
        if (!std::isfinite(channel.times[k]) || (k > 0 && !(channel.times[k] > channel.times[k - 1])))
          return fault("time ", k, ", ", channel.times[k], " s, is not finite or not after the one before");
      for (const Vec4& v : channel.values)
        if (!std::isfinite(v.w) || !is_finite(Vec3{v.x, v.y, v.z})) return fault("has a value that is not finite");
    }
  return {};
}

}  // namespace

double duration_of(const Skin::Animation& animation) {
  double longest = 0;
  for (const Skin::Channel& channel : animation.channels) longest = std::max(longest, double(channel.times.back()));
  return longest;
}

std::vector<Affine> joints_at(const Skin& skin, std::uint32_t animation, double time) {
  std::vector<Skin::Node> nodes = skin.nodes;
  if (animation != kNone)
    for (const Skin::Channel& channel : skin.animations[animation].channels) {
      if (channel.moves == Skin::Moves::weight) continue;
      const Vector4d value = value_at(channel, time);
      Skin::Node& node = nodes[channel.node];
      node.matrix.reset();   // glTF has none where a channel moves the node
      switch (channel.moves) {
        case Skin::Moves::weight: break;
        case Skin::Moves::translation: node.translation = narrow(Eigen::Vector3d(value.head<3>())); break;
        case Skin::Moves::scale: node.scale = narrow(Eigen::Vector3d(value.head<3>())); break;
        case Skin::Moves::rotation: {
          const Quaterniond q = turn(value);
          node.rotation = {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()), static_cast<float>(q.w())};
          break;
        }
      }
    }
  std::vector<Affine3d> places;
  for (const Skin::Node& node : nodes) {
    const Affine3d own = node.matrix ? wide(*node.matrix)
                                     : Affine3d(Eigen::Translation3d(wide(node.translation)) *
                                                turn({node.rotation.x, node.rotation.y, node.rotation.z, node.rotation.w}) *
                                                Eigen::Scaling(wide(node.scale)));
    places.push_back(node.parent == kNone ? own : places[node.parent] * own);
  }
  const Affine3d place = wide(skin.place), back = place.inverse();
  std::vector<Affine> joints;
  for (const Skin::Joint& joint : skin.joints) joints.push_back(narrow(place * places[joint.node] * wide(joint.inverse_bind) * back));
  return joints;
}

std::vector<float> weights_at(const Skin& skin, std::uint32_t animation, double time) {
  std::vector<float> weights;
  for (const Skin::Morph& morph : skin.morphs) weights.push_back(morph.weight);
  if (animation != kNone)
    for (const Skin::Channel& channel : skin.animations[animation].channels)
      if (channel.moves == Skin::Moves::weight) weights[channel.node] = static_cast<float>(value_at(channel, time).x());
  return weights;
}

Result<void> parts::check_skin(const Skin& skin, std::size_t points) {
  if (auto good = check_tree(skin); !good) return good;
  if (auto good = check_weights(skin, points); !good) return good;
  if (auto good = check_morphs(skin, points); !good) return good;
  return check_animations(skin);
}

}  // namespace weft
