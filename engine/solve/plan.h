// The plan: from what a scene calls for to the passes that run and the buffers that exist.
//
// The plan takes the passes of every effect that the scene calls for, specialises their code (compute/specialize.h) and reflects
// what is left: what the passes touch determines the buffers, the bindings and the barriers. An effect that a scene does not call
// for therefore has no pipeline, no byte and no dispatch. No Vulkan here.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "compute/index_set.h"
#include "compute/reflect.h"
#include "compute/result.h"
#include "compute/specialize.h"
#include "engine/effects/effect.h"

namespace weft {

struct PlannedPass {
  /// What a binding of the shader refers to.
  struct Resource {
    compute::Binding binding;
    enum class Kind { buffer, slice } kind = Kind::buffer;
    std::size_t number = 0;                // of the buffer's row, or into Plan::slices
  };

  const Pass* pass = nullptr;
  bool finalizes = false;                  // ends an iteration, or holds tethers at the end of one
  std::string label;                       // "bend+tether+finalize": all that the dispatch does
  std::vector<std::uint32_t> spirv;        // specialised: no constant is left open
  std::vector<Resource> resources;
  compute::IndexSet reads, writes;         // rows' numbers
};

struct Plan {
  struct PlannedBuffer {
    const Buffer* row = nullptr;
    bool storage = false, texels = false, shared_texels = false;  // how it is bound (SHARE_GATHER: the last)
  };
  std::vector<PlannedPass> passes;
  std::vector<PlannedBuffer> buffers;      // those that passes touch, in the order of their numbers
  std::vector<const Slice*> slices;        // of the uniform buffer, those that passes read

  /// Null where no pass touches it.
  const PlannedBuffer* find(const Buffer& row) const;
  bool has(const Buffer& row) const { return find(row) != nullptr; }
};

/// Errors: a shader that is not there, or that touches what no effect has a row for; never for the effects as they are.
Result<Plan> make_plan(const Needs& setup, compute::Specializer& specializer);

/// Bytes of a buffer; at least one element.
std::uint64_t bytes_of(const Buffer& row, const Cooked& subject);

/// The same with room for what may come: torn cloth has other lists, hardly ever twice as long.
std::uint64_t room_of(const Buffer& row, const Cooked& subject);

/// The dispatches of a pass where it is listed once, each with its part of the threads.
std::vector<Range> ranges_of(const Pass& pass, const Cooked& subject);

}  // namespace weft
