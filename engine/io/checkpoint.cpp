// SPDX-License-Identifier: BSD-3-Clause
#include "engine/io/checkpoint.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "base/atomic_file.hpp"
#include "base/errors.hpp"
#include "base/hash.hpp"
#include "engine/core/agree.hpp"

namespace grouser {
namespace {

namespace fs = std::filesystem;

// Keys of a piece, per rank.
constexpr std::int64_t kPieceKeys = 1 << 20;

// What a piece says of the whole.
std::uintmax_t bytes_of(const State& piece) {
  std::uintmax_t bytes = 0;
  for (const StateTable& table : piece)
    bytes += static_cast<std::uintmax_t>(table.all_rows) *
             (table.integer_width() * sizeof(std::int64_t) + table.real_width() * sizeof(double));
  return bytes;
}

constexpr const char* kFilePrefix = "step_";

// Headers and attributes of a file, beside its data.
constexpr std::uintmax_t kFileOverhead = 256 << 10;

bool is_absent(fs::path file, const char* extension) {
  std::error_code ignored;
  return fs::status(file.replace_extension(extension), ignored).type() == fs::file_type::not_found;
}

// A kill leaves a state file without its manifest, a half-written manifest or a test of the room.
// A file whose manifest was put aside as damaged stays for people to look at.
bool is_unpublished(const fs::path& file) {
  const std::string name = file.filename().string();
  if (name.starts_with(kRoomProbe)) return true;
  if (!name.starts_with(kFilePrefix)) return false;
  if (name.find(".json.tmp-") != std::string::npos) return true;
  return file.extension() == ".h5" && is_absent(file, ".json") && is_absent(file, ".bad");
}

}  // namespace

void read_checkpoint(const Communicator& ranks, const fs::path& directory,
                     const CheckpointManifest& manifest, const RowSink& sink) {
  const fs::path file = directory / manifest.file;
  std::string hash;
  std::string failure = agreed_failure(ranks, [&] {
    std::error_code error;
    const auto size = fs::file_size(file, error);
    if (error || static_cast<std::int64_t>(size) != manifest.bytes)
      throw FormatError(file.string() + " has not the size its manifest tells");
  });
  // Only a file of the right size is opened by all ranks together.
  if (failure.empty()) {
    failure = agreed_failure(ranks, [&] { hash = hex(read_state_file(ranks, file, sink)); });
    if (!failure.empty()) failure = file.string() + ": " + failure;
  }
  if (failure.empty() && hash != manifest.state_hash)
    failure = file.string() + " does not have the hash its manifest tells";
  if (!failure.empty()) throw FormatError(failure);
}

CheckpointStore::CheckpointStore(const Communicator& ranks, const fs::path& directory,
                                 std::string input)
    : ranks_(ranks), directory_(directory), input_(std::move(input)) {
  on_first_rank(ranks_, [&] {
    fs::create_directories(directory_);
    for (const auto& entry : fs::directory_iterator(directory_))
      if (is_unpublished(entry.path())) leftovers_.push_back(entry.path());
  });
}

void CheckpointStore::remove_leftovers() {
  for (const fs::path& file : leftovers_) {
    std::error_code error;
    // Asked again: one that was slow to publish may have done so since.
    if (!is_unpublished(file) || !fs::remove(file, error)) continue;
    spdlog::info("io unpublished {} of an earlier attempt removed", file.filename().string());
  }
  leftovers_.clear();
  ranks_.barrier();
}

std::int64_t CheckpointStore::pieces_for(std::int64_t keys) const {
  return std::max<std::int64_t>(1, keys / (kPieceKeys * ranks_.size()));
}

CheckpointManifest CheckpointStore::write_data(const StateSource& source, std::int64_t pieces,
                                               CheckpointManifest manifest) {
  State first = source({0, pieces});
  const std::uintmax_t bytes = bytes_of(first);
  std::string name;
  if (ranks_.rank() == 0) {
    name = kFilePrefix + run_files::step_digits(manifest.step);
    // What another attempt left under the same name is not touched.
    for (int again = 1; fs::exists(directory_ / (name + ".h5")); ++again)
      name = name.substr(0, name.find('-')) + "-" + std::to_string(again);
  }
  name = ranks_.from_first(name + ".h5");
  manifest.file = name;
  const fs::path file = directory_ / name;

  // Asking first keeps a full disk away from the file library, which does not survive one.
  std::string failure = agreed_failure(ranks_, [&] {
    if (ranks_.rank() == 0) check_room(directory_, bytes + input_.size() + kFileOverhead);
  });
  if (failure.empty())
    failure = agreed_failure(ranks_, [&] {
      const auto piece = [&](const StatePiece& wanted) {
        return wanted.index == 0 ? std::move(first) : source(wanted);
      };
      manifest.state_hash = hex(write_state_file(ranks_, file, piece, pieces, manifest, input_));
    });
  if (failure.empty())
    failure = agreed_failure(ranks_, [&] {
      if (ranks_.rank() == 0) sync_path(file);
      manifest.bytes = static_cast<std::int64_t>(fs::file_size(file));
    });
  if (failure.empty()) {
    try {
      read_checkpoint(ranks_, directory_, manifest, [](const StateTable&) {});
    } catch (const FormatError& error) {
      failure = error.what();
    }
  }
  if (!failure.empty()) {
    discard(manifest);
    throw StorageError("checkpoint at step " + std::to_string(manifest.step) +
                       " could not be written: " + failure);
  }
  return manifest;
}

void CheckpointStore::publish(const CheckpointManifest& manifest) {
  const std::string failure = agreed_failure(ranks_, [&] {
    if (ranks_.rank() == 0)
      write_atomic((directory_ / manifest.file).replace_extension(".json"), to_json(manifest));
  });
  if (failure.empty()) return;
  discard(manifest);
  throw StorageError(failure);
}

void CheckpointStore::discard(const CheckpointManifest& manifest) {
  if (ranks_.rank() == 0) {
    std::error_code ignored;
    // The manifest may be there although making it durable failed: it must not outlive its file.
    fs::remove((directory_ / manifest.file).replace_extension(".json"), ignored);
    fs::remove(directory_ / manifest.file, ignored);
  }
  ranks_.barrier();
}

std::vector<CheckpointManifest> CheckpointStore::manifests() const {
  std::vector<CheckpointManifest> all;
  for (const auto& entry : fs::directory_iterator(directory_)) {
    if (entry.path().extension() != ".json") continue;
    try {
      const auto text = read_file(entry.path());
      if (text) all.push_back(manifest_from_json(*text, entry.path().string()));
    } catch (const FormatError& error) {
      spdlog::warn("io unreadable manifest passed over: {}", error.what());
    }
  }
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return std::tie(b.step, b.file) < std::tie(a.step, a.file);
  });
  return all;
}

std::optional<CheckpointManifest> CheckpointStore::find_newest(const std::string& case_key) {
  // Rank 0 alone looks, so that all ranks try the same files.
  std::string list;
  on_first_rank(ranks_, [&] {
    for (const CheckpointManifest& m : manifests())
      if (m.case_key == case_key) list += to_json(m) + '\0';
  });
  list = ranks_.from_first(list);
  bool any = false;
  for (std::size_t from = 0; from < list.size();) {
    const std::size_t to = list.find('\0', from);
    const CheckpointManifest manifest =
        manifest_from_json(list.substr(from, to - from), directory_.string());
    from = to + 1;
    any = true;
    try {
      // Once for the hashes alone: nobody is to take rows of a damaged one.
      read_checkpoint(ranks_, directory_, manifest, [](const StateTable&) {});
      return manifest;
    } catch (const FormatError& error) {
      if (ranks_.rank() != 0) continue;
      spdlog::warn("io damaged checkpoint passed over: {}", error.what());
      std::error_code ignored;
      const fs::path mark = (directory_ / manifest.file).replace_extension(".json");
      fs::rename(mark, fs::path(mark).replace_extension(".bad"), ignored);
    }
  }
  if (any) throw FormatError("every checkpoint in " + directory_.string() + " is damaged");
  return std::nullopt;
}

void CheckpointStore::read(const CheckpointManifest& manifest, const RowSink& sink) const {
  read_checkpoint(ranks_, directory_, manifest, sink);
}

void CheckpointStore::retain(std::size_t keep) {
  on_first_rank(ranks_, [&] {
    const std::vector<CheckpointManifest> all = manifests();
    for (std::size_t i = keep; i < all.size(); ++i) {
      const fs::path file = directory_ / all[i].file;
      std::error_code ignored;
      // The manifest goes first: what it names must exist as long as it does.
      fs::remove(fs::path(file).replace_extension(".json"), ignored);
      fs::remove(file, ignored);
    }
  });
}

}  // namespace grouser
