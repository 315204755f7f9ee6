// Perturbations as changes of a scene. Lengths and accelerations grow by s, so that everything takes as long as before: forces per
// mass grow by s too, tension per width by s^2, and a moment per width and curvature by s^4 (area densities stay).
#include "samples/weft/perturbation.h"

#include <algorithm>
#include <cmath>

namespace weft::command {

namespace {

constexpr std::uint32_t kJitters = 10;
constexpr double kRates[] = {30, 60, 120, 240};     // Hz
constexpr double kRateBands = 2.5;                  // a solver of 30 Hz has eight times the substeps of one of 240 Hz
constexpr double kMasses[] = {1e-3, 1e-1, 10, 1e3};
constexpr double kSize = 100;
constexpr Vec3 kAway{10e3f, 0, -10e3f};             // m
constexpr double kHitchSeconds = 0.5;                      // s
constexpr Vec3 kJump{5, 0, 0};                      // m
constexpr Vec3 kTeleport{30, 10, -40};              // m

std::string text(double value) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%g", value);
  return digits;
}

void make_heavier(Scene& scene, double m) {
  for (Cloth& cloth : scene.cloths) {
    cloth.fabric.area_density *= m;
    if (cloth.springs) cloth.springs->mass *= m;
  }
}

void make_stiffer(Scene& scene, double m) {
  for (Cloth& cloth : scene.cloths) {
    cloth.fabric.stretch *= m;
    cloth.fabric.shear *= m;
    cloth.fabric.bend *= m;
    if (!cloth.springs) continue;
    for (Springs::Kind* kind : {&cloth.springs->structural, &cloth.springs->shear, &cloth.springs->bend})
      kind->stiffness *= m, kind->damping *= m;
  }
}

void enlarge(std::vector<Key>& keys, float s) {
  for (Key& key : keys) key.translate = s * key.translate;
}

void enlarge(Scene& scene, double factor) {
  const auto s = static_cast<float>(factor);
  const double s2 = factor * factor;
  scene.gravity = s * scene.gravity;
  for (double* length : {&scene.contacts.recover, &scene.contacts.cell, &scene.contacts.detection_margin}) *length *= factor;
  for (Cloth& cloth : scene.cloths) {
    cloth.transform.translate = s * cloth.transform.translate;
    cloth.transform.scale *= factor;
    cloth.start.radius *= factor;
    cloth.start.velocity = s * cloth.start.velocity;
    cloth.fabric.thickness *= factor;
    cloth.fabric.stretch *= s2;
    cloth.fabric.shear *= s2;
    cloth.fabric.bend *= s2 * s2;
    if (cloth.springs) {
      cloth.springs->mass *= s2;
      for (Springs::Kind* kind : {&cloth.springs->structural, &cloth.springs->shear, &cloth.springs->bend})
        kind->stiffness *= s2, kind->damping *= s2;
    }
    for (Anchor& anchor : cloth.anchors) {
      if (anchor.top) *anchor.top *= factor;
      if (anchor.box) anchor.box = Anchor::Box{s * anchor.box->low, s * anchor.box->high};
      enlarge(anchor.keys, s);
    }
  }
  for (Collider& collider : scene.colliders) {
    collider.centre = s * collider.centre;
    collider.size = s * collider.size;
    for (double* length : {&collider.scale, &collider.thickness, &collider.radius, &collider.length}) *length *= factor;
    if (collider.radius_end) *collider.radius_end *= factor;
    enlarge(collider.keys, s);
  }
}

void move(Scene& scene, Vec3 by) {
  for (Cloth& cloth : scene.cloths) {
    cloth.transform.translate = cloth.transform.translate + by;
    for (Anchor& anchor : cloth.anchors)
      if (anchor.box) anchor.box = Anchor::Box{anchor.box->low + by, anchor.box->high + by};
  }
  for (Collider& collider : scene.colliders) collider.centre = collider.centre + by;
}

// The same keys, `by` further on from `time` + `within`.
std::vector<Key> with_jump(const std::vector<Key>& keys, double time, double within, Vec3 by) {
  const auto at = [&](double when, Vec3 further) {
    Key key = pose_at(keys, when);
    key.time = when;
    key.translate = key.translate + further;
    return key;
  };
  std::vector<Key> jumping;
  for (const Key& key : keys)
    if (key.time < time) jumping.push_back(key);
  jumping.push_back(at(time, {}));
  jumping.push_back(at(time + within, by));
  for (const Key& key : keys)
    if (key.time > time + within) jumping.push_back(at(key.time, by));
  return jumping;
}

void not_judged(Perturbation& perturbation) {
  perturbation.bands = INFINITY;
  perturbation.same_strain = false;
}

}  // namespace

std::vector<Perturbation> all_perturbations(const Scene& scene, bool quick) {
  std::vector<Perturbation> all;
  const auto add = [&](const char* group, std::string name) -> Perturbation& {
    Perturbation& added = all.emplace_back();
    added.group = group;
    added.name = std::move(name);
    return added;
  };
  for (std::uint32_t seed = 1; seed <= (quick ? 2 : kJitters); ++seed)
    add("jittered starts", "jittered start " + std::to_string(seed)).seed = seed;
  for (const double rate : kRates)
    if (!quick || rate == 30 || rate == 240) add("frame rates", "frames at " + text(rate) + " Hz").frame = 1 / rate;
  for (const double rate : kRates)
    if (!quick || rate == 30 || rate == 240) {
      Perturbation& solver = add("solver rates", "solver at " + text(rate) + " Hz");
      solver.rate = rate;
      solver.bands = kRateBands;
      solver.same_strain = false;   // other substeps have another error
    }
  for (const double mass : kMasses)
    if (!quick || mass == 1e-3 || mass == 1e3) add("masses", "mass and moduli x " + text(mass)).mass = mass;
  const bool gives_way = std::any_of(scene.cloths.begin(), scene.cloths.end(), [](const Cloth& cloth) {
    return cloth.springs || cloth.bending || !std::isinf(cloth.fabric.stretch) || !std::isinf(cloth.fabric.shear);
  });
  for (const double mass : kMasses)
    if (!quick || mass == 1e-3 || mass == 1e3) {
      Perturbation& weight = add("masses alone", "mass alone x " + text(mass));
      weight.weight = mass;
      if (gives_way) not_judged(weight);
    }
  add("far away", "10 km away").away = kAway;
  add("large", "everything x " + text(kSize)).size = kSize;
  add("hitch", "a frame of " + text(kHitchSeconds) + " s").hitch = kHitchSeconds;
  add("teleport", "everything set 51 m away").teleport = kTeleport;
  Perturbation& jolt = add("jolt", "anchors and colliders jump 5 m");
  jolt.jolt = kJump;
  not_judged(jolt);   // friction takes free cloth along, and cloth that is torn through a collider may stay there
  return all;
}

std::uint32_t least_frames(const Scene& scene) {
  const double hitch = std::min(kHitchSeconds, scene.solver.longest_advance) * scene.solver.rate;   // frames
  return 2 * static_cast<std::uint32_t>(std::ceil(hitch - 1e-6));
}

Scene perturbed(const Scene& scene, const Perturbation& perturbation, double halfway, double frame) {
  Scene changed = scene;
  if (perturbation.rate > 0) changed.solver.rate = perturbation.rate;
  if (perturbation.mass != 1) make_stiffer(changed, perturbation.mass);
  if (const double mass = perturbation.mass * perturbation.weight; mass != 1) make_heavier(changed, mass);
  if (perturbation.size != 1) enlarge(changed, perturbation.size);
  if (perturbation.away != Vec3{}) move(changed, perturbation.away);
  if (const Vec3 jump = perturbation.jolt + perturbation.teleport; jump != Vec3{}) {
    for (Cloth& cloth : changed.cloths)
      for (Anchor& anchor : cloth.anchors) anchor.keys = with_jump(anchor.keys, halfway, frame, jump);
    for (Collider& collider : changed.colliders) collider.keys = with_jump(collider.keys, halfway, frame, jump);
  }
  return changed;
}

}  // namespace weft::command
