// What `weft` says of what it is given, and what flags allow.
#include "tests/support/command_line.h"

namespace weft {
namespace {

class Inputs : public CommandLine {};

TEST_F(Inputs, a_capacity_beyond_the_device_is_named_by_its_key_and_noted_where_there_is_no_device) {
  const std::string scene =
      write("large.json", R"({"cloths": [{"grid": {"cells": [4, 4]}}], "contacts": {"capacity": 67108864}})").string();
  const std::string key = "contacts.capacity: 67108864 candidate pairs, too many for ";
  const Outcome checked = weft({"check", scene});
  EXPECT_EQ(checked.exit, 0) << checked.error;
  EXPECT_NE(checked.out.find("note: " + key), std::string::npos) << checked.out;
  const Outcome run = weft({"run", scene, "--frames", "1", "--no-picture", "--out", out()});
  if (run.exit == 0) GTEST_SKIP() << "this device has room for that many";
  EXPECT_NE(run.error.find("contacts.capacity: 67108864 candidate pairs"), std::string::npos) << run.error;
}

TEST_F(Inputs, buffers_outside_a_gltf_s_folder_are_read_where_a_flag_allows_it) {
  fs::create_directories(folder / "own");
  const float corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::ofstream(folder / "mesh.bin", std::ios::binary).write(reinterpret_cast<const char*>(corners), sizeof corners);
  const std::string mesh = write("own/mesh.gltf", R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "buffers": [{"byteLength": 36, "uri": "../mesh.bin"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}]})").string();
  const std::string scene = write("scene.json", R"({"contacts": false, "cloths": [{"mesh": "own/mesh.gltf"}]})").string();
  for (const std::string& file : {mesh, scene})
    for (std::vector<std::string> call : {std::vector<std::string>{"check", file},
                                          {"run", file, "--frames", "1", "--no-picture", "--out", out()}}) {
      const Outcome refused = weft(call);
      EXPECT_EQ(refused.exit, 2) << file;
      EXPECT_NE(refused.error.find("lies outside the folder of the glTF"), std::string::npos) << refused.error;
      call.push_back("--allow-outside");
      const Outcome allowed = weft(call);
      EXPECT_EQ(allowed.exit, 0) << allowed.error;
    }
}

}  // namespace
}  // namespace weft
