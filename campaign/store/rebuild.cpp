// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/store/rebuild.hpp"

#include <map>
#include <nlohmann/json.hpp>

#include "base/atomic_file.hpp"
#include "base/errors.hpp"
#include "campaign/store/journal.hpp"
#include "campaign/store/row_json.hpp"

namespace grouser {
namespace {

namespace fs = std::filesystem;

constexpr const char* kUnfinished = ".grouser.db.rebuilt";

void remove_database(const fs::path& database) {
  for (const char* part : {"", "-wal", "-shm", "-journal"}) {
    std::error_code ignored;
    fs::remove(fs::path(database).concat(part), ignored);
  }
}

// The first name NAME.old-1, NAME.old-2 ... that is free.
fs::path name_for_old(const fs::path& database) {
  for (int i = 1;; ++i) {
    const fs::path old = fs::path(database).concat(".old-" + std::to_string(i));
    if (!fs::exists(old)) return old;
  }
}

using RowTexts = std::map<std::string, std::map<std::string, std::string>>;

// Of every run, by directory: its rows by name, as text.
RowTexts texts_of(const Store& store) {
  RowTexts texts;
  std::map<RunId, std::string> directories;
  for (const RunRow& run : store.runs()) {
    directories[run.id] = run.directory.string();
    texts[run.directory.string()]["run"] = row_json(run).dump();
  }
  for (const ChunkRow& chunk : store.chunks())
    texts[directories.at(chunk.run)]["chunk " + std::to_string(chunk.position)] =
        row_json(chunk).dump();
  for (const AttemptRow& attempt : store.attempts())
    texts[directories.at(attempt.run)]["attempt " + std::to_string(attempt.number)] =
        row_json(attempt).dump();
  return texts;
}

}  // namespace

std::int64_t replay_journal(const fs::path& root, const fs::path& database, std::int64_t until) {
  const fs::path journal = root / kJournalName;
  Store store = Store::open_for_replay(database);
  std::int64_t last = 0;
  read_journal(journal, [&](std::int64_t number, const std::string& line) {
    if (until > 0 && number > until) return;
    try {
      store.redo(line);
    } catch (const std::exception& error) {
      throw FormatError(journal.string() + ": change " + std::to_string(number) +
                        " cannot be done again: " + error.what());
    }
    last = number;
  });
  return last;
}

std::string rebuild_database(const fs::path& root) {
  const fs::path made = root / kUnfinished;
  const fs::path place = root / Store::kFileName;
  remove_database(made);
  if (replay_journal(root, made) == 0)
    throw FormatError((root / kJournalName).string() + ": holds no change");
  sync_path(made);
  fs::path old;
  if (fs::exists(place)) {
    old = name_for_old(place);
    fs::rename(place, old);
  }
  // A log of the former database must not be taken for one of the new.
  for (const char* part : {"-wal", "-shm", "-journal"}) {
    const fs::path file = fs::path(place).concat(part);
    if (!fs::exists(file)) continue;
    fs::rename(file, old.empty() ? name_for_old(file) : fs::path(old).concat(part));
  }
  fs::rename(made, place);
  sync_path(root);
  return old.filename().string();
}

std::vector<std::string> row_differences(const Store& database, const Store& journal) {
  std::vector<std::string> found;
  const RowTexts ours = texts_of(database);
  const RowTexts theirs = texts_of(journal);
  for (const auto& [directory, rows] : ours) {
    const auto other = theirs.find(directory);
    if (other == theirs.end()) {
      found.push_back(directory + ": the journal does not know the run");
      continue;
    }
    for (const auto& [name, text] : rows) {
      const auto at = other->second.find(name);
      if (at == other->second.end() || at->second != text)
        found.push_back(directory + ": " + name + " is not as the journal has it");
    }
    for (const auto& [name, text] : other->second)
      if (rows.find(name) == rows.end())
        found.push_back(directory + ": " + name + " is in the journal and not in the database");
  }
  for (const auto& [directory, rows] : theirs)
    if (ours.find(directory) == ours.end())
      found.push_back(directory + ": the database does not know the run");
  return found;
}

}  // namespace grouser
