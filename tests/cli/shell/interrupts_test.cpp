// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/shell/interrupts.h"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>

#include <gtest/gtest.h>

#include "cli/acquire/driven_session.h"

namespace glint {
namespace {

/// Writes into a pipe that nobody reads. @return the error's number
int write_to_nobody() {
  std::array<int, 2> pipe = {};
  if (::pipe(pipe.data()) != 0) {
    return 0;
  }
  ::close(pipe[0]);
  const ssize_t count = ::write(pipe[1], "x", 1);
  const int error = count < 0 ? errno : 0;
  ::close(pipe[1]);
  return error;
}

/// What is done at a signal, which is the default from then on.
auto handler_of(int number) {
  return std::signal(number, SIG_DFL);
}

TEST(KeepAttending, WritingToNobodyFailsAndEndsNothing) {
  keep_attending();
  EXPECT_EQ(write_to_nobody(), EPIPE);
  EXPECT_EQ(handler_of(SIGPIPE), SIG_IGN);
}

TEST(KeepAttending, NothingTypedOrWrittenHaltsTheProgram) {
  keep_attending();
  for (const int number : {SIGTSTP, SIGTTOU}) {
    EXPECT_EQ(handler_of(number), SIG_IGN) << number;
    EXPECT_EQ(handler_of(number), SIG_DFL) << "the control";
  }
}

// All verbs that drive an arm over views go by it.
TEST(KeepAttending, IsPartOfEveryDrivenSession) {
  for (const int number : {SIGPIPE, SIGTSTP, SIGTTOU}) {
    std::signal(number, SIG_DFL);
  }
  const DrivenSession session(true);
  for (const int number : {SIGPIPE, SIGTSTP, SIGTTOU}) {
    EXPECT_EQ(handler_of(number), SIG_IGN) << number;
  }
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    handler_of(number);
  }
}

// The control.
TEST(KeepAttendingDeathTest, WritingToNobodyEndsAProgramThatDoesNot) {
  EXPECT_EXIT(
      {
        std::signal(SIGPIPE, SIG_DFL);
        write_to_nobody();
      },
      testing::KilledBySignal(SIGPIPE),
      "");
}

}  // namespace
}  // namespace glint
