// Any bytes as a snapshot, and as what a snapshot holds under a head and a digest that fit: they end in a sentence, or in a snapshot that
// is written as the same bytes.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

#include "compute/digest.h"
#include "engine/snapshot.h"

namespace {

constexpr std::size_t kLengthAt = 12, kHead = 20;   // snapshot.h: magic, version, length

template <class T>
void put(std::vector<std::byte>& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

// What no flipped bit would get past by itself.
std::vector<std::byte> sealed(std::span<const std::byte> body) {
  std::vector<std::byte> bytes = weft::snapshot_bytes({});
  bytes.resize(kHead);
  bytes.insert(bytes.end(), body.begin(), body.end());
  put(bytes, kLengthAt, std::uint64_t(bytes.size() + sizeof(std::uint64_t)));
  weft::Digest digest;
  digest.add(bytes);
  bytes.resize(bytes.size() + sizeof(std::uint64_t));
  put(bytes, bytes.size() - sizeof(std::uint64_t), digest.value());
  return bytes;
}

void try_all_of(std::span<const std::byte> bytes) {
  const auto snapshot = weft::parse_snapshot(bytes);
  if (!snapshot && snapshot.error().empty()) std::abort();
  if (snapshot && !std::ranges::equal(weft::snapshot_bytes(*snapshot), bytes)) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const auto given = std::as_bytes(std::span(bytes, size));
  try_all_of(given);
  try_all_of(sealed(given));
  return 0;
}
