// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "engine/core/communicator.hpp"

namespace grouser {

/// Contact histories listed by particle, on the move: between two neighbour lists, between ranks,
/// or to and from a checkpoint. Each record has a few integers that name the partner and the law's
/// history as plain numbers.
class ContactRecords {
 public:
  ContactRecords(std::size_t name_width, std::size_t value_width)
      : name_width_(name_width), value_width_(value_width) {}

  std::size_t name_width() const { return name_width_; }
  std::size_t value_width() const { return value_width_; }
  std::size_t particles() const { return start_.size() - 1; }
  std::size_t records() const { return start_.back(); }

  /// Records of particle `i` are begin(i) ... end(i)-1.
  std::size_t begin(std::size_t i) const { return start_[i]; }
  std::size_t end(std::size_t i) const { return start_[i + 1]; }
  const std::int64_t* names(std::size_t record) const { return &names_[record * name_width_]; }
  const double* values(std::size_t record) const { return values_.data() + record * value_width_; }

  /// Adds a record to the particle being listed.
  void add(const std::int64_t* names, const double* values);
  /// Ends the records of one particle.
  void close_particle() { start_.push_back(names_.size() / name_width_); }
  /// Lists particle `i` of `other` next, with its records.
  void copy_particle(const ContactRecords& other, std::size_t i);

  void pack(std::size_t i, Bytes& bytes) const;
  /// Lists the packed particle next.
  void unpack(ByteReader& reader);

 private:
  std::size_t name_width_;
  std::size_t value_width_;
  std::vector<std::size_t> start_{0};
  std::vector<std::int64_t> names_;
  std::vector<double> values_;
};

}  // namespace grouser
