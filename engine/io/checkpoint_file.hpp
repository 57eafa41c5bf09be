// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "base/run_contract.hpp"
#include "engine/core/communicator.hpp"
#include "engine/core/state_io.hpp"

namespace grouser {

/// Writes sorted tables as one HDF5 file, and beside them rank 0's `input`. @throws StorageError,
/// on this rank alone. Collective.
void write_state_file(const Communicator& ranks, const std::filesystem::path& file,
                      const State& state, const CheckpointManifest& manifest,
                      const std::string& input);

/// Reads a file written by write_state_file and checks the hash of every dataset; each rank gets
/// its block of keys.
/// @throws StorageError or FormatError, on this rank alone. Collective.
State read_state_file(const Communicator& ranks, const std::filesystem::path& file);

}  // namespace grouser
