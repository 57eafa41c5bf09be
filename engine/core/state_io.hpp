// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "engine/core/communicator.hpp"

namespace grouser {

/// One column group of a state table: a scalar or vector quantity per row.
struct StateField {
  std::string name;  ///< dataset name in a checkpoint
  std::string unit;  ///< UDUNITS-2 unit, "1" for pure numbers
  int width = 1;     ///< components per row
};

/// First key of the block of keys that block `index` of `count` has. Local.
std::int64_t first_key(std::int64_t key_count, std::int64_t count, std::int64_t index);

/// A share of a state: the rows whose keys are in one of `count` blocks of their table's keys. A
/// large state is saved piece by piece, so that it never stands in memory as a whole.
struct StatePiece {
  std::int64_t index = 0;
  std::int64_t count = 1;

  std::int64_t begin(std::int64_t key_count) const { return first_key(key_count, count, index); }
  std::int64_t end(std::int64_t key_count) const { return first_key(key_count, count, index + 1); }
  bool has(std::int64_t key, std::int64_t key_count) const {
    return key >= begin(key_count) && key < end(key_count);
  }
};

/// Rows of state, spread over ranks in any way. A module describes all it must remember as tables;
/// checkpoint files, restart and the state hash follow from that without knowing the module.
/// Every row starts with two integers that order it: `key` (the particle id, or a row number for
/// tables of a few rows, which are then spread too) and `order` within the key, e.g. the partner's
/// id. (key, order) pairs are unique over all ranks.
struct StateTable {
  std::string name;                        ///< group name in a checkpoint
  std::vector<StateField> integer_fields;  ///< beyond key and order
  std::vector<StateField> real_fields;
  std::int64_t key_count = 0;          ///< keys run from 0 to key_count - 1
  std::int64_t all_rows = 0;           ///< over all ranks and pieces
  std::vector<std::int64_t> integers;  ///< rows x (2 + integer widths)
  std::vector<double> reals;           ///< rows x real widths

  std::size_t integer_width() const;  ///< per row, key and order included
  std::size_t real_width() const;
  std::size_t rows() const { return integers.size() / integer_width(); }
};

/// All tables of a run.
using State = std::vector<StateTable>;

/// The table called `name`. @throws FormatError when the state has none. Local.
const StateTable& table_of(const State& state, const std::string& name);

/// The real columns of the row with key 0, known to one rank, on every rank. Collective.
std::vector<double> first_row(const Communicator& ranks, const StateTable& table);

/// What a module must offer to be part of checkpoints and restarts.
class Stateful {
 public:
  virtual ~Stateful() = default;
  /// Appends this module's tables with those rows of the piece that this rank owns; every piece has
  /// all tables. Collective.
  virtual void save_state(State& state, const StatePiece& piece = {}) const = 0;

  /// Forgets what it has, before its tables come back through load_rows.
  virtual void begin_load() = 0;
  /// Takes rows back; they may sit on any rank. Tables come in the order they were saved, each in
  /// one or more pieces by rising key; those of other modules are passed over. Collective.
  virtual void load_rows(const StateTable& rows) = 0;
  /// @throws FormatError on every rank when what came does not fit together. Collective.
  virtual void end_load() = 0;

  /// All of it at once. Collective.
  void load_state(const State& state) {
    begin_load();
    for (const StateTable& table : state) load_rows(table);
    end_load();
  }
};

/// Hash of a state that comes in pieces. Equal rows give equal hashes on any number of ranks, in
/// any pieces, in any order.
class StateHash {
 public:
  void add(const StateTable& rows);                      ///< Local.
  std::uint64_t value(const Communicator& ranks) const;  ///< Collective.

 private:
  std::uint64_t rows_ = 0;
  std::map<std::string, std::uint64_t> tables_;
};

/// Hash of all rows wherever they are: equal bits give equal hashes on any number of ranks.
/// Collective.
std::uint64_t hash_state(const Communicator& ranks, const State& state);

/// Sends every row to the rank whose block of the piece's keys its key is in and sorts there by
/// (key, order), so that the rows of rank 0, 1, ... one after another are the same whatever the
/// decomposition. Collective.
void sort_rows(const Communicator& ranks, StateTable& table, const StatePiece& piece = {});

}  // namespace grouser
