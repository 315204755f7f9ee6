// Snapshots as bytes: what goes in comes out, and nothing else is taken for a snapshot. What they do for a simulation is in
// tests/solve/save_restore_test.cpp.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "compute/digest.h"
#include "engine/effects/effect.h"
#include "engine/snapshot.h"
#include "tests/support/without_contacts.h"

namespace weft {
namespace {

// Every member different from what it is by default.
Snapshot example() {
  Snapshot s;
  s.digest = 0x0123456789abcdef;
  s.substeps = 4711;
  s.left_over = 0.001;
  s.gravity = {1, -2, 3};
  s.haste = 0.25f;
  s.phase = 2;
  s.capacity = 4096;
  s.anchors = {{7, true, {1, 2, 3}}, {9, false, {}}};
  s.colliders = {{true, true, {{1, 2, 3}, {0, 0, 1}, {0, 0, 1, 0}}, {{4, 5, 6}, {1, 0, 0}, {1, 0, 0, 0}}, true,
                  {0.1, 0.2, 0.3, {1, 2, 3}}, {0.4, 0.6, 0.7, {4, 5, 6}}}};
  s.contents = {{"positions", std::vector<std::byte>(48, std::byte{42})}, {"candidates", {}}};
  s.note = {std::byte{'h'}, std::byte{'i'}};
  return s;
}

std::vector<std::byte> sealed(std::vector<std::byte> bytes) {   // with the digest that a damaged file would not have
  Digest digest;
  digest.add(std::span(bytes).first(bytes.size() - 8));
  const std::uint64_t value = digest.value();
  std::memcpy(bytes.data() + bytes.size() - 8, &value, 8);
  return bytes;
}

void expect_refused(std::span<const std::byte> bytes, const std::string& word) {
  const auto parsed = parse_snapshot(bytes);
  ASSERT_FALSE(parsed) << word;
  EXPECT_NE(parsed.error().find(word), std::string::npos) << parsed.error();
}

TEST(Snapshots, what_is_written_is_read_back) {
  const Snapshot s = example();
  const auto bytes = snapshot_bytes(s);
  const auto read = parse_snapshot(bytes);
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(read->digest, s.digest);
  EXPECT_EQ(read->substeps, s.substeps);
  EXPECT_EQ(read->left_over, s.left_over);
  EXPECT_EQ(read->gravity, s.gravity);
  EXPECT_EQ(read->haste, s.haste);
  EXPECT_EQ(read->phase, s.phase);
  EXPECT_EQ(read->capacity, s.capacity);
  EXPECT_EQ(read->anchors.at(0).target, s.anchors[0].target);
  EXPECT_EQ(read->colliders.at(0).pending.rotation, s.colliders[0].pending.rotation);
  EXPECT_TRUE(read->colliders.at(0).is_resized);
  EXPECT_EQ(read->colliders.at(0).size, s.colliders[0].size);
  EXPECT_EQ(read->colliders.at(0).pending_size, s.colliders[0].pending_size);
  EXPECT_EQ(read->contents.at(0).bytes, s.contents[0].bytes);
  EXPECT_EQ(read->note, s.note);
  EXPECT_EQ(snapshot_bytes(*read), bytes) << "and everything else";
}

TEST(Snapshots, a_file_that_is_cut_anywhere_is_refused) {
  const auto bytes = snapshot_bytes(example());
  for (std::size_t size = 0; size < bytes.size(); ++size) expect_refused(std::span(bytes).first(size), size < 1 ? "no snapshot" : "is cut");
}

TEST(Snapshots, any_single_bit_that_flips_is_noticed) {
  auto bytes = snapshot_bytes(example());
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] ^= std::byte(1u << bit % 8);
    EXPECT_FALSE(parse_snapshot(bytes)) << "bit " << bit;
    bytes[bit / 8] ^= std::byte(1u << bit % 8);
  }
  EXPECT_TRUE(parse_snapshot(bytes));
}

TEST(Snapshots, foreign_and_oversized_files_are_refused_with_a_sentence_that_says_so) {
  const std::string scene = R"({"cloths": [{"grid": {}}]})";
  expect_refused(std::as_bytes(std::span(scene)), "does not begin with WEFTSNAP");
  auto bytes = snapshot_bytes(example());
  bytes[8] = std::byte{1};   // an older one
  expect_refused(sealed(bytes), "version 1");
  bytes = snapshot_bytes(example());
  bytes.push_back(std::byte{0});
  expect_refused(bytes, "says that it has");
}

TEST(Snapshots, lengths_that_cannot_be_are_refused_before_anything_is_allocated) {
  const auto good = snapshot_bytes(example());
  // Every offset at which a length could stand, behind the head of 20 bytes: most hold none, and a change is harmless.
  for (std::size_t at = 20; at + 16 <= good.size(); ++at) {
    auto bytes = good;
    std::memset(bytes.data() + at, 0xff, 8);
    (void)parse_snapshot(sealed(std::move(bytes)));
  }
  auto bytes = good;
  std::memset(bytes.data() + 12, 0xff, 8);   // the file's own
  expect_refused(sealed(bytes), "is cut");
}

TEST(Snapshots, a_file_appears_whole_or_not_at_all) {
  const auto folder = std::filesystem::temp_directory_path() / ("weft_snapshot_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const auto file = folder / "now.snapshot";
  const auto saved = save_snapshot(file, example());
  ASSERT_TRUE(saved) << saved.error();
  const auto loaded = load_snapshot(file);
  ASSERT_TRUE(loaded) << loaded.error();
  EXPECT_EQ(snapshot_bytes(*loaded), snapshot_bytes(example()));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);

  EXPECT_FALSE(save_snapshot(folder / "no such folder" / "now.snapshot", example()));
  const auto missing = load_snapshot(folder / "never.snapshot");
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().find("never.snapshot"), std::string::npos) << missing.error();
  std::filesystem::resize_file(file, 30);
  const auto cut = load_snapshot(file);
  ASSERT_FALSE(cut);
  EXPECT_NE(cut.error().find("is cut"), std::string::npos) << cut.error();
  // A file as long as this takes no memory: the head says that it is something else.
  std::ofstream(file, std::ios::binary | std::ios::trunc) << "RIFF";
  std::filesystem::resize_file(file, std::uintmax_t(1) << 40);
  EXPECT_FALSE(load_snapshot(file));
  // One that says so of itself is too long.
  auto bytes = snapshot_bytes(example());
  const std::uint64_t length = std::uint64_t(1) << 40;
  std::memcpy(bytes.data() + 12, &length, sizeof length);
  std::ofstream(file, std::ios::binary | std::ios::trunc)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  std::filesystem::resize_file(file, length);
  const auto endless = load_snapshot(file);
  ASSERT_FALSE(endless);
  EXPECT_NE(endless.error().find("none has more than"), std::string::npos) << endless.error();
  std::filesystem::remove_all(folder);
}

TEST(Snapshots, the_digest_knows_what_a_simulation_depends_on_and_nothing_else) {
  Scene scene = without_contacts();
  scene.cloths.emplace_back().grid = Grid{{1, 1}, 4, 4, Topology::diagonal, true};
  scene.colliders.emplace_back();
  const auto digest = [](const Scene& s) {
    const auto meshes = make_meshes(s);
    EXPECT_TRUE(meshes) << meshes.error();
    const auto fabric = cook(s, *meshes);
    EXPECT_TRUE(fabric) << fabric.error();
    return digest_of(s, *fabric);
  };
  const std::uint64_t before = digest(scene);
  EXPECT_EQ(digest(scene), before);
  Scene looks = scene;
  looks.name = "another";
  looks.frames = 7;
  looks.camera.fov_degrees = 60;
  looks.light.sun = 1;
  looks.cloths[0].appearance.metallic = 1;
  looks.colliders[0].colour = {1, 0, 0};
  EXPECT_EQ(digest(looks), before);
  for (const auto change : {+[](Scene& s) { s.gravity.y = -1; }, +[](Scene& s) { s.solver.substeps = 11; },
                            +[](Scene& s) { s.cloths[0].grid->cells_x = 5; }, +[](Scene& s) { s.cloths[0].fabric.bend = 1; },
                            +[](Scene& s) { s.colliders[0].centre.y = -3; }, +[](Scene& s) { s.cloths[0].transform.degrees = 1; },
                            +[](Scene& s) { s.colliders[0].keys = {{1, {}, {0, 1, 0}, 0}}; }}) {
    Scene other = scene;
    change(other);
    EXPECT_NE(digest(other), before);
  }
}

TEST(Snapshots, the_digest_knows_every_list_that_was_cooked) {
  Scene scene;
  for (Cloth& cloth : scene.cloths = std::vector<Cloth>(2)) {
    cloth.grid = Grid{{1, 1}, 4, 4, Topology::diagonal, true};
    cloth.bending = cloth.tethers = true;
    cloth.anchors.emplace_back().top = 0;
  }
  scene.cloths[1].bend_rest = BendRest::mesh;
  scene.colliders.emplace_back();
  const auto meshes = make_meshes(scene);
  ASSERT_TRUE(meshes) << meshes.error();
  const auto fabric = cook(scene, *meshes);
  ASSERT_TRUE(fabric) << fabric.error();
  const std::uint64_t before = digest_of(scene, *fabric);
  const Cooked subject = cooked_of(scene, *fabric);
  int lists = 0;
  for (const Effect* effect : all_effects()) {
    if (!effect->called_for(scene, *fabric)) continue;
    for (const Buffer* row : effect->buffers) {
      if (row->contents == nullptr || row->contents(subject).lying.empty()) continue;
      auto* last = const_cast<std::byte*>(&row->contents(subject).lying.back());
      *last ^= std::byte{1};
      EXPECT_NE(digest_of(scene, *fabric), before) << row->name;
      *last ^= std::byte{1};
      ++lists;
    }
  }
  EXPECT_GT(lists, 10);
  EXPECT_EQ(digest_of(scene, *fabric), before);
}

}  // namespace
}  // namespace weft
