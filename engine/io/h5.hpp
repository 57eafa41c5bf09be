// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <hdf5.h>

#include <string>
#include <utility>

#include "base/errors.hpp"

namespace grouser {

/// An HDF5 handle that closes itself. Errors of HDF5 calls become StorageError with what was done.
class H5Handle {
 public:
  using Close = herr_t (*)(hid_t);

  H5Handle() = default;  ///< of nothing
  H5Handle(hid_t id, Close closer, const std::string& doing) : id_(id), close_(closer) {
    if (id_ < 0) throw StorageError("HDF5 could not " + doing);
  }
  H5Handle(H5Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  H5Handle(const H5Handle&) = delete;
  H5Handle& operator=(const H5Handle&) = delete;
  H5Handle& operator=(H5Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~H5Handle() {
    if (id_ >= 0) close_(id_);
  }

  operator hid_t() const { return id_; }

  /// Closes now; files tell only here that their last bytes did not fit.
  void close(const std::string& doing) {
    if (close_(std::exchange(id_, -1)) < 0) throw StorageError("HDF5 could not " + doing);
  }

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

inline void h5_check(herr_t result, const std::string& doing) {
  if (result < 0) throw StorageError("HDF5 could not " + doing);
}

}  // namespace grouser
