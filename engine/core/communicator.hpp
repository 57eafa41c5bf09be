// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/core/exact_sum.hpp"

namespace grouser {

/// Bytes on their way between ranks.
using Bytes = std::vector<std::byte>;

/// All ranks of one run. The only place that talks to MPI.
class Communicator {
 public:
  /// Ranks of MPI_COMM_WORLD; MPI must be initialised.
  Communicator();
  /// A communicator of this rank alone; every call is then local.
  static Communicator alone();

  int rank() const { return rank_; }
  int size() const { return size_; }

  /// Everything one time step has to agree on, in one message.
  struct StepTotals {
    std::vector<ExactSum> sums;
    std::vector<double> maxima;
  };
  /// Replaces each entry by its total or maximum over ranks. NaN maxima stay NaN. Collective.
  void combine(StepTotals& totals) const;

  std::int64_t sum(std::int64_t value) const;         ///< Collective.
  std::uint64_t wrap_sum(std::uint64_t value) const;  ///< modulo 2^64. Collective.
  std::int64_t max(std::int64_t value) const;         ///< Collective.
  double max(double value) const;                     ///< Collective.
  /// Sum of `value` over all lower ranks. Collective.
  std::int64_t sum_before(std::int64_t value) const;
  /// Rank 0's value. Collective.
  std::int64_t from_first(std::int64_t value) const;
  std::string from_first(const std::string& text) const;

  /// `out[r]`, a multiple of eight bytes, goes to rank r; returns what each rank sent here, by
  /// sender. Collective.
  std::vector<Bytes> exchange_all(const std::vector<Bytes>& out) const;

  /// The same among `others`, who all name this rank too: `out[k]` goes to others[k]; returns what
  /// came from each. Only those ranks need to call.
  std::vector<Bytes> exchange_with(const std::vector<int>& others,
                                   const std::vector<Bytes>& out) const;

  void barrier() const;  ///< Collective.

  /// MPI_Comm of the ranks, as an integer handle for libraries that need one (parallel HDF5).
  int fortran_handle() const { return handle_; }

 private:
  Communicator(int rank, int size, int handle);

  int rank_ = 0;
  int size_ = 1;
  int handle_ = 0;
};

/// Messages between this rank and others that travel while the rank works. All are a multiple of
/// eight bytes long, and both sides know how long.
class Messages {
 public:
  explicit Messages(const Communicator& ranks);
  Messages(Messages&&) noexcept;
  Messages& operator=(Messages&&) noexcept;
  ~Messages();

  /// Begins to fill `in`, which must stay where it is and untouched until finish(). Local.
  void receive(int from, void* in, std::size_t bytes);
  /// Begins to send `out`, likewise. Messages between the same two ranks keep their order. Local.
  void send(int to, const void* out, std::size_t bytes);
  /// Waits until all have arrived and left.
  void finish();

 private:
  struct Requests;
  std::unique_ptr<Requests> requests_;
};

/// MPI_Init and MPI_Finalize around a program's life.
class ParallelSession {
 public:
  ParallelSession(int* argc, char*** argv);
  ~ParallelSession();
  ParallelSession(const ParallelSession&) = delete;
  ParallelSession& operator=(const ParallelSession&) = delete;
};

/// Ends this rank with `code` without MPI's and other libraries' tidying up, which may not survive
/// what has happened; all ranks must come here. Collective.
[[noreturn]] void leave_at_once(const Communicator& ranks, int code);

/// Ends all ranks at once with `code`; for errors that the others cannot know of.
[[noreturn]] void abort_all_ranks(int code);

/// Appends the bytes of a plain value or array.
template <class Value>
void append_bytes(Bytes& bytes, const Value* values, std::size_t count) {
  const auto* begin = reinterpret_cast<const std::byte*>(values);
  bytes.insert(bytes.end(), begin, begin + count * sizeof(Value));
}

/// Takes plain values off the front of a message.
class ByteReader {
 public:
  explicit ByteReader(const Bytes& bytes, std::size_t at = 0) : bytes_(bytes), at_(at) {}
  bool empty() const { return at_ == bytes_.size(); }
  std::size_t position() const { return at_; }
  void skip(std::size_t size) { at_ += size; }
  template <class Value>
  void take(Value* values, std::size_t count) {
    copy(values, count * sizeof(Value));
  }

 private:
  void copy(void* target, std::size_t size);

  const Bytes& bytes_;
  std::size_t at_ = 0;
};

}  // namespace grouser
