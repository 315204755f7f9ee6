// What a simulation counts while it runs.
#pragma once

#include <cstdint>

namespace weft {

/// Counts since create. non_finite, coincident and contacts_overflowed are 0 in a healthy run.
struct Counts {
  std::uint32_t non_finite = 0;            // particles put back to their last finite position
  /// Links with both ends at one position, pushed apart in an arbitrary direction. Springs that only pull, and those of the
  /// method implicit, are left as they are.
  std::uint32_t coincident = 0;
  std::uint32_t contacts_most = 0;         // the most candidate pairs that one detection found
  /// Candidate pairs beyond the capacity, whose particles were held still instead: with record and submit, where pairs grow faster than
  /// the capacity, and where the device has no more memory.
  std::uint32_t contacts_overflowed = 0;
  std::uint32_t contacts_room = 0;         // the capacity that would have sufficed so far: what to reserve_contacts next time
  std::uint32_t truncated = 0;             // steps of particles and anchors cut short to prevent a crossing; may be several a substep
  std::uint32_t detections = 0;            // searches for candidate pairs
  std::uint32_t crossings = 0;             // pairs of an edge and a triangle that it goes through, at the last detection
  std::uint32_t crossings_most = 0;        // the most that one detection found
  std::uint32_t splits = 0;                // vertices that have become two by tearing and cutting; put back by restore
  /// Times that cloth would have torn, or was cut, and could not, or not all of it: no spare vertices left (Tear::spare), or no room for the
  /// lists of cloth that is torn so often.
  std::uint32_t splits_refused = 0;
  float tracking_error = 0;                // m, the largest distance of an anchor or a mesh collider's vertex, held back, from its target
  // Method implicit only. The norm of a residual r is r . D^-1 r, D the blocks on the matrix's diagonal.
  std::uint32_t unconverged = 0;           // substeps whose solve left more than 1 % of the free flight's residual
  std::uint32_t stopped = 0;               // substeps whose solve was stopped early, with the best iterate so far
  float residual = 0;                      // relative, of the last substep's solve, before its last iteration
  // Method chebyshev only.
  std::uint32_t unaccelerated = 0;         // substeps finished as jacobi, because the acceleration diverged
};

}  // namespace weft
