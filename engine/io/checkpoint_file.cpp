// SPDX-License-Identifier: BSD-3-Clause
#include "engine/io/checkpoint_file.hpp"

#include <algorithm>

#include "base/hash.hpp"
#include "engine/io/h5_rows.hpp"

namespace grouser {
namespace {

constexpr std::int64_t kFormatVersion = 2;
constexpr const char* kHash = "hash";
constexpr const char* kInput = "case";

std::string read_text(hid_t place, const char* name) {
  H5Handle attribute(H5Aopen(place, name, H5P_DEFAULT), H5Aclose,
                     std::string("open attribute ") + name);
  H5Handle type(H5Aget_type(attribute), H5Tclose, "ask a text's type");
  std::string text(H5Tget_size(type), '\0');
  h5_check(H5Aread(attribute, type, text.data()), std::string("read attribute ") + name);
  while (!text.empty() && text.back() == '\0') text.pop_back();
  return text;
}

std::int64_t read_number(hid_t place, const char* name) {
  H5Handle attribute(H5Aopen(place, name, H5P_DEFAULT), H5Aclose,
                     std::string("open attribute ") + name);
  std::int64_t value = 0;
  h5_check(H5Aread(attribute, H5T_NATIVE_INT64, &value), std::string("read attribute ") + name);
  return value;
}

// Hash of a dataset, the same however its rows are spread: every row counts with its place.
template <class Number>
std::string hash_of_rows(const Communicator& ranks, std::int64_t first,
                         const std::vector<Number>& values, std::size_t rows, std::size_t width) {
  std::uint64_t local = 0;
  for (std::size_t row = 0; row < rows; ++row)
    local += hash_bytes(values.data() + row * width, width * sizeof(Number),
                        static_cast<std::uint64_t>(first) + row);
  return hex(ranks.wrap_sum(local));
}

void check_hash(hid_t dataset, const std::string& found) {
  if (read_text(dataset, kHash) == found) return;
  std::string path(256, '\0');
  path.resize(static_cast<std::size_t>(
      std::max<ssize_t>(0, H5Iget_name(dataset, path.data(), path.size()))));
  throw FormatError("dataset " + path + " does not have the hash written with it");
}

// One field of a table as a dataset rows x width; `column` is its place in the rows of `values`.
template <class Number>
void write_field(const Communicator& ranks, hid_t group, const StateField& field,
                 const std::vector<Number>& values, std::size_t column, std::size_t row_width) {
  const auto width = static_cast<std::size_t>(field.width);
  const std::size_t rows = values.size() / row_width;
  std::vector<Number> block(rows * width);
  for (std::size_t row = 0; row < rows; ++row)
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(row * row_width + column), width,
                block.begin() + static_cast<std::ptrdiff_t>(row * width));
  const H5Handle dataset = write_rows(ranks, group, field.name, block, width);
  write_text(dataset, "unit", field.unit);
  const std::int64_t first = ranks.sum_before(static_cast<std::int64_t>(rows));
  write_text(dataset, kHash, hash_of_rows(ranks, first, block, rows, width));
}

// Rows first ... first + count - 1 of a dataset into one column of `values`.
template <class Number>
void read_field(const Communicator& ranks, hid_t group, const StateField& field, hsize_t first,
                hsize_t rows, std::vector<Number>& values, std::size_t column,
                std::size_t row_width) {
  const auto width = static_cast<std::size_t>(field.width);
  std::vector<Number> block(rows * width + 1);
  H5Handle dataset(H5Dopen2(group, field.name.c_str(), H5P_DEFAULT), H5Dclose,
                   "open dataset " + field.name);
  H5Handle file_space(H5Dget_space(dataset), H5Sclose, "ask a data space");
  if (H5Sget_simple_extent_npoints(file_space) == 0) return;
  const hsize_t start[2] = {first, 0};
  const hsize_t count[2] = {rows, width};
  H5Handle memory_space(H5Screate_simple(2, count, nullptr), H5Sclose, "make a data space");
  select_rows(file_space, memory_space, start, count);
  h5_agree(ranks,
           H5Dread(dataset, h5_type<Number>(), memory_space, file_space, collective_transfer(ranks),
                   block.data()),
           "read dataset " + field.name);
  check_hash(dataset, hash_of_rows(ranks, static_cast<std::int64_t>(first), block, rows, width));
  for (std::size_t row = 0; row < rows; ++row)
    std::copy_n(block.begin() + static_cast<std::ptrdiff_t>(row * width), width,
                values.begin() + static_cast<std::ptrdiff_t>(row * row_width + column));
}

const StateField kKey{"key", "1", 1};
const StateField kOrder{"order", "1", 1};

void write_table(const Communicator& ranks, hid_t file, const StateTable& table) {
  H5Handle group(H5Gcreate2(file, table.name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                 H5Gclose, "make group " + table.name);
  write_number(group, "key_count", table.key_count);
  write_number(group, "rows", ranks.sum(static_cast<std::int64_t>(table.rows())));
  const std::size_t iw = table.integer_width();
  write_field(ranks, group, kKey, table.integers, 0, iw);
  write_field(ranks, group, kOrder, table.integers, 1, iw);
  std::string integers;
  std::size_t column = 2;
  for (const StateField& field : table.integer_fields) {
    write_field(ranks, group, field, table.integers, column, iw);
    column += static_cast<std::size_t>(field.width);
    integers += (integers.empty() ? "" : " ") + field.name;
  }
  // Without real columns a row count cannot be told from the reals; such tables have none.
  std::string reals;
  column = 0;
  for (const StateField& field : table.real_fields) {
    write_field(ranks, group, field, table.reals, column, table.real_width());
    column += static_cast<std::size_t>(field.width);
    reals += (reals.empty() ? "" : " ") + field.name;
  }
  write_text(group, "integer_fields", integers);
  write_text(group, "real_fields", reals);
}

std::vector<StateField> read_fields_of(hid_t group, const char* list) {
  std::vector<StateField> fields;
  const std::string names = read_text(group, list);
  for (std::size_t from = 0; from < names.size();) {
    const std::size_t to = std::min(names.find(' ', from), names.size());
    StateField field;
    field.name = names.substr(from, to - from);
    H5Handle dataset(H5Dopen2(group, field.name.c_str(), H5P_DEFAULT), H5Dclose,
                     "open dataset " + field.name);
    H5Handle space(H5Dget_space(dataset), H5Sclose, "ask a data space");
    hsize_t extent[2] = {0, 0};
    if (H5Sget_simple_extent_ndims(space) != 2 ||
        H5Sget_simple_extent_dims(space, extent, nullptr) < 0)
      throw FormatError("dataset " + field.name + " has not two dimensions");
    field.width = static_cast<int>(extent[1]);
    field.unit = read_text(dataset, "unit");
    fields.push_back(field);
    from = to + 1;
  }
  return fields;
}

StateTable read_table(const Communicator& ranks, hid_t file, const std::string& name) {
  H5Handle group(H5Gopen2(file, name.c_str(), H5P_DEFAULT), H5Gclose, "open group " + name);
  StateTable table;
  table.name = name;
  table.key_count = read_number(group, "key_count");
  table.integer_fields = read_fields_of(group, "integer_fields");
  table.real_fields = read_fields_of(group, "real_fields");
  const std::int64_t all = read_number(group, "rows");
  if (all < 0 || table.key_count < 0) throw FormatError("table " + name + " has a negative size");
  // Any split of the rows will do: modules sort them to where they belong.
  const std::int64_t first = first_key(all, ranks.size(), ranks.rank());
  const auto rows = static_cast<hsize_t>(first_key(all, ranks.size(), ranks.rank() + 1) - first);
  const auto from = static_cast<hsize_t>(first);
  const std::size_t iw = table.integer_width();
  table.integers.resize(rows * iw);
  table.reals.resize(rows * table.real_width());
  read_field(ranks, group, kKey, from, rows, table.integers, 0, iw);
  read_field(ranks, group, kOrder, from, rows, table.integers, 1, iw);
  std::size_t column = 2;
  for (const StateField& field : table.integer_fields) {
    read_field(ranks, group, field, from, rows, table.integers, column, iw);
    column += static_cast<std::size_t>(field.width);
  }
  column = 0;
  for (const StateField& field : table.real_fields) {
    read_field(ranks, group, field, from, rows, table.reals, column, table.real_width());
    column += static_cast<std::size_t>(field.width);
  }
  return table;
}

void write_input(const Communicator& ranks, hid_t file, const std::string& input) {
  const H5Handle dataset =
      write_rows(ranks, file, kInput,
                 ranks.rank() == 0 ? std::vector<std::uint8_t>(input.begin(), input.end())
                                   : std::vector<std::uint8_t>{},
                 0);
  write_text(dataset, kHash, ranks.from_first(hash_text(input)));
}

// Nobody computes with the stored case; it is read only to know that it is whole.
void check_input(const Communicator& ranks, hid_t file) {
  H5Handle dataset(H5Dopen2(file, kInput, H5P_DEFAULT), H5Dclose, "open the stored case");
  H5Handle file_space(H5Dget_space(dataset), H5Sclose, "ask a data space");
  const hssize_t size = H5Sget_simple_extent_npoints(file_space);
  if (size < 0) throw FormatError("the stored case has no size");
  const hsize_t start = 0;
  const hsize_t count = ranks.rank() == 0 ? static_cast<hsize_t>(size) : 0;
  std::string text(count, '\0');
  if (size > 0) {
    H5Handle memory_space(H5Screate_simple(1, &count, nullptr), H5Sclose, "make a data space");
    select_rows(file_space, memory_space, &start, &count);
    char nothing = 0;
    h5_agree(ranks,
             H5Dread(dataset, h5_type<std::uint8_t>(), memory_space, file_space,
                     collective_transfer(ranks), text.empty() ? &nothing : text.data()),
             "read the stored case");
  }
  check_hash(dataset, ranks.from_first(hash_text(text)));
}

}  // namespace

void write_state_file(const Communicator& ranks, const std::filesystem::path& file,
                      const State& state, const CheckpointManifest& manifest,
                      const std::string& input) {
  H5Handle h5 = create_file(ranks, file, false);
  write_number(h5, "format", kFormatVersion);
  write_number(h5, "step", manifest.step);
  write_text(h5, "case_key", manifest.case_key);
  write_text(h5, "state_hash", manifest.state_hash);
  std::string names;
  for (const StateTable& table : state) {
    write_table(ranks, h5, table);
    names += (names.empty() ? "" : " ") + table.name;
  }
  write_text(h5, "tables", names);
  write_input(ranks, h5, input);
  h5.close("finish " + file.string());
}

State read_state_file(const Communicator& ranks, const std::filesystem::path& file) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  H5Handle h5(H5Fopen(file.c_str(), H5F_ACC_RDONLY, file_access(ranks)), H5Fclose,
              "open " + file.string());
  if (read_number(h5, "format") != kFormatVersion) throw FormatError("has another format version");
  State state;
  const std::string names = read_text(h5, "tables");
  for (std::size_t from = 0; from < names.size();) {
    const std::size_t to = std::min(names.find(' ', from), names.size());
    state.push_back(read_table(ranks, h5, names.substr(from, to - from)));
    from = to + 1;
  }
  check_input(ranks, h5);
  return state;
}

}  // namespace grouser
