// gltf_cloth IN OUT [seconds]: loads a mesh, lets it hang from its top, and writes it as it hangs then.
//
// The shortest program that puts a mesh through Weft and gets a mesh back. Exit codes: 0 done, 1 the machine's fault,
// 2 the input's.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "engine/export.h"
#include "engine/simulation.h"

namespace {

constexpr double kMostSeconds = 3600;

int complain(int code, const std::string& sentence) {
  std::fprintf(stderr, "gltf_cloth: %s\n", sentence.c_str());
  return code;
}

}  // namespace

int main(int count, char** words) {
  if (count < 3 || count > 4) return complain(2, "usage: gltf_cloth IN OUT [seconds]   (IN is a mesh: .glb, .obj and others; OUT a .glb)");
  char* end = nullptr;
  const double seconds = count == 4 ? std::strtod(words[3], &end) : 2;
  if (count == 4 && (end == words[3] || *end != '\0' || !(seconds >= 0 && seconds <= kMostSeconds)))
    return complain(2, std::string("the seconds are \"") + words[3] + "\", not a number from 0 to 3600");

  auto mesh = weft::load_mesh(words[1]);
  if (!mesh) return complain(2, mesh.error());
  weft::RenderMesh moved = mesh->render;
  weft::Vec3 low = moved.positions[0], high = low;
  for (const weft::Vec3& p : moved.positions) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const weft::Scene scene = weft::default_scene(words[1], low, high);   // pinned along its top, a floor below

  auto device = weft::compute::Device::create();
  if (!device) return complain(1, device.error());
  auto simulation = weft::Simulation::create(**device, scene, {std::move(*mesh)});
  if (!simulation) return complain(2, simulation.error());
  for (long frame = 0, frames = std::lround(seconds * scene.solver.rate); frame < frames; ++frame)
    if (auto done = (*simulation)->advance(1 / scene.solver.rate); !done) return complain(1, done.error());

  auto positions = (*simulation)->read_vertex_positions();
  auto normals = (*simulation)->read_vertex_normals();
  if (!positions || !normals) return complain(1, positions ? normals.error() : positions.error());
  moved.positions = std::move(*positions);
  moved.normals = std::move(*normals);
  if (auto written = weft::write_glb(words[2], moved); !written) return complain(1, written.error());
  std::printf("%s: %zu vertices after %g s on %s\n", words[2], moved.positions.size(), (*simulation)->time(), (*device)->name().c_str());
}
