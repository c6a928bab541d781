// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "studies/acquire/acquire_plan.h"
#include "studies/definition/study.h"
#include "tests/studies/acquire/run_of_prototypes.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using testing::HasSubstr;

/// A strip under a tunnel, in a cell whose views look at it.
class StripeOffset : public testing::Test {
 protected:
  AcquireWork work_with(const std::string& stage, const std::string& tunnel) const {
    write_file(folder_ / "cell.toml",
               std::string(kLonelyCell) + "[lights.tunnel]\noutput = 2\n" + stage);
    write_file(folder_ / "scene.toml",
               "schema = 1\n[part]\nshape = \"plate\"\n[scan]\npositions = 1\nstep_mm = 1\n"
               "[lighting.tunnel]\n" +
                   tunnel);
    AcquireSource source;
    source.scene = load_study(folder_ / "scene.toml", {}).scene;
    return work_of(source, read_cell(folder_ / "cell.toml"), 0.5);
  }

  std::string error_with(const std::string& stage, const std::string& tunnel) const {
    return text_thrown_by<ConfigError>([&] { work_with(stage, tunnel); });
  }

  TemporaryFolder folder_;
};

constexpr const char* kRail = "[stage]\nhost = \"127.0.0.1\"\n";

TEST_F(StripeOffset, IsWhereALinearStageBegins) {
  const AcquireWork work = work_with(kRail, "offset_mm = 5\n");
  EXPECT_DOUBLE_EQ(work.steps.to_first_mm, 5.0);
  EXPECT_EQ(work.grounds.at("[stage] first_mm"), "5");
  const AcquireWork plain = work_with(kRail, "");
  EXPECT_EQ(plain.steps.to_first_mm, 0.0);
  EXPECT_NE(work.digest, plain.digest) << "they share no pictures";
}

// 5 mm along the normal of stripes that are turned by 60 degrees: 5 / cos 60 = 10 mm.
TEST_F(StripeOffset, IsAlongTheNormalOfTheStripes) {
  const AcquireWork work = work_with(kRail, "offset_mm = 5\norientation_deg = 60\n");
  EXPECT_NEAR(work.steps.to_first_mm, 10.0, 1e-9);
  EXPECT_THAT(error_with(kRail, "offset_mm = 5\norientation_deg = 90\n"),
              HasSubstr("lighting.tunnel.offset_mm: is 5, must be 0 where the stripes run along"));
}

// A display shows what was drawn for it; without a stage the stripes stand where hands put them.
TEST_F(StripeOffset, IsRefusedWhereNothingMovesTheStripes) {
  EXPECT_THAT(error_with("", "offset_mm = 5\n"),
              HasSubstr("lighting.tunnel.offset_mm: is 5, and the cell has no [stage]"));
  write_file(folder_ / "a.png", "a");
  make_folder(folder_ / "show");
  const std::string display =
      "[stage]\nkind = \"folder\"\nfolder = \"show\"\npictures = [\"a.png\"]\n";
  EXPECT_THAT(error_with(display, "offset_mm = 5\n"), HasSubstr("are for stage.offset_mm = 0"));
  const AcquireWork drawn = work_with(display + "offset_mm = 5\n", "offset_mm = 5\n");
  EXPECT_EQ(drawn.digest, work_with(display, "").digest);
}

}  // namespace
}  // namespace glint
