// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/shell_word.h"

#include <gtest/gtest.h>

namespace glint {
namespace {

TEST(ShellWord, IsTheTextWhereItMeansItself) {
  EXPECT_EQ(shell_word("out/ring-1/run.d:a=b@c%d+e,f"), "out/ring-1/run.d:a=b@c%d+e,f");
}

TEST(ShellWord, IsQuotedWhereAShellWouldReadMore) {
  EXPECT_EQ(shell_word("out/my run"), "'out/my run'");
  EXPECT_EQ(shell_word("a;b"), "'a;b'");
  EXPECT_EQ(shell_word("$HOME"), "'$HOME'");
  EXPECT_EQ(shell_word("~/x"), "'~/x'");
  EXPECT_EQ(shell_word(""), "''");
}

TEST(ShellWord, LeavesTheQuotesForAQuote) {
  EXPECT_EQ(shell_word("it's"), "'it'\\''s'");
}

}  // namespace
}  // namespace glint
