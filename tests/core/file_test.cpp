// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::StartsWith;

TEST(WriteFile, ComesBackByteForByte) {
  const TemporaryFolder folder;
  std::string bytes;
  for (int i = 0; i < 200000; ++i) {
    bytes += static_cast<char>(i * 7 % 256);
  }
  write_file(folder / "data.bin", bytes);
  EXPECT_EQ(read_file(folder / "data.bin"), bytes);
  EXPECT_EQ(folder.count(), 1);
}

TEST(WriteFile, ReplacesWhatWasThere) {
  const TemporaryFolder folder;
  write_file(folder / "a.txt", "a long first text");
  write_file(folder / "a.txt", "short");
  EXPECT_EQ(read_file(folder / "a.txt"), "short");
  write_file(folder / "a.txt", "");
  EXPECT_EQ(read_file(folder / "a.txt"), "");
}

TEST(WriteFileDurably, WritesAsWriteFileDoes) {
  const TemporaryFolder folder;
  make_folder_durably(folder / "a/b");
  write_file_durably(folder / "a/b/c.txt", "a long first text");
  write_file_durably(folder / "a/b/c.txt", "short");
  EXPECT_EQ(read_file(folder / "a/b/c.txt"), "short");
  rename_durably(folder / "a/b/c.txt", folder / "a/b/d.txt");
  EXPECT_EQ(read_file(folder / "a/b/d.txt"), "short");
  const fs::path missing = folder / "missing/a.txt";
  EXPECT_THAT(text_thrown_by<IoError>([&] { write_file_durably(missing, "x"); }),
              StartsWith(missing.string() + ": cannot be written: "));
  EXPECT_THROW(rename_durably(folder / "missing", folder / "a/e"), IoError);
  EXPECT_THROW(write_file_durably("/dev/full", "x"), IoError);
  EXPECT_EQ(folder.count(), 1);
}

TEST(WriteFile, NamesTheFileWhenTheFolderIsUnusable) {
  const TemporaryFolder folder;
  write_file(folder / "plain", "x");
  const fs::path below_a_file = folder / "plain" / "a.txt";
  const std::string text =
      text_thrown_by<IoError>([&] { write_file(below_a_file, "never arrives"); });
  EXPECT_THAT(text, StartsWith(below_a_file.string() + ": cannot be written: "));
  EXPECT_THAT(text, EndsWith("Not a directory"));
  EXPECT_THROW(write_file(folder / "missing" / "a.txt", "x"), IoError);
  EXPECT_THROW(write_file("/proc/glint_test.txt", "x"), IoError);
  EXPECT_EQ(folder.count(), 1);
}

TEST(WriteFile, LeavesNothingBehindWhenItCannotTakeItsPlace) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "taken");
  write_file(folder / "taken" / "inside", "x");
  EXPECT_THROW(write_file(folder / "taken", "x"), IoError);
  EXPECT_EQ(folder.count(), 1);
  EXPECT_EQ(read_file(folder / "taken" / "inside"), "x");
}

TEST(WriteFile, KeepsTheOldFileWhenTheDiskIsFull) {
  const TemporaryFolder folder;
  write_file(folder / "a.txt", "old");
  fill_disk_under(folder / "a.txt");
  const std::string text = text_thrown_by<IoError>([&] { write_file(folder / "a.txt", "new"); });
  EXPECT_THAT(text, HasSubstr("No space left on device"));
  EXPECT_EQ(read_file(folder / "a.txt"), "old");
  EXPECT_EQ(folder.count(), 1);
}

TEST(WriteFile, WritesToADeviceInPlace) {
  EXPECT_THAT(text_thrown_by<IoError>([] { write_file("/dev/full", "x"); }),
              HasSubstr("/dev/full: cannot be written: No space left on device"));
  write_file("/dev/null", "x");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST(AtomicFile, AppearsOnlyAtCommit) {
  const TemporaryFolder folder;
  {
    AtomicFile file(folder / "picture.png");
    EXPECT_EQ(file.temporary_path().parent_path(), folder.path());
    EXPECT_EQ(file.temporary_path().extension(), ".png");
    write_file(file.temporary_path(), "pixels");
    EXPECT_FALSE(fs::exists(folder / "picture.png"));
    file.commit();
    EXPECT_EQ(read_file(folder / "picture.png"), "pixels");
  }
  EXPECT_EQ(folder.count(), 1);
}

TEST(AtomicFile, IsRemovedWithoutCommit) {
  const TemporaryFolder folder;
  {
    const AtomicFile file(folder / "picture.png");
    write_file(file.temporary_path(), "half");
    EXPECT_EQ(folder.count(), 1);
  }
  EXPECT_EQ(folder.count(), 0);
}

TEST(AtomicFile, SaysWhenTheRenameFails) {
  const TemporaryFolder folder;
  AtomicFile file(folder / "never_written");
  EXPECT_THAT(text_thrown_by<IoError>([&] { file.commit(); }),
              HasSubstr("never_written: cannot be written: No such file or directory"));
}

TEST(ReadFile, SaysWhyAFileCannotBeRead) {
  const TemporaryFolder folder;
  EXPECT_THAT(text_thrown_by<IoError>([&] { read_file(folder / "none"); }),
              EndsWith("none: cannot be read: No such file or directory"));
  EXPECT_THAT(text_thrown_by<IoError>([&] { read_file(folder.path()); }),
              EndsWith(": cannot be read: it is a folder"));
}

TEST(MakeFolder, MakesParentsAndAcceptsWhatIsThere) {
  const TemporaryFolder folder;
  make_folder(folder / "a/b/c");
  EXPECT_TRUE(fs::is_directory(folder / "a/b/c"));
  make_folder(folder / "a/b/c");
  EXPECT_EQ(folder.count(), 1);
}

TEST(MakeFolder, SaysWhenAFileIsInTheWay) {
  const TemporaryFolder folder;
  write_file(folder / "plain", "x");
  EXPECT_THAT(text_thrown_by<IoError>([&] { make_folder(folder / "plain"); }),
              HasSubstr("plain: the folder cannot be made: "));
  EXPECT_THROW(make_folder(folder / "plain/below"), IoError);
  EXPECT_THROW(make_folder("/proc/glint_test"), IoError);
  fs::create_symlink("nowhere", folder / "link");
  EXPECT_THAT(text_thrown_by<IoError>([&] { make_folder(folder / "link"); }),
              EndsWith("link: the folder cannot be made: a link of that name leads to nothing"));
  EXPECT_THAT(
      text_thrown_by<IoError>([&] { make_folder(folder / "link/below"); }),
      MatchesRegex(".*link/below: the folder cannot be made: the link .*link leads to nothing"));
}

}  // namespace
}  // namespace glint
