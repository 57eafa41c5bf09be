// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace grouser {

/// The campaign's journal: one line of JSON for every change of the database, written and synced
/// before the change counts. Docs: docs/reference/formats/journal.md.
///
/// Every line has a number. A manager killed between its line and the database leaves a line that
/// never counted; the next change takes the same number again, and the later line is the valid one.
class Journal {
 public:
  explicit Journal(std::filesystem::path file) : file_(std::move(file)) {}
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;
  ~Journal();

  /// Adds a line and waits until it is on disk. @param text  one JSON object without a line break
  /// @throws StorageError; the file is then as it was. Local.
  void append(const std::string& text);

  /// Number of its last whole line, 0 when there is none. Local.
  std::int64_t last_number() const;

  const std::filesystem::path& file() const { return file_; }

 private:
  void open();

  std::filesystem::path file_;
  int descriptor_ = -1;
};

/// Calls `use` with every valid line in order: whole ones, and of those with one number the last.
/// @throws FormatError naming the line where the numbers have a gap; StorageError. Local.
void read_journal(const std::filesystem::path& file,
                  const std::function<void(std::int64_t number, const std::string& line)>& use);

}  // namespace grouser
