#include "samples/weft/footprint.h"

namespace weft::command {

Footprint footprint_of(const Simulation& simulation) {
  Footprint footprint;
  for (const PassUse& pass : simulation.passes()) {
    ++footprint.passes;
    footprint.dispatches += pass.dispatches_per_frame;
    footprint.instructions += pass.instructions;
  }
  for (const BufferUse& buffer : simulation.buffers()) footprint.bytes += buffer.bytes;
  return footprint;
}

}  // namespace weft::command
