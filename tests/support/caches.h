// Reads caches as other programs do: by the formats' own descriptions, with no code of Weft's.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "engine/vector.h"

namespace weft::test {

struct ReadCache {
  std::vector<std::vector<Vec3>> frames, normals;
  std::vector<float> times;                       // of each frame: s, or its number
  std::vector<Vec3> rest;
  std::vector<Vec2> uvs;
  std::vector<std::uint32_t> corners;
  float rate = 0;
};

/// Bits, so that -0 is not 0.
inline bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0);
}

template <class T>
T value_at(std::string_view bytes, std::size_t offset, bool big_endian = false) {
  std::array<char, sizeof(T)> raw{};
  if (offset + sizeof(T) > bytes.size()) {
    ADD_FAILURE() << "beyond the end: " << offset << " of " << bytes.size();
    return {};
  }
  std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(offset), sizeof(T), raw.begin());
  if (big_endian) std::ranges::reverse(raw);
  T value;
  std::memcpy(&value, raw.data(), sizeof value);
  return value;
}

inline std::vector<Vec3> vectors_at(std::string_view bytes, std::size_t offset, std::size_t count, bool big_endian = false) {
  std::vector<Vec3> list(count);
  for (std::size_t v = 0; v < count; ++v) {
    const auto number = [&](std::size_t k) { return value_at<float>(bytes, offset + 12 * v + 4 * k, big_endian); };
    list[v] = {number(0), number(1), number(2)};
  }
  return list;
}

inline std::vector<Vec3> triples(const std::vector<float>& numbers) {
  std::vector<Vec3> list;
  for (std::size_t k = 0; k + 2 < numbers.size(); k += 3) list.push_back({numbers[k], numbers[k + 1], numbers[k + 2]});
  return list;
}

inline ReadCache read_pc2(std::string_view bytes) {
  EXPECT_EQ(bytes.substr(0, 12), std::string_view("POINTCACHE2\0", 12));
  EXPECT_EQ(value_at<std::int32_t>(bytes, 12), 1);
  const auto points = static_cast<std::size_t>(value_at<std::int32_t>(bytes, 16));
  const auto samples = static_cast<std::size_t>(value_at<std::int32_t>(bytes, 28));
  EXPECT_EQ(bytes.size(), 32 + samples * points * 12);
  ReadCache cache;
  for (std::size_t k = 0; k < samples; ++k) {
    cache.frames.push_back(vectors_at(bytes, 32 + k * points * 12, points));
    cache.times.push_back(value_at<float>(bytes, 20) + static_cast<float>(k) * value_at<float>(bytes, 24));
  }
  return cache;
}

inline ReadCache read_mdd(std::string_view bytes) {
  const auto frames = static_cast<std::size_t>(value_at<std::int32_t>(bytes, 0, true));
  const auto points = static_cast<std::size_t>(value_at<std::int32_t>(bytes, 4, true));
  EXPECT_EQ(bytes.size(), 8 + 4 * frames + frames * points * 12);
  ReadCache cache;
  for (std::size_t k = 0; k < frames; ++k) {
    cache.times.push_back(value_at<float>(bytes, 8 + 4 * k, true));
    cache.frames.push_back(vectors_at(bytes, 8 + 4 * frames + k * points * 12, points, true));
  }
  return cache;
}

/// Also whether accessors and buffer views are what glTF 2.0 asks of them: types, alignment, ranges, bounds.
inline ReadCache read_glb(const std::string& bytes) {
  using nlohmann::json;
  ReadCache cache;
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(value_at<std::uint32_t>(bytes, 4), 2u);
  EXPECT_EQ(value_at<std::uint32_t>(bytes, 8), bytes.size());
  const std::size_t text = value_at<std::uint32_t>(bytes, 12);
  EXPECT_EQ(text % 4, 0u);
  EXPECT_EQ(bytes.substr(16, 4), "JSON");
  const json document = json::parse(bytes.substr(20, text), nullptr, false);
  if (!document.is_object()) return ADD_FAILURE() << "not JSON", cache;
  const std::size_t length = value_at<std::uint32_t>(bytes, 20 + text);
  EXPECT_EQ(bytes.substr(24 + text, 4), std::string("BIN\0", 4));
  EXPECT_EQ(28 + text + length, bytes.size());
  EXPECT_EQ(document["buffers"], json::array({{{"byteLength", length}}}));
  const std::string binary = bytes.substr(28 + text);

  std::size_t next = 0;   // views lie one after another and leave nothing out
  for (const json& view : document["bufferViews"]) {
    EXPECT_EQ(view.value("byteOffset", std::size_t{0}), next);
    next += view["byteLength"].get<std::size_t>();
  }
  EXPECT_EQ(next, length);
  const std::map<std::string, std::size_t> widths = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}};
  const auto floats_of = [&](std::size_t index) {
    const json& accessor = document["accessors"][index];
    const json& view = document["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    const std::size_t width = widths.at(accessor["type"]), count = accessor["count"];
    const std::size_t within = accessor.value("byteOffset", std::size_t{0});
    EXPECT_EQ(within % 4, 0u);
    EXPECT_EQ(view.value("byteStride", 4 * width), 4 * width) << index << ": packed";
    EXPECT_LE(within + 4 * width * count, view["byteLength"].get<std::size_t>()) << index;
    EXPECT_EQ(accessor["componentType"], 5126);
    std::vector<float> values;
    for (std::size_t k = 0; k < width * count; ++k)
      values.push_back(value_at<float>(binary, view.value("byteOffset", std::size_t{0}) + within + 4 * k));
    for (const auto& [key, sign] : {std::pair{"max", 1.f}, {"min", -1.f}})
      for (std::size_t k = 0; accessor.contains(key) && k < width; ++k) {
        float bound = -INFINITY;
        for (std::size_t v = k; v < values.size(); v += width) bound = std::max(bound, sign * values[v]);
        EXPECT_EQ(accessor[key][k].get<double>(), static_cast<double>(sign * bound)) << "accessor " << index << ' ' << key;
      }
    return values;
  };
  const auto vectors_of = [&](std::size_t index, bool bounded) {
    EXPECT_EQ(document["accessors"][index]["type"], "VEC3");
    for (const char* key : {"min", "max"}) EXPECT_EQ(document["accessors"][index].contains(key), bounded) << index;
    const std::vector<float> values = floats_of(index);
    return triples(values);
  };
  const json& primitive = document["meshes"][0]["primitives"][0];
  cache.rest = vectors_of(primitive["attributes"]["POSITION"], true);
  const bool has_normals = primitive["attributes"].contains("NORMAL");
  const std::vector<Vec3> normals = has_normals ? vectors_of(primitive["attributes"]["NORMAL"], false) : std::vector<Vec3>();
  if (primitive["attributes"].contains("TEXCOORD_0")) {
    const std::vector<float> uvs = floats_of(primitive["attributes"]["TEXCOORD_0"]);
    for (std::size_t k = 0; k + 1 < uvs.size(); k += 2) cache.uvs.push_back({uvs[k], uvs[k + 1]});
  }
  const json& indices = document["accessors"][primitive["indices"].get<std::size_t>()];
  EXPECT_EQ(indices["componentType"], 5125);
  for (std::size_t k = 0; k < indices["count"]; ++k)
    cache.corners.push_back(value_at<std::uint32_t>(
        binary, document["bufferViews"][indices["bufferView"].get<std::size_t>()]["byteOffset"].get<std::size_t>() + 4 * k));

  const json& sampler = document["animations"][0]["samplers"][0];
  EXPECT_EQ(sampler["interpolation"], "LINEAR");
  EXPECT_EQ(document["animations"][0]["channels"][0], (json{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}));
  const std::vector<float> times = floats_of(sampler["input"]), weights = floats_of(sampler["output"]);
  EXPECT_TRUE(document["accessors"][sampler["input"].get<std::size_t>()].contains("min"));
  const std::size_t targets = primitive["targets"].size();
  EXPECT_EQ(times.size(), targets + 1);
  EXPECT_EQ(weights.size(), targets * (targets + 1));
  for (std::size_t key = 0; key < times.size(); ++key)
    for (std::size_t k = 0; k < targets; ++k) EXPECT_EQ(weights.at(key * targets + k), key == k + 1 ? 1 : 0);
  EXPECT_EQ(times.at(0), 0);
  cache.times.assign(times.begin() + 1, times.end());
  for (const json& target : primitive["targets"]) {
    std::vector<Vec3> list = vectors_of(target["POSITION"], true);
    for (std::size_t v = 0; v < list.size(); ++v) list[v] = cache.rest.at(v) + list[v];
    cache.frames.push_back(list);
    if (!has_normals) continue;
    list = vectors_of(target["NORMAL"], false);
    for (std::size_t v = 0; v < list.size(); ++v) list[v] = normals.at(v) + list[v];
    cache.normals.push_back(list);
  }
  return cache;
}

/// The numbers in a text, whatever is between them.
inline std::vector<float> numbers_in(std::string_view text) {
  std::vector<float> numbers;
  while (true) {
    text.remove_prefix(std::min(text.find_first_of("-0123456789"), text.size()));
    if (text.empty()) return numbers;
    float number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    EXPECT_EQ(error, std::errc());
    numbers.push_back(number);
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  }
}

inline std::vector<Vec3> tuples_in(std::string_view text) {
  const std::vector<float> numbers = numbers_in(text);
  EXPECT_EQ(numbers.size() % 3, 0u);
  return triples(numbers);
}

/// Line by line: "TYPE NAME = VALUE", and samples as "CODE: VALUE," up to "}".
inline ReadCache read_usda(const std::string& bytes) {
  ReadCache cache;
  EXPECT_TRUE(bytes.starts_with("#usda 1.0\n"));
  EXPECT_TRUE(bytes.ends_with("    }\n}\n"));
  std::istringstream lines(bytes);
  std::string line, sampled;
  while (std::getline(lines, line)) {
    const std::size_t equals = line.find(" = "), colon = line.find(": [");
    const std::string value = equals == std::string::npos ? "" : line.substr(equals + 3);
    if (line.find(".timeSamples = {") != std::string::npos) sampled = line;
    else if (line == "    }") sampled.clear();
    else if (!sampled.empty() && colon != std::string::npos) {
      EXPECT_TRUE(line.ends_with(",")) << sampled;
      const std::vector<Vec3> list = tuples_in(std::string_view(line).substr(colon + 2));
      if (sampled.find("point3f[] points.") != std::string::npos) {
        cache.frames.push_back(list);
        cache.times.push_back(numbers_in(line.substr(0, colon)).at(0));
      }
      if (sampled.find("normal3f[] normals.") != std::string::npos) cache.normals.push_back(list);
    } else if (line.find("int[] faceVertexIndices") != std::string::npos) {
      for (const float corner : numbers_in(value)) cache.corners.push_back(static_cast<std::uint32_t>(corner));
    } else if (line.find("point3f[] points =") != std::string::npos) cache.rest = tuples_in(value);
    else if (line.find("timeCodesPerSecond") != std::string::npos) cache.rate = numbers_in(value).at(0);
    else if (line.find("primvars:st") != std::string::npos) {
      const std::vector<float> uvs = numbers_in(value);
      for (std::size_t k = 0; k + 1 < uvs.size(); k += 2) cache.uvs.push_back({uvs[k], uvs[k + 1]});
    }
  }
  return cache;
}

/// Positions and, where it has them, normals of one file of a sequence.
inline void add_ply(ReadCache& cache, const std::string& bytes) {
  const std::size_t body = bytes.find("end_header\n") + 11;
  const std::string head = bytes.substr(0, body);
  const std::size_t vertices = std::stoul(head.substr(head.find("element vertex ") + 15));
  std::size_t width = 0;
  for (std::size_t at = head.find("property float"); at != std::string::npos; at = head.find("property float", at + 1)) ++width;
  const bool normals = head.find("float nx") != std::string::npos;
  std::vector<Vec3> positions, directions;
  for (std::size_t v = 0; v < vertices; ++v) {
    positions.push_back(vectors_at(bytes, body + 4 * width * v, 1)[0]);
    if (normals) directions.push_back(vectors_at(bytes, body + 4 * width * v + 12, 1)[0]);
  }
  cache.frames.push_back(positions);
  cache.normals.push_back(directions);
}

inline void add_obj(ReadCache& cache, const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  std::vector<Vec3> positions, normals;
  cache.corners.clear();
  while (std::getline(lines, line)) {
    if (line.starts_with("v ")) positions.push_back(tuples_in(line)[0]);
    if (line.starts_with("vn ")) normals.push_back(tuples_in(line)[0]);
    if (!line.starts_with("f ")) continue;
    std::istringstream words(line.substr(2));
    for (std::string word; words >> word;) cache.corners.push_back(static_cast<std::uint32_t>(std::stoul(word)) - 1);
  }
  cache.frames.push_back(positions);
  cache.normals.push_back(normals);
}

}  // namespace weft::test
