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

// Rows of a table that are read at a time, by all ranks together and per rank.
constexpr std::int64_t kRowsAtATime = 1 << 20;

// Hash of a dataset, the same however its rows are spread and cut: every row counts with its place.
class RowsHash {
 public:
  template <class Number>
  void add(std::int64_t first, const std::vector<Number>& values, std::size_t width) {
    for (std::size_t row = 0; row * width < values.size(); ++row)
      sum_ += hash_bytes(values.data() + row * width, width * sizeof(Number),
                         static_cast<std::uint64_t>(first) + row);
  }
  std::string text(const Communicator& ranks) const { return hex(ranks.wrap_sum(sum_)); }

 private:
  std::uint64_t sum_ = 0;
};

void check_hash(hid_t dataset, const std::string& found) {
  if (read_text(dataset, kHash) == found) return;
  std::string path(256, '\0');
  path.resize(static_cast<std::size_t>(
      std::max<ssize_t>(0, H5Iget_name(dataset, path.data(), path.size()))));
  throw FormatError("dataset " + path + " does not have the hash written with it");
}

const StateField kKey{"key", "1", 1};
const StateField kOrder{"order", "1", 1};

// A field of a table and its place among the columns of a row.
struct Column {
  StateField field;
  bool is_integer = false;
  std::size_t at = 0;
  H5Handle dataset;
  RowsHash hash;

  std::size_t width() const { return static_cast<std::size_t>(field.width); }
};

std::vector<Column> columns_of(const StateTable& table) {
  std::vector<Column> columns;
  const auto add = [&](const StateField& field, bool is_integer, std::size_t at) {
    columns.push_back({field, is_integer, at, {}, {}});
    return at + columns.back().width();
  };
  std::size_t at = add(kOrder, true, add(kKey, true, 0));
  for (const StateField& field : table.integer_fields) at = add(field, true, at);
  at = 0;
  for (const StateField& field : table.real_fields) at = add(field, false, at);
  return columns;
}

std::string names_of(const std::vector<StateField>& fields) {
  std::string names;
  for (const StateField& field : fields) names += (names.empty() ? "" : " ") + field.name;
  return names;
}

// One table of a file being written.
class TableWriter {
 public:
  TableWriter(hid_t file, const StateTable& table)
      : group_(H5Gcreate2(file, table.name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
               H5Gclose, "make group " + table.name),
        all_rows_(table.all_rows),
        columns_(columns_of(table)) {
    write_number(group_, "key_count", table.key_count);
    write_number(group_, "rows", all_rows_);
    write_text(group_, "integer_fields", names_of(table.integer_fields));
    write_text(group_, "real_fields", names_of(table.real_fields));
    for (Column& column : columns_) {
      const std::string& name = column.field.name;
      column.dataset = column.is_integer
                           ? make_rows<std::int64_t>(group_, name, all_rows_, column.width())
                           : make_rows<double>(group_, name, all_rows_, column.width());
      write_text(column.dataset, "unit", column.field.unit);
    }
  }

  void add(const Communicator& ranks, const StateTable& piece) {
    const std::int64_t rows = ranks.sum(static_cast<std::int64_t>(piece.rows()));
    if (written_ + rows > all_rows_) throw StorageError("a table has more rows than it told");
    for (Column& column : columns_) {
      if (column.is_integer) {
        write(ranks, column, piece.rows(), piece.integers, piece.integer_width());
      } else {
        write(ranks, column, piece.rows(), piece.reals, piece.real_width());
      }
    }
    written_ += rows;
  }

  void finish(const Communicator& ranks) {
    if (written_ != all_rows_) throw StorageError("a table has fewer rows than it told");
    for (Column& column : columns_) write_text(column.dataset, kHash, column.hash.text(ranks));
  }

 private:
  template <class Number>
  void write(const Communicator& ranks, Column& column, std::size_t rows,
             const std::vector<Number>& values, std::size_t row_width) {
    std::vector<Number> block(rows * column.width());
    for (std::size_t row = 0; row < rows; ++row)
      std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(row * row_width + column.at),
                  column.width(),
                  block.begin() + static_cast<std::ptrdiff_t>(row * column.width()));
    write_rows_at(ranks, column.dataset, written_, block, column.width());
    column.hash.add(written_ + ranks.sum_before(static_cast<std::int64_t>(rows)), block,
                    column.width());
  }

  H5Handle group_;
  std::int64_t all_rows_;
  std::int64_t written_ = 0;
  std::vector<Column> columns_;
};

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

// One table of a file being read.
class TableReader {
 public:
  TableReader(hid_t file, const std::string& name)
      : group_(H5Gopen2(file, name.c_str(), H5P_DEFAULT), H5Gclose, "open group " + name) {
    table_.name = name;
    table_.key_count = read_number(group_, "key_count");
    table_.all_rows = read_number(group_, "rows");
    table_.integer_fields = read_fields_of(group_, "integer_fields");
    table_.real_fields = read_fields_of(group_, "real_fields");
    if (table_.all_rows < 0 || table_.key_count < 0)
      throw FormatError("table " + name + " has a negative size");
    columns_ = columns_of(table_);
    for (Column& column : columns_) {
      const std::string& dataset = column.field.name;
      column.dataset = {H5Dopen2(group_, dataset.c_str(), H5P_DEFAULT), H5Dclose,
                        "open dataset " + dataset};
    }
  }

  // Any split of the rows over ranks will do: modules send them to where they belong.
  template <class Visit>
  void each_piece(const Communicator& ranks, const Visit& visit) {
    const std::int64_t pieces =
        std::max<std::int64_t>(1, table_.all_rows / (kRowsAtATime * ranks.size()));
    for (std::int64_t index = 0; index < pieces; ++index) {
      const StatePiece piece{index, pieces};
      const std::int64_t begin = piece.begin(table_.all_rows);
      const std::int64_t rows = piece.end(table_.all_rows) - begin;
      const std::int64_t first = begin + first_key(rows, ranks.size(), ranks.rank());
      const std::int64_t last = begin + first_key(rows, ranks.size(), ranks.rank() + 1);
      const auto own = static_cast<std::size_t>(last - first);
      table_.integers.resize(own * table_.integer_width());
      table_.reals.resize(own * table_.real_width());
      for (Column& column : columns_) {
        if (column.is_integer) {
          read(ranks, column, first, own, table_.integers, table_.integer_width());
        } else {
          read(ranks, column, first, own, table_.reals, table_.real_width());
        }
      }
      visit(table_);
    }
    for (const Column& column : columns_) check_hash(column.dataset, column.hash.text(ranks));
  }

 private:
  template <class Number>
  void read(const Communicator& ranks, Column& column, std::int64_t first, std::size_t rows,
            std::vector<Number>& values, std::size_t row_width) {
    if (table_.all_rows == 0) return;
    const std::size_t width = column.width();
    std::vector<Number> block(rows * width);
    H5Handle file_space(H5Dget_space(column.dataset), H5Sclose, "ask a data space");
    const hsize_t start[2] = {static_cast<hsize_t>(first), 0};
    const hsize_t count[2] = {rows, width};
    H5Handle memory_space(H5Screate_simple(2, count, nullptr), H5Sclose, "make a data space");
    select_rows(file_space, memory_space, start, count);
    Number nothing{};
    h5_agree(ranks,
             H5Dread(column.dataset, h5_type<Number>(), memory_space, file_space,
                     collective_transfer(ranks), rows > 0 ? block.data() : &nothing),
             "read dataset " + column.field.name);
    column.hash.add(first, block, width);
    for (std::size_t row = 0; row < rows; ++row)
      std::copy_n(block.begin() + static_cast<std::ptrdiff_t>(row * width), width,
                  values.begin() + static_cast<std::ptrdiff_t>(row * row_width + column.at));
  }

  H5Handle group_;
  StateTable table_;
  std::vector<Column> columns_;
};

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

std::uint64_t write_state_file(const Communicator& ranks, const std::filesystem::path& file,
                               const StateSource& source, std::int64_t pieces,
                               const CheckpointManifest& manifest, const std::string& input) {
  H5Handle h5 = create_file(ranks, file, false);
  write_number(h5, "format", kFormatVersion);
  write_number(h5, "step", manifest.step);
  write_text(h5, "case_key", manifest.case_key);
  StateHash hash;
  std::vector<TableWriter> writers;
  std::string names;
  for (std::int64_t index = 0; index < pieces; ++index) {
    const StatePiece piece{index, pieces};
    State state = source(piece);
    for (std::size_t t = 0; t < state.size(); ++t) {
      sort_rows(ranks, state[t], piece);
      if (index == 0) {
        writers.emplace_back(h5, state[t]);
        names += (names.empty() ? "" : " ") + state[t].name;
      }
      writers[t].add(ranks, state[t]);
      hash.add(state[t]);
      state[t] = StateTable{};  // the next table's copies need the room
    }
  }
  for (TableWriter& writer : writers) writer.finish(ranks);
  writers.clear();
  const std::uint64_t value = hash.value(ranks);
  write_text(h5, "state_hash", hex(value));
  write_text(h5, "tables", names);
  write_input(ranks, h5, input);
  h5.close("finish " + file.string());
  return value;
}

std::uint64_t read_state_file(const Communicator& ranks, const std::filesystem::path& file,
                              const RowSink& sink) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  H5Handle h5(H5Fopen(file.c_str(), H5F_ACC_RDONLY, file_access(ranks)), H5Fclose,
              "open " + file.string());
  if (read_number(h5, "format") != kFormatVersion) throw FormatError("has another format version");
  StateHash hash;
  const std::string names = read_text(h5, "tables");
  for (std::size_t from = 0; from < names.size();) {
    const std::size_t to = std::min(names.find(' ', from), names.size());
    TableReader(h5, names.substr(from, to - from)).each_piece(ranks, [&](const StateTable& rows) {
      hash.add(rows);
      sink(rows);
    });
    from = to + 1;
  }
  check_input(ranks, h5);
  return hash.value(ranks);
}

}  // namespace grouser
