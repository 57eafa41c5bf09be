// SPDX-License-Identifier: BSD-3-Clause
#include "base/hash.hpp"

#include <xxhash.h>

namespace grouser {

std::uint64_t hash_bytes(const void* data, std::size_t size, std::uint64_t seed) {
  return XXH3_64bits_withSeed(data, size, seed);
}

std::string hash_text(const std::string& text) { return hex(hash_bytes(text.data(), text.size())); }

std::string hex(std::uint64_t value) {
  std::string text(16, '0');
  for (std::size_t i = 0; i < text.size(); ++i)
    text[15 - i] = "0123456789abcdef"[(value >> (4 * i)) & 0xF];
  return text;
}

}  // namespace grouser
