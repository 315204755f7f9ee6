// Caches from code: every format read back by an independent reader, gone on with after a stop, and refused where it cannot hold what it
// is asked to.
#include "engine/cache.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>
#include <csignal>
#include <random>

#include "engine/export.h"
#include "tests/support/caches.h"
#include "tests/support/mesh_files.h"
#include "tests/support/must.h"

namespace weft {
namespace {

using test::Folder;
using test::ReadCache;
using test::same_bits;
using test::slurp;

constexpr std::uint32_t kFrames = 5;
constexpr const char* kFormats[] = {"pc2", "mdd", "glb", "usda", "ply", "obj"};

constexpr std::uint32_t kFew = 3, kMany = 50;   // cells across: of many a frame's text is written in pieces

/// Frames of random positions, some of them numbers with long texts: tiny, huge, -0.
struct Motion {
  RenderMesh mesh;
  std::vector<std::vector<Vec3>> positions, normals;
  std::vector<float> strain;

  explicit Motion(std::uint32_t seed = 1, std::uint32_t cells = kFew)
      : mesh(make_grid(Grid{.size = {1, 2}, .cells_x = cells, .cells_y = cells - 1}).render), strain(mesh.positions.size(), 0.25f) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> any(-2, 2);
    for (std::uint32_t k = 0; k < kFrames; ++k) {
      std::vector<Vec3>&p = positions.emplace_back(), &n = normals.emplace_back();
      for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        p.push_back({any(random), any(random), any(random)});
        n.push_back({any(random), any(random), any(random)});
      }
      p[k] = {-1.17549435e-38f, -123456792.f, -0.f};
    }
  }
  CacheFrame frame(std::uint32_t k, bool with_strain = false) const {
    return {positions[k], normals[k], with_strain ? std::span<const float>(strain) : std::span<const float>()};
  }
  std::vector<std::uint32_t> corners() const {
    std::vector<std::uint32_t> list;
    for (const Triangle& t : mesh.triangles) list.insert(list.end(), t.begin(), t.end());
    return list;
  }
};

const CacheOptions kWanted{.frames = kFrames, .rate = 24, .name = "a sheet", .resumable = true};

std::unique_ptr<CacheWriter> begun(const std::filesystem::path& file, const Motion& motion, std::uint32_t frames) {
  auto cache = must(CacheWriter::create(file, motion.mesh, kWanted));
  for (std::uint32_t k = 0; k < frames; ++k) must(cache->add(motion.frame(k)));
  return cache;
}

/// A file, or the files of a sequence one after another.
std::string all_bytes(const Folder& folder, const std::string& name) {
  const std::filesystem::path file = folder / name;
  if (!is_sequence(must(cache_format(file)))) return slurp(file);
  std::string bytes;
  for (std::uint32_t k = 1; k <= kFrames; ++k) bytes += slurp(sequence_file(file, k, kFrames));
  return bytes;
}

std::ptrdiff_t entries_of(const Folder& folder) { return std::distance(std::filesystem::directory_iterator(folder / ""), {}); }

ReadCache read_sequence(const Folder& folder, const char* name, void (*add)(ReadCache&, const std::string&)) {
  ReadCache cache;
  for (std::uint32_t k = 1; k <= kFrames; ++k) add(cache, slurp(sequence_file(folder / name, k, kFrames)));
  return cache;
}

class CacheOf : public testing::TestWithParam<std::uint32_t> {};
INSTANTIATE_TEST_SUITE_P(Cells, CacheOf, testing::Values(kFew, kMany));

TEST_P(CacheOf, every_format_holds_every_frame_to_the_last_bit) {
  const Folder folder;
  const Motion motion(1, GetParam());
  for (const char* format : kFormats) must(begun(folder / (std::string("a.") + format), motion, kFrames)->finish());
  const ReadCache pc2 = test::read_pc2(slurp(folder / "a.pc2")), mdd = test::read_mdd(slurp(folder / "a.mdd")),
                  usda = test::read_usda(slurp(folder / "a.usda")), ply = read_sequence(folder, "a.ply", test::add_ply),
                  obj = read_sequence(folder, "a.obj", test::add_obj);
  for (const ReadCache* read : {&pc2, &mdd, &usda, &ply, &obj}) {
    ASSERT_EQ(read->frames.size(), kFrames);
    for (std::uint32_t k = 0; k < kFrames; ++k) EXPECT_TRUE(same_bits(read->frames[k], motion.positions[k])) << k;
  }
  for (const ReadCache* read : {&usda, &ply, &obj})
    for (std::uint32_t k = 0; k < kFrames; ++k) EXPECT_TRUE(same_bits(read->normals.at(k), motion.normals[k])) << k;
  EXPECT_EQ(pc2.times, (std::vector<float>{1, 2, 3, 4, 5}));
  EXPECT_EQ(mdd.times, (std::vector<float>{1 / 24.f, 2 / 24.f, 3 / 24.f, 4 / 24.f, 5 / 24.f}));
  EXPECT_EQ(usda.times, (std::vector<float>{1, 2, 3, 4, 5}));
  EXPECT_EQ(usda.rate, 24);
  EXPECT_EQ(usda.corners, motion.corners());
  EXPECT_TRUE(same_bits(usda.rest, motion.mesh.positions));
  EXPECT_EQ(obj.corners, motion.corners());
  for (std::size_t v = 0; v < usda.uvs.size(); ++v) EXPECT_EQ(usda.uvs[v], (Vec2{motion.mesh.uvs[v].x, 1 - motion.mesh.uvs[v].y}));
  const std::string text = slurp(folder / "a.usda");
  if (GetParam() != kFew) return;
  for (const char* part : {"defaultPrim = \"a_sheet\"", "def Mesh \"a_sheet\"", "startTimeCode = 1", "endTimeCode = 5", "metersPerUnit = 1",
                           "upAxis = \"Y\"", "subdivisionScheme = \"none\"", "int[] faceVertexCounts = [3,3,3,3,3,3,3,3,3,3,3,3]"})
    EXPECT_NE(text.find(part), std::string::npos) << part;
}

// Differences from rest are added by whoever shows it: where they are the positions, nothing is rounded.
TEST(Cache, a_glb_holds_every_frame_and_its_accessors_are_sound) {
  const Folder folder;
  Motion motion;
  must(begun(folder / "a.glb", motion, kFrames)->finish());
  const ReadCache read = test::read_glb(slurp(folder / "a.glb"));
  EXPECT_TRUE(same_bits(read.rest, motion.mesh.positions));
  EXPECT_EQ(read.corners, motion.corners());
  EXPECT_EQ(read.uvs, motion.mesh.uvs);
  EXPECT_EQ(read.times, (std::vector<float>{1 / 24.f, 2 / 24.f, 3 / 24.f, 4 / 24.f, 5 / 24.f}));
  ASSERT_EQ(read.frames.size(), kFrames);
  for (std::uint32_t k = 0; k < kFrames; ++k)
    for (std::size_t v = 0; v < read.rest.size(); ++v) {
      const Vec3 p = motion.positions[k][v], rest = read.rest[v], off = read.frames[k][v] - p;
      // Of the difference and of the sum half a unit of the last place each.
      const float largest = std::max({length(p), length(rest), 1e-30f});
      EXPECT_LE(length(off), largest * 0x1p-23f) << k << ' ' << v;
      EXPECT_LE(length(read.normals[k][v] - motion.normals[k][v]), 4 * 0x1p-23f);
    }
  for (Vec3& p : motion.mesh.positions) p = {};
  motion.mesh.normals.clear();
  motion.mesh.uvs.clear();
  must(begun(folder / "b.glb", motion, kFrames)->finish());
  const ReadCache exact = test::read_glb(slurp(folder / "b.glb"));
  for (std::uint32_t k = 0; k < kFrames; ++k) EXPECT_EQ(exact.frames.at(k), motion.positions[k]) << k;
  EXPECT_TRUE(exact.normals.empty());
}

TEST(Cache, assimp_reads_a_glb_as_the_same_animation) {
  const Folder folder;
  const Motion motion;
  must(begun(folder / "a.glb", motion, kFrames)->finish());
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile((folder / "a.glb").string(), aiProcess_ValidateDataStructure);
  ASSERT_NE(scene, nullptr) << importer.GetErrorString();
  ASSERT_EQ(scene->mNumMeshes, 1u);
  const aiMesh& mesh = *scene->mMeshes[0];
  ASSERT_EQ(mesh.mNumAnimMeshes, kFrames);
  ASSERT_EQ(mesh.mNumVertices, motion.mesh.positions.size());
  for (std::uint32_t k = 0; k < kFrames; ++k)
    for (std::uint32_t v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D at = mesh.mAnimMeshes[k]->mVertices[v];
      const Vec3 p = motion.positions[k][v];
      EXPECT_LE(length(Vec3{at.x, at.y, at.z} - p), std::max(length(p), 2.f) * 0x1p-23f) << k << ' ' << v;
    }
  ASSERT_EQ(scene->mNumAnimations, 1u);
  ASSERT_EQ(scene->mAnimations[0]->mNumMorphMeshChannels, 1u);
  const aiMeshMorphAnim& channel = *scene->mAnimations[0]->mMorphMeshChannels[0];
  ASSERT_EQ(channel.mNumKeys, kFrames + 1);
  for (std::uint32_t key = 0; key <= kFrames; ++key) {
    EXPECT_NEAR(channel.mKeys[key].mTime, 1000.0 * key / 24, 1e-3);   // ms
    for (std::uint32_t k = 0; k < kFrames; ++k) EXPECT_EQ(channel.mKeys[key].mWeights[k], key == k + 1 ? 1 : 0);
  }
}

TEST(Cache, a_file_of_a_sequence_is_what_write_ply_writes) {
  const Folder folder;
  const Motion motion;
  auto cache = must(CacheWriter::create(folder / "a.ply", motion.mesh, kWanted));
  must(cache->add(motion.frame(0, true)));
  must(write_ply(folder / "by_itself.ply", motion.positions[0], motion.normals[0], motion.strain, motion.mesh.triangles));
  EXPECT_EQ(slurp(folder / "a_0001.ply"), slurp(folder / "by_itself.ply"));
  EXPECT_EQ(sequence_file("x/a.b.ply", 7, 10'000), std::filesystem::path("x/a.b_00007.ply"));
}

TEST(Cache, one_that_is_gone_on_with_is_the_same_bit_by_bit) {
  const Motion motion;
  for (const char* format : kFormats) {
    const Folder folder;
    const std::string name = std::string("stopped.") + format, whole = std::string("whole.") + format;
    must(begun(folder / whole, motion, kFrames)->finish());
    begun(folder / name, motion, 4).reset();   // it did one frame more than it is gone on from
    EXPECT_FALSE(std::filesystem::exists(folder / name));
    const auto left = must(CacheWriter::resume(folder / name, motion.mesh, kWanted, 3, motion.frame(2)));
    EXPECT_EQ(left->frames(), 3u);
    for (std::uint32_t k = 3; k < kFrames; ++k) must(left->add(motion.frame(k)));
    must(left->finish());
    EXPECT_EQ(all_bytes(folder, name), all_bytes(folder, whole)) << format;
    // A program may be killed after the file has its name and before anybody knows.
    const auto again = must(CacheWriter::resume(folder / name, motion.mesh, kWanted, 4, motion.frame(3)));
    EXPECT_EQ(std::filesystem::exists(folder / name), false) << format;
    must(again->add(motion.frame(4)));
    must(again->finish());
    EXPECT_EQ(all_bytes(folder, name), all_bytes(folder, whole)) << format;
    EXPECT_EQ(entries_of(folder), is_sequence(must(cache_format(name))) ? 2 * kFrames : 2) << format;
  }
}

TEST(Cache, what_another_run_has_left_is_not_gone_on_with) {
  const Motion motion, other(2);
  for (const char* format : kFormats) {
    const Folder folder;
    const std::filesystem::path file = folder / (std::string("a.") + format);
    const auto nothing = CacheWriter::resume(file, motion.mesh, kWanted, 2, motion.frame(1));
    ASSERT_FALSE(nothing) << format;
    EXPECT_NE(nothing.error().find(" is not there"), std::string::npos) << nothing.error();
    begun(file, motion, 3).reset();
    const auto refused = CacheWriter::resume(file, other.mesh, kWanted, 3, other.frame(2));
    ASSERT_FALSE(refused) << format;
    EXPECT_NE(refused.error().find(" is not of this run: it does not hold its frame 3"), std::string::npos) << refused.error();
    EXPECT_TRUE(CacheWriter::resume(file, motion.mesh, kWanted, 3, motion.frame(2))) << "and it is untouched";
  }
}

TEST(Cache, there_is_a_whole_file_or_none) {
  const Folder folder;
  const Motion motion;
  for (const char* format : {"pc2", "mdd", "glb", "usda"}) {
    folder.write("old", "old");
    std::filesystem::rename(folder / "old", folder / (std::string("a.") + format));
    CacheOptions options = kWanted;
    options.resumable = false;
    auto cache = must(CacheWriter::create(folder / (std::string("a.") + format), motion.mesh, options));
    must(cache->add(motion.frame(0)));
    const Result<void> early = cache->finish();
    ASSERT_FALSE(early);
    EXPECT_EQ(early.error(), (folder / (std::string("a.") + format)).string() + " has 1 of its 5 frames");
    EXPECT_EQ(entries_of(folder), 2);
    cache.reset();
    EXPECT_EQ(slurp(folder / (std::string("a.") + format)), "old");
    EXPECT_EQ(entries_of(folder), 1);
    std::filesystem::remove(folder / (std::string("a.") + format));
  }
}

TEST(Cache, a_full_disk_is_a_sentence_and_leaves_no_half_file) {
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const Motion motion;
  for (const char* format : kFormats) {
    const Folder folder;
    const std::filesystem::path file = folder / (std::string("a.") + format);
    CacheOptions options = kWanted;
    options.resumable = false;
    options.frames = 100;
    const rlim_t room = std::string(format) == "glb" ? 100'000 : std::string(format) == "usda" ? 12'000 : 4096;
    const rlimit small{room, before.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
    std::string sentence;
    {
      auto cache = CacheWriter::create(file, make_grid(Grid{.cells_x = 14, .cells_y = 14}).render, options);
      if (!cache) sentence = cache.error();
      const std::vector<Vec3> still(225);
      for (int k = 0; k < 100 && sentence.empty(); ++k)
        if (const auto added = (*cache)->add({.positions = still, .normals = still, .strain = {}}); !added) sentence = added.error();
    }
    setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_NE(sentence.find(" cannot be written: File too large"), std::string::npos) << format << ": " << sentence;
    EXPECT_EQ(entries_of(folder), 0) << format;
  }
}

TEST(Cache, what_cannot_be_written_is_a_sentence_before_anything_is) {
  const Folder folder;
  const Motion motion;
  const auto refusal = [&](const std::string& name, const CacheOptions& options, const RenderMesh& mesh) {
    const auto cache = CacheWriter::create(folder / name, mesh, options);
    EXPECT_FALSE(cache) << name;
    EXPECT_EQ(entries_of(folder), 0) << name;
    return cache ? "" : cache.error();
  };
  const std::string at = (folder / "").string();
  EXPECT_EQ(refusal("a.abc", kWanted, motion.mesh),
            at + "a.abc has the extension \".abc\"; caches are .glb, .pc2, .mdd, .usda, or .ply and "
                 ".obj with a file a frame");
  EXPECT_TRUE(cache_format("A.PC2"));
  EXPECT_EQ(refusal("a.pc2", {.frames = 0}, motion.mesh),
            at + "a.pc2 is not written: a cache has at least one frame, and this one would have 0");
  EXPECT_NE(refusal("a.pc2", {.frames = 1, .rate = 0}, motion.mesh).find("0 frames a second are not above 0"), std::string::npos);
  EXPECT_NE(refusal("a.pc2", {.frames = 3'000'000'000}, motion.mesh).find("at most 2147483647 of each"), std::string::npos);
  EXPECT_NE(refusal("a.usda", {.frames = 4'000'000'000}, motion.mesh).find(" bytes, and its disk has "), std::string::npos);
  EXPECT_EQ(refusal("a.glb", {.frames = 32'768}, motion.mesh),
            at + "a.glb is not written: 32768 frames of 12 vertices take more than 4294967295 bytes, and a GLB has at most 4294967295; a "
                 ".usda, a .pc2 or a .mdd has no such limit");
  const RenderMesh large = make_grid(Grid{.cells_x = 199, .cells_y = 199}).render;
  EXPECT_NE(refusal("a.glb", {.frames = 5000}, large).find("5000 frames of 40000 vertices take 49"), std::string::npos);
  EXPECT_NE(refusal("a.glb", kWanted, {.positions = motion.mesh.positions, .normals = {}, .tangents = {}, .uvs = {}, .triangles = {}})
                .find("has nothing to draw"),
            std::string::npos);
  RenderMesh crooked = motion.mesh;
  crooked.normals.pop_back();
  EXPECT_NE(refusal("a.usda", kWanted, crooked).find("11 normals for 12 vertices"), std::string::npos);
  crooked = motion.mesh;
  crooked.triangles[2][1] = 12;
  EXPECT_NE(refusal("a.obj", kWanted, crooked).find("triangle 2 has vertex 12 of 12"), std::string::npos);
  crooked.positions[3].y = NAN;
  EXPECT_NE(refusal("a.mdd", kWanted, crooked).find("vertex 3 of the mesh at rest is not finite"), std::string::npos);
  EXPECT_NE(refusal("missing/a.pc2", kWanted, motion.mesh).find("cannot be written: No such file or directory"), std::string::npos);
  EXPECT_NE(refusal("missing/a.ply", kWanted, motion.mesh).find("cannot be written: No such file or directory"), std::string::npos);
}

TEST(Cache, a_frame_that_does_not_fit_is_refused_and_can_be_added_again) {
  const Folder folder;
  const Motion motion;
  auto cache = must(CacheWriter::create(folder / "a.glb", motion.mesh, kWanted));
  const auto refusal = [&](const CacheFrame& frame) { return cache->add(frame).error(); };
  const std::string at = "frame 1 of " + (folder / "a.glb").string() + ": ";
  std::vector<Vec3> bad = motion.positions[0];
  bad[4].z = INFINITY;
  EXPECT_EQ(refusal({bad, motion.normals[0], {}}), at + "vertex 4 is not finite, or 1e+10 m away or more");
  EXPECT_EQ(refusal({motion.positions[0], {}, {}}), at + "0 normals for 12 vertices");
  bad.pop_back();
  EXPECT_EQ(refusal({bad, motion.normals[0], {}}), at + "11 positions for 12 vertices");
  for (std::uint32_t k = 0; k < kFrames; ++k) must(cache->add(motion.frame(k)));
  EXPECT_NE(refusal(motion.frame(0)).find("has all of its 5 frames already"), std::string::npos);
  must(cache->finish());
  EXPECT_EQ(test::read_glb(slurp(folder / "a.glb")).frames.size(), kFrames);
}

}  // namespace
}  // namespace weft
