// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace grouser {

/// XXH3 64-bit hash of `size` bytes. Not cryptographic: it tells accidents, not attacks. Local.
std::uint64_t hash_bytes(const void* data, std::size_t size, std::uint64_t seed = 0);

/// 16 lower-case hexadecimal digits of the hash. Local.
std::string hash_text(const std::string& text);

std::string hex(std::uint64_t value);

}  // namespace grouser
