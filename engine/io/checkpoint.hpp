// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/run_contract.hpp"
#include "engine/core/communicator.hpp"
#include "engine/core/state_io.hpp"
#include "engine/io/checkpoint_file.hpp"

namespace grouser {

/// Checkpoints of one run: HDF5 files that are complete or do not exist.
/// Format: docs/reference/formats/checkpoint.md.
///
/// A checkpoint is a new file, written, closed, synced, opened again and compared with the hash of
/// what was meant; its manifest, written last and atomically, makes it exist. So neither a kill at
/// any moment nor a full disk can harm the one before.
class CheckpointStore {
 public:
  /// @param directory the run's checkpoint directory; made when missing
  /// @param input     text of the frozen case, stored in every checkpoint for people
  CheckpointStore(const Communicator& ranks, const std::filesystem::path& directory,
                  std::string input = "");

  /// Writes a checkpoint of what `source` gives in `pieces` pieces; `manifest` names case, step and
  /// time, the rest is filled in and returned.
  /// @param may_publish asked on rank 0 right before the manifest is written; on false nothing
  ///        remains and nothing is returned
  /// @throws StorageError on every rank; the checkpoints before stay. Collective.
  template <class MayPublish>
  std::optional<CheckpointManifest> write(const StateSource& source, std::int64_t pieces,
                                          CheckpointManifest manifest,
                                          const MayPublish& may_publish) {
    manifest = write_data(source, pieces, std::move(manifest));
    const bool allowed = ranks_.from_first(ranks_.rank() == 0 ? may_publish() : 0) != 0;
    if (!allowed) {
      discard(manifest);
      return std::nullopt;
    }
    publish(manifest);
    return manifest;
  }

  /// Pieces for a state of so many keys, such that one of them takes little room beside the grains.
  /// Local.
  std::int64_t pieces_for(std::int64_t keys) const;

  /// Looks for the newest checkpoint of `case_key` that is whole; damaged ones are marked and
  /// passed over. Nothing when there is none at all. @throws FormatError when all there are are
  /// damaged. Collective.
  std::optional<CheckpointManifest> find_newest(const std::string& case_key);

  /// Hands over the rows of a checkpoint that find_newest has found. @throws FormatError on every
  /// rank. Collective.
  void read(const CheckpointManifest& manifest, const RowSink& sink) const;

  /// Removes all but the newest `keep` checkpoints. Collective.
  void retain(std::size_t keep);

  /// Removes what attempts before this one began and never published, as far as it lay in the
  /// directory when this store was made. To be called by the owner of the run only: who owns it now
  /// owned it then, so those files' writers have lost it and may not publish them any more. Files
  /// that came later are left alone; a next owner may be writing them. Collective.
  void remove_leftovers();

 private:
  CheckpointManifest write_data(const StateSource& source, std::int64_t pieces,
                                CheckpointManifest manifest);
  void publish(const CheckpointManifest& manifest);
  void discard(const CheckpointManifest& manifest);
  std::vector<CheckpointManifest> manifests() const;

  Communicator ranks_;
  std::filesystem::path directory_;
  std::string input_;
  std::vector<std::filesystem::path> leftovers_;  // rank 0
};

/// Reads the file of `manifest` in `directory`, hands over its rows and checks all hashes.
/// @throws FormatError on every rank when it is not what the manifest says. Collective.
void read_checkpoint(const Communicator& ranks, const std::filesystem::path& directory,
                     const CheckpointManifest& manifest, const RowSink& sink);

}  // namespace grouser
