// What contacts cost a scene as it is: its frames with contacts and without, in turns.
#pragma once

#include "compute/device.h"
#include "engine/metrics.h"
#include "engine/scene.h"
#include "samples/weft/report.h"

namespace weft::command {

struct ContactPrice {
  Spread frame;   // ms: whole frames on the wall clock
  Strain strain;  // of the last frame
  std::size_t crossings = 0;   // edges of the cloth that go through its triangles, in the last frame
};

struct ContactPrices {
  std::uint32_t frames = 0;
  ContactPrice without, with;
};

/// Steps two simulations of the scene frame by frame in turns, so that whatever else the machine does slows both alike; fewer frames if
/// that is interrupted. The first frame of each, in which the driver compiles, is not timed.
Result<ContactPrices> contact_prices(const compute::Device& device, const Scene& scene, std::uint32_t frames);

/// A table of three rows.
void print(const ContactPrices& prices, const std::string& scene);
std::string csv(const ContactPrices& prices);

}  // namespace weft::command
