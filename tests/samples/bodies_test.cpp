// The programs that couple cloth with rigid bodies stepped by Bullet.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "tests/support/programs.h"

namespace weft {
namespace {

TEST_F(Programs, hammock_swings_a_ball_which_comes_to_rest_and_weighs_on_it_what_it_weighs) {
  ASSERT_EQ(run("hammock 8"), 0) << said();
  std::istringstream lines(said());
  std::string line;
  double second = 0, height = 0, aside = 0, speed = 0, force = 0, fastest = 0;
  std::getline(lines, line);   // the heading
  while (std::getline(lines, line) && !line.starts_with("the ball weighs")) {
    std::istringstream(line) >> second >> height >> aside >> speed >> force;
    if (second > 1) fastest = std::max(fastest, speed);   // it has fallen in the first
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
  double second = 0, place = 0, speed = 0, degrees = 0, force = 0, up = 0, given = 0, weight = 0;
  std::getline(lines, line);   // the heading
  while (std::getline(lines, line) && !line.starts_with("friction")) {
    std::istringstream(line) >> second >> place >> speed >> degrees >> force >> up;
    if (second == 1) given += speed;   // times 1 kg
    if (second >= 2 && second <= 4) given += force, weight += 9.81 - up;
    if (second == 4) given -= speed;
  }
  EXPECT_EQ(second, 6);
  EXPECT_NEAR(weight, 3 * 9.81, 0.01 * 3 * 9.81) << said();
  EXPECT_NEAR(given, 0.3 * weight, 0.01 * 0.3 * weight) << said();   // to the floor, in three seconds in which it slides
  EXPECT_NEAR(place, 2.1, 0.15) << said();
  EXPECT_LT(speed, 0.01) << said();
  EXPECT_LT(std::abs(degrees), 10) << said();
}

TEST_F(Programs, what_bullet_steps_is_the_same_every_time) {
  for (const char* program : {"hammock 2", "tow 2"}) {
    ASSERT_EQ(run(program), 0) << said();
    const std::string once = said();
    ASSERT_EQ(run(program), 0) << said();
    EXPECT_EQ(said(), once);
  }
}

}  // namespace
}  // namespace weft
