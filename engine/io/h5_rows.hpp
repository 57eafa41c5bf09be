// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/core/communicator.hpp"
#include "engine/io/h5.hpp"

namespace grouser {

/// HDF5 type of a number, in memory and in the file: double, float, std::int64_t, std::uint8_t.
template <class Number>
hid_t h5_type();

/// Access by all ranks together; a single rank opens the file as any program does.
H5Handle file_access(const Communicator& ranks);
H5Handle collective_transfer(const Communicator& ranks);

/// A transfer may fail on one rank alone; all must then leave the file together.
/// @throws StorageError on every rank when it failed on one. Collective.
void h5_agree(const Communicator& ranks, herr_t result, const std::string& doing);

/// Creates a file for all ranks; an existing one is refused, or replaced when `replace` says so.
/// @throws StorageError. Collective.
H5Handle create_file(const Communicator& ranks, const std::filesystem::path& file, bool replace);

/// Attributes of a group or dataset. Called alike by all ranks that have the file open.
void write_text(hid_t place, const char* name, const std::string& text);
void write_numbers(hid_t place, const char* name, const std::vector<std::int64_t>& values);
void write_reals(hid_t place, const char* name, const std::vector<double>& values);
void write_number(hid_t place, const char* name, std::int64_t value);

/// Selects rows start[0] ... start[0] + count[0] - 1 for a transfer, nothing when there are none.
void select_rows(hid_t file_space, hid_t memory_space, const hsize_t* start, const hsize_t* count);

/// Makes a dataset of `rows` x `width` numbers; width 0 makes one of one dimension. Collective.
template <class Number>
H5Handle make_rows(hid_t group, const std::string& name, std::int64_t rows, std::size_t width);

/// Writes the rows of all ranks one rank after the other, from row `first` of the dataset on.
/// @param values rows x width on this rank; may be empty
/// @throws StorageError on every rank. Collective.
template <class Number>
void write_rows_at(const Communicator& ranks, hid_t dataset, std::int64_t first,
                   const std::vector<Number>& values, std::size_t width);

/// Writes this rank's rows behind those of the ranks before it, as one dataset of all ranks' rows.
/// @param values  rows x width on this rank; may be empty
/// @param width   numbers per row; 0 makes a dataset of one dimension
/// @throws StorageError on every rank. Collective.
template <class Number>
H5Handle write_rows(const Communicator& ranks, hid_t group, const std::string& name,
                    const std::vector<Number>& values, std::size_t width);

/// Writes layers of cells, those of all ranks one after the other, as one dataset of the extents
/// z, y, x and, with a width over 0, components.
/// @param values whole layers of this rank; may be empty
/// @throws StorageError on every rank. Collective.
void write_layers(const Communicator& ranks, hid_t group, const std::string& name,
                  const std::vector<float>& values, const std::array<std::int64_t, 3>& cells,
                  std::size_t width);

}  // namespace grouser
