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

int rank_of_key(std::int64_t key, std::int64_t key_count, int ranks) {
  auto guess = static_cast<int>(key * ranks / std::max<std::int64_t>(key_count, 1));
  while (guess + 1 < ranks && key >= first_key(key_count, ranks, guess + 1)) ++guess;
  while (guess > 0 && key < first_key(key_count, ranks, guess)) --guess;
  return guess;
}

std::vector<Bytes> pack_by_key(const StateTable& table, int ranks) {
  std::vector<Bytes> out(static_cast<std::size_t>(ranks));
  const std::size_t iw = table.integer_width();
  const std::size_t rw = table.real_width();
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const std::int64_t* integers = &table.integers[row * iw];
    GROUSER_CHECK(integers[0] >= 0 && integers[0] < table.key_count);
    Bytes& to = out[static_cast<std::size_t>(rank_of_key(integers[0], table.key_count, ranks))];
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

std::uint64_t hash_table(const Communicator& ranks, const StateTable& table) {
  const std::size_t iw = table.integer_width();
  const std::size_t rw = table.real_width();
  const std::uint64_t seed = hash_bytes(table.name.data(), table.name.size());
  std::uint64_t local = 0;  // a sum, because rows come in any order
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const std::uint64_t integers =
        hash_bytes(&table.integers[row * iw], iw * sizeof(std::int64_t), seed);
    local += hash_bytes(table.reals.data() + row * rw, rw * sizeof(double), integers);
  }
  return ranks.wrap_sum(local) + seed;
}

std::uint64_t hash_state(const Communicator& ranks, const State& state) {
  std::uint64_t all = 0;
  for (const StateTable& table : state) all += hash_table(ranks, table);
  return all;
}

std::int64_t first_key(std::int64_t key_count, int ranks, int rank) {
  return key_count / ranks * rank + std::min<std::int64_t>(rank, key_count % ranks);
}

void sort_rows(const Communicator& ranks, StateTable& table) {
  const std::size_t iw = table.integer_width();
  const std::size_t rw = table.real_width();
  const std::vector<Bytes> in = ranks.exchange_all(pack_by_key(table, ranks.size()));
  std::vector<std::int64_t> integers;
  std::vector<double> reals;
  for (const Bytes& message : in) {
    ByteReader reader(message);
    while (!reader.empty()) {
      integers.resize(integers.size() + iw);
      reader.take(&integers[integers.size() - iw], iw);
      reals.resize(reals.size() + rw);
      if (rw > 0) reader.take(&reals[reals.size() - rw], rw);
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
