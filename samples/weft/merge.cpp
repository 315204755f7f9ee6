// `weft merge`: the parts of a sweep to the table, plot or page that one machine would have written.
#include "samples/weft/merge.h"

#include <algorithm>
#include <cstdio>

#include "engine/scene/faults.h"
#include "samples/weft/console.h"

namespace weft::command {

Exit merge(const MergeOptions& options) {
  const auto all = gather(options.parts);
  if (!all) {
    complain(all.error());
    return kBadInput;
  }
  const Mergeable known[] = {merged_accuracy(),   merged_contacts(), merged_effects(), merged_family(),
                             merged_hard_cases(), merged_harden(),   merged_implicit()};
  const Work& work = all->work;
  const auto made = std::ranges::find(known, work.command, &Mergeable::command);
  if (made == std::end(known)) {
    complain(options.parts.front().string() + ": holds rows of \"" + printable(work.command) + "\", of which weft merge makes nothing");
    return kBadInput;
  }
  listen_for_interrupts();
  std::vector<Input> inputs;
  for (const std::filesystem::path& part : options.parts) inputs.push_back({part, "a part"});
  if (const Exit exit = prepare_outputs(options.out, made->files, inputs); exit != kDone) return exit;
  std::printf("%zu parts, %u rows of %s\n", options.parts.size(), work.items, work.command.c_str());
  return concluded(*all, options.parts.front(), [&](const Rows& rows) { return made->conclude(rows, options.out); });
}

}  // namespace weft::command
