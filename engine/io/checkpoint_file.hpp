// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>

#include "base/run_contract.hpp"
#include "engine/core/communicator.hpp"
#include "engine/core/state_io.hpp"

namespace grouser {

/// Makes one piece of a state. Collective.
using StateSource = std::function<State(const StatePiece&)>;

/// Takes one piece of one table. Collective.
using RowSink = std::function<void(const StateTable&)>;

/// Writes a state as one HDF5 file, piece by piece, and beside it rank 0's `input`.
/// @return hash of the state
/// @throws StorageError, on this rank alone. Collective.
std::uint64_t write_state_file(const Communicator& ranks, const std::filesystem::path& file,
                               const StateSource& source, std::int64_t pieces,
                               const CheckpointManifest& manifest, const std::string& input);

/// Reads a file written by write_state_file, table by table in the order they were saved, large
/// ones in pieces, and checks the hash of every dataset; rows come in any split over ranks.
/// @return hash of the state
/// @throws StorageError or FormatError, on this rank alone. Collective.
std::uint64_t read_state_file(const Communicator& ranks, const std::filesystem::path& file,
                              const RowSink& sink);

}  // namespace grouser
