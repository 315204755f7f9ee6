// The checker of barriers on streams of a few commands: every kind of hazard is found, every kind of synchronisation is accepted.
#include "tests/support/hazards.h"

#include <gtest/gtest.h>

namespace weft::hazards {
namespace {

constexpr Stages kCompute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, kIndirect = VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT,
                 kCopy = VK_PIPELINE_STAGE_2_COPY_BIT, kTransfer = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                 kVertex = VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT, kHost = VK_PIPELINE_STAGE_2_HOST_BIT,
                 kAll = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
constexpr Accesses kRead = VK_ACCESS_2_SHADER_STORAGE_READ_BIT, kWrite = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                   kCopyRead = VK_ACCESS_2_TRANSFER_READ_BIT, kCopyWrite = VK_ACCESS_2_TRANSFER_WRITE_BIT,
                   kArguments = VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT, kVertices = VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT,
                   kHostRead = VK_ACCESS_2_HOST_READ_BIT;

// A stream of buffers `a` and `b`, and `mapped`.
struct Told {
  Stream stream{{{"a"}, {"b"}, {"mapped", true}}, {}};

  Event& add(Event::Kind kind, const char* name) {
    Event& event = stream.events.emplace_back();
    event.kind = kind;
    event.name = name;
    return event;
  }
  Told& touch(Stages stage, Accesses access, std::uint32_t buffer = 0, VkDeviceSize begin = 0, VkDeviceSize end = 64) {
    add(Event::Kind::command, "command").accesses = {{buffer, begin, end, stage, access}};
    return *this;
  }
  Told& barrier(Stages from, Accesses made, Stages to, Accesses shown) {
    add(Event::Kind::barrier, "barrier").barrier = {VK_STRUCTURE_TYPE_MEMORY_BARRIER_2, nullptr, from, made, to, shown};
    return *this;
  }
  Told& semaphore(Event::Kind kind, std::uint64_t value, Stages stages = kAll) {
    Event& event = add(kind, "semaphore");
    event.semaphore = 7;
    event.value = value;
    event.stages = stages;
    return *this;
  }
  Told& signal(std::uint64_t value, Stages stages = kAll) { return semaphore(Event::Kind::signal, value, stages); }
  Told& wait(std::uint64_t value, Stages stages = kAll) { return semaphore(Event::Kind::wait, value, stages); }
  Told& host_wait(std::uint64_t value) { return semaphore(Event::Kind::host_wait, value); }
  // The first words of each hazard.
  std::vector<std::string> found() const {
    std::vector<std::string> kinds;
    for (const std::string& hazard : hazards_of(stream)) kinds.push_back(hazard.substr(0, hazard.find(':')));
    return kinds;
  }
};
using Kinds = std::vector<std::string>;
const Kinds kNone, kReadAfterWrite{"read after write"}, kWriteAfterWrite{"write after write"}, kWriteAfterRead{"write after read"};

TEST(HazardChecker, every_pair_but_two_reads_needs_a_barrier) {
  EXPECT_EQ(Told().touch(kCompute, kWrite).touch(kCompute, kRead).found(), kReadAfterWrite);
  EXPECT_EQ(Told().touch(kCompute, kWrite).touch(kCompute, kWrite).found(), kWriteAfterWrite);
  EXPECT_EQ(Told().touch(kCompute, kRead).touch(kCompute, kWrite).found(), kWriteAfterRead);
  EXPECT_EQ(Told().touch(kCompute, kRead).touch(kCopy, kCopyRead).found(), kNone);
  const auto settled = [](Accesses first, Accesses second) {
    return Told().touch(kCompute, first).barrier(kCompute, kWrite, kCompute, kRead | kWrite).touch(kCompute, second).found();
  };
  EXPECT_EQ(settled(kWrite, kRead), kNone);
  EXPECT_EQ(settled(kWrite, kWrite), kNone);
  EXPECT_EQ(settled(kRead, kWrite), kNone);
}

TEST(HazardChecker, one_command_may_read_what_it_writes) {
  Told told;
  told.add(Event::Kind::command, "both").accesses = {{0, 0, 64, kCompute, kRead}, {0, 0, 64, kCompute, kWrite}};
  EXPECT_EQ(told.found(), kNone);
  EXPECT_EQ(told.touch(kCompute, kWrite).found().size(), 2u);
}

TEST(HazardChecker, bytes_and_buffers_apart_do_not_meet) {
  EXPECT_EQ(Told().touch(kCompute, kWrite, 0).touch(kCompute, kWrite, 1).found(), kNone);
  EXPECT_EQ(Told().touch(kCompute, kWrite, 0, 0, 64).touch(kCompute, kRead, 0, 64, 128).found(), kNone);
  EXPECT_EQ(Told().touch(kCompute, kWrite, 0, 0, 64).touch(kCompute, kRead, 0, 63, 128).found(), kReadAfterWrite);
  // What a later write has covered is no longer told of, what it has left is: the part before it, and the part behind.
  const auto covered = [](VkDeviceSize at) {
    return Told()
        .touch(kCompute, kWrite, 0, 0, 96).barrier(kCompute, kWrite, kCopy, kCopyWrite).touch(kCopy, kCopyWrite, 0, 32, 64)
        .barrier(kCopy, kCopyWrite, kVertex, kVertices).touch(kIndirect, kArguments, 0, at, at + 4).found();
  };
  for (const VkDeviceSize at : {0, 32, 92}) EXPECT_EQ(covered(at), kReadAfterWrite) << at;
}

TEST(HazardChecker, a_write_needs_memory_made_visible_to_the_very_access) {
  const auto after_write = [](Stages from, Accesses made, Stages to, Accesses shown, Stages stage, Accesses access) {
    return Told().touch(kCompute, kWrite).barrier(from, made, to, shown).touch(stage, access).found();
  };
  EXPECT_EQ(after_write(kCompute, 0, kCompute, 0, kCompute, kRead), kReadAfterWrite) << "execution alone";
  EXPECT_EQ(after_write(kCompute, 0, kCompute, 0, kCompute, kWrite), kWriteAfterWrite) << "execution alone";
  EXPECT_EQ(after_write(kCompute, kWrite, kCompute, kRead, kCompute, kWrite), kWriteAfterWrite) << "another access";
  EXPECT_EQ(after_write(kCompute, kCopyWrite, kCompute, kRead, kCompute, kRead), kReadAfterWrite) << "another write";
  EXPECT_EQ(after_write(kTransfer, kWrite, kCompute, kRead, kCompute, kRead), kReadAfterWrite) << "another source";
  EXPECT_EQ(after_write(kCompute, kWrite, kCompute, kRead, kIndirect, kArguments), kReadAfterWrite) << "shaders alone";
  EXPECT_EQ(after_write(kCompute, kWrite, kIndirect, kArguments, kIndirect, kArguments), kNone);
  EXPECT_EQ(after_write(kCompute, kWrite, kIndirect, kArguments | kRead, kCompute, kRead), kReadAfterWrite)
      << "later stages come after it, but their accesses are not in scope";
  EXPECT_EQ(after_write(kAll, VK_ACCESS_2_MEMORY_WRITE_BIT, kAll, VK_ACCESS_2_MEMORY_READ_BIT, kVertex, kVertices), kNone);
  EXPECT_EQ(after_write(kCompute, VK_ACCESS_2_SHADER_WRITE_BIT, kTransfer, kCopyRead, kCopy, kCopyRead), kNone);
  EXPECT_EQ(after_write(kCompute, kWrite, VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT, kVertices, kVertex, kVertices), kNone);
}

TEST(HazardChecker, execution_is_enough_for_a_write_after_a_read) {
  EXPECT_EQ(Told().touch(kVertex, kVertices).barrier(kVertex, 0, kCompute, 0).touch(kCompute, kWrite).found(), kNone);
  EXPECT_EQ(Told().touch(kVertex, kVertices).barrier(kCopy, 0, kCompute, 0).touch(kCompute, kWrite).found(), kWriteAfterRead);
  EXPECT_EQ(Told().touch(kVertex, kVertices).barrier(kVertex, 0, kCopy, 0).touch(kCompute, kWrite).found(), kWriteAfterRead);
  EXPECT_EQ(Told().touch(kIndirect, kArguments).barrier(kCompute, 0, kCompute, 0).touch(kCompute, kWrite).found(), kNone)
      << "a dispatch has read its arguments before it computes";
  EXPECT_EQ(Told().touch(kCompute, kRead).barrier(kIndirect, 0, kCompute, 0).touch(kCompute, kWrite).found(), kWriteAfterRead)
      << "but not computed when it has read them";
}

TEST(HazardChecker, barriers_chain_where_their_stages_meet) {
  EXPECT_EQ(Told().touch(kVertex, kVertices).barrier(kVertex, 0, kCopy, 0).barrier(kCopy, 0, kCompute, 0).touch(kCompute, kWrite).found(),
            kNone);
  EXPECT_EQ(Told().touch(kVertex, kVertices).barrier(kVertex, 0, kCopy, 0).barrier(kVertex, 0, kHost, 0).touch(kCompute, kWrite).found(),
            kWriteAfterRead);
  const auto handed_on = [](Stages stage, Accesses made) {
    return Told().touch(kCompute, kWrite).barrier(kCompute, made, kCopy, kCopyRead).barrier(stage, 0, kVertex, kVertices)
        .touch(kVertex, kVertices).found();
  };
  EXPECT_EQ(handed_on(kCopy, kWrite), kNone) << "what is available stays so";
  EXPECT_EQ(handed_on(kCopy, 0), kReadAfterWrite);
  EXPECT_EQ(handed_on(kHost, kWrite), kReadAfterWrite);
}

TEST(HazardChecker, submissions_are_ordered_by_semaphores_and_by_nothing_else) {
  const auto between = [](std::uint64_t signalled, Stages from, std::uint64_t waited, Stages to) {
    return Told().touch(kCompute, kWrite).signal(signalled, from).wait(waited, to).touch(kVertex, kVertices).found();
  };
  EXPECT_EQ(between(1, kAll, 1, kVertex), kNone);
  EXPECT_EQ(between(1, kAll, 2, kAll), kNone) << "the wait for a later value";
  EXPECT_EQ(between(1, kCompute, 1, kAll), kNone);
  EXPECT_EQ(between(2, kAll, 1, kAll), kReadAfterWrite) << "an earlier value";
  EXPECT_EQ(between(1, kCopy, 1, kAll), kReadAfterWrite) << "a signal that does not wait for it";
  EXPECT_EQ(between(1, kAll, 1, kCompute), kReadAfterWrite) << "a wait of other stages";
  EXPECT_EQ(Told().signal(1).touch(kCompute, kWrite).wait(1).touch(kVertex, kVertices).found(), kReadAfterWrite) << "signalled before";
  EXPECT_EQ(Told().touch(kCompute, kWrite).signal(1).touch(kVertex, kVertices).found(), kReadAfterWrite) << "waited for by nobody";
  EXPECT_EQ(Told().touch(kCompute, kWrite).signal(1).wait(1, kCompute).barrier(kCompute, 0, kVertex, kVertices).touch(kVertex, kVertices)
                .found(), kNone) << "a barrier goes on from a wait";
}

TEST(HazardChecker, a_host_that_waits_is_shown_what_a_barrier_shows_it) {
  const auto copied = [](Stages to, Accesses shown, std::uint32_t buffer) {
    return Told().touch(kCopy, kCopyWrite, buffer).barrier(kTransfer, kCopyWrite, to, shown).signal(1).host_wait(1).found();
  };
  EXPECT_EQ(copied(kHost, kHostRead, 2), kNone);
  EXPECT_EQ(copied(kAll, VK_ACCESS_2_MEMORY_READ_BIT, 2), Kinds{"read of the host after write"}) << "the host is not among all commands";
  EXPECT_EQ(copied(kAll, VK_ACCESS_2_MEMORY_READ_BIT, 0), kNone) << "not mapped";
}

TEST(HazardChecker, what_is_submitted_after_a_wait_of_the_host_comes_after_what_it_waited_for) {
  const auto waited = [](std::uint64_t value) {
    return Told().touch(kCompute, kWrite, 0).signal(1).touch(kCompute, kWrite, 1).signal(2).host_wait(value)
        .touch(kVertex, kVertices, 0).touch(kVertex, kVertices, 1).found();
  };
  EXPECT_EQ(waited(2), kNone);
  EXPECT_EQ(waited(1), kReadAfterWrite);
}

TEST(HazardChecker, a_barrier_is_redundant_where_its_absence_leaves_no_hazard) {
  Told told;
  told.touch(kCompute, kWrite).barrier(kCompute, kWrite, kCompute, kRead).touch(kCompute, kRead)
      .barrier(kCompute, 0, kCompute, 0).touch(kCompute, kRead);
  EXPECT_EQ(redundant_barriers(told.stream), (std::vector<std::size_t>{3}));
  told.touch(kCompute, kWrite, 1).barrier(kCompute, kWrite, kCopy, kCopyRead).barrier(kCompute, kWrite, kCopy, kCopyRead)
      .touch(kCopy, kCopyRead, 1);
  EXPECT_EQ(redundant_barriers(told.stream), (std::vector<std::size_t>{3, 6, 7})) << "each of two, alone";
}

}  // namespace
}  // namespace weft::hazards
