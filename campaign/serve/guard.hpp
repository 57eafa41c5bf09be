// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <set>
#include <string>

namespace grouser {

// Who may ask `serve` what.

/// What a request says about where it comes from; "" = the header is not there.
struct RequestOrigin {
  std::string host;           ///< Host
  std::string origin;         ///< Origin
  std::string fetch_site;     ///< Sec-Fetch-Site
  std::string authorization;  ///< Authorization
};

/// Names under which the service may be addressed: the address itself and, for a loopback one,
/// the usual names of this machine. Without such a list, a foreign page whose name was made to
/// point here would count as the service's own. Pure.
std::set<std::string> own_names(const std::string& address);

/// Whether only this machine reaches the address. Pure.
bool is_loopback(const std::string& address);

/// Why the request is not served; "" when it may read. Pure.
std::string refusal_of_reading(const RequestOrigin& request, const std::set<std::string>& names);

/// The same of one that changes something: it must come from the service's own page or from no page
/// at all, so that no other page in the user's browser can do it. Pure.
std::string refusal_of_writing(const RequestOrigin& request, const std::set<std::string>& names);

/// Whether the request carries the token ("Authorization: Bearer TOKEN"). Takes as long for a
/// nearly right token as for a wrong one. Pure. @param token  "" is never carried
bool carries_token(const RequestOrigin& request, const std::string& token);

/// The token in the file: made at random, for its owner alone (0600), when there is none.
/// @throws ConfigError when others may read it or it is too short. StorageError. Local.
std::string token_of(const std::filesystem::path& file);

/// The canonical path of `relative` below `root`; "" when it is not there, is no plain file or
/// leads out of `root`, by `..` or by a link. Local.
std::filesystem::path file_within(const std::filesystem::path& root,
                                  const std::filesystem::path& relative);

}  // namespace grouser
