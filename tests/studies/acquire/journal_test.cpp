// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/journal.h"

#include <fcntl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "core/error.h"
#include "core/file.h"
#include "core/rng.h"
#include "optimizer/storage/sqlite.h"
#include "tests/support/temporary_folder.h"

namespace {

/// What was put on the disk, in order: paths of synced files and folders, new names after "-> ".
/// Null: nobody looks.
std::vector<std::string>* disk_order = nullptr;

void note_sync(int file) {
  if (disk_order != nullptr) {
    std::error_code none;
    disk_order->push_back(
        std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(file), none).string());
  }
}

}  // namespace

// In the place of the C library's, also for SQLite: what they do, and a note of it.
extern "C" int fsync(int file) {
  note_sync(file);
  return static_cast<int>(::syscall(SYS_fsync, file));
}

extern "C" int fdatasync(int file) {
  note_sync(file);
  return static_cast<int>(::syscall(SYS_fdatasync, file));
}

extern "C" int rename(const char* from, const char* to) noexcept {
  if (disk_order != nullptr) {
    disk_order->push_back(std::string("-> ") + to);
  }
  return ::renameat(AT_FDCWD, from, AT_FDCWD, to);
}

namespace glint {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

AcquiredPicture picture(int position) {
  AcquiredPicture picture = {.view = "left",
                             .position = position,
                             .lights = {"ring"},
                             .file = fmt::format("views/left/sequence/frame_{:03}.png", position)};
  picture.base_from_flange.translation() = Eigen::Vector3d(100.0 + position, 2.5, 300.125);
  picture.joints_rad[1] = -1.25;
  picture.frame_id = static_cast<std::uint64_t>(position) + 7;
  return picture;
}

std::string bytes_of(int position) {
  return fmt::format("picture {}", position) + std::string(2000, 'x');
}

TEST(AcquireJournal, RemembersWhatItKept) {
  const TemporaryFolder folder;
  {
    AcquireJournal journal(folder / "", "plan");
    journal.keep(picture(0), bytes_of(0));
    journal.keep(picture(1), bytes_of(1));
  }
  const AcquireJournal again(folder / "", "plan");
  ASSERT_EQ(again.pictures().size(), 2U);
  EXPECT_EQ(again.num_resumed(), 2);
  EXPECT_EQ(again.pictures()[1].frame_id, 8U);
  EXPECT_NEAR(again.pictures()[1].base_from_flange.translation().x(), 101.0, 1e-12);
  EXPECT_NEAR(again.pictures()[1].joints_rad[1], -1.25, 1e-12);
  EXPECT_EQ(read_file(folder / "views/left/sequence/frame_001.png"), bytes_of(1));
}

TEST(AcquireJournal, RefusesAnotherPlanAndASecondProcess) {
  const TemporaryFolder folder;
  { const AcquireJournal journal(folder / "", "plan"); }
  try {
    const AcquireJournal other(folder / "", "another");
    FAIL() << "must throw";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("another plan"));
  }
  const AcquireJournal first(folder / "", "plan");
  EXPECT_THROW(AcquireJournal(folder / "", "plan"), ConfigError);
}

// What a process leaves that is killed between the steps of one picture.
TEST(AcquireJournal, RepairsEachHalfOfAPicture) {
  const TemporaryFolder folder;
  const fs::path sequence = folder / "views/left/sequence";
  {
    AcquireJournal journal(folder / "", "plan");
    for (int i = 0; i < 3; ++i) {
      journal.keep(picture(i), bytes_of(i));
    }
  }
  fs::rename(sequence / "frame_000.png", sequence / ".frame_000.png.part");  // row, no name
  write_file(sequence / "frame_001.png", "other bytes");                     // damaged
  write_file(sequence / ".frame_009.png.part", "half");                      // no row
  write_file(sequence / "frame_010.png", "whole, of nobody");
  const AcquireJournal again(folder / "", "plan");
  ASSERT_EQ(again.pictures().size(), 2U);
  EXPECT_EQ(again.pictures()[0].position, 0);
  EXPECT_EQ(again.pictures()[1].position, 2);
  EXPECT_EQ(read_file(sequence / "frame_000.png"), bytes_of(0));
  EXPECT_FALSE(fs::exists(sequence / "frame_001.png"));
  EXPECT_FALSE(fs::exists(sequence / ".frame_009.png.part"));
  EXPECT_FALSE(fs::exists(sequence / "frame_010.png"));
}

// On a full disk the bytes may fit, and the row not: they make room for what is to be told of it.
TEST(AcquireJournal, LeavesNoBytesWithoutARow) {
  const TemporaryFolder folder;
  AcquireJournal journal(folder / "", "plan");
  Database(folder / "journal.sqlite", Database::Access::kReadWrite)
      .run("CREATE TRIGGER full BEFORE INSERT ON picture BEGIN SELECT RAISE(ABORT, 'full'); END");
  EXPECT_THROW(journal.keep(picture(0), bytes_of(0)), IoError);
  EXPECT_TRUE(fs::is_empty(folder / "views/left/sequence"));
  EXPECT_TRUE(journal.pictures().empty());
}

// A person has looked through the rejected pictures, and thrown away one of them.
TEST(AcquireJournal, GivesNoNumberOfARejectedPictureTwice) {
  const TemporaryFolder folder;
  const std::string stem = "rejected/left/frame_001_try_";
  const auto reject = [&stem](AcquireJournal& journal, int number) {
    AcquiredPicture rejected = picture(1);
    rejected.is_accepted = false;
    rejected.file = fmt::format("{}{}.png", stem, number);
    journal.keep(rejected, bytes_of(number));
  };
  {
    AcquireJournal journal(folder / "", "plan");
    journal.keep(picture(1), bytes_of(0));
    EXPECT_EQ(journal.next_try(stem), 1);
    for (int number = 1; number <= 10; ++number) {
      reject(journal, number);
    }
    EXPECT_EQ(journal.next_try(stem), 11);
    EXPECT_EQ(journal.next_try("rejected/left/frame_002_try_"), 1);
  }
  fs::remove(folder / (stem + "1.png"));
  AcquireJournal again(folder / "", "plan");
  EXPECT_EQ(again.pictures().size(), 10U);
  EXPECT_EQ(again.next_try(stem), 11);
  reject(again, again.next_try(stem));
  EXPECT_EQ(again.pictures().size(), 11U);
}

/// Where something was noted after `from`; the end: it was not.
std::size_t place_of(const std::vector<std::string>& order,
                     const std::string& what,
                     std::size_t from = 0) {
  const auto begin = order.begin() + static_cast<std::ptrdiff_t>(std::min(from, order.size()));
  return static_cast<std::size_t>(std::find(begin, order.end(), what) - order.begin());
}

// What a power cut leaves is a beginning of this order: the row never comes before the bytes that
// it tells of, nor before the names of the folders that lead to them.
TEST(AcquireJournal, PutsAPictureOnTheDiskBeforeItsRow) {
  const TemporaryFolder folder;
  AcquireJournal journal(folder / "", "plan");
  std::vector<std::string> order;
  disk_order = &order;
  journal.keep(picture(0), bytes_of(0));
  disk_order = nullptr;
  const fs::path whole = fs::canonical(folder.path());
  const fs::path sequence = whole / "views/left/sequence";
  const std::string all = testing::PrintToString(order);
  const std::size_t row = place_of(order, (whole / "journal.sqlite").string());
  const std::size_t named =
      place_of(order, "-> " + (folder / "views/left/sequence").string() + "/frame_000.png");
  ASSERT_LT(named, order.size()) << all;
  EXPECT_LT(row, named) << all;
  for (const fs::path& before : {sequence / ".frame_000.png.part",
                                 sequence,
                                 sequence.parent_path(),
                                 whole / "views",
                                 whole}) {
    EXPECT_LT(place_of(order, before.string()), row) << before << all;
  }
  EXPECT_LT(place_of(order, sequence.string(), named), order.size()) << "its own name" << all;
}

/// Keeps three of what is missing of 12 pictures, and waits where more are: however quick the disk
/// is, at least three such processes are killed. Never returns.
[[noreturn]] void keep_three(const fs::path& folder) {
  AcquireJournal journal(folder, "plan");
  const int end = std::min(journal.num_resumed() + 3, 12);
  for (int i = journal.num_resumed(); i < end; ++i) {
    journal.keep(picture(i), bytes_of(i));
  }
  while (end < 12) {
    ::pause();
  }
  ::_exit(0);
}

TEST(AcquireJournal, LosesAndDoublesNothingWhenItIsKilled) {
  const TemporaryFolder folder;
  Rng random(3, Stream::kTest, 0);
  int kills = 0;
  for (bool is_done = false; !is_done;) {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      keep_three(folder / "");
    }
    // The patience grows: how long a picture takes is the disk's business.
    const double longest_s = 0.0005 * std::pow(1.15, kills);
    std::this_thread::sleep_for(std::chrono::duration<double>(random.uniform(0.0, longest_s)));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    is_done = WIFEXITED(status);
    ASSERT_TRUE(is_done || WTERMSIG(status) == SIGKILL) << "it must not fail by itself";
    ++kills;
    ASSERT_LT(kills, 200);
  }
  const AcquireJournal journal(folder / "", "plan");
  ASSERT_EQ(journal.pictures().size(), 12U);
  for (int i = 0; i < 12; ++i) {
    EXPECT_EQ(journal.pictures()[static_cast<std::size_t>(i)].position, i);
    EXPECT_EQ(read_file(folder / fmt::format("views/left/sequence/frame_{:03}.png", i)),
              bytes_of(i));
  }
  EXPECT_GT(kills, 2);
}

TEST(Acquired, NamesFoldersOfViews) {
  EXPECT_EQ(folder_name_of("left-2.b"), "left-2.b");
  EXPECT_EQ(folder_name_of("../left hand"), "_.._left_hand");
  EXPECT_EQ(folder_name_of(""), "_");
}

TEST(Acquired, RefusesFilesThatAreNone) {
  const TemporaryFolder folder;
  EXPECT_THROW(read_acquired(folder / ""), IoError);
  write_file(folder / "acquired.json", R"({"kind": "plan"})");
  EXPECT_THROW(read_acquired(folder / ""), ConfigError);
  write_file(folder / "acquired.json", R"({"kind": "acquired", "pictures": [{"view": 3}]})");
  EXPECT_THROW(read_acquired(folder / ""), ConfigError);
}

}  // namespace
}  // namespace glint
