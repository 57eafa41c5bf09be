// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <set>

#include "base/errors.hpp"
#include "base/hash.hpp"
#include "engine/io/checkpoint.hpp"
#include "engine/io/series.hpp"

namespace grouser {
namespace {

namespace fs = std::filesystem;

// Run under mpirun with any number of ranks.

fs::path fresh_directory(const std::string& name) {
  const Communicator ranks;
  const fs::path directory =
      fs::path(::testing::TempDir()) / ("checkpoint_" + name + "_" + std::to_string(ranks.size()));
  if (ranks.rank() == 0) fs::remove_all(directory);
  ranks.barrier();
  return directory;
}

State some_state(double factor, std::int64_t rows, const StatePiece& piece = {}) {
  const Communicator ranks;
  StateTable table;
  table.name = "grains";
  table.key_count = table.all_rows = rows;
  table.integer_fields = {{"kind", "1", 1}};
  table.real_fields = {{"position", "m", 3}, {"radius", "m", 1}};
  StateTable empty;
  empty.name = "nothing";
  empty.real_fields = {{"value", "1", 1}};
  for (std::int64_t key = rows - 1 - ranks.rank(); key >= 0; key -= ranks.size()) {
    if (!piece.has(key, rows)) continue;
    table.integers.insert(table.integers.end(), {key, 0, key % 7});
    const double x = factor * static_cast<double>(key);
    table.reals.insert(table.reals.end(), {x, -x, 0.1 * x, 1e-3});
  }
  return {table, empty};
}

CheckpointManifest at_step(std::int64_t step) {
  CheckpointManifest manifest;
  manifest.case_key = "key";
  manifest.step = step;
  manifest.time = 0.5 * static_cast<double>(step);
  return manifest;
}

std::optional<CheckpointManifest> write(CheckpointStore& store, double factor, std::int64_t step,
                                        std::int64_t pieces = 1) {
  const auto source = [&](const StatePiece& piece) { return some_state(factor, 1000, piece); };
  return store.write(source, pieces, at_step(step), [] { return true; });
}

struct Loaded {
  CheckpointManifest manifest;
  State state;
};
std::optional<Loaded> load_newest(CheckpointStore& store, const std::string& key) {
  const auto found = store.find_newest(key);
  if (!found) return std::nullopt;
  Loaded loaded{*found, {}};
  store.read(*found, [&](const StateTable& rows) { loaded.state.push_back(rows); });
  return loaded;
}

TEST(Checkpoint, ReadsBackTheBitsThatWereWritten) {
  const Communicator ranks;
  CheckpointStore store(ranks, fresh_directory("roundtrip"));
  ASSERT_TRUE(write(store, 1.0 / 3.0, 10));
  const auto loaded = load_newest(store, "key");
  ASSERT_TRUE(loaded);
  EXPECT_EQ(loaded->manifest.step, 10);
  EXPECT_EQ(hash_state(ranks, loaded->state), hash_state(ranks, some_state(1.0 / 3.0, 1000)));
  EXPECT_EQ(table_of(loaded->state, "grains").real_fields[0].unit, "m");
  EXPECT_FALSE(load_newest(store, "another case"));
}

TEST(Checkpoint, IsTheSameFileInHoweverManyPiecesItWasWritten) {
  const Communicator ranks;
  const fs::path directory = fresh_directory("pieces");
  CheckpointStore store(ranks, directory);
  const auto whole = write(store, 1.0 / 3.0, 10);
  for (const std::int64_t pieces : {2, 7, 1500}) {  // some of 1500 have no key
    const auto cut = write(store, 1.0 / 3.0, 10, pieces);
    EXPECT_EQ(cut->state_hash, whole->state_hash);
    const auto loaded = load_newest(store, "key");
    EXPECT_EQ(hash_state(ranks, loaded->state), hash_state(ranks, some_state(1.0 / 3.0, 1000)));
    std::ifstream a(directory / whole->file, std::ios::binary);
    std::ifstream b(directory / cut->file, std::ios::binary);
    EXPECT_TRUE(
        std::equal(std::istreambuf_iterator<char>(a), {}, std::istreambuf_iterator<char>(b)))
        << pieces << " pieces";
    ranks.barrier();
  }
}

TEST(Checkpoint, ATruncatedOneIsRefusedAndThePreviousUsed) {
  const Communicator ranks;
  const fs::path directory = fresh_directory("truncated");
  CheckpointStore store(ranks, directory);
  write(store, 1.0, 10);
  const auto second = write(store, 2.0, 20);
  if (ranks.rank() == 0)
    fs::resize_file(directory / second->file, fs::file_size(directory / second->file) / 2);
  ranks.barrier();
  const auto loaded = load_newest(store, "key");
  ASSERT_TRUE(loaded);
  EXPECT_EQ(loaded->manifest.step, 10);
}

TEST(Checkpoint, AFlippedBitIsRefusedAndThePreviousUsed) {
  const Communicator ranks;
  const fs::path directory = fresh_directory("flipped");
  CheckpointStore store(ranks, directory);
  write(store, 1.0, 10);
  const auto second = write(store, 2.0, 20);
  if (ranks.rank() == 0) {
    std::fstream file(directory / second->file, std::ios::in | std::ios::out | std::ios::binary);
    file.seekg(0, std::ios::end);
    const auto place = static_cast<std::streamoff>(file.tellg()) / 2;
    file.seekg(place);
    const int byte = file.get();
    file.seekp(place);
    file.put(static_cast<char>(byte ^ 0x10));
  }
  ranks.barrier();
  const auto loaded = load_newest(store, "key");
  ASSERT_TRUE(loaded);
  EXPECT_EQ(loaded->manifest.step, 10);
}

TEST(Checkpoint, WhenAllAreDamagedTheRunIsRefused) {
  const Communicator ranks;
  const fs::path directory = fresh_directory("all_bad");
  CheckpointStore store(ranks, directory);
  const auto only = write(store, 1.0, 10);
  if (ranks.rank() == 0) fs::resize_file(directory / only->file, 100);
  ranks.barrier();
  EXPECT_THROW(load_newest(store, "key"), FormatError);
}

TEST(Checkpoint, WithoutItsManifestItDoesNotExist) {
  const Communicator ranks;
  const fs::path directory = fresh_directory("no_manifest");
  CheckpointStore store(ranks, directory);
  write(store, 1.0, 10);
  EXPECT_FALSE(store.write([](const StatePiece& piece) { return some_state(2.0, 1000, piece); }, 1,
                           at_step(20), [] { return false; }));
  EXPECT_EQ(load_newest(store, "key")->manifest.step, 10);
  ranks.barrier();
  // Nothing of the unpublished one remains.
  EXPECT_EQ(std::distance(fs::directory_iterator(directory), fs::directory_iterator()), 2);
}

TEST(Checkpoint, OnlyTheNewestAreKept) {
  const Communicator ranks;
  const fs::path directory = fresh_directory("retain");
  CheckpointStore store(ranks, directory);
  for (int i = 1; i <= 5; ++i) write(store, i, i);
  store.retain(2);
  EXPECT_EQ(std::distance(fs::directory_iterator(directory), fs::directory_iterator()), 4);
  EXPECT_EQ(load_newest(store, "key")->manifest.step, 5);
}

std::set<std::string> names_in(const fs::path& directory) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(directory))
    names.insert(entry.path().filename().string());
  return names;
}

TEST(Checkpoint, WhatAKilledAttemptLeftIsRemovedAndNothingElse) {
  const Communicator ranks;
  const fs::path directory = fresh_directory("leftovers");
  CheckpointStore before(ranks, directory);
  const auto kept = write(before, 1.0, 10);
  const auto damaged = write(before, 2.0, 20);
  const auto touch = [&](const char* name) {
    if (ranks.rank() == 0) std::ofstream(directory / name) << "half";
  };
  if (ranks.rank() == 0)
    fs::rename(directory / fs::path(damaged->file).replace_extension(".json"),
               directory / fs::path(damaged->file).replace_extension(".bad"));
  touch("step_000000000030.h5");
  touch("step_000000000030-1.h5");
  touch("step_000000000025.json.tmp-4711-0");
  touch(".room-4711");
  touch("notes.h5");  // not the engine's
  ranks.barrier();
  CheckpointStore owner(ranks, directory);
  ranks.barrier();
  // One of them gets its manifest late; another writer begins a file after the owner's start.
  touch("step_000000000030-1.json");
  touch("step_000000000040.h5");
  ranks.barrier();
  owner.remove_leftovers();
  const std::string ten = fs::path(kept->file).stem().string();
  const std::string twenty = fs::path(damaged->file).stem().string();
  const std::set<std::string> expected{ten + ".h5",
                                       ten + ".json",
                                       twenty + ".h5",
                                       twenty + ".bad",
                                       "step_000000000030-1.h5",
                                       "step_000000000030-1.json",
                                       "notes.h5",
                                       "step_000000000040.h5"};
  EXPECT_EQ(names_in(directory), expected);
  ranks.barrier();
}

// Turns one bit of the first place where `bytes` stand in the file.
void flip_bit_at(const fs::path& file, const std::string& bytes) {
  std::ifstream in(file, std::ios::binary);
  std::string content(std::istreambuf_iterator<char>(in), {});
  const std::size_t place = content.find(bytes);
  ASSERT_NE(place, std::string::npos);
  content[place] = static_cast<char>(content[place] ^ 0x10);
  std::ofstream(file, std::ios::binary) << content;
}

std::string why_refused(const Communicator& ranks, const fs::path& directory,
                        const CheckpointManifest& manifest) {
  try {
    read_checkpoint(ranks, directory, manifest, [](const StateTable&) {});
  } catch (const FormatError& error) {
    return error.what();
  }
  return "";
}

TEST(Checkpoint, NamesTheDatasetWhoseBitFlipped) {
  const Communicator ranks;
  const fs::path directory = fresh_directory("dataset");
  CheckpointStore store(ranks, directory, "gravity: 9.81 m/s2\n");
  const auto first = write(store, 1.0 / 3.0, 10);
  const auto second = write(store, 1.0 / 3.0, 20);
  EXPECT_EQ(why_refused(ranks, directory, *first), "");
  const double x = 1.0 / 3.0 * 998.0;
  const double row[3] = {x, -x, 0.1 * x};
  if (ranks.rank() == 0) {
    flip_bit_at(directory / first->file,
                std::string(reinterpret_cast<const char*>(row), sizeof row));
    flip_bit_at(directory / second->file, "gravity");
  }
  ranks.barrier();
  EXPECT_EQ(why_refused(ranks, directory, *first),
            (directory / first->file).string() +
                ": dataset /grains/position does not have the hash written with it");
  EXPECT_EQ(why_refused(ranks, directory, *second),
            (directory / second->file).string() +
                ": dataset /case does not have the hash written with it");
}

TEST(Checkpoint, ADiskThatFillsUpInTheMiddleKeepsThePrevious) {
  const Communicator ranks;
  const fs::path directory = fresh_directory("full");
  CheckpointStore store(ranks, directory);
  write(store, 1.0, 10);
  // Files end here for this process as they do on a full disk: the write fails half way.
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  rlimit small = before;
  small.rlim_cur = 20000;
  setrlimit(RLIMIT_FSIZE, &small);
  EXPECT_THROW(write(store, 2.0, 20), StorageError);
  setrlimit(RLIMIT_FSIZE, &before);
  const auto loaded = load_newest(store, "key");
  ASSERT_TRUE(loaded);
  EXPECT_EQ(loaded->manifest.step, 10);
  EXPECT_EQ(hash_state(ranks, loaded->state), hash_state(ranks, some_state(1.0, 1000)));
  ASSERT_TRUE(write(store, 2.0, 20));  // and there is room again
  EXPECT_EQ(load_newest(store, "key")->manifest.step, 20);
}

TEST(Series, ContinuesAsIfItHadNeverBeenCut) {
  const fs::path directory = fresh_directory("series");
  if (Communicator().rank() != 0) return;
  fs::create_directories(directory);
  const auto text_of = [](const fs::path& file) {
    std::ifstream in(file);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  {
    SeriesFile straight(directory / "a.csv", "step,time,phase,a,b", 0);
    for (int i = 1; i <= 6; ++i) straight.add(i, 0.1 * i, "driving", {1.0 / i, NAN});
    straight.flush();
  }
  {
    SeriesFile cut(directory / "b.csv", "step,time,phase,a,b", 0);
    for (int i = 1; i <= 5; ++i) cut.add(i, 0.1 * i, "driving", {1.0 / i, NAN});
    cut.flush();
  }
  std::ofstream(directory / "b.csv", std::ios::app) << "6,0.6,dri";  // torn by a kill
  SeriesFile resumed(directory / "b.csv", "step,time,phase,a,b", 3);
  for (int i = 4; i <= 6; ++i) resumed.add(i, 0.1 * i, "driving", {1.0 / i, NAN});
  resumed.flush();
  EXPECT_EQ(text_of(directory / "a.csv"), text_of(directory / "b.csv"));
}

}  // namespace
}  // namespace grouser
