// SPDX-License-Identifier: BSD-3-Clause
#include "engine/core/state_io.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "base/check.hpp"
#include "base/errors.hpp"
#include "base/hash.hpp"

namespace grouser {
namespace {

// Block of `count` that has the key-th of `keys`.
int block_of(std::int64_t key, std::int64_t keys, int count) {
  auto guess = static_cast<int>(key * count / std::max<std::int64_t>(keys, 1));
  while (guess + 1 < count && key >= first_key(keys, count, guess + 1)) ++guess;
  while (guess > 0 && key < first_key(keys, count, guess)) --guess;
  return guess;
}

std::vector<Bytes> pack_by_key(const StateTable& table, int ranks, const StatePiece& piece) {
  std::vector<Bytes> out(static_cast<std::size_t>(ranks));
  const std::size_t iw = table.integer_width();
  const std::size_t rw = table.real_width();
  const std::int64_t begin = piece.begin(table.key_count);
  const std::int64_t keys = piece.end(table.key_count) - begin;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const std::int64_t* integers = &table.integers[row * iw];
    GROUSER_CHECK(piece.has(integers[0], table.key_count));
    Bytes& to = out[static_cast<std::size_t>(block_of(integers[0] - begin, keys, ranks))];
    append_bytes(to, integers, iw);
    append_bytes(to, table.reals.data() + row * rw, rw);
  }
  return out;
}

}  // namespace

std::size_t StateTable::integer_width() const {
  std::size_t width = 2;
  for (const StateField& field : integer_fields) width += static_cast<std::size_t>(field.width);
  return width;
}

std::size_t StateTable::real_width() const {
  std::size_t width = 0;
  for (const StateField& field : real_fields) width += static_cast<std::size_t>(field.width);
  return width;
}

const StateTable& table_of(const State& state, const std::string& name) {
  for (const StateTable& table : state)
    if (table.name == name) return table;
  throw FormatError("the checkpoint has no table '" + name + "'");
}

std::vector<double> first_row(const Communicator& ranks, const StateTable& table) {
  Communicator::StepTotals totals;  // known on one rank: a maximum spreads it
  totals.maxima.assign(table.real_width(), -std::numeric_limits<double>::infinity());
  if (table.rows() > 0) std::copy_n(table.reals.begin(), table.real_width(), totals.maxima.begin());
  ranks.combine(totals);
  return totals.maxima;
}

void StateHash::add(const StateTable& rows) {
  const std::size_t iw = rows.integer_width();
  const std::size_t rw = rows.real_width();
  const std::uint64_t seed = hash_bytes(rows.name.data(), rows.name.size());
  tables_[rows.name] = seed;
  for (std::size_t row = 0; row < rows.rows(); ++row) {
    const std::uint64_t integers =
        hash_bytes(&rows.integers[row * iw], iw * sizeof(std::int64_t), seed);
    // A sum, because rows come in any order.
    rows_ += hash_bytes(rows.reals.data() + row * rw, rw * sizeof(double), integers);
  }
}

std::uint64_t StateHash::value(const Communicator& ranks) const {
  std::uint64_t all = ranks.wrap_sum(rows_);
  for (const auto& [name, seed] : tables_) all += seed;
  return all;
}

std::uint64_t hash_state(const Communicator& ranks, const State& state) {
  StateHash hash;
  for (const StateTable& table : state) hash.add(table);
  return hash.value(ranks);
}

std::int64_t first_key(std::int64_t key_count, std::int64_t count, std::int64_t index) {
  return key_count / count * index + std::min(index, key_count % count);
}

void sort_rows(const Communicator& ranks, StateTable& table, const StatePiece& piece) {
  const std::size_t iw = table.integer_width();
  const std::size_t rw = table.real_width();
  std::vector<std::int64_t> integers;
  std::vector<double> reals;
  if (ranks.size() == 1) {
    integers.swap(table.integers);
    reals.swap(table.reals);
  } else {
    const std::vector<Bytes> in = ranks.exchange_all(pack_by_key(table, ranks.size(), piece));
    table.integers = {};
    table.reals = {};
    for (const Bytes& message : in) {
      ByteReader reader(message);
      while (!reader.empty()) {
        integers.resize(integers.size() + iw);
        reader.take(&integers[integers.size() - iw], iw);
        reals.resize(reals.size() + rw);
        if (rw > 0) reader.take(&reals[reals.size() - rw], rw);
      }
    }
  }
  std::vector<std::size_t> order(integers.size() / iw);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(integers[a * iw], integers[a * iw + 1]) <
           std::pair(integers[b * iw], integers[b * iw + 1]);
  });
  table.integers.clear();
  table.reals.clear();
  table.integers.reserve(integers.size());
  table.reals.reserve(reals.size());
  for (const std::size_t row : order) {
    const auto i = integers.begin() + static_cast<std::ptrdiff_t>(row * iw);
    table.integers.insert(table.integers.end(), i, i + static_cast<std::ptrdiff_t>(iw));
    const auto r = reals.begin() + static_cast<std::ptrdiff_t>(row * rw);
    table.reals.insert(table.reals.end(), r, r + static_cast<std::ptrdiff_t>(rw));
  }
}

}  // namespace grouser
