// What is on view: a scene and its simulation, played, stopped, changed, and gone back with.
//
// The simulation is made anew whenever the scene changes, and goes on from where the old one was (carry.h). The viewer's own things are
// added to what is simulated and not to the scene: a hand, pins, and the ball that follows the pointer.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/simulation.h"
#include "samples/view/carry.h"
#include "samples/view/orbit.h"

namespace weft::view {

struct Keepsake {
  std::uint64_t frame = 0;
  double time = 0;   // s
  Snapshot snapshot;
  std::vector<std::uint32_t> pinned, released;   // vertices, by the user
};

class Stage {
 public:
  /// Errors: as load_subject's and Simulation::create's.
  static Result<std::unique_ptr<Stage>> open(const compute::Device& device, const std::filesystem::path& file,
                                             std::span<const Assignment> assignments);

  const Scene& scene() const { return scene_; }
  const Simulation& simulation() const { return *simulation_; }
  const std::filesystem::path& file() const { return file_; }
  std::uint64_t frame() const { return frame_; }
  /// Counts the simulations that there were: who holds on to one's buffers looks here.
  std::uint64_t generation() const { return generation_; }
  bool times_passes() const { return times_; }
  std::optional<std::uint32_t> ball() const { return ball_; }

  /// Submits a frame; it is drawn once ready_semaphore() says so.
  Result<void> step();
  /// The scene from its beginning.
  Result<void> reset();
  /// Another scene: a simulation made anew, but for gravity and wind, which it takes as it runs. With an error everything is as it was.
  Result<void> change(const Scene& scene);
  Result<void> time_passes(bool on);
  /// A ball of that radius (m) that the host moves; none: it goes.
  Result<void> put_ball(std::optional<double> radius);
  Result<void> move_ball(Vec3 centre);
  /// Makes cloth that does not tear one that can be cut, or puts the knife away; what is cut stays so.
  Result<void> take_knife(bool on);
  bool has_knife() const { return has_knife_; }
  /// Cuts cloth along the line between where two rays go; returns how many vertices have become two.
  Result<std::uint32_t> cut(const Ray& from, const Ray& to);

  Result<void> keep();
  const std::vector<Keepsake>& kept() const { return kept_; }
  Result<void> go_back_to(std::size_t kept);

  /// Takes hold of cloth under a ray; false: there is none.
  Result<bool> grab(const Ray& ray);
  bool is_grabbing() const { return grabbed_.has_value(); }
  /// Along the ray, in the plane of the first hold across `ahead`.
  Result<void> drag(const Ray& ray, Vec3 ahead);
  Result<void> let_go();
  /// Pins the vertex nearest to where the ray meets cloth, or lets go of it where it is held; nothing where there is none.
  Result<std::optional<std::string>> pin_or_release(const Ray& ray);

  /// The bounds of cloth (m). Waits.
  Result<std::pair<Vec3, Vec3>> bounds() const;
  /// The candidate pairs of contacts that the last detection found: the middles of their sides, two a pair (m). Waits.
  Result<std::vector<Vec3>> contacts() const;

 private:
  explicit Stage(const compute::Device& device) : device_(&device) {}
  Scene prepared(const Scene& scene) const;
  Result<std::unique_ptr<Simulation>> make(const Scene& prepared) const;
  Result<void> replace(const Scene& scene);
  void renumber(std::span<const Room> was, std::span<const Room> now);
  bool differs_in_forces_alone(const Scene& scene) const;

  const compute::Device* device_;
  std::filesystem::path file_;
  Scene scene_;
  std::unique_ptr<Simulation> simulation_;
  std::vector<Keepsake> kept_;
  std::optional<Keepsake> start_;
  std::optional<Grabbed> grabbed_;
  std::optional<std::uint32_t> ball_;
  std::optional<double> ball_radius_;
  Vec3 ball_centre_;
  std::vector<std::uint32_t> pinned_, released_;   // vertices
  std::uint64_t frame_ = 0, generation_ = 0;
  bool times_ = false, has_knife_ = false;
};

}  // namespace weft::view
