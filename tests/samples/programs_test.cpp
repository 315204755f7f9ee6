// The small programs that show how Weft is embedded, as a user runs them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "engine/export.h"
#include "engine/mesh.h"
#include "engine/image.h"
#include "tests/support/programs.h"

namespace weft {
namespace {

TEST_F(Programs, host_engine_embeds_weft_in_silence_and_leaves_a_picture) {
  ASSERT_EQ(run("host_engine --frames 40 --validation --out " + file("new/picture.png")), 0) << said();
  EXPECT_NE(said().find("Validation had nothing to say"), std::string::npos) << said();
  auto image = read_image(folder / "new/picture.png");
  ASSERT_TRUE(image) << image.error();
  EXPECT_EQ(image->width * 9, image->height * 16);
  // The curtain is the only thing that is red, and it hangs in the middle: back again after it was destroyed.
  std::size_t red = 0;
  for (std::size_t k = 0; k < image->rgba.size(); k += 4) red += image->rgba[k] > 2 * image->rgba[k + 1];
  EXPECT_GT(red, image->rgba.size() / 4 / 20);
  EXPECT_LT(red, image->rgba.size() / 4 / 2);
}

TEST_F(Programs, host_engine_answers_a_wrong_flag_and_a_missing_device_in_a_sentence) {
  EXPECT_EQ(run("host_engine --frames -3"), 2);
  EXPECT_NE(said().find("--frames"), std::string::npos) << said();
  EXPECT_EQ(run("host_engine --device no_such_device"), 1);
  EXPECT_NE(said().find("no_such_device"), std::string::npos) << said();
}

TEST_F(Programs, gltf_cloth_writes_a_mesh_that_loads_again_and_has_moved) {
  const Mesh sheet = make_grid({{1, 1}, 12, 12, Topology::centre, false});
  ASSERT_TRUE(write_glb(folder / "in.glb", sheet.render));
  ASSERT_EQ(run("gltf_cloth " + file("in.glb") + " " + file("out.glb") + " 0.5"), 0) << said();
  auto moved = load_mesh(folder / "out.glb");
  ASSERT_TRUE(moved) << moved.error();
  ASSERT_EQ(moved->render.positions.size(), sheet.render.positions.size());
  EXPECT_EQ(moved->render.triangles, sheet.render.triangles);
  float lowest = 0;
  for (const Vec3& p : moved->render.positions) lowest = std::min(lowest, p.y);
  EXPECT_LT(lowest, -0.2f);   // flat at y = 0, let go for half a second but for its far edge
  for (const Vec3& n : moved->render.normals) EXPECT_NEAR(length(n), 1, 1e-4);
}

TEST_F(Programs, gltf_cloth_answers_wrong_words_and_files_in_a_sentence) {
  EXPECT_EQ(run("gltf_cloth"), 2);
  EXPECT_NE(said().find("usage"), std::string::npos) << said();
  EXPECT_EQ(run("gltf_cloth " + file("missing.glb") + " " + file("out.glb")), 2);
  EXPECT_NE(said().find("missing.glb"), std::string::npos) << said();
  const Mesh sheet = make_grid({{1, 1}, 2, 2, Topology::diagonal, true});
  ASSERT_TRUE(write_glb(folder / "in.glb", sheet.render));
  EXPECT_EQ(run("gltf_cloth " + file("in.glb") + " " + file("out.glb") + " soon"), 2);
  EXPECT_NE(said().find("soon"), std::string::npos) << said();
  EXPECT_EQ(run("gltf_cloth " + file("in.glb") + " " + file("no/folder/out.glb") + " 0"), 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "out.glb"));
}

TEST_F(Programs, the_example_of_the_readme_runs) {
  ASSERT_EQ(run("embedding"), 0) << said();
  EXPECT_NE(said().find("1617 vertices, 2 s simulated"), std::string::npos) << said();
}

}  // namespace
}  // namespace weft
