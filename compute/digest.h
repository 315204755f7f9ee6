// A 64-bit digest of bytes (FNV-1a, Fowler, Noll and Vo 1991): of positions, of what a snapshot belongs to, of files.
//
// Each step is a bijection of the state, whatever the byte, so a change of any single byte always changes the digest. It is
// no protection against deliberate forgery.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace weft {

class Digest {
 public:
  void add(std::span<const std::byte> bytes) {
    for (const std::byte byte : bytes) value_ = (value_ ^ static_cast<std::uint64_t>(byte)) * 0x100000001b3u;
  }
  void add(std::string_view text) { add(std::as_bytes(std::span(text))); }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

}  // namespace weft
