// Shifts of links against their twin, over frames in which the links' ends are elsewhere each time.
#include <gtest/gtest.h>

#include <bit>

#include "engine/effects/gauss_seidel/gauss_seidel.h"
#include "engine/effects/shift/shift.h"
#include "engine/effects/strand/strand.h"
#include "engine/effects/stretch/stretch.h"
#include "shaders/shift/shift.ref.h"
#include "tests/support/single_pass.h"

namespace weft {
namespace {

using KernelShift = GpuTest;

constexpr double kRate = 60, kFollows = 2, kForgets = 0.7;   // Hz, 1/s

struct Shifted {
  const Buffer* links;
  const Buffer* shifted;
  const Buffer* shifts;
  std::string_view pass;
  bool in_patches = false;
};

constexpr Shifted kInPatches{&buffers::patch_links, &buffers::patch_shifted, &buffers::patch_shifts, "shift_patches", true};
constexpr Shifted kInStrands{&buffers::strand_links, &buffers::strand_shifted, &buffers::strand_shifts, "shift_strands"};
constexpr Shifted kStretch{&buffers::stretch_links, &buffers::stretch_shifted, &buffers::stretch_shifts, "shift_stretch"};

// Every link's rest length as the solver reads it, its direction of pull, and its other word, which stays.
struct Read {
  float rest;
  bool only_pulls;
  std::uint32_t other, low;
};

Read read(const Shifted& kind, gpu::uvec2 packed) {
  if (kind.in_patches) {
    const gpu::PatchLink link = gpu::unpack_patch_link(packed);
    return {link.rest, link.only_pulls, packed.x, packed.y & 1u};
  }
  const gpu::Link link = gpu::unpack_link(packed.x, packed.y);
  return {link.rest, link.only_pulls, packed.x, packed.y & 0xffu};
}

// q of shift.glsl, as the cooked gain tells.
double gives_way(const gpu::ShiftedLink& link) { return 1 - link.gain / (kFollows / kRate); }

void expect_twin(const compute::Device& device, const Shifted& kind, Method method, double stretch, bool storage) {
  SCOPED_TRACE(std::string(kind.pass) + (storage ? ", storage buffers" : ", texels") + ", " + std::to_string(stretch) + " N/m");
  Scene scene = without_contacts();
  scene.solver = {.rate = kRate, .method = method, .levels = true, .shifts = true};
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{.size = {1, 1}, .cells_x = 20, .cells_y = 13};
  cloth.tethers = false;
  cloth.fabric.stretch = stretch;
  cloth.anchors.emplace_back().corners = {Corner::low_low, Corner::high_high};
  const CookedFabric fabric = must(cook(scene, must(make_meshes(scene))));
  SinglePass passes(device, scene, fabric, storage);
  const std::size_t count = kind.shifted->length(cooked_of(scene, fabric));
  ASSERT_GT(count, 100u);
  const auto words = passes.get<gpu::uvec4>(*kind.shifted, count);
  const auto before = passes.get<gpu::uvec2>(*kind.links, count);
  std::vector<double> twin(count);
  Random random(71);
  std::size_t at_most = 0, links = 0;
  for (int frame = 0; frame < 60; ++frame) {
    auto places = fabric.positions;
    for (gpu::vec4& x : places) {
      const gpu::vec4 d = anywhere(random, frame < 30 ? 0.01 : 0.1, 0);
      x = {1.02f * x.x + d.x, x.y + d.y, x.z + d.z, x.w};
    }
    std::vector<gpu::vec4> velocities;
    for (std::size_t i = 0; i < places.size(); ++i) velocities.push_back(anywhere(random, i % 3 == 0 ? 0.02 : 1, 0));
    passes.put(buffers::positions, places);
    passes.put(buffers::velocities, velocities);
    passes.begin(frame_of(1));
    passes.run(kind.pass);
    const auto shifts = passes.get<std::uint32_t>(*kind.shifts, count);
    const auto after = passes.get<gpu::uvec2>(*kind.links, count);
    for (std::size_t k = 0; k < count; ++k) {
      const gpu::ShiftedLink link = gpu::unpack_shifted_link(words[k]);
      const Read was = read(kind, before[k]), is = read(kind, after[k]);
      ASSERT_EQ(was.other, is.other);
      ASSERT_EQ(was.low, is.low);
      if (link.rest == 0) {
        ASSERT_EQ(is.rest, was.rest);
        continue;
      }
      ASSERT_EQ(link.rest, was.rest);
      const double speed = std::max(vector(velocities[link.a]).norm(), vector(velocities[link.b]).norm());
      const reference::Shift shift{link.rest, gives_way(link), was.only_pulls};
      twin[k] = shift.renewed(twin[k], vector(places[link.a]), vector(places[link.b]), speed, 1 / kRate, kFollows, kForgets);
      // Lengths up to 0.5 m, and parts in units of 1/65535, half of one off, over the last frames that a shift remembers.
      ASSERT_NEAR(std::bit_cast<float>(shifts[k]), twin[k], 30 * (8 * kRounding + 0.5 / 65535) * link.rest) << "frame " << frame;
      ASSERT_NEAR(is.rest, link.rest - std::bit_cast<float>(shifts[k]), 0x1p-18 * link.rest);
      at_most += std::abs(twin[k]) > 0.0999 * link.rest, ++links;
    }
  }
  EXPECT_GT(at_most, links / 30) << "too few links come to the limit";
  EXPECT_LT(at_most, links);
}

TEST_F(KernelShift, shifts_follow_what_is_left_as_their_twin_says) {
  for (const double stretch : {20.0, 1e4, std::numeric_limits<double>::infinity()})
    for (const bool storage : {false, true}) {
      expect_twin(device(), kInPatches, Method::gauss_seidel, stretch, storage);
      expect_twin(device(), kInStrands, Method::strands, stretch, storage);
      expect_twin(device(), kStretch, Method::strands, stretch, storage);
    }
}

TEST_F(KernelShift, what_gives_way_by_itself_is_shifted_the_less) {
  Scene scene = without_contacts();
  scene.solver = {.method = Method::gauss_seidel, .levels = true, .shifts = true};
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{.size = {1, 1}, .cells_x = 20, .cells_y = 20};
  cloth.fabric.stretch = 1e4;
  cloth.fabric.shear = 1;
  const CookedFabric fabric = must(cook(scene, must(make_meshes(scene))));
  double threads = 0, diagonals = 1;
  for (const gpu::uvec4& packed : fabric.own.of<ShiftLists>().patches) {
    const gpu::ShiftedLink link = gpu::unpack_shifted_link(packed);
    double& seen = link.rest < 0.051 ? threads : diagonals;
    seen = link.rest < 0.051 ? std::max(seen, gives_way(link)) : std::min(seen, gives_way(link));
    EXPECT_NEAR(link.kept, 1 - (kForgets + kFollows * gives_way(link)) / kRate, 3e-5);
  }
  EXPECT_LT(threads, 0.05);
  EXPECT_GT(diagonals, 0.5);
}

}  // namespace
}  // namespace weft
