// See samples/weft/assignments.h.
#include "samples/weft/assignments.h"

namespace weft::command {

void add_set(CLI::App& command, std::vector<std::string>& texts) {
  command.add_option("--set", texts, "Change a value of the scene: --set solver.substeps=20 --set cloths[0].fabric=denim")
      ->type_name("PATH=X")
      ->expected(1)
      ->take_all()
      ->allow_extra_args(false);
}

std::string split(const std::vector<std::string>& texts, std::vector<Assignment>& assignments) {
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) return "--set " + text + ": is not path.to.value=X";
    assignments.push_back({text.substr(0, equals), text.substr(equals + 1)});
  }
  return "";
}

}  // namespace weft::command
