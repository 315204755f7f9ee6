// Pictures of cloth that has torn: they have its triangles once they are told of them.
#include <gtest/gtest.h>

#include "engine/shading/shading.h"
#include "engine/simulation.h"
#include "tests/support/must.h"
#include "tests/support/on_device.h"

namespace weft {
namespace {

using TornPictures = compute::OnDevice;

std::size_t red_pixels(const Image& image) {
  std::size_t count = 0;
  for (std::size_t at = 0; at < image.rgba.size(); at += 4) count += image.rgba[at] > 2 * image.rgba[at + 1] && image.rgba[at] > 40;
  return count;
}

TEST_F(TornPictures, have_the_gap_once_they_follow) {
  Scene scene;
  scene.contacts.enabled = false;   // so that it is as if nothing held the lower half back
  Cloth& cloth = scene.cloths.emplace_back();
  cloth.grid = Grid{{1, 1}, 12, 12, Topology::diagonal, true};
  cloth.tear = Tear{.strain = 100};
  cloth.anchors.emplace_back().top = 0.001;
  cloth.appearance.base_colour = {0.7f, 0.02f, 0.02f};
  scene.camera.eye = {0, -0.4f, 4};
  scene.camera.target = {0, -0.4f, 0};
  auto simulation = must(Simulation::create(device(), scene));
  auto shading = must(Shading::create(*device_, scene, shaded_cloths(scene, simulation->fabric(), simulation->meshes()), {160, 120}));
  const auto red = [&] {
    return red_pixels(must(shading->draw({.positions = simulation->positions(), .normals = simulation->normals(), .colliders = {}})));
  };
  const std::size_t whole = red();
  ASSERT_GT(whole, 500u);
  ASSERT_GT(must(simulation->cut({0, 0.04f, 3}, {-1, 0, -3}, {1, 0, -3})), 0u);
  for (int frame = 0; frame < 22; ++frame) must(simulation->advance(1.0 / 60));   // the lower half falls 0.66 m
  EXPECT_GT(red(), whole * 3 / 2) << "a triangle spans the gap as long as nobody says that it does not";
  const auto cloths = shaded_cloths(scene, simulation->fabric(), simulation->meshes());
  must(shading->follow(cloths));
  EXPECT_LT(red(), whole * 11 / 10);
  EXPECT_GT(red(), whole * 6 / 10);

  EXPECT_EQ(shading->follow({}).error(), "0 cloths were given for 1");
  RenderMesh other = simulation->meshes()[0].render;
  other.triangles.pop_back();
  const ShadedCloth fewer{&other, &cloth.appearance};
  EXPECT_EQ(shading->follow(std::span(&fewer, 1)).error(), "212 vertices and 287 triangles were given for 212 and 288");
  other.triangles.push_back({0, 1, 1000});
  EXPECT_EQ(shading->follow(std::span(&fewer, 1)).error(), "a triangle of cloth 0 refers to vertex 1000, but there are 212");
}

}  // namespace
}  // namespace weft
