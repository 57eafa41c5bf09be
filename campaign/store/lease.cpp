// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/store/change.hpp"
#include "campaign/store/database.hpp"

namespace grouser {
namespace {

// The beat says that the holder works, not who it is.
bool is_same_process(const LeaseHolder& a, const LeaseHolder& b) {
  return a.host == b.host && a.boot == b.boot && a.pid == b.pid && a.start == b.start;
}

void write_lease(SQLite::Database& database, const LeaseHolder& holder) {
  SQLite::Statement statement(database,
                              "INSERT INTO lease (id, host, boot, pid, start, beat) "
                              "VALUES (1, ?, ?, ?, ?, ?) ON CONFLICT (id) DO UPDATE SET "
                              "host = excluded.host, boot = excluded.boot, pid = excluded.pid, "
                              "start = excluded.start, beat = excluded.beat");
  statement.bind(1, holder.host);
  statement.bind(2, holder.boot);
  statement.bind(3, holder.pid);
  statement.bind(4, holder.start);
  statement.bind(5, holder.beat);
  statement.exec();
}

}  // namespace

std::optional<LeaseHolder> read_lease(SQLite::Database& database) {
  SQLite::Statement statement(database, "SELECT host, boot, pid, start, beat FROM lease");
  if (!statement.executeStep()) return std::nullopt;
  LeaseHolder holder;
  holder.host = statement.getColumn(0).getString();
  holder.boot = statement.getColumn(1).getString();
  holder.pid = statement.getColumn(2).getInt64();
  holder.start = statement.getColumn(3).getInt64();
  holder.beat = statement.getColumn(4).getInt64();
  return holder;
}

void Store::Impl::confirm_lease() {
  if (is_replay) return;
  if (inode_of(database->getFilename()) != inode)
    throw LeaseLost(database->getFilename() +
                    ": was replaced or deleted while this manager worked; nothing was written");
  const auto holder = read_lease(*database);
  if (!lease || !holder || !is_same_process(*holder, *lease))
    throw LeaseLost(holder ? "process " + std::to_string(holder->pid) + " on " + holder->host +
                                 " took over the campaign"
                           : "the campaign is written to without its lease");
  database->exec("UPDATE lease SET beat = beat + 1");
}

void Store::Impl::note(nlohmann::json change) {
  if (is_replay) return;
  database->exec("UPDATE journal SET number = number + 1");
  change["n"] = database->execAndGet("SELECT number FROM journal").getInt64();
  journal->append(change.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

void Store::Impl::complete_journal(const Store& store) {
  const std::int64_t number = database->execAndGet("SELECT number FROM journal").getInt64();
  if (journal->last_number() >= number && std::filesystem::exists(journal->file())) return;
  if (!store.has_campaign()) return;
  WriteTransaction transaction(*database);
  confirm_lease();
  // From before there was a journal, or the journal was lost: it begins anew with all rows.
  std::error_code error;
  const auto old = std::filesystem::path(journal->file()).concat(".old");
  std::filesystem::rename(journal->file(), old, error);
  note(json_of_all(store));
  transaction.commit();
}

std::optional<LeaseHolder> Store::take_lease(
    const LeaseHolder& me, const std::function<bool(const LeaseHolder&)>& may_replace) {
  SQLite::Database& database = *impl_->database;
  return guarded(database, [&]() -> std::optional<LeaseHolder> {
    WriteTransaction transaction(database);
    const auto holder = read_lease(database);
    if (holder && !is_same_process(*holder, me) && !may_replace(*holder)) return holder;
    LeaseHolder mine = me;
    mine.beat = holder ? holder->beat + 1 : 1;
    write_lease(database, mine);
    transaction.commit();
    impl_->lease = mine;
    impl_->complete_journal(*this);
    return std::nullopt;
  });
}

void Store::release_lease(const LeaseHolder& me) {
  SQLite::Database& database = *impl_->database;
  guarded(database, [&] {
    WriteTransaction transaction(database);
    const auto holder = read_lease(database);
    if (holder && is_same_process(*holder, me)) database.exec("DELETE FROM lease");
    transaction.commit();
    impl_->lease.reset();
  });
}

}  // namespace grouser
