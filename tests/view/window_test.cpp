// The viewer in a real window, on a screen that nobody sees: driven as a user drives it, and looked at.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "engine/image.h"
#include "engine/scene.h"

namespace weft {
namespace {

using namespace std::chrono_literals;

constexpr int kWidth = 900, kHeight = 600;          // of the viewer's window
constexpr std::array kScreen = {1000, 700};
constexpr int kPanel = 350;                         // its panel's width

class ViewWindow : public testing::Test {
 protected:
  void SetUp() override {
    const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    folder = std::filesystem::path(testing::TempDir()) / ("weft_" + name);
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    start_screen();
  }
  void TearDown() override {
    if (viewer > 0) kill(viewer, SIGKILL);
    if (screen > 0) kill(screen, SIGTERM);   // it puts its lock and its socket away
    for (const pid_t child : {viewer, screen})
      if (child > 0) waitpid(child, nullptr, 0);
    std::filesystem::remove_all(folder);
  }

  // Xvfb tells the number that it has found through a pipe. It stays up when its last client goes.
  void start_screen() {
    std::array<int, 2> pipe_ends{};
    ASSERT_EQ(pipe(pipe_ends.data()), 0);
    screen = fork();
    if (screen == 0) {
      const std::string number = std::to_string(pipe_ends[1]), size = std::to_string(kScreen[0]) + "x" + std::to_string(kScreen[1]) + "x24";
      if (freopen("/dev/null", "w", stderr) == nullptr) _exit(126);
      execlp("Xvfb", "Xvfb", "-displayfd", number.c_str(), "-screen", "0", size.c_str(), "-nolisten", "tcp", "-noreset", nullptr);
      _exit(127);
    }
    close(pipe_ends[1]);
    std::string told;
    for (char c = 0; read(pipe_ends[0], &c, 1) == 1 && c != '\n';) told += c;
    close(pipe_ends[0]);
    ASSERT_FALSE(told.empty()) << "Xvfb did not start; on Debian: apt install xvfb xdotool x11-apps";
    setenv("DISPLAY", (":" + told).c_str(), 1);
  }

  void start(const std::vector<std::string>& arguments) {
    std::vector<std::string> all = {"weft", "view", "--validation", "--width", std::to_string(kWidth), "--height", std::to_string(height)};
    all.insert(all.end(), arguments.begin(), arguments.end());
    viewer = fork();
    if (viewer != 0) return;
    std::vector<char*> given;
    for (std::string& one : all) given.push_back(one.data());
    given.push_back(nullptr);
    const auto into = [&](const char* name, FILE* stream) { return freopen((folder / name).c_str(), "w", stream) != nullptr; };
    if (!into("said", stdout) || !into("complained", stderr)) _exit(126);
    execv(WEFT_BINARIES "/weft", given.data());
    _exit(127);
  }
  int wait_for_end() {
    int status = 0;
    for (int tries = 0; tries < 1200; ++tries, std::this_thread::sleep_for(50ms))
      if (waitpid(viewer, &status, WNOHANG) == viewer) {
        viewer = 0;
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
      }
    return -1;
  }

  std::string text(const char* name) const {
    std::ifstream stream(folder / name);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  std::string said() const { return text("said"); }
  // That it is said once more than before.
  testing::AssertionResult hears(const std::string& what, std::size_t from = 0) {
    for (int tries = 0; tries < 1200; ++tries, std::this_thread::sleep_for(25ms))
      if (said().find(what, from) != std::string::npos) return testing::AssertionSuccess();
    return testing::AssertionFailure() << '"' << what << "\" was not said, but: " << said() << text("complained");
  }
  int do_it(const std::string& what) const { return std::system(("timeout 20 xdotool " + what + " >/dev/null 2>&1").c_str()); }
  int x_client(const std::string& what) const { return std::system((WEFT_BINARIES "/weft_x_client " + what).c_str()); }
  void focus() {
    ASSERT_EQ(do_it("search --sync --onlyvisible --name '^Weft' windowfocus --sync"), 0) << "on Debian: apt install xdotool";
  }

  // The screen as it is.
  Image look() const {
    const std::string file = (folder / "screen.xwd").string();
    EXPECT_EQ(std::system(("xwd -root -silent -out '" + file + "'").c_str()), 0) << "on Debian: apt install x11-apps";
    std::ifstream stream(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    // X11/XWDFile.h: the header is of big-endian words.
    const auto word = [&](std::size_t k) {
      std::uint32_t value = 0;
      for (std::size_t b = 0; b < 4; ++b) value = value << 8 | static_cast<unsigned char>(bytes.at(4 * k + b));
      return value;
    };
    const std::size_t header = word(0) + 12 * word(19), bits = word(11), row = word(12);
    Image image{word(4), word(5), {}};
    for (std::size_t y = 0; y < image.height; ++y)
      for (std::size_t x = 0; x < image.width; ++x) {
        const auto* pixel = reinterpret_cast<const unsigned char*>(bytes.data()) + header + y * row + x * bits / 8;
        image.rgba.insert(image.rgba.end(), {pixel[2], pixel[1], pixel[0], 255});
      }
    return image;
  }
  // Looks until the picture is as `wanted`: however busy the machine is. The last one that it saw.
  template <class Wanted>
  Image sees(const char* what, Wanted wanted) const {
    Image seen;
    for (int tries = 0; tries < 200; ++tries, std::this_thread::sleep_for(100ms))
      if (seen = look(); wanted(seen)) return seen;
    ADD_FAILURE() << "never seen: " << what;
    return seen;
  }
  static std::array<int, 3> pixel(const Image& image, int x, int y) {
    const std::size_t at = 4 * (static_cast<std::size_t>(y) * image.width + static_cast<std::size_t>(x));
    return {image.rgba.at(at), image.rgba.at(at + 1), image.rgba.at(at + 2)};
  }
  // How many pixels right of the panel differ.
  static std::size_t difference(const Image& a, const Image& b) {
    std::size_t differ = 0;
    for (int y = 0; y < kHeight - 60; ++y)   // without the line that says what was done
      for (int x = kPanel; x < kWidth; ++x) differ += pixel(a, x, y) != pixel(b, x, y);
    return differ;
  }
  static std::size_t count(const Image& image, bool (*wanted)(const std::array<int, 3>&), int rows = kHeight) {
    std::size_t found = 0;
    for (int y = 0; y < rows; ++y)
      for (int x = kPanel; x < kWidth; ++x) found += wanted(pixel(image, x, y));
    return found;
  }

  std::filesystem::path folder;
  pid_t screen = 0, viewer = 0;
  int height = kHeight;
};

std::string asset(const char* scene) { return std::string(WEFT_ASSETS "/scenes/") + scene; }

// A red sheet in front of the camera, free of the panel, and held so that it hardly moves.
constexpr const char* kSheet =
    R"({"name":"sheet","contacts":false,"gravity":[0,-1,0],"camera":{"eye":[-0.6,0,3],"target":[-0.6,0,0]},
        "cloths":[{"grid":{"size":[1,1],"cells":[10,10],"upright":true},"anchors":[{"vertices":[0,10]}],
                   "appearance":{"base_colour":[0.7,0.02,0.02]}}]})";

bool is_red(const std::array<int, 3>& p) { return p[0] > 2 * p[1] && p[0] > 60; }
bool is_fault(const std::array<int, 3>& p) { return p[0] > 200 && p[1] < 140 && p[2] < 120 && p[1] > 90; }
bool is_bright(const std::array<int, 3>& p) { return p[0] > 180 && p[1] > 170 && p[2] > 150; }

TEST_F(ViewWindow, plays_and_closes_by_itself_without_a_word_of_validation) {
  start({asset("minimal.json"), "--frames", "20"});
  EXPECT_EQ(wait_for_end(), 0) << said() << text("complained");
  EXPECT_NE(said().find("opened minimal.json"), std::string::npos) << said();
  EXPECT_NE(said().find("20 pictures"), std::string::npos) << said();
  EXPECT_EQ(text("complained"), "");
}

TEST_F(ViewWindow, is_paused_stepped_turned_and_grabbed) {
  std::ofstream(folder / "sheet.json") << kSheet;
  start({(folder / "sheet.json").string(), "--paused"});
  ASSERT_TRUE(hears("opened sheet.json"));
  focus();
  const Image still = sees("the sheet, where it belongs", [](const Image& seen) {
    return count(seen, is_red) > 20000 && is_red(pixel(seen, 600, 300)) && !is_red(pixel(seen, 880, 20));
  });
  const std::size_t red = count(still, is_red);
  do_it("key period");
  ASSERT_TRUE(hears("at frame 1"));
  // Turned by a drag of what is no cloth: seen from the side a sheet is narrow.
  const auto drag = [&](const char* from, const char* by) {
    do_it("mousemove " + std::string(from) + " 30 mousedown 3");
    for (int k = 0; k < 8; ++k) do_it("mousemove_relative -- " + std::string(by) + " 0");
    do_it("mouseup 3");
  };
  drag("740", "-37");   // 296 of 600 pixels: 90 degrees
  sees("the sheet from the side", [&](const Image& seen) { return count(seen, is_red) < red / 4; });
  drag("444", "37");
  sees("the sheet from the front again", [&](const Image& seen) { return count(seen, is_red) > 9 * red / 10; });
  do_it("click 4 click 4");
  sees("the sheet from nearer", [&](const Image& seen) { return count(seen, is_red) > 11 * red / 10; });
  do_it("click 5 click 5");
  const Image before = sees("the sheet from where it was", [&](const Image& seen) { return count(seen, is_red) < 105 * red / 100; });

  do_it("mousemove 600 400 mousedown 1");
  ASSERT_TRUE(hears("grabbed cloth"));
  do_it("mousemove_relative -- 200 50 key space");
  ASSERT_TRUE(hears("plays from frame"));
  const auto reaches = [](const Image& seen) {   // beyond its right rim, which hangs at 753
    std::size_t found = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 775; x < kWidth; ++x) found += is_red(pixel(seen, x, y));
    return found > 100;
  };
  sees("the sheet being pulled", reaches);
  do_it("mouseup 1");
  ASSERT_TRUE(hears("let go"));
  sees("the sheet swinging back", [&](const Image& seen) { return !reaches(seen); });
  do_it("key space");
  ASSERT_TRUE(hears("paused at frame"));
  do_it("key x");
  ASSERT_TRUE(hears("a knife"));
  do_it("mousemove 610 120 mousedown 1 sleep 0.1 mousemove 630 585 sleep 0.1 mouseup 1");
  ASSERT_TRUE(hears("vertices have become two"));
  do_it("key x");
  ASSERT_TRUE(hears("the knife is put away"));
  // A picture that stands still is not drawn again: two looks have the same pixels.
  const auto is_still = [&](const Image& seen) {
    std::this_thread::sleep_for(600ms);
    return look().rgba == seen.rgba;
  };
  sees("a picture that stands still", is_still);
  do_it("key ctrl+q");
  EXPECT_EQ(wait_for_end(), 0) << said() << text("complained");
}

TEST_F(ViewWindow, shows_strain_wires_anchors_bounds_and_the_rendered_picture) {
  std::ofstream(folder / "sheet.json") << kSheet;
  start({(folder / "sheet.json").string(), "--paused"});
  ASSERT_TRUE(hears("opened sheet.json"));
  focus();
  const Image lit = sees("the sheet", [](const Image& seen) { return count(seen, is_red) > 20000; });
  const std::size_t red = count(lit, is_red);
  do_it("key 2");
  sees("a sheet that is not stretched: light grey", [&](const Image& seen) {
    return count(seen, is_red) == 0 && count(seen, is_bright) > 20000;
  });
  do_it("key 1 key w");
  sees("wires, and only on the sheet", [&](const Image& seen) { return difference(lit, seen) > 2000 && difference(lit, seen) < red; });
  do_it("key w key a key b");
  const auto is_orange = [](const std::array<int, 3>& p) { return p[0] > 230 && p[1] > 120 && p[1] < 180 && p[2] < 60; };
  const auto is_green = [](const std::array<int, 3>& p) { return p[1] > 200 && p[0] < 110 && p[2] < 110; };
  sees("two anchors, squares of some pixels, and the box about it", [&](const Image& seen) {
    return count(seen, is_orange) > 20 && count(seen, is_orange) < 400 && count(seen, is_green) > 200;
  });
  do_it("key a key b key 0");
  sees("the rendered picture, with another sky", [&](const Image& seen) {
    return count(seen, is_red) > 15000 && difference(lit, seen) > 50000;
  });
  do_it("key ctrl+q");
  EXPECT_EQ(wait_for_end(), 0) << said() << text("complained");
}

TEST_F(ViewWindow, survives_every_size_and_being_hidden) {
  start({asset("minimal.json")});
  ASSERT_TRUE(hears("opened minimal.json"));
  focus();
  for (const char* size : {"400 300", "64 64", "990 690", "120 650", "900 600"}) {
    do_it("search --name '^Weft' windowsize --sync " + std::string(size));
    std::this_thread::sleep_for(200ms);
  }
  do_it("search --name '^Weft' windowunmap --sync sleep 0.3 windowmap --sync");
  focus();
  const std::size_t heard = said().size();
  do_it("key space");
  EXPECT_TRUE(hears("paused at frame", heard));
  do_it("key ctrl+q");
  EXPECT_EQ(wait_for_end(), 0) << said() << text("complained");
}

TEST_F(ViewWindow, keys_of_the_scene_are_changed_by_clicks_and_letters_and_written_to_a_file) {
  std::ofstream(folder / "sheet.json") << kSheet;
  height = 690;   // all of the panel
  start({(folder / "sheet.json").string(), "--paused"});
  ASSERT_TRUE(hears("opened sheet.json"));
  focus();
  const auto click = [&](const char* at) { do_it("mousemove " + std::string(at) + " sleep 0.3 mousedown 1 sleep 0.1 mouseup 1"); };
  const auto is_blue = [](const std::array<int, 3>& p) { return p[2] > p[0] + 20; };
  sees("a panel that ends with its headings", [&](const Image& seen) {
    return is_blue(pixel(seen, 200, 398)) && !is_blue(pixel(seen, 60, 536));
  });
  click("60 398");   // "Scene"
  sees("the scene's keys", [&](const Image& seen) { return is_blue(pixel(seen, 60, 536)); });
  click("25 667");   // "reactions"
  ASSERT_TRUE(hears("changed; made anew"));

  // A list, which is a line of text: room for it, "cloths", the first, its "anchors", the first, its "vertices".
  for (const char* at : {"60 250", "60 112", "26 333", "47 350", "68 567", "89 584", "150 604"})
    do_it("mousemove " + std::string(at) + " sleep 0.1 mousedown 1 sleep 0.1 mouseup 1 sleep 0.05");
  const auto type = [&](const char* text) {   // in place of what is there; a key that is up again at once is not seen
    do_it("keydown ctrl keydown a sleep 0.1 keyup a keyup ctrl type '" + std::string(text) + "'");
    do_it("keydown Return sleep 0.1 keyup Return");
  };
  type("0, top");
  sees("red letters", [&](const Image& seen) { return count(seen, is_fault, height) >= 200; });
  EXPECT_NE(text("complained").find("cloths[0].anchors[0].vertices: \"top\" is no whole number"), std::string::npos) << text("complained");
  const std::size_t heard = said().size();
  do_it("mousedown 1 sleep 0.1 mouseup 1");
  type("0-4 10");
  ASSERT_TRUE(hears("changed; made anew", heard));
  click("50 204");   // "Save scene"
  ASSERT_TRUE(hears("saved "));
  auto changed = load_scene(folder / "sheet.changed.json");
  ASSERT_TRUE(changed) << changed.error();
  EXPECT_TRUE(changed->reactions);
  EXPECT_EQ(changed->cloths[0].grid->cells_x, 10u);
  EXPECT_EQ(changed->cloths[0].anchors[0].vertices, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 10}));
  do_it("key ctrl+q");
  EXPECT_EQ(wait_for_end(), 0) << said() << text("complained");
}

TEST_F(ViewWindow, shows_the_times_of_passes) {
  start({asset("minimal.json"), "--set", "contacts=false"});
  ASSERT_TRUE(hears("opened minimal.json"));
  focus();
  const auto is_bar = [](const std::array<int, 3>& p) { return p[0] > 200 && p[1] > 150 && p[2] < 60; };
  const auto bars = [&](const Image& seen) {
    std::size_t found = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kPanel; ++x) found += is_bar(pixel(seen, x, y));
    return found;
  };
  sees("the panel, without bars", [&](const Image& seen) { return pixel(seen, 200, 250)[2] > 60 && bars(seen) == 0; });
  do_it("mousemove 25 375 sleep 0.3 mousedown 1 sleep 0.1 mouseup 1");
  sees("bars", [&](const Image& seen) { return bars(seen) > 2000; });
  do_it("key space");
  ASSERT_TRUE(hears("paused at frame"));
  do_it("mousemove 25 375 sleep 0.3 mousedown 1 sleep 0.1 mouseup 1");
  sees("no bars again, though it is paused", [&](const Image& seen) { return bars(seen) == 0; });
  do_it("key ctrl+q");
  EXPECT_EQ(wait_for_end(), 0) << said() << text("complained");
}

TEST_F(ViewWindow, a_broken_scene_is_told_of_in_the_window_which_stays) {
  std::ofstream(folder / "broken.json") << R"({"cloths":[{"grid":{"size":[1,1],"cells":[0,1]}}]})";
  start({(folder / "broken.json").string()});
  sees("red letters", [&](const Image& seen) { return count(seen, is_fault) >= 200; });
  EXPECT_NE(text("complained").find("cells"), std::string::npos) << text("complained");
  focus();
  do_it("key ctrl+q");
  EXPECT_EQ(wait_for_end(), 0) << said() << text("complained");
}

TEST_F(ViewWindow, files_that_are_dropped_are_opened_and_a_broken_one_is_told_of) {
  const auto path = [&](const char* name) { return (folder / name).string(); };
  std::ofstream(folder / "sheet.json") << kSheet;
  std::ofstream(folder / "broken.json") << R"({"cloths":[{"grid":{"size":[1,1],"cells":[0,1]}}]})";
  std::filesystem::copy_file(WEFT_ASSETS "/generated/cape.glb", folder / "a cape.glb");   // its name is to be unescaped
  start({path("sheet.json"), "--paused"});
  ASSERT_TRUE(hears("opened sheet.json"));
  focus();
  sees("the sheet", [](const Image& seen) { return count(seen, is_red) > 20000; });
  ASSERT_EQ(x_client("drop '" + path("broken.json") + "'"), 0);
  sees("red letters, and the sheet", [](const Image& seen) { return count(seen, is_fault) >= 200 && count(seen, is_red) > 20000; });
  EXPECT_NE(text("complained").find("cloths[0].grid.cells[0]"), std::string::npos) << text("complained");
  ASSERT_EQ(x_client("drop '" + path("a cape.glb") + "'"), 0);
  ASSERT_TRUE(hears("opened a cape.glb"));
  sees("no red sheet", [](const Image& seen) { return count(seen, is_red) < 2000; });
  do_it("key ctrl+q");
  EXPECT_EQ(wait_for_end(), 0) << said() << text("complained");
}

TEST_F(ViewWindow, letters_are_twice_as_large_on_a_screen_of_twice_the_density) {
  std::ofstream(folder / "sheet.json") << kSheet;
  ASSERT_EQ(x_client("dpi 192"), 0);
  start({(folder / "sheet.json").string(), "--paused"});
  ASSERT_TRUE(hears("opened sheet.json"));
  // It ends at 696, over most of the sheet, instead of at 348.
  sees("a panel twice as wide", [](const Image& seen) { return is_red(pixel(seen, 720, 300)) && !is_red(pixel(seen, 680, 300)); });
  focus();
  do_it("key ctrl+q");   // by itself: xdotool may fail when the window that it has found goes
  EXPECT_EQ(wait_for_end(), 0) << said() << text("complained");
}

TEST_F(ViewWindow, without_a_screen_a_sentence_says_so) {
  unsetenv("DISPLAY");
  start({asset("minimal.json")});
  EXPECT_EQ(wait_for_end(), 1);
  EXPECT_NE(text("complained").find("no window can be opened"), std::string::npos) << text("complained");
}

}  // namespace
}  // namespace weft
