// The air: what a scene says of it, as the passes want it. shaders/air/air.comp has the force.
#include "engine/effects/air/air.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/cook/cook_state.h"
#include "engine/effects/air/fans.h"
#include "engine/effects/effect.h"

namespace weft {

namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kGolden = 0.6180339887498949;   // its multiples, modulo 1, are spread evenly

Vec3 narrow(double x, double y, double z) { return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)}; }
gpu::vec3 packed(Vec3 v) { return {v.x, v.y, v.z}; }
float wrapped(double phase) { return static_cast<float>(std::remainder(phase, kTurn)); }

// Of eddy k: where its wave goes (unit), evenly over the sphere (a Fibonacci lattice), in an order that mixes large and small ones.
Vec3 way_of(std::uint32_t k) {
  const double height = 1 - (2.0 * (k * 7 % WEFT_AIR_EDDIES) + 1) / WEFT_AIR_EDDIES, about = kTurn * kGolden * k;
  const double across = std::sqrt(1 - height * height);
  return narrow(across * std::cos(about), height, across * std::sin(about));
}

// A direction at right angles to it (unit): then the wave has no divergence.
Vec3 across(Vec3 way, double angle) {
  const Vec3 other = std::abs(way.y) < 0.9f ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
  const Vec3 aside = cross(way, other), first = (1 / length(aside)) * aside, second = cross(way, first);
  return static_cast<float>(std::cos(angle)) * first + static_cast<float>(std::sin(angle)) * second;
}

// Turbulence as the sum of waves of Kraichnan (1970), the curl of a potential that is a sum of sines: lengths from the largest eddies' to
// an eighth of it in even steps of an octave's part, energy by Kolmogorov's k^(-5/3), and so crests by k^(-1/3). The wind carries them
// along, and each has a turn of its own as well, as fast as eddies of its length turn over.
void add_eddies(const Air& air, const AirState& state, double time, double seconds, Vec3 origin, MovingAir& moving) {
  if (!(air.turbulence > 0)) return;
  double energy = 0;
  for (std::uint32_t k = 0; k < WEFT_AIR_EDDIES; ++k) energy += 0.5 * std::pow(8, -2.0 / 3 * k / (WEFT_AIR_EDDIES - 1));
  for (std::uint32_t k = 0; k < WEFT_AIR_EDDIES; ++k) {
    const double finer = std::pow(8, double(k) / (WEFT_AIR_EDDIES - 1)), number = kTurn / air.eddy * finer;
    const double crest = air.turbulence / std::sqrt(energy) * std::pow(finer, -1.0 / 3);
    const double own = number * crest * (2 * std::fmod(kGolden * (k + 1), 1.0) - 1);   // rad/s
    const Vec3 way = way_of(k);
    const auto along = [&](double x, double y, double z) { return number * (double(way.x) * x + double(way.y) * y + double(way.z) * z); };
    gpu::AirWave& wave = moving.waves[moving.used++];
    wave.velocity = packed(static_cast<float>(crest) * across(way, kTurn * kGolden * kGolden * k));
    wave.wave = packed(static_cast<float>(number) * way);
    wave.phase = wrapped(along(origin.x - state.travelled[0], origin.y - state.travelled[1], origin.z - state.travelled[2]) + own * time +
                         kTurn * std::fmod(kGolden * 3 * k, 1.0));
    wave.turn = static_cast<float>(own * seconds - seconds * along(state.wind.x, state.wind.y, state.wind.z));
  }
}

}  // namespace

void AirState::pass(double seconds) {
  travelled[0] += seconds * double(wind.x);
  travelled[1] += seconds * double(wind.y);
  travelled[2] += seconds * double(wind.z);
}

MovingAir air_of(const Air& air, const AirState& state, double time, double seconds, Vec3 origin) {
  MovingAir moving{};
  gpu::Air& made = moving.air;
  made.wind = packed(state.wind);
  made.half_density = static_cast<float>(0.5 * air.density);
  made.drag = static_cast<float>(air.drag);
  made.lift = static_cast<float>(air.lift);
  made.friction = static_cast<float>(air.friction);
  // Along the normal the force is (drag c^2 + (friction + lift) (1 - c^2)) times its part of u.
  made.most = static_cast<float>(std::max(air.drag, air.friction + air.lift));
  for (const Air::Gust& gust : air.gusts) {
    gpu::AirWave& wave = moving.waves[moving.used++];
    wave.velocity = packed(gust.velocity);
    wave.phase = wrapped(kTurn * (time / gust.period + gust.phase / 360));
    wave.turn = static_cast<float>(kTurn * seconds / gust.period);
  }
  for (std::size_t k = 0; k < state.fields.size(); ++k) {
    const Air::Field& field = state.fields[k];
    moving.fields[k] = {packed(field.centre), static_cast<float>(field.radius), packed(0.5f * field.size), static_cast<float>(field.falloff),
                        packed(field.velocity), static_cast<gpu::uint>(field.shape)};
  }
  add_eddies(air, state, time, seconds, origin, moving);
  return moving;
}

std::uint32_t air_every(const Cooked& subject) {
  constexpr double kLongest = 1.0 / 300;   // s
  return static_cast<std::uint32_t>(std::max(1.0, std::floor(kLongest / subject.fabric.h + 1e-6)));
}

namespace effects {
namespace {

constexpr const Buffer* kBuffers[] = {&buffers::air_waves,   &buffers::air_fields,  &buffers::air_rows, &buffers::air_fans,
                                      &buffers::air_stirred, &buffers::wake_bodies, &buffers::wakes};

bool is_stirred(const Needs& needs) {
  using namespace gpu::constant;
  return needs.constants[air_wave_count] + needs.constants[air_field_count] + needs.constants[has_lee] > 0;
}

constexpr Pass kPasses[] = {
    {.name = "air_wake", .stage = Stage::frame_begin, .threads = {[](const Cooked& s) { return buffers::wakes.length(s); }},
     .when = [](const Needs& needs) { return needs.constants[gpu::constant::wake_count] > 0; }, .a_workgroup_each = true},
    {.name = "air_stir", .stage = Stage::frame_begin, .threads = threads::particles, .when = is_stirred},
    {.name = "air", .stage = Stage::force, .threads = threads::particles, .changes = Changes::velocity, .every = air_every},
};

// Rows of one length need no look at where they begin, and their loops are unrolled, which is worth some places that nobody needs.
constexpr double kMostPadding = 0.5;

Result<void> cook(cooking::CookState& state, const cooking::ClothInput& input) {
  if (!state.scene().air) return {};
  const auto particle_of = state.particle_of();
  AirSurface& surface = state.fabric().own.of<AirSurface>();
  surface.corners.resize(state.fabric().positions.size());
  surface.places.resize(surface.corners.size());
  const std::vector<Vec3>& x = input.mesh.points;
  for (const auto& [a, b, c] : input.mesh.triangles) {
    const float third = length(cross(x[b] - x[a], x[c] - x[a])) / 6;
    surface.corners[particle_of[a]].push_back({particle_of[b], particle_of[c], third});
    surface.corners[particle_of[b]].push_back({particle_of[c], particle_of[a], third});
    surface.corners[particle_of[c]].push_back({particle_of[a], particle_of[b], third});
  }
  for (std::size_t p = 0; p < x.size(); ++p) surface.places[particle_of[p]] = x[p];
  return {};
}

// Nobody is in a cloth's own lee: a cloth that is alone with formulas has none.
std::vector<gpu::uvec4> wake_bodies(const Scene& scene, const CookedFabric& fabric) {
  std::vector<gpu::uvec4> bodies;
  const auto cloths = static_cast<std::uint32_t>(fabric.cloths.size()), meshes = static_cast<std::uint32_t>(fabric.collider_meshes.size());
  if (!scene.air->lee || cloths + meshes < 2) return bodies;
  std::uint32_t first = 0;
  for (std::uint32_t c = 0; cloths > 1 && c < cloths; ++c) {
    const std::uint32_t end = fabric.cloths[c].first_particle + fabric.cloths[c].particles;
    std::uint32_t k = first;
    while (k < fabric.cloth_triangles && fabric.triangles[k][0] < end) ++k;
    bodies.push_back({first, k - first, c, 0});
    first = k;
  }
  for (std::uint32_t m = 0; m < meshes; ++m)
    bodies.push_back({fabric.collider_meshes[m].first_triangle, fabric.collider_meshes[m].triangles, cloths + m, 0});
  return bodies;
}

void lay_out(cooking::CookState& state) {
  if (!state.scene().air) return;
  state.fabric().own.of<WakeLists>().bodies = wake_bodies(state.scene(), state.fabric());
  AirSurface surface = std::exchange(state.fabric().own.of<AirSurface>(), {});
  surface.corners.resize(state.fabric().positions.size());
  surface.places.resize(surface.corners.size());
  PairRows& rows = state.fabric().own.of<AirLists>().fans;
  rows = cooking::pack_rows(fans_of(surface), cooking::Padding::owner, kMostPadding);
  for (gpu::uvec2& row : rows.rows) row.y = (row.y + 1) / 2;
}

}  // namespace

constinit const Effect air{
    .name = "air",
    .key = "air",
    .called_for = [](const Scene& scene, const CookedFabric&) { return scene.air.has_value(); },
    .buffers = kBuffers,
    .passes = kPasses,
    .specialize =
        [](const Cooked& s, Constants& constants) {
          const Air& air = *s.scene.air;
          constants[gpu::constant::air_wave_count] =
              static_cast<std::uint32_t>(air.gusts.size()) + (air.turbulence > 0 ? WEFT_AIR_EDDIES : 0);
          constants[gpu::constant::air_field_count] = static_cast<std::uint32_t>(air.fields.size());
          const std::size_t wakes = s.fabric.own.of<WakeLists>().bodies.size();
          constants[gpu::constant::wake_count] = static_cast<std::uint32_t>(wakes);
          constants[gpu::constant::has_lee] = wakes > 0 || (air.lee && std::ranges::any_of(s.scene.colliders, [](const Collider& c) {
            return c.shape == ColliderShape::sphere || c.shape == ColliderShape::capsule || c.shape == ColliderShape::box;
          }));
          constants[gpu::constant::air_every] = air_every(s);
          constants[gpu::constant::air_stride] = s.fabric.own.of<AirLists>().fans.stride;
        },
    .slice = {"air", [](const Cooked& s) { return made(std::vector{air_of(*s.scene.air, {s.scene.air->wind, {}, {}}, 0, 0, {}).air}); }},
    .reference = Reference::absent,
    .cook = cook,
    .lay_out = lay_out,
};

}  // namespace effects
}  // namespace weft
