// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace grouser::diagnosis {

/// Where the truth of a set of concealed cases lies, and the words that were written down about it
/// and about the answers before it was opened.
inline constexpr const char* kTruthFile = "sealed/truth.json";
inline constexpr const char* kSealFile = "seal.txt";
inline constexpr const char* kAnswersFile = "answers.txt";

/// Writes the truth's hash beside it and takes away the right to read it.
/// @throws StorageError. Local.
void seal(const std::filesystem::path& folder);

/// Text of the truth after its hash was found to be the sealed one. @throws FormatError. Local.
std::string open_truth(const std::filesystem::path& folder);

/// Writes the hash of every answer, once all are there. @throws StorageError. Local.
void seal_answers(const std::filesystem::path& folder);

/// @throws FormatError when an answer is not the one that was sealed. Local.
void check_answers(const std::filesystem::path& folder);

}  // namespace grouser::diagnosis
