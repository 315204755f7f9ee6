// Maps: what a cloth's figures are multiplied by, vertex by vertex, by attributes of its mesh and by pictures.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <filesystem>
#include <random>
#include <set>

#include "engine/cook/parts.h"
#include "engine/image.h"
#include "tests/support/cooked.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

// A sheet of 2 m by 1 m, with an attribute "_X" of four channels: 0 at its low x and 2, 4, 8 and 16 at its high x.
struct Sheet {
  Scene scene = without_contacts();
  std::vector<Mesh> meshes;
  explicit Sheet(std::uint32_t cells = 8) {
    Cloth& cloth = scene.cloths.emplace_back();
    cloth.grid = Grid{{2, 1}, 2 * cells, cells, Topology::diagonal, true};
    cloth.start.imperfection = 0;
    meshes = must(make_meshes(scene));
    for (const Vec3& x : meshes[0].points) {
      const float u = 0.5f * (x.x + 1);
      meshes[0].attributes["_X"].push_back({2 * u, 4 * u, 8 * u, 16 * u});
    }
  }
  Maps& maps() { return scene.cloths[0].maps; }
  CookedFabric cooked() const { return must(cook(scene, meshes)); }
  std::string fault() const {
    const auto fabric = cook(scene, meshes);
    return fabric ? "no fault" : fabric.error();
  }
};

TEST(Maps, mass_is_that_of_the_triangles_around_a_point_times_the_map_there) {
  Sheet plain, mapped;
  mapped.maps().mass = "_X.g";
  mapped.meshes[0].attributes["_X"][0].y = 0.5f;   // nobody weighs nothing
  for (Vec4& v : mapped.meshes[0].attributes["_X"]) v.y = std::max(v.y, 0.5f);
  const CookedFabric a = plain.cooked(), b = mapped.cooked();
  for (std::size_t i = 0; i < a.positions.size(); ++i) {
    const double u = 0.5 * (double(a.positions[i].x) + 1);
    EXPECT_NEAR(double(a.positions[i].w) / b.positions[i].w, std::max(4 * u, 0.5), 1e-5);
  }
}

TEST(Maps, stiffness_is_that_between_the_ends_of_a_link_and_over_a_fold) {
  for (const BendRest rest : {BendRest::flat, BendRest::mesh}) {
    Sheet plain, mapped;
    for (Sheet* sheet : {&plain, &mapped}) sheet->scene.cloths[0].bend_rest = rest;
    mapped.maps().stretch = "_X";
    mapped.maps().bend = "_X.a";
    const CookedFabric a = plain.cooked(), b = mapped.cooked();
    const auto middle = [&](std::uint32_t i, std::uint32_t j) { return 0.5 * (0.5 * (double(a.positions[i].x) + a.positions[j].x) + 1); };
    ASSERT_EQ(a.links.size(), b.links.size());
    for (std::size_t k = 0; k < a.links.size(); ++k) {
      const double first = 2 * middle(a.links[k].a, a.links[k].a), second = 2 * middle(a.links[k].b, a.links[k].b);
      if (std::min(first, second) < 1e-3) {
        EXPECT_GT(b.links[k].compliance, 1e10) << "it has no stiffness there";
        continue;
      }
      const double wanted = 2 * first * second / (first + second);
      EXPECT_NEAR(a.links[k].compliance / b.links[k].compliance, wanted, 0.01 * wanted);   // compliances have 16 bits
    }
    for (std::size_t e = 0; e < a.bends.size(); ++e) {
      const double u = middle(a.bends[e].particle[0], a.bends[e].particle[1]);
      if (u > 1e-3) { EXPECT_NEAR(a.bends[e].compliance / b.bends[e].compliance, 16 * u, 1e-4); }
      else { EXPECT_GT(b.bends[e].compliance, 1e10f); }
    }
    for (std::size_t e = 0; e < a.hinges.size(); ++e) {
      const double u = middle(a.hinges[e].particle[0], a.hinges[e].particle[1]);
      if (u > 1e-3) { EXPECT_NEAR(a.hinges[e].compliance / b.hinges[e].compliance, 16 * u, 1e-4); }
      else { EXPECT_GT(b.hinges[e].compliance, 1e10f); }
    }
    EXPECT_EQ(a.bends.empty(), rest == BendRest::mesh);
  }
}

TEST(Maps, materials_are_one_of_each_kind_of_point_and_know_their_cloth) {
  Sheet mapped;
  mapped.scene.cloths[0].fabric.friction = 0.25;
  mapped.scene.cloths.push_back(mapped.scene.cloths[0]);   // the second is plain
  mapped.meshes.push_back(mapped.meshes[0]);
  mapped.maps().friction = "_X.r";
  mapped.maps().thickness = "_X.b";
  const CookedFabric fabric = mapped.cooked();
  EXPECT_EQ(fabric.materials.size(), 17u + 1);
  for (std::uint32_t i = 0; i < fabric.positions.size(); ++i) {
    const double u = i < fabric.cloths[1].first_particle ? 0.5 * (double(fabric.positions[i].x) + 1) : 0;
    const gpu::Material& material = fabric.materials[std::bit_cast<std::uint32_t>(fabric.velocities[i].w)];
    const std::uint32_t cloth = i >= fabric.cloths[1].first_particle;
    EXPECT_EQ(body_of(fabric, i), cloth);
    EXPECT_NEAR(material.friction, cloth == 1 ? 0.25 : 0.5 * u, 1e-6);
    EXPECT_NEAR(material.thickness, cloth == 1 ? 0.002 : 0.016 * u, 1e-8);
  }
}

TEST(Maps, a_map_of_ones_cooks_the_same_bits) {
  Sheet plain, ones;
  for (Vec4& v : ones.meshes[0].attributes["_X"]) v = {1, 1, 1, 1};
  ones.maps() = {"_X", "_X.g", "_X.b", "_X.a", "_X"};
  const CookedFabric a = plain.cooked(), b = ones.cooked();
  EXPECT_EQ(a.materials.size(), b.materials.size());
  const auto same = [](const auto& x, const auto& y) {
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof x[0]) == 0;
  };
  EXPECT_TRUE(same(a.positions, b.positions) && same(a.velocities, b.velocities) && same(a.stretch.pairs, b.stretch.pairs));
  EXPECT_TRUE(same(a.bend.pairs, b.bend.pairs) && same(a.materials, b.materials));
}

TEST(Maps, anchors_hold_where_a_map_is_a_half_or_more) {
  Sheet mapped;
  mapped.scene.cloths[0].anchors.emplace_back().map = "_X";
  const CookedFabric fabric = mapped.cooked();
  EXPECT_EQ(fabric.anchors.size(), 9u * 13);   // from u = 1/4 on: 13 of 17 columns
  for (const AnchorTarget& anchor : fabric.anchors) EXPECT_GE(anchor.rest.x, -0.5f);
}

class PaintedMap : public testing::Test {
 protected:
  PaintedMap() { std::filesystem::create_directories(folder_); }
  ~PaintedMap() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  Scene scene(const std::string& map) const {
    Scene scene = without_contacts();
    scene.folder = folder_;
    Cloth& cloth = scene.cloths.emplace_back();
    cloth.grid = Grid{{1, 1}, 8, 8, Topology::diagonal, true};
    cloth.fabric.friction = 1;
    cloth.maps.friction = map;
    return scene;
  }
  std::filesystem::path folder_ = std::filesystem::temp_directory_path() / ("weft_maps_" + std::to_string(std::random_device{}()));
};

// Two pixels: what lies beyond their middles is as they are, what lies between is between; v grows downwards.
TEST_F(PaintedMap, lies_over_the_uvs) {
  ASSERT_TRUE(write_png(folder_ / "two.png", Image{2, 1, {0, 51, 255, 255, 255, 102, 0, 255}}));
  ASSERT_TRUE(write_png(folder_ / "up.png", Image{1, 2, {255, 0, 0, 255, 0, 0, 0, 255}}));
  const auto friction_at = [&](const std::string& map, float x, float y) {
    const CookedFabric fabric = cooked(scene(map));
    for (std::size_t i = 0; i < fabric.positions.size(); ++i)
      if (std::abs(fabric.positions[i].x - x) < 1e-3f && std::abs(fabric.positions[i].y - y) < 1e-3f)
        return double(fabric.materials[std::bit_cast<std::uint32_t>(fabric.velocities[i].w)].friction);
    return double(NAN);
  };
  for (const char* map : {"two.png", "two.png.r"}) {
    EXPECT_EQ(friction_at(map, -0.5f, 0.5f), 0);
    EXPECT_EQ(friction_at(map, -0.25f, 0), 0);
    EXPECT_NEAR(friction_at(map, 0, 0), 0.5, 1e-6);
    EXPECT_NEAR(friction_at(map, 0.125f, 0), 0.75, 1e-6);
    EXPECT_EQ(friction_at(map, 0.5f, -0.5f), 1);
  }
  EXPECT_NEAR(friction_at("two.png.g", -0.5f, 0), 0.2, 1e-6);
  EXPECT_NEAR(friction_at("two.png.g", 0.5f, 0), 0.4, 1e-6);
  EXPECT_EQ(friction_at("two.png.b", 0.5f, 0), 0);
  EXPECT_EQ(friction_at("up.png", 0, 0.5f), 1) << "the picture's top is the sheet's";
  EXPECT_EQ(friction_at("up.png", 0, -0.5f), 0);
}

TEST_F(PaintedMap, is_refused_with_its_key_where_it_cannot_be_read) {
  const auto fault = [&](const std::string& map) {
    const auto meshes = make_meshes(scene(map));
    return meshes ? "no fault" : meshes.error();
  };
  EXPECT_EQ(fault("none.png"), "cloths[0].maps.friction: picture \"" + (folder_ / "none.png").string() + "\" does not exist");
  ASSERT_TRUE(write_png(folder_ / "a.png", Image{1, 1, {0, 0, 0, 0}}));
  EXPECT_EQ(fault("a.png.q"), "cloths[0].maps.friction: \"a.png.q\" ends in a channel that is not r, g, b or a");
}

TEST(Maps, what_is_wrong_is_a_sentence_with_its_key) {
  Sheet mapped;
  mapped.maps().stretch = "COLOR_0.r";
  EXPECT_EQ(mapped.fault(), "cloths[0]: maps.stretch: the mesh has no attribute \"COLOR_0\"; it has _X");
  mapped.maps().stretch = "_X.x";
  EXPECT_EQ(mapped.fault(), "cloths[0]: maps.stretch: \"_X.x\" ends in a channel that is not r, g, b or a");
  mapped.maps() = {};
  mapped.maps().thickness = "_X.a";
  mapped.scene.cloths[0].fabric.thickness = 0.1;
  EXPECT_TRUE(mapped.fault().starts_with("cloths[0]: maps.thickness: at point ")) << mapped.fault();
  EXPECT_TRUE(mapped.fault().ends_with("is more than 1 (m)")) << mapped.fault();
  mapped.scene.cloths[0].fabric.thickness = 0.002;
  mapped.meshes[0].attributes["_X"][3] = {-1, -1, -1, -1};
  EXPECT_EQ(mapped.fault(), "cloths[0]: maps.thickness: \"_X.a\" is -1 at point 3, less than 0");
  mapped.meshes[0].attributes["_X"][3].w = 2e6f;
  EXPECT_EQ(mapped.fault(), "cloths[0]: maps.thickness: \"_X.a\" is 2e+06 at point 3, more than 1000000");
  mapped.meshes[0].attributes["_X"][3] = {};
  mapped.maps() = {};
  mapped.maps().mass = "_X";
  EXPECT_TRUE(mapped.fault().ends_with("has a mass of 0 kg; it must be above 0")) << mapped.fault();
  mapped.maps() = {};
  mapped.maps().bend = "_X";
  mapped.scene.cloths[0].springs.emplace();
  EXPECT_EQ(check(mapped.scene).error(), "cloths[0].maps.bend: is of the fabric's stiffness, and this cloth has springs instead");
}

}  // namespace
}  // namespace weft
