// A checker for barriers: from which command touches which bytes, in order of submission, to pairs that nothing orders.
//
// Of each range of bytes it keeps the last writes, and the reads since then. What synchronises moves these on: which stages come
// after them, and to which accesses a write has been made visible. A pair is a hazard when the later one's stage does not come after
// an earlier read, or an earlier write is not visible to the later access. Copies and dispatches count as touching all that they may.
//
// Source: the Vulkan specification 1.3, chapter 7:
//   7.1    a write after a read needs an execution dependency; whatever follows a write needs a memory dependency, and that makes
//          all available writes of its first scope visible; dependencies chain where their scopes meet
//   7.1.2  a scope of execution has a source's logically earlier stages too, and a destination's later ones; one of memory has not
//   7.3    a fence and 7.4 a semaphore: a signal comes after everything earlier in submission order, and all memory access of the
//          device; a wait comes before everything later of its stages. Without them submissions to one queue are in no order
//   7.9    a submission comes after all that the host did before it, the wait for a fence included
// A fence or a wait of the host makes nothing visible to the host: that takes a barrier to VK_PIPELINE_STAGE_2_HOST_BIT.
// Limitations: one queue; no images, events or render passes; scopes meet where their stages do; of the host only what it has waited for.
#pragma once

#include <vulkan/vulkan_core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace weft::hazards {

using Stages = VkPipelineStageFlags2;
using Accesses = VkAccessFlags2;

/// One kind of access to a part of a buffer, by one stage.
struct Access {
  std::uint32_t buffer = 0;              // into Stream::buffers
  VkDeviceSize begin = 0, end = 0;       // bytes
  Stages stage = 0;                      // one bit, that of a single stage
  Accesses access = 0;                   // one bit
};

struct Event {
  enum class Kind { command, barrier, signal, wait, host_wait } kind = Kind::command;
  std::string name;                      // of the pass, or of the function
  std::string commands;                  // the command buffer's name
  std::vector<Access> accesses;          // of a command
  VkMemoryBarrier2 barrier{};
  std::uint64_t semaphore = 0;           // or a fence
  std::uint64_t value = 0;
  Stages stages = 0;                     // of the signal or wait
};

struct Stream {
  struct Buffer {
    std::string name;
    bool mapped = false;
  };
  std::vector<Buffer> buffers;
  std::vector<Event> events;             // in the order of submission
};

// All stages that buffers are touched in here. Each comes after those in its row below, logically (7.1.2).
inline constexpr Stages kStages[] = {
    VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT, VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT,    VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT,
    VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_PIPELINE_STAGE_2_COPY_BIT,
    VK_PIPELINE_STAGE_2_CLEAR_BIT,         VK_PIPELINE_STAGE_2_HOST_BIT};
inline constexpr std::size_t kStageCount = std::size(kStages);
inline constexpr Stages kEarlier[kStageCount] = {0, kStages[0], kStages[0] | kStages[1], kStages[0] | kStages[1] | kStages[2],
                                                 kStages[0], 0, 0, 0};

inline constexpr Accesses kWrites =
    VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT | VK_ACCESS_2_HOST_WRITE_BIT;
inline constexpr Accesses kReads =
    VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT | VK_ACCESS_2_INDEX_READ_BIT | VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT |
    VK_ACCESS_2_UNIFORM_READ_BIT | VK_ACCESS_2_SHADER_SAMPLED_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_READ_BIT |
    VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_HOST_READ_BIT;

/// A mask with its groups told one by one: all commands, all transfers, vertex input. The host is in none of them.
inline Stages single(Stages mask) {
  const auto group = [&](Stages name, Stages members) {
    if (mask & name) mask |= members;
  };
  group(VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_2_ALL_GRAPHICS_BIT | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT | kStages[4]);
  group(VK_PIPELINE_STAGE_2_ALL_GRAPHICS_BIT, kStages[0] | VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT | kStages[3]);
  group(VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, kStages[5] | kStages[6]);
  group(VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT, kStages[1] | kStages[2]);
  return mask;
}
inline Accesses single_accesses(Accesses mask) {
  if (mask & VK_ACCESS_2_MEMORY_WRITE_BIT) mask |= kWrites;
  if (mask & VK_ACCESS_2_MEMORY_READ_BIT) mask |= kReads;
  if (mask & VK_ACCESS_2_SHADER_WRITE_BIT) mask |= VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
  if (mask & VK_ACCESS_2_SHADER_READ_BIT) mask |= VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_SAMPLED_READ_BIT;
  return mask;
}
/// What a source's scope of execution has, and what a destination's has.
inline Stages with_earlier(Stages mask) {
  Stages all = mask = single(mask);
  for (std::size_t k = 0; k < kStageCount; ++k)
    if (mask & kStages[k]) all |= kEarlier[k];
  return all;
}
inline Stages with_later(Stages mask) {
  Stages all = mask = single(mask);
  for (std::size_t k = 0; k < kStageCount; ++k)
    if (mask & kEarlier[k]) all |= kStages[k];
  return all;
}

class Checker {
 public:
  explicit Checker(const Stream& stream) : stream_(&stream) {}

  /// Takes the stream's event in, and adds what it finds.
  void take(std::size_t event);
  /// "read after write: bend reads [0, 96) of positions (compute) that predict has written; event 17 of weft frame"
  const std::vector<std::string>& found() const { return found_; }

 private:
  // An access, and what has come after it since.
  struct Past {
    Access access;
    std::size_t event = 0;
    Stages after = 0;                              // stages that come after it, in a chain or directly
    bool available = false;                        // a write: to the device
    std::array<Accesses, kStageCount> visible{};   // by stage
    std::vector<std::pair<std::uint64_t, std::uint64_t>> signalled;   // the first value of each semaphore that tells of it

    bool writes() const { return (access.access & kWrites) != 0; }
    bool tells_of(std::uint64_t semaphore, std::uint64_t value) const {
      return std::ranges::any_of(signalled, [&](const auto& one) { return one.first == semaphore && one.second <= value; });
    }
    void show(Stages stages, Accesses accesses) {
      available = true;
      for (std::size_t k = 0; k < kStageCount; ++k)
        if (stages & kStages[k]) visible[k] |= accesses;
    }
    bool is_visible(Stages stage, Accesses accesses) const {
      for (std::size_t k = 0; k < kStageCount; ++k)
        if (stage == kStages[k]) return (visible[k] & accesses) == accesses;
      return false;
    }
  };

  void order(const VkMemoryBarrier2& barrier);
  void host_waits(const Event& event, std::size_t at);
  void check(const Access& access, std::size_t at);
  void remember(const Access& access, std::size_t at);
  void tell(const char* kind, const Access& access, const Past& past, std::size_t at);
  template <class Body>
  void for_each(Body body) {
    for (auto& [buffer, pasts] : pasts_)
      for (Past& past : pasts) body(past);
  }

  const Stream* stream_;
  std::map<std::uint32_t, std::vector<Past>> pasts_;   // by buffer
  std::vector<std::string> found_;
};

inline void Checker::take(std::size_t at) {
  const Event& event = stream_->events[at];
  switch (event.kind) {
    case Event::Kind::command:   // all of its accesses are one command's: they are not checked against each other
      for (const Access& access : event.accesses) check(access, at);
      for (const Access& access : event.accesses) remember(access, at);
      break;
    case Event::Kind::barrier: order(event.barrier); break;
    case Event::Kind::signal:
      for_each([&](Past& past) {
        if ((past.access.stage | past.after) & with_earlier(event.stages)) past.signalled.push_back({event.semaphore, event.value});
      });
      break;
    case Event::Kind::wait:
      for_each([&](Past& past) {
        if (!past.tells_of(event.semaphore, event.value)) return;
        past.after |= with_later(event.stages);
        past.show(single(event.stages), kReads | kWrites);
      });
      break;
    case Event::Kind::host_wait: host_waits(event, at); break;
  }
}

inline void Checker::order(const VkMemoryBarrier2& barrier) {
  const Stages from = single(barrier.srcStageMask), source = with_earlier(from);
  const Accesses made_available = single_accesses(barrier.srcAccessMask), shown = single_accesses(barrier.dstAccessMask);
  for_each([&](Past& past) {
    if (((past.access.stage | past.after) & source) == 0) return;
    const bool in_scope = (past.access.stage & from) != 0 && (past.access.access & made_available) != 0;
    if (past.writes() && (past.available || in_scope)) past.show(single(barrier.dstStageMask), shown);
    past.after |= with_later(barrier.dstStageMask);
  });
}

// The host is taken to read then all memory that it has mapped. What is submitted after that comes after all that it has waited for.
inline void Checker::host_waits(const Event& event, std::size_t at) {
  for (auto& [buffer, pasts] : pasts_) {
    std::erase_if(pasts, [&, buffer = buffer](const Past& past) {
      if (!past.tells_of(event.semaphore, event.value)) return false;
      const Access read{buffer, past.access.begin, past.access.end, VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT};
      if (stream_->buffers[buffer].mapped && past.writes() && !past.is_visible(read.stage, read.access))
        tell("read of the host after write", read, past, at);
      return true;
    });
  }
}

inline void Checker::check(const Access& access, std::size_t at) {
  const bool writes = (access.access & kWrites) != 0;
  for (const Past& past : pasts_[access.buffer]) {
    if (past.access.end <= access.begin || access.end <= past.access.begin) continue;
    if (past.writes()) {
      if (!past.is_visible(access.stage, access.access)) tell(writes ? "write after write" : "read after write", access, past, at);
    } else if (writes && (past.after & access.stage) == 0) {
      tell("write after read", access, past, at);
    }
  }
}

// A write leaves nothing of what it covers: what is ordered after it is ordered after that. So it is with two reads of one kind.
inline void Checker::remember(const Access& access, std::size_t at) {
  std::vector<Past>& pasts = pasts_[access.buffer];
  const bool writes = (access.access & kWrites) != 0;
  std::vector<Past> kept;
  for (Past& past : pasts) {
    const bool replaced = past.event != at && (writes || (past.access.stage == access.stage && past.access.access == access.access));
    if (!replaced || past.access.end <= access.begin || access.end <= past.access.begin) {
      kept.push_back(std::move(past));
      continue;
    }
    for (const auto& [begin, end] : {std::pair(past.access.begin, access.begin), std::pair(access.end, past.access.end)}) {
      if (begin >= end) continue;
      kept.push_back(past);
      kept.back().access.begin = begin;
      kept.back().access.end = end;
    }
  }
  Past& now = kept.emplace_back();
  now.access = access;
  now.event = at;
  pasts = std::move(kept);
}

inline void Checker::tell(const char* kind, const Access& access, const Past& past, std::size_t at) {
  const Event &now = stream_->events[at], &then = stream_->events[past.event];
  found_.push_back(std::string(kind) + ": " + now.name + " touches [" + std::to_string(access.begin) + ", " + std::to_string(access.end) +
                   ") of " + stream_->buffers[access.buffer].name + " after " + then.name + "; events " + std::to_string(at) + " of " +
                   now.commands + " and " + std::to_string(past.event) + " of " + then.commands);
}

/// What is wrong with the stream; empty when nothing is.
inline std::vector<std::string> hazards_of(const Stream& stream) {
  Checker checker(stream);
  for (std::size_t k = 0; k < stream.events.size(); ++k) checker.take(k);
  return checker.found();
}

/// Those of its barriers that can each be left out alone and leave no hazard. The stream as it is must have none.
inline std::vector<std::size_t> redundant_barriers(const Stream& stream) {
  std::vector<std::size_t> redundant;
  Checker before(stream);
  for (std::size_t k = 0; k < stream.events.size(); ++k) {
    if (stream.events[k].kind == Event::Kind::barrier) {
      Checker without = before;
      for (std::size_t next = k + 1; next < stream.events.size() && without.found().empty(); ++next) without.take(next);
      if (without.found().empty()) redundant.push_back(k);
    }
    before.take(k);
  }
  return redundant;
}

}  // namespace weft::hazards
