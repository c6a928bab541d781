// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/shell/counted.h"

#include <gtest/gtest.h>

namespace glint::test {
namespace {

TEST(Counted, IsSingularOfOneAlone) {
  EXPECT_EQ(counted(0, "false alarm"), "0 false alarms");
  EXPECT_EQ(counted(1, "false alarm"), "1 false alarm");
  EXPECT_EQ(counted(2, "design"), "2 designs");
}

}  // namespace
}  // namespace glint::test
