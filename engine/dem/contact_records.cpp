// SPDX-License-Identifier: BSD-3-Clause
#include "engine/dem/contact_records.hpp"

namespace grouser {

void ContactRecords::add(const std::int64_t* names, const double* values) {
  names_.insert(names_.end(), names, names + name_width_);
  values_.insert(values_.end(), values, values + value_width_);
}

void ContactRecords::copy_particle(const ContactRecords& other, std::size_t i) {
  for (std::size_t record = other.begin(i); record < other.end(i); ++record)
    add(other.names(record), other.values(record));
  close_particle();
}

void ContactRecords::pack(std::size_t i, Bytes& bytes) const {
  const std::size_t count = end(i) - begin(i);
  append_bytes(bytes, &count, 1);
  append_bytes(bytes, names_.data() + begin(i) * name_width_, count * name_width_);
  append_bytes(bytes, values_.data() + begin(i) * value_width_, count * value_width_);
}

void ContactRecords::unpack(ByteReader& reader) {
  std::size_t count = 0;
  reader.take(&count, 1);
  const std::size_t names = names_.size();
  const std::size_t values = values_.size();
  names_.resize(names + count * name_width_);
  values_.resize(values + count * value_width_);
  reader.take(names_.data() + names, count * name_width_);
  reader.take(values_.data() + values, count * value_width_);
  close_particle();
}

}  // namespace grouser
