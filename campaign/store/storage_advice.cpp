// SPDX-License-Identifier: BSD-3-Clause
#include "campaign/store/storage_advice.hpp"

#include <sqlite3.h>

namespace grouser {

std::string storage_advice(int code) {
  constexpr int kPrimary = 0xff;  // extended codes carry the primary one in their low byte
  switch (code & kPrimary) {
    case SQLITE_FULL:
      return "the file system or the quota is full: free some space, then the same command goes "
             "on; "
             "nothing is lost";
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return "another program holds it: `fuser FILE` names that program; when it has ended the "
             "same "
             "command goes on";
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      return "the file is damaged: `grouser rebuild --yes -C DIR`, DIR being its directory, makes "
             "it "
             "anew from the journal beside it; nothing in the run directories is lost";
    case SQLITE_IOERR:
      return "the file system failed: see that it is mounted and has room, then the same command "
             "goes on";
    case SQLITE_READONLY:
    case SQLITE_PERM:
    case SQLITE_CANTOPEN:
      return "see that this user may read and write the file and its directory";
    default:
      return "";
  }
}

}  // namespace grouser
