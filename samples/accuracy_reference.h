// References for an accuracy sweep: the same scene solved by Newton's method in double precision (engine/reference/trajectory.h),
// kept on disk, since they cost more than all that is compared with them.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "engine/reference/trajectory.h"
#include "engine/scene.h"

namespace weft::command {

/// FNV-1a over bytes, to tell scenes and what was cooked from them apart; in 16 hexadecimal digits.
class Fingerprint {
 public:
  Fingerprint& add(const void* bytes, std::size_t count);
  Fingerprint& add(std::string_view text) { return add(text.data(), text.size()); }
  std::string text() const;

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

/// The scene's run of `frames` frames in time steps of 1 / (rate substeps). Taken from `folder` if it was kept there, and kept there
/// otherwise; the name tells the scene, what was cooked from it, the frames and the step. Errors: those of integrate_newton, and "stopped" after ctrl-C.
Result<reference::Trajectory> reference_run(Scene scene, std::uint32_t substeps, std::uint32_t frames, const std::filesystem::path& folder);

/// Rms distance of a run's particles from a reference's, over the frames so far and relative to `size` (m).
class Distance {
 public:
  Distance(const reference::Trajectory& from, double size) : from_(from), size_(size) {}
  void add(std::span<const gpu::vec4> positions);   // frame after frame; anchors, which are where they have to be, do not count
  double value() const;

 private:
  const reference::Trajectory& from_;
  double size_;
  std::size_t frame_ = 0, count_ = 0;
  double sum_ = 0;   // m^2
};

/// The diagonal of the box around the particles (m).
double size_of(std::span<const gpu::vec4> positions);

}  // namespace weft::command
