// SPDX-License-Identifier: BSD-3-Clause
#include <mpi.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <fstream>

#include "base/errors.hpp"
#include "engine/io/checkpoint_file.hpp"

using namespace grouser;

// MPI is never finalised: libFuzzer ends the process by itself.
extern "C" const char* __asan_default_options() { return "detect_leaks=0"; }

extern "C" int LLVMFuzzerInitialize(int* count, char*** words) {
  MPI_Init(count, words);
  return 0;
}

// A checkpoint of any bytes is read or refused. Its hashes refuse nearly all; what is fuzzed is
// what is read before they are known.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string file = "/dev/shm/grouser-fuzz-" + std::to_string(::getpid());
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    read_state_file(Communicator::alone(), file, [](const StateTable&) {});
  } catch (const FormatError&) {
  } catch (const StorageError&) {
  }
  ::unlink(file.c_str());
  return 0;
}
