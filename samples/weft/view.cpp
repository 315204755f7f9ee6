// See samples/weft/view.h.
#include "samples/weft/view.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>

#include "samples/weft/console.h"

namespace weft::command {

Exit view(char** arguments) {
  std::error_code unknown;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", unknown);
  const std::string program = (unknown ? std::filesystem::path("weft_view") : self.parent_path() / "weft_view").string();
  if (unknown) execvp(program.c_str(), arguments);
  else execv(program.c_str(), arguments);
  if (errno == ENOENT)
    return failed(program + ": there is no viewer, for it was built without GLFW and Dear ImGui. On Debian: apt install libglfw3-dev "
                  "libimgui-dev, and build again");
  return failed(program + ": cannot be started: " + std::strerror(errno));
}

}  // namespace weft::command
