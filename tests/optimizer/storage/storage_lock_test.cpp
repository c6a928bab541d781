// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "core/file.h"
#include "tests/optimizer/storage/some_trials.h"

namespace glint {
namespace {

using test::identity;
using test::open_error;
using test::write_some_trials;
using testing::HasSubstr;

TEST(Storage, OnlyOneProcessMayHoldIt) {
  const TemporaryFolder folder;
  const Storage storage = Storage::open(folder / "s.sqlite", identity());
  EXPECT_THAT(open_error(folder / "s.sqlite"), HasSubstr("another process is running this study"));
  EXPECT_NO_THROW(Storage::read(folder / "s.sqlite"));
}

TEST(Storage, ALockDiesWithItsProcess) {
  const TemporaryFolder folder;
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    Storage storage = Storage::open(folder / "s.sqlite", identity());
    write_some_trials(storage, 3);
    const bool is_written = ::write(ready[1], "x", 1) == 1;
    ::pause();
    ::_exit(is_written ? 0 : 1);
  }
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  EXPECT_THAT(open_error(folder / "s.sqlite"), HasSubstr("another process"));
  EXPECT_EQ(Storage::read(folder / "s.sqlite").trials(TrialKind::kSearch).size(), 3U);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  ::close(ready[0]);
  ::close(ready[1]);
  EXPECT_EQ(open_error(folder / "s.sqlite"), "");
  EXPECT_EQ(Storage::read(folder / "s.sqlite").events().size(), 6U);
}

}  // namespace
}  // namespace glint
