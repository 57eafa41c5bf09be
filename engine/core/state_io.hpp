// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
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
  /// Appends this module's tables with the rows this rank owns. Collective.
  virtual void save_state(State& state) const = 0;
  /// Takes the module's tables back; rows may sit on any rank. Collective.
  virtual void load_state(const State& state) = 0;
};

/// Hash of all rows wherever they are: equal bits give equal hashes on any number of ranks.
/// Collective.
std::uint64_t hash_state(const Communicator& ranks, const State& state);

/// Hash of one table. Collective.
std::uint64_t hash_table(const Communicator& ranks, const StateTable& table);

/// First key of the block of keys that `rank` keeps in canonical order. Local.
std::int64_t first_key(std::int64_t key_count, int ranks, int rank);

/// Sends every row to the rank whose block its key is in and sorts there by (key, order), so that
/// the rows of rank 0, 1, ... one after another are the same whatever the decomposition.
/// Collective.
void sort_rows(const Communicator& ranks, StateTable& table);

}  // namespace grouser
