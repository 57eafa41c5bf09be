// SPDX-License-Identifier: BSD-3-Clause
#include "engine/core/communicator.hpp"

#include <mpi.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "base/check.hpp"

namespace grouser {
namespace {

MPI_Comm comm_of(int handle) { return MPI_Comm_f2c(handle); }

int as_count(std::size_t bytes) {
  GROUSER_CHECK(bytes <= static_cast<std::size_t>(std::numeric_limits<int>::max()));
  return static_cast<int>(bytes);
}

constexpr std::size_t kWord = sizeof(std::int64_t);

std::size_t words_in(std::size_t bytes) {
  GROUSER_CHECK(bytes % kWord == 0);
  return bytes / kWord;
}

// Message of combine(): number of sums, number of maxima, then the words themselves. The layout
// describes itself because an MPI operator gets no context.
void combine_words(void* in, void* inout, int* length, MPI_Datatype*) {
  const auto* from = static_cast<const std::int64_t*>(in);
  auto* to = static_cast<std::int64_t*>(inout);
  // The operator is called with whole messages: one element of a contiguous type.
  for (int element = 0; element < *length; ++element) {
    const std::int64_t sums = from[0];
    const std::int64_t maxima = from[1];
    for (std::int64_t i = 2; i < 2 + sums; ++i) to[i] += from[i];
    for (std::int64_t i = 2 + sums; i < 2 + sums + maxima; ++i) {
      double a = 0.0;
      double b = 0.0;
      std::memcpy(&a, &from[i], sizeof a);
      std::memcpy(&b, &to[i], sizeof b);
      if (std::isnan(a) || a > b) std::memcpy(&to[i], &a, sizeof a);
    }
    from += 2 + sums + maxima;
    to += 2 + sums + maxima;
  }
}

}  // namespace

Communicator::Communicator(int rank, int size, int handle)
    : rank_(rank), size_(size), handle_(handle) {}

Communicator::Communicator() : handle_(MPI_Comm_c2f(MPI_COMM_WORLD)) {
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
}

Communicator Communicator::alone() {
  return Communicator(0, 1, static_cast<int>(MPI_Comm_c2f(MPI_COMM_SELF)));
}

void Communicator::combine(StepTotals& totals) const {
  if (size_ == 1) return;
  constexpr std::size_t kLimbs = std::tuple_size_v<ExactSum::Limbs>;
  const std::size_t sums = totals.sums.size() * kLimbs;
  std::vector<std::int64_t> words(2 + sums + totals.maxima.size());
  words[0] = static_cast<std::int64_t>(sums);
  words[1] = static_cast<std::int64_t>(totals.maxima.size());
  for (std::size_t i = 0; i < totals.sums.size(); ++i) {
    const ExactSum::Limbs limbs = totals.sums[i].limbs();
    std::copy(limbs.begin(), limbs.end(),
              words.begin() + static_cast<std::ptrdiff_t>(2 + i * kLimbs));
  }
  if (!totals.maxima.empty())
    std::memcpy(&words[2 + sums], totals.maxima.data(), totals.maxima.size() * sizeof(double));

  static const MPI_Op op = [] {
    MPI_Op made;
    MPI_Op_create(combine_words, 1, &made);
    return made;
  }();
  MPI_Datatype message;
  MPI_Type_contiguous(as_count(words.size()), MPI_INT64_T, &message);
  MPI_Type_commit(&message);
  MPI_Allreduce(MPI_IN_PLACE, words.data(), 1, message, op, comm_of(handle_));
  MPI_Type_free(&message);

  for (std::size_t i = 0; i < totals.sums.size(); ++i) {
    ExactSum::Limbs limbs;
    std::copy_n(words.begin() + static_cast<std::ptrdiff_t>(2 + i * kLimbs), kLimbs, limbs.begin());
    totals.sums[i] = ExactSum::from_limbs(limbs);
  }
  if (!totals.maxima.empty())
    std::memcpy(totals.maxima.data(), &words[2 + sums], totals.maxima.size() * sizeof(double));
}

std::int64_t Communicator::sum(std::int64_t value) const {
  if (size_ > 1) MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_INT64_T, MPI_SUM, comm_of(handle_));
  return value;
}

std::uint64_t Communicator::wrap_sum(std::uint64_t value) const {
  if (size_ > 1) MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_UINT64_T, MPI_SUM, comm_of(handle_));
  return value;
}

std::int64_t Communicator::max(std::int64_t value) const {
  if (size_ > 1) MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_INT64_T, MPI_MAX, comm_of(handle_));
  return value;
}

double Communicator::max(double value) const {
  if (size_ > 1) MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MAX, comm_of(handle_));
  return value;
}

std::int64_t Communicator::sum_before(std::int64_t value) const {
  std::int64_t before = 0;
  if (size_ > 1) MPI_Exscan(&value, &before, 1, MPI_INT64_T, MPI_SUM, comm_of(handle_));
  return rank_ == 0 ? 0 : before;  // MPI leaves rank 0's result undefined
}

std::int64_t Communicator::from_first(std::int64_t value) const {
  if (size_ > 1) MPI_Bcast(&value, 1, MPI_INT64_T, 0, comm_of(handle_));
  return value;
}

std::string Communicator::from_first(const std::string& text) const {
  std::string out = text;
  out.resize(static_cast<std::size_t>(from_first(static_cast<std::int64_t>(text.size()))));
  if (size_ > 1) MPI_Bcast(out.data(), as_count(out.size()), MPI_BYTE, 0, comm_of(handle_));
  return out;
}

std::vector<Bytes> Communicator::exchange_all(const std::vector<Bytes>& out) const {
  GROUSER_CHECK(out.size() == static_cast<std::size_t>(size_));
  if (size_ == 1) return out;
  const auto ranks = static_cast<std::size_t>(size_);
  std::vector<int> out_count(ranks), in_count(ranks), out_at(ranks), in_at(ranks);
  // Counted in words of eight bytes, which all messages are made of: MPI counts with 31 bits.
  for (std::size_t r = 0; r < ranks; ++r) out_count[r] = as_count(words_in(out[r].size()));
  MPI_Alltoall(out_count.data(), 1, MPI_INT, in_count.data(), 1, MPI_INT, comm_of(handle_));
  std::size_t out_total = 0;
  std::size_t in_total = 0;
  for (std::size_t r = 0; r < ranks; ++r) {
    out_at[r] = as_count(out_total);
    in_at[r] = as_count(in_total);
    out_total += static_cast<std::size_t>(out_count[r]);
    in_total += static_cast<std::size_t>(in_count[r]);
  }
  Bytes send;
  send.reserve(out_total * kWord);
  for (const Bytes& part : out) send.insert(send.end(), part.begin(), part.end());
  Bytes receive(in_total * kWord);
  MPI_Alltoallv(send.data(), out_count.data(), out_at.data(), MPI_INT64_T, receive.data(),
                in_count.data(), in_at.data(), MPI_INT64_T, comm_of(handle_));
  std::vector<Bytes> in(ranks);
  for (std::size_t r = 0; r < ranks; ++r) {
    const auto from = receive.begin() + std::ptrdiff_t{in_at[r]} * std::ptrdiff_t{kWord};
    in[r].assign(from, from + std::ptrdiff_t{in_count[r]} * std::ptrdiff_t{kWord});
  }
  return in;
}

std::vector<Bytes> Communicator::exchange_with(const std::vector<int>& others,
                                               const std::vector<Bytes>& out) const {
  GROUSER_CHECK(out.size() == others.size());
  std::vector<std::size_t> out_bytes, in_bytes(others.size());
  Messages messages(*this);
  for (const Bytes& part : out) out_bytes.push_back(part.size());
  for (std::size_t k = 0; k < others.size(); ++k)
    messages.receive(others[k], &in_bytes[k], sizeof in_bytes[k]);
  for (std::size_t k = 0; k < others.size(); ++k)
    messages.send(others[k], &out_bytes[k], sizeof out_bytes[k]);
  messages.finish();
  std::vector<Bytes> in(others.size());
  for (std::size_t k = 0; k < others.size(); ++k) {
    in[k].resize(in_bytes[k]);
    messages.receive(others[k], in[k].data(), in[k].size());
  }
  for (std::size_t k = 0; k < others.size(); ++k)
    messages.send(others[k], out[k].data(), out[k].size());
  messages.finish();
  return in;
}

void Communicator::barrier() const {
  if (size_ > 1) MPI_Barrier(comm_of(handle_));
}

struct Messages::Requests {
  MPI_Comm ranks;
  std::vector<MPI_Request> all;
};

namespace {

constexpr int kTag = 1;

}  // namespace

Messages::Messages(const Communicator& ranks)
    : requests_(std::make_unique<Requests>(Requests{comm_of(ranks.fortran_handle()), {}})) {}
Messages::Messages(Messages&&) noexcept = default;
Messages& Messages::operator=(Messages&&) noexcept = default;
Messages::~Messages() = default;

void Messages::receive(int from, void* in, std::size_t bytes) {
  if (bytes == 0) return;
  MPI_Irecv(in, as_count(words_in(bytes)), MPI_INT64_T, from, kTag, requests_->ranks,
            &requests_->all.emplace_back());
}

void Messages::send(int to, const void* out, std::size_t bytes) {
  if (bytes == 0) return;
  MPI_Isend(out, as_count(words_in(bytes)), MPI_INT64_T, to, kTag, requests_->ranks,
            &requests_->all.emplace_back());
}

void Messages::finish() {
  MPI_Waitall(static_cast<int>(requests_->all.size()), requests_->all.data(), MPI_STATUSES_IGNORE);
  requests_->all.clear();
}

ParallelSession::ParallelSession(int* argc, char*** argv) {
  // Only the first thread of a rank talks to MPI.
  int provided = MPI_THREAD_SINGLE;
  MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &provided);
}
ParallelSession::~ParallelSession() { MPI_Finalize(); }

void leave_at_once(const Communicator& ranks, int code) {
  ranks.barrier();
  std::_Exit(code);
}

void abort_all_ranks(int code) {
  MPI_Abort(MPI_COMM_WORLD, code);
  std::abort();
}

void ByteReader::copy(void* target, std::size_t size) {
  GROUSER_CHECK(size <= bytes_.size() - at_);
  if (size > 0) std::memcpy(target, bytes_.data() + at_, size);
  at_ += size;
}

}  // namespace grouser
