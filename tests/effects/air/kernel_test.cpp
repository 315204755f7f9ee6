// The pass air against its twin; gusts and eddies.
#include <algorithm>
#include <bit>
#include <cmath>

#include <gtest/gtest.h>

#include "engine/effects/air/air.h"
#include "engine/effects/air/fans.h"
#include "shaders/air/air.ref.h"
#include "tests/support/cooked.h"
#include "tests/support/sheets.h"
#include "tests/support/single_pass.h"

namespace weft {
namespace {

using KernelAir = GpuTest;

// A particle's fans as the pass reads them: a triangle for every entry with an area, with the entry before.
std::vector<std::vector<reference::AirCorner>> corners_of(const CookedFabric& fabric) {
  const PairRows& fans = fabric.own.of<AirLists>().fans;
  std::vector<std::vector<reference::AirCorner>> corners(fabric.positions.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto own = static_cast<std::uint32_t>(i);
    const gpu::uvec2 row = fans.stride > 0 ? gpu::uvec2{own * fans.stride, fans.stride} : fans.rows[i];
    std::uint32_t before = own;
    const auto add = [&](std::uint32_t particle, std::uint32_t third) {
      if (third != 0) corners[i].push_back({before, particle, 3 * double(std::bit_cast<float>(third))});
      before = particle;
    };
    for (std::uint32_t k = row.x; k < row.x + row.y; ++k) {
      add(fans.pairs[k].x, fans.pairs[k].y);
      add(fans.pairs[k].z, fans.pairs[k].w);
    }
  }
  return corners;
}

Scene in_air(std::uint32_t cells, Topology topology) {
  Scene scene = sheet(cells);
  scene.cloths[0].grid->topology = topology;
  scene.cloths[0].anchors.push_back(held_at({Corner::low_low}));
  scene.air.emplace();
  scene.air->wind = {4, -1, 2};
  return scene;
}

Air::Field any_field(Random& random, Air::Field::Shape shape, double speed) {
  const gpu::vec4 centre = anywhere(random, 0.5, 0), velocity = anywhere(random, speed, 0);
  Air::Field field;
  field.shape = shape;
  field.centre = {centre.x, centre.y, centre.z};
  field.velocity = {velocity.x, velocity.y, velocity.z};
  field.size = {static_cast<float>(between(random, 0.1, 1)), 0.3f, 0.6f};
  field.radius = between(random, 0.05, 0.5);
  field.falloff = between(random, 0.05, 0.5);
  return field;
}

// From a breath to a storm in which an explicit step would turn the velocity round a hundred times over.
TEST_F(KernelAir, does_what_its_twin_does_on_crumpled_sheets_in_every_wind) {
  Random random(5);
  for (const Topology topology : {Topology::diagonal, Topology::centre})
    for (const bool storage : {false, true})
      for (const double speed : {0.1, 5.0, 1000.0})
        for (const bool stirred : {false, true}) {
          SCOPED_TRACE(std::to_string(speed) + " m/s");
          Scene scene = in_air(7, topology);
          Air& air = *scene.air;
          air.drag = between(random, 0, 2);
          air.lift = between(random, 0, 2);
          air.friction = between(random, 0, 0.5);
          const gpu::vec4 wind = anywhere(random, speed, 0);
          air.wind = {wind.x, wind.y, wind.z};
          if (stirred) {
            air.turbulence = 0.3 * speed;
            air.gusts.push_back({{1, 2, -1}, 0.7, 30});
            for (std::uint32_t k = 0; k < 8; ++k) air.fields.push_back(any_field(random, Air::Field::Shape(k % 4), speed));
          }
          CookedFabric fabric = cooked(scene);
          for (gpu::vec4& x : fabric.positions) {
            const gpu::vec4 d = anywhere(random, 0.05, 0);
            x = {x.x + d.x, x.y + d.y, x.z + d.z, x.w};
          }
          for (gpu::vec4& v : fabric.velocities) v = anywhere(random, 3, v.w);
          for (const std::uint32_t i : {9u, 10u, 17u}) {   // a triangle of no area
            fabric.positions[i] = {0.1f, 0, 0.1f, fabric.positions[i].w};
          }
          SinglePass passes(device(), scene, fabric, storage);
          FrameInput input = frame_of(4);
          input.gravity = scene.gravity;
          input.air = air_of(air, {air.wind, air.fields, {3, 1, 4}}, 2.5, 4 * fabric.h, {1, 0, 0});
          passes.begin(input);
          if (stirred) passes.run("air_stir");
          passes.run("air", 1);   // in every second substep; half of the frame is over
          const auto after = passes.particles(buffers::velocities), predicted = passes.particles(buffers::predicted);
          const auto corners = corners_of(fabric);
          const reference::Points x = points(fabric.positions), v = points(fabric.velocities);
          const reference::Vector gravity(scene.gravity.x, scene.gravity.y, scene.gravity.z);
          for (std::uint32_t i = 0; i < x.size(); ++i) {
            reference::Vector still = reference::Vector::Zero();
            for (const Air::Field& field : air.fields) still += reference::field_at(field, x[i]);
            const reference::Vector stir = still + 0.5 * (reference::stirred_at(*input.air, x[i], 0) + reference::stirred_at(*input.air, x[i], 1));
            const reference::Vector u = vector(input.air->air.wind) + stir - (v[i] - 1.5 * fabric.h * gravity);
            const reference::Vector dv =
                reference::push_by_air(input.air->air, corners[i], x[i], x, u, double(fabric.positions[i].w), 2 * fabric.h);
            const double tolerance = 400 * kRounding * (1 + u.norm() + 10 * (stirred ? 10 * speed : 0));
            EXPECT_LT((vector(after[i]) - v[i] - dv).norm(), tolerance) << i;
            EXPECT_LE(dv.norm(), 1.5 * u.norm()) << i;
            if (fabric.positions[i].w == 0) continue;
            EXPECT_LT((vector(predicted[i]) - x[i] - fabric.h * (v[i] + dv)).norm(), 4 * kRounding + fabric.h * tolerance);
          }
        }
}

TEST_F(KernelAir, a_neighbour_that_is_not_finite_spoils_nobody) {
  const Scene scene = in_air(5, Topology::diagonal);
  CookedFabric fabric = cooked(scene);
  fabric.positions[14].x = std::numeric_limits<float>::quiet_NaN();
  fabric.velocities[21].y = std::numeric_limits<float>::infinity();
  SinglePass passes(device(), scene, fabric);
  FrameInput input = frame_of(1);
  input.air = air_of(*scene.air, {scene.air->wind, {}, {}}, 0, fabric.h, {});
  passes.begin(input);
  passes.run("air");
  const auto after = passes.particles(buffers::velocities);
  for (std::uint32_t i = 0; i < after.size(); ++i)
    if (i != 21) { EXPECT_TRUE(std::isfinite(after[i].x + after[i].y + after[i].z)) << i; }
}

// Pope 2000, 5.1: far from the nozzle a jet keeps its momentum, the integral of the velocity squared over its cross-section.
TEST(AirFields, a_jet_keeps_its_momentum_and_a_vortex_its_circulation) {
  Air::Field jet;
  jet.shape = Air::Field::Shape::jet;
  jet.velocity = {0, 0, 12};
  jet.radius = 0.1;
  const auto momentum = [&](double along) {
    double sum = 0;
    for (double r = 0.0005; r < 4; r += 0.001) sum += 2 * 3.14159265 * r * 0.001 * reference::field_at(jet, {r, 0, along}).squaredNorm();
    return sum;
  };
  for (const double along : {2.0, 4.0, 8.0}) EXPECT_NEAR(momentum(along), momentum(3), 0.01 * momentum(3)) << along;
  EXPECT_NEAR(momentum(3), 144 * 3.14159265 * 0.01, 0.3 * momentum(3)) << "that of the nozzle, about";
  EXPECT_EQ(reference::field_at(jet, {0, 0, -0.01}).norm(), 0);
  EXPECT_NEAR(reference::field_at(jet, {0, 0, 0.5}).norm(), 12, 1e-9);

  Air::Field vortex;
  vortex.shape = Air::Field::Shape::vortex;
  vortex.velocity = {0, 3, 0};
  vortex.radius = 0.4;
  EXPECT_NEAR(reference::field_at(vortex, {0.4, 7, 0}).norm(), 3, 1e-6);
  for (const double r : {0.1, 0.3, 0.39, 0.41, 1.0}) EXPECT_LT(reference::field_at(vortex, {r, 0, 0}).norm(), 3) << r;
  EXPECT_NEAR(10 * reference::field_at(vortex, {10, 0, 0}).norm(), 5 * reference::field_at(vortex, {5, 0, 0}).norm(), 1e-6);
  EXPECT_LT(reference::field_at(vortex, {1, 0, 0}).z(), 0) << "by the right hand about +y";
}

// Behind a sphere, a capsule and a turned box: the twin's sum of what each leaves, and as much momentum lost in every cross-section far behind.
TEST_F(KernelAir, slows_down_in_the_lee_of_bodies_as_its_twin_does) {
  Random random(17);
  Scene scene = in_air(24, Topology::diagonal);
  scene.air->lee = true;
  scene.air->wind = {3, 0.5f, -1};
  scene.colliders.push_back(sphere({-0.6f, 0, 0}, 0.1));
  Collider capsule = sphere({-0.3f, 0.1f, 0.3f}, 0.05);
  capsule.shape = ColliderShape::capsule;
  capsule.length = 0.3;
  Collider box = sphere({-0.8f, 0, -0.2f}, 0.1);
  box.shape = ColliderShape::box;
  box.size = {0.2f, 0.1f, 0.3f};
  scene.colliders.push_back(capsule);
  scene.colliders.push_back(box);
  const CookedFabric fabric = cooked(scene);
  std::vector<gpu::Collider> colliders;
  for (const Collider& c : scene.colliders) {
    gpu::Collider told{};
    told.radius = static_cast<float>(c.radius);
    told.centre_from = {c.centre.x, c.centre.y, c.centre.z};
    told.centre_to = {c.centre.x + 0.2f, c.centre.y, c.centre.z};
    told.rotation_from = {0, 0, 0.6f, 0.8f};
    told.half_size = c.shape == ColliderShape::box ? gpu::vec3{0.1f, 0.05f, 0.15f} : gpu::vec3{0, 0.15f, 0};
    colliders.push_back(told);
  }
  SinglePass passes(device(), scene, fabric);
  FrameInput input = frame_of(4);
  input.air = air_of(*scene.air, {scene.air->wind, {}, {}}, 0, 4 * fabric.h, {});
  input.colliders = colliders;
  passes.begin(input);
  passes.run("air_stir");
  const auto stirred = passes.get<gpu::vec4>(buffers::air_stirred, 2 * fabric.positions.size());
  const reference::Vector wind(3, 0.5, -1), way = wind.normalized();
  // As large as they look along the wind, in the bodies' axes, which are turned about z.
  const double cosine = 0.8 * 0.8 - 0.6 * 0.6, sine = 2 * 0.6 * 0.8;
  const reference::Vector seen(cosine * way.x() + sine * way.y(), -sine * way.x() + cosine * way.y(), way.z());
  const double pi = 3.14159265358979, across = std::hypot(seen.x(), seen.z());
  const double radii[] = {0.1, std::sqrt(0.05 * 0.05 + 2 * 0.05 * 0.3 * across / pi),
                          std::sqrt((std::abs(seen.x()) * 0.1 * 0.3 + std::abs(seen.y()) * 0.2 * 0.3 + std::abs(seen.z()) * 0.2 * 0.1) / pi)};
  double most = 0;
  for (std::size_t i = 0; i < fabric.positions.size(); ++i)
    for (const int end : {0, 1}) {
      double left = 1;
      for (std::size_t k = 0; k < 3; ++k)
        left *= 1 - reference::deficit_at(vector(fabric.positions[i]) - vector(end ? colliders[k].centre_to : colliders[k].centre_from), way, radii[k]);
      EXPECT_LT((vector(stirred[2 * i + static_cast<std::size_t>(end)]) - (left - 1) * wind).norm(), 1e-5) << i;
      most = std::max(most, 1 - left);
    }
  EXPECT_GT(most, 0.9);
  const auto lost = [](double behind) {   // m^2: of the velocity over a cross-section
    double sum = 0;
    for (double r = 0.0005; r < 3; r += 0.001) sum += 2 * 3.14159265 * r * 0.001 * reference::deficit_at({behind, r, 0}, {1, 0, 0}, 0.1);
    return sum;
  };
  for (const double behind : {0.3, 1.0, 5.0}) EXPECT_NEAR(lost(behind), 0.5 * 1.04 * pi * 0.01, 0.02 * pi * 0.01) << "a coefficient of drag of about 1";
}

// A box and a sphere: all of it inside, nothing beyond the falloff, and no step between.
TEST(AirFields, fade_out_without_a_step) {
  for (const auto shape : {Air::Field::Shape::box, Air::Field::Shape::sphere}) {
    Air::Field field;
    field.shape = shape;
    field.velocity = {5, 0, 0};
    field.size = {1, 1, 1};
    field.radius = 0.5;
    field.falloff = 0.25;
    EXPECT_EQ(reference::field_at(field, {0, 0, 0.49}).norm(), 5);
    EXPECT_EQ(reference::field_at(field, {0, 0, 0.76}).norm(), 0);
    double before = 5;
    for (double z = 0.49; z < 0.8; z += 0.01) {
      const double now = reference::field_at(field, {0, 0, z}).norm();
      EXPECT_LE(now, before);
      EXPECT_LT(before - now, 0.35);
      before = now;
    }
  }
}

// Of a sum of plane waves whose velocity is across the way they go; and as strong as it was asked to be.
TEST(Eddies, have_no_divergence_and_the_strength_and_length_that_the_scene_says) {
  Air air;
  air.turbulence = 3;
  air.eddy = 2;
  const MovingAir moving = air_of(air, {{5, 0, 1}, {}, {}}, 7, 0.02, {});
  ASSERT_EQ(moving.used, WEFT_AIR_EDDIES);
  double squares = 0, longest = 0, shortest = 1e9;
  for (const gpu::AirWave& wave : std::span(moving.waves).first(moving.used)) {
    const reference::Vector velocity = vector(wave.velocity), along = vector(wave.wave);
    EXPECT_LT(std::abs(velocity.dot(along)), 1e-5 * velocity.norm() * along.norm());
    squares += velocity.squaredNorm() / 2;
    longest = std::max(longest, 2 * std::numbers::pi / along.norm());
    shortest = std::min(shortest, 2 * std::numbers::pi / along.norm());
  }
  EXPECT_NEAR(std::sqrt(squares), 3, 1e-4);
  EXPECT_NEAR(longest, 2, 1e-4);
  EXPECT_NEAR(shortest, 0.25, 1e-4);
  Random random(8);   // over places and times, too, no component more than another by far
  reference::Vector mean = reference::Vector::Zero(), square = mean;
  constexpr int kPlaces = 4000;
  for (int k = 0; k < kPlaces; ++k) {
    const MovingAir then = air_of(air, {{5, 0, 1}, {}, {between(random, 0, 100), 0, 0}}, between(random, 0, 100), 0.02, {});
    const reference::Vector u = reference::stirred_at(then, vector(anywhere(random, 50, 0)), 0);
    mean += u / kPlaces;
    square += u.cwiseAbs2() / kPlaces;
  }
  EXPECT_LT(mean.norm(), 0.2);
  EXPECT_NEAR(std::sqrt(square.sum()), 3, 0.1);
  EXPECT_GT(square.minCoeff(), 0.15 * square.sum());
}

// Frozen turbulence (Taylor's hypothesis): who goes with the wind sees only what turns over by itself, and frames join without a jump.
TEST(Eddies, go_with_the_wind_and_frames_join) {
  Air air;
  air.turbulence = 0.01;   // so that eddies hardly turn over
  air.wind = {8, 0, 3};
  AirState state{air.wind, {}, {}};
  const double frame = 0.02;
  const MovingAir first = air_of(air, state, 0, frame, {2, 0, 0});
  state.pass(frame);
  const MovingAir second = air_of(air, state, frame, frame, {2, 0, 0});
  for (const double place : {0.0, 1.3, -7.0}) {
    const reference::Vector x(place, 0.5, 0.2), there = reference::stirred_at(first, x, 0);
    EXPECT_LT((reference::stirred_at(second, x + frame * reference::Vector(8, 0, 3), 0) - there).norm(), 0.02 * 0.01);
    EXPECT_LT((reference::stirred_at(second, x, 0) - reference::stirred_at(first, x, 1)).norm(), 1e-4 * 0.01);
  }
}

// A flat square of 1 m, beside it a strip of 0.1 m x 1 m that does not touch it.
AirSurface square_and_strip(std::uint32_t cells) {
  AirSurface surface;
  const float step = 1 / static_cast<float>(cells);
  const auto add_grid = [&](std::uint32_t columns, float left) {
    const auto first = static_cast<std::uint32_t>(surface.places.size()), row = columns + 1;
    for (std::uint32_t k = 0; k < row * (cells + 1); ++k)
      surface.places.push_back({left + step * static_cast<float>(k % row), 0, step * static_cast<float>(k / row)});
    surface.corners.resize(surface.places.size());
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      const float third = step * step / 6;
      surface.corners[a].push_back({b, c, third});
      surface.corners[b].push_back({c, a, third});
      surface.corners[c].push_back({a, b, third});
    };
    for (std::uint32_t y = 0; y < cells; ++y)
      for (std::uint32_t x = 0; x < columns; ++x) {
        const std::uint32_t k = first + y * row + x;
        add(k, k + 1, k + row + 1);
        add(k, k + row + 1, k + row);
      }
  };
  add_grid(cells, 0);
  add_grid(cells / 10, 2);
  return surface;
}

// A quarter of the square root of the area in the mean, whatever the mesh is, and at a border as far as that is away, but a quarter of it at
// least; of each piece by itself, and with the areas that the mesh has.
TEST(AirFans, reach_as_far_on_every_mesh_and_keep_their_areas) {
  for (const std::uint32_t cells : {10u, 30u, 70u}) {
    const AirSurface surface = square_and_strip(cells);
    const auto fans = fans_of(surface);
    const double step = 1.5 / cells;   // and a diagonal
    double area = 0, far = 0, farthest_at_border = 0, farthest_in_strip = 0;
    std::uint32_t ends = 0;
    for (std::size_t i = 0; i < fans.size(); ++i)
      for (const gpu::uvec2& end : fans[i]) {
        area += double(std::bit_cast<float>(end.y));
        const Vec3 from = surface.places[i];
        const double way = double(length(surface.places[end.x] - from));
        const bool is_inside = from.z > 0.35f && from.z < 0.65f;
        if (is_inside && from.x > 0.35f && from.x < 0.65f) far += way, ++ends;
        if (is_inside && from.x == 0) farthest_at_border = std::max(farthest_at_border, way);
        if (from.x > 1.5f) farthest_in_strip = std::max(farthest_in_strip, way);
      }
    EXPECT_NEAR(area, 1.1, 1e-4) << cells;
    EXPECT_NEAR(far / ends, 0.25, 0.02) << cells;
    EXPECT_LT(farthest_at_border, 0.25 * 0.25 + step) << cells;
    EXPECT_GT(farthest_at_border, 0.9 * 0.25 * 0.25) << cells;
    EXPECT_LT(farthest_in_strip, 0.05 + step) << cells;
  }
}

}  // namespace
}  // namespace weft
