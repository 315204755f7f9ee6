// weft_view: a window on a simulation. `weft view` starts it.
#include <CLI/CLI.hpp>

#include <cstdio>
#include <iostream>

#include "samples/view/viewer.h"
#include "samples/weft/assignments.h"
#include "samples/weft/commands.h"
#include "samples/weft/console.h"

namespace {

using namespace weft;
using namespace weft::command;

Exit obey(int count, char** arguments) {
  CLI::App app("Look at a scene while it is simulated: turn, grab, throw, pin, change its keys, see strain and times", "weft view");
  view::ViewerOptions options;
  view::WindowRequest window;
  std::vector<std::string> sets;
  std::uint32_t frames = 0;
  app.add_option("scene", options.file, "A scene (JSON) or a mesh (glTF, GLB, OBJ, PLY, STL, Collada, FBX)")
      ->required()->type_name("SCENE|MESH");
  add_set(app, sets);
  app.add_flag("--paused", options.is_paused, "Do not play at once");
  app.add_option("--width", window.width, "Of the window")->check(CLI::Range(64, 16384))->capture_default_str();
  app.add_option("--height", window.height, "Of the window")->check(CLI::Range(64, 16384))->capture_default_str();
  CLI::Option* frames_option = app.add_option("--frames", frames, "Close after so many pictures; without it stays open");
  app.add_option("--device", window.device, "Index or part of the name; weft info lists them");
  app.add_flag("--validation", window.validation, "With Khronos validation; what it says is printed, and fails the command");
  try {
    app.parse(count, arguments);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error), kDone;   // --help
    complain("weft view: " + std::string(error.what()) + "; weft view --help tells what there is");
    return kBadInput;
  }
  if (const std::string fault = split(sets, options.assignments); !fault.empty()) {
    complain(fault);
    return kBadInput;
  }
  if (*frames_option) options.frames = frames;
  listen_for_interrupts();
  window.title = "Weft";
  auto opened = view::Window::create(window);
  if (!opened) return failed(opened.error());
  Result<void> done;
  {
    view::Viewer viewer(**opened);
    done = viewer.run(options);
  }
  const std::vector<std::string> heard = (*opened)->device().validation_messages();
  for (const std::string& message : heard) complain(message);
  if (!done) return failed(done.error());
  return heard.empty() ? kDone : kFailed;
}

}  // namespace

int main(int count, char** arguments) { return obey(count, arguments); }
