// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace grouser {

/// Replaces `file` by `text` so that a reader, or a machine that loses power, sees the old or the
/// new content and never a part: temporary file beside it, fsync, rename, fsync of the directory.
/// @throws StorageError when the file system refuses; the old content is then kept. Local.
void write_atomic(const std::filesystem::path& file, const std::string& text);

/// Creates `file` with `text` if no such file exists (O_EXCL), else leaves it alone.
/// @return whether this call created it. @throws StorageError. Local.
bool create_exclusive(const std::filesystem::path& file, const std::string& text);

/// fsync of a file or of a directory's entries. @throws StorageError. Local.
void sync_path(const std::filesystem::path& path);

/// The file's whole content, or nothing when there is no such file. @throws StorageError. Local.
std::optional<std::string> read_file(const std::filesystem::path& file);

/// How names of the files begin with which check_room asks; a kill may leave one.
inline constexpr const char* kRoomProbe = ".room-";

/// Makes sure that `bytes` more fit into `directory`, quotas included: allocates them in a file
/// that is removed again. On file systems that cannot allocate, free space alone is asked.
/// @throws StorageError when they do not fit. Local.
void check_room(const std::filesystem::path& directory, std::uintmax_t bytes);

}  // namespace grouser
