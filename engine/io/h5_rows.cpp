// SPDX-License-Identifier: BSD-3-Clause
#include "engine/io/h5_rows.hpp"

#include <algorithm>

namespace grouser {

template <>
hid_t h5_type<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
hid_t h5_type<float>() {
  return H5T_NATIVE_FLOAT;
}
template <>
hid_t h5_type<std::int64_t>() {
  return H5T_NATIVE_INT64;
}
template <>
hid_t h5_type<std::uint8_t>() {
  return H5T_NATIVE_UINT8;
}

H5Handle file_access(const Communicator& ranks) {
  H5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "prepare file access");
  if (ranks.size() > 1)
    h5_check(H5Pset_fapl_mpio(access, MPI_Comm_f2c(ranks.fortran_handle()), MPI_INFO_NULL),
             "prepare parallel access");
  return access;
}

H5Handle collective_transfer(const Communicator& ranks) {
  H5Handle transfer(H5Pcreate(H5P_DATASET_XFER), H5Pclose, "prepare a transfer");
  if (ranks.size() > 1)
    h5_check(H5Pset_dxpl_mpio(transfer, H5FD_MPIO_COLLECTIVE), "prepare a collective transfer");
  return transfer;
}

void h5_agree(const Communicator& ranks, herr_t result, const std::string& doing) {
  h5_check(ranks.max(std::int64_t{result < 0 ? 1 : 0}) != 0 ? -1 : 0, doing);
}

H5Handle create_file(const Communicator& ranks, const std::filesystem::path& file, bool replace) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  return {H5Fcreate(file.c_str(), replace ? H5F_ACC_TRUNC : H5F_ACC_EXCL, H5P_DEFAULT,
                    file_access(ranks)),
          H5Fclose, "create " + file.string()};
}

void write_text(hid_t place, const char* name, const std::string& text) {
  H5Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "make a text type");
  h5_check(H5Tset_size(type, std::max<std::size_t>(1, text.size())), "size a text type");
  h5_check(H5Tset_strpad(type, H5T_STR_NULLPAD), "size a text type");  // the last byte counts
  H5Handle space(H5Screate(H5S_SCALAR), H5Sclose, "make a scalar");
  H5Handle attribute(H5Acreate2(place, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                     std::string("make attribute ") + name);
  h5_check(H5Awrite(attribute, type, text.empty() ? "" : text.data()),
           std::string("write attribute ") + name);
}

void write_numbers(hid_t place, const char* name, const std::vector<std::int64_t>& values) {
  const hsize_t count = values.size();
  H5Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose, "make a data space");
  H5Handle attribute(H5Acreate2(place, name, H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT),
                     H5Aclose, std::string("make attribute ") + name);
  h5_check(H5Awrite(attribute, H5T_NATIVE_INT64, values.data()),
           std::string("write attribute ") + name);
}

void write_reals(hid_t place, const char* name, const std::vector<double>& values) {
  const hsize_t count = values.size();
  H5Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose, "make a data space");
  H5Handle attribute(H5Acreate2(place, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT),
                     H5Aclose, std::string("make attribute ") + name);
  h5_check(H5Awrite(attribute, H5T_NATIVE_DOUBLE, values.data()),
           std::string("write attribute ") + name);
}

void write_number(hid_t place, const char* name, std::int64_t value) {
  H5Handle space(H5Screate(H5S_SCALAR), H5Sclose, "make a scalar");
  H5Handle attribute(H5Acreate2(place, name, H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT),
                     H5Aclose, std::string("make attribute ") + name);
  h5_check(H5Awrite(attribute, H5T_NATIVE_INT64, &value), std::string("write attribute ") + name);
}

void select_rows(hid_t file_space, hid_t memory_space, const hsize_t* start, const hsize_t* count) {
  if (count[0] > 0) {
    h5_check(H5Sselect_hyperslab(file_space, H5S_SELECT_SET, start, nullptr, count, nullptr),
             "select rows");
  } else {
    h5_check(H5Sselect_none(file_space), "select no rows");
    h5_check(H5Sselect_none(memory_space), "select no rows");
  }
}

template <class Number>
H5Handle make_rows(hid_t group, const std::string& name, std::int64_t rows, std::size_t width) {
  const hsize_t extent[2] = {static_cast<hsize_t>(rows), width};
  H5Handle space(H5Screate_simple(width == 0 ? 1 : 2, extent, nullptr), H5Sclose,
                 "make a data space");
  // No times: the same rows make the same file.
  H5Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "prepare a dataset");
  h5_check(H5Pset_obj_track_times(properties, false), "prepare a dataset");
  return {H5Dcreate2(group, name.c_str(), h5_type<Number>(), space, H5P_DEFAULT, properties,
                     H5P_DEFAULT),
          H5Dclose, "make dataset " + name};
}

template <class Number>
void write_rows_at(const Communicator& ranks, hid_t dataset, std::int64_t first,
                   const std::vector<Number>& values, std::size_t width) {
  const hsize_t columns = std::max<std::size_t>(width, 1);
  const auto rows = static_cast<std::int64_t>(values.size() / columns);
  const std::int64_t before = first + ranks.sum_before(rows);
  if (ranks.sum(rows) == 0) return;  // HDF5 1.10 cannot write nothing together
  const hsize_t start[2] = {static_cast<hsize_t>(before), 0};
  const hsize_t count[2] = {static_cast<hsize_t>(rows), columns};
  H5Handle file_space(H5Dget_space(dataset), H5Sclose, "ask a data space");
  H5Handle memory_space(H5Screate_simple(width == 0 ? 1 : 2, count, nullptr), H5Sclose,
                        "make a data space");
  select_rows(file_space, memory_space, start, count);
  const Number nothing{};
  h5_agree(ranks,
           H5Dwrite(dataset, h5_type<Number>(), memory_space, file_space,
                    collective_transfer(ranks), rows > 0 ? values.data() : &nothing),
           "write a dataset");
}

template <class Number>
H5Handle write_rows(const Communicator& ranks, hid_t group, const std::string& name,
                    const std::vector<Number>& values, std::size_t width) {
  const auto rows = static_cast<std::int64_t>(values.size() / std::max<std::size_t>(width, 1));
  H5Handle dataset = make_rows<Number>(group, name, ranks.sum(rows), width);
  write_rows_at(ranks, dataset, 0, values, width);
  return dataset;
}

void write_layers(const Communicator& ranks, hid_t group, const std::string& name,
                  const std::vector<float>& values, const std::array<std::int64_t, 3>& cells,
                  std::size_t width) {
  const int dimensions = width == 0 ? 3 : 4;
  hsize_t extent[4] = {static_cast<hsize_t>(cells[2]), static_cast<hsize_t>(cells[1]),
                       static_cast<hsize_t>(cells[0]), width};
  H5Handle space(H5Screate_simple(dimensions, extent, nullptr), H5Sclose, "make a data space");
  H5Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "prepare a dataset");
  h5_check(H5Pset_obj_track_times(properties, false), "prepare a dataset");
  H5Handle dataset(H5Dcreate2(group, name.c_str(), h5_type<float>(), space, H5P_DEFAULT, properties,
                              H5P_DEFAULT),
                   H5Dclose, "make dataset " + name);
  const std::int64_t layer =
      cells[0] * cells[1] * static_cast<std::int64_t>(std::max<std::size_t>(width, 1));
  const std::int64_t layers = static_cast<std::int64_t>(values.size()) / layer;
  const hsize_t start[4] = {static_cast<hsize_t>(ranks.sum_before(layers)), 0, 0, 0};
  extent[0] = static_cast<hsize_t>(layers);
  H5Handle memory(H5Screate_simple(dimensions, extent, nullptr), H5Sclose, "make a data space");
  select_rows(space, memory, start, extent);
  const float nothing = 0.0f;
  h5_agree(ranks,
           H5Dwrite(dataset, h5_type<float>(), memory, space, collective_transfer(ranks),
                    layers > 0 ? values.data() : &nothing),
           "write a dataset");
}

template H5Handle make_rows<double>(hid_t, const std::string&, std::int64_t, std::size_t);
template H5Handle make_rows<std::int64_t>(hid_t, const std::string&, std::int64_t, std::size_t);
template void write_rows_at(const Communicator&, hid_t, std::int64_t, const std::vector<double>&,
                            std::size_t);
template void write_rows_at(const Communicator&, hid_t, std::int64_t,
                            const std::vector<std::int64_t>&, std::size_t);
template H5Handle write_rows(const Communicator&, hid_t, const std::string&,
                             const std::vector<double>&, std::size_t);
template H5Handle write_rows(const Communicator&, hid_t, const std::string&,
                             const std::vector<float>&, std::size_t);
template H5Handle write_rows(const Communicator&, hid_t, const std::string&,
                             const std::vector<std::int64_t>&, std::size_t);
template H5Handle write_rows(const Communicator&, hid_t, const std::string&,
                             const std::vector<std::uint8_t>&, std::size_t);

}  // namespace grouser
