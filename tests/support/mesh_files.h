// Small mesh files for tests: a folder that goes away again, and glTF documents written piece by piece.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace weft::test {

class Folder {
 public:
  Folder() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::temp_directory_path() /
            (std::string("weft_") + test->test_suite_name() + "_" + test->name() + "_" + std::to_string(getpid()));
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  std::filesystem::path write(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

inline std::string slurp(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// A glTF document with one external buffer, mesh.bin. One mesh; `json` may be edited before it is written.
struct Gltf {
  nlohmann::json json{{"asset", {{"version", "2.0"}}},
                      {"scene", 0},
                      {"scenes", {{{"nodes", {0}}}}},
                      {"nodes", {{{"mesh", 0}}}},
                      {"meshes", {{{"primitives", nlohmann::json::array()}}}}};
  std::string bytes;

  template <class T>
  std::size_t accessor(const std::vector<T>& values, int component, const char* type, std::size_t width) {
    bytes.resize((bytes.size() + 3) / 4 * 4, '\0');
    const std::size_t size = values.size() * sizeof(T);
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", size}});
    json["accessors"].push_back(
        {{"bufferView", json["bufferViews"].size() - 1}, {"componentType", component}, {"count", values.size() / width}, {"type", type}});
    bytes.append(reinterpret_cast<const char*>(values.data()), size);
    return json["accessors"].size() - 1;
  }
  std::size_t vec2(const std::vector<float>& values) { return accessor(values, 5126, "VEC2", 2); }
  std::size_t vec3(const std::vector<float>& values) { return accessor(values, 5126, "VEC3", 3); }
  std::size_t vec4(const std::vector<float>& values) { return accessor(values, 5126, "VEC4", 4); }
  std::size_t indices8(const std::vector<std::uint8_t>& values) { return accessor(values, 5121, "SCALAR", 1); }
  std::size_t indices16(const std::vector<std::uint16_t>& values) { return accessor(values, 5123, "SCALAR", 1); }
  std::size_t indices32(const std::vector<std::uint32_t>& values) { return accessor(values, 5125, "SCALAR", 1); }

  /// Adds a primitive and returns it, to be given more.
  nlohmann::json& primitive(std::size_t position, int mode = 4) {
    auto& list = json["meshes"][0]["primitives"];
    list.push_back({{"attributes", {{"POSITION", position}}}, {"mode", mode}});
    return list.back();
  }

  std::filesystem::path write(const Folder& folder) {
    json["buffers"] = nlohmann::json::array({{{"byteLength", bytes.size()}, {"uri", "mesh.bin"}}});
    folder.write("mesh.bin", bytes);
    return folder.write("mesh.gltf", json.dump(1));
  }
};

}   // namespace weft::test
