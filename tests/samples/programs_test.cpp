// The small programs that show how Weft is embedded, as a user runs them.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "engine/export.h"
#include "engine/mesh.h"
#include "engine/image.h"

namespace weft {
namespace {

class Programs : public testing::Test {
 protected:
  std::filesystem::path folder = std::filesystem::path(testing::TempDir()) /
                                 ("weft_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));

  void SetUp() override {
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  int run(const std::string& command) const {
    const std::string line = WEFT_BINARIES "/" + command + " >" + file("said") + " 2>&1";
    const int status = std::system(line.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string said() const {
    std::ifstream stream(folder / "said");
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  std::string file(const char* name) const { return std::string("'").append((folder / name).string()).append("'"); }
};

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

TEST_F(Programs, hammock_swings_a_ball_which_comes_to_rest_and_weighs_on_it_what_it_weighs) {
  ASSERT_EQ(run("hammock 8"), 0) << said();
  std::istringstream lines(said());
  std::string line;
  double second = 0, height = 0, aside = 0, speed = 0, force = 0, fastest = 0;
  std::getline(lines, line);   // the heading
  while (std::getline(lines, line) && !line.starts_with("the ball weighs")) {
    std::istringstream(line) >> second >> height >> aside >> speed >> force;
    fastest = std::max(fastest, speed);
  }
  EXPECT_EQ(second, 8);
  EXPECT_GT(fastest, 0.5) << said();
  EXPECT_LT(speed, 0.05) << said();
  EXPECT_NEAR(force, 2 * 9.81, 0.01 * 2 * 9.81) << said();
  EXPECT_GT(height, -0.6) << said();   // corners at 0, 0.3 m closer than the cloth between them is long: it sags by half a metre at most
  EXPECT_LT(height, -0.2) << said();
}

// The bar walks 2 m in 4 s: the box is pulled along against the friction of the floor, and ends where the sheet lets it.
TEST_F(Programs, tow_pulls_a_box_by_a_sheet_against_friction) {
  ASSERT_EQ(run("tow 6"), 0) << said();
  std::istringstream lines(said());
  std::string line;
  double second = 0, place = 0, speed = 0, degrees = 0, force = 0, given = 0;
  std::getline(lines, line);   // the heading
  while (std::getline(lines, line) && !line.starts_with("friction")) {
    std::istringstream(line) >> second >> place >> speed >> degrees >> force;
    if (second == 1) given += speed;   // times 1 kg
    if (second >= 2 && second <= 4) given += force;
    if (second == 4) given -= speed;
  }
  EXPECT_EQ(second, 6);
  EXPECT_NEAR(given, 3 * 0.3 * 9.81, 0.01 * 3 * 0.3 * 9.81) << said();   // to the floor, in three seconds in which it slides
  EXPECT_NEAR(place, 2.1, 0.15) << said();
  EXPECT_LT(speed, 0.01) << said();
  EXPECT_LT(std::abs(degrees), 10) << said();
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
