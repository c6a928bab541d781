// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/cell/cell_stage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "core/image/image_io.h"
#include "hardware/twin/stage/stage_twin.h"
#include "studies/cell/cell_file.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using testing::HasSubstr;

std::string problem_of_stage(const std::string& text) {
  const TemporaryFolder folder;
  write_file(folder / "cell.toml", "[camera]\naddress = \"127.0.0.1\"\n" + text);
  try {
    read_cell(folder / "cell.toml");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(CellStage, NamesWhatIsMissing) {
  EXPECT_EQ(problem_of_stage("[stage]\nhost = \"127.0.0.1\"\n"), "");
  EXPECT_THAT(problem_of_stage("[stage]\n"), HasSubstr("either host or device"));
  EXPECT_THAT(problem_of_stage("[stage]\nkind = \"folder\"\n"), HasSubstr("stage.pictures"));
  EXPECT_THAT(problem_of_stage("[stage]\nkind = \"rail\"\n"), HasSubstr("framebuffer"));
  EXPECT_THAT(problem_of_stage("[stage]\nhost = \"1.2.3.4\"\nspeed_mm_s = 0\n"),
              HasSubstr("stage.speed_mm_s"));
  EXPECT_THAT(problem_of_stage("[acquisition]\nmax_retakes = 50\n"),
              HasSubstr("acquisition.max_retakes"));
  EXPECT_THAT(problem_of_stage("[twin]\nmotion_speedup = 0\n"), HasSubstr("twin.motion_speedup"));
}

// Nothing in the file: 6 positions 2 mm apart, as the scan has them.
TEST(CellStage, TakesFromTheScanWhatItDoesNotTell) {
  const StageWay way = stage_way_of({.first_mm = 5.0}, 6, {.to_next_mm = 2.0});
  EXPECT_EQ(way.positions, 6);
  EXPECT_DOUBLE_EQ(way.at_mm(3), 11.0);
  const StageWay own = stage_way_of({.positions = 4, .step_mm = -1.0}, 6, {.to_next_mm = 2.0});
  EXPECT_EQ(own.positions, 4);
  EXPECT_DOUBLE_EQ(own.at_mm(3), -3.0);
}

// 5 + 1.5 + 3 * 2; of a stage that counts against the scan 5 - 1.5 - 3 * 2.
TEST(CellStage, BeginsWhereTheDesignsStripesDo) {
  const ScanSteps steps = {.to_first_mm = 1.5, .to_next_mm = 2.0};
  EXPECT_DOUBLE_EQ(stage_way_of({.first_mm = 5.0}, 6, steps).at_mm(3), 12.5);
  EXPECT_DOUBLE_EQ(stage_way_of({.first_mm = 5.0, .step_mm = -2.0}, 6, steps).at_mm(3), -2.5);
}

TEST(CellStage, MovesATwin) {
  const StageTwin twin({});
  const CellStage settings = {.host = "127.0.0.1", .port = twin.port(), .speed_mm_s = 400.0};
  const ConnectedStage connected = connect_stage(settings, 6, {.to_next_mm = 2.0});
  connected.stage->go_to(4);
  EXPECT_EQ(connected.stage->position(), 4);
  EXPECT_DOUBLE_EQ(twin.position_mm(), 8.0);
}

TEST(CellStage, ShowsPicturesInAFolder) {
  const TemporaryFolder folder;
  write_png(folder / "one.png", ImageF(4, 3), PixelDepth::k8Bit);
  const ConnectedStage connected = connect_stage({.kind = CellStage::Kind::kFolder,
                                                  .folder = folder / "shown",
                                                  .pictures = {folder / "one.png"},
                                                  .settle_s = 0.0},
                                                 1,
                                                 {});
  connected.stage->go_to(0);
  EXPECT_EQ(read_image(folder / "shown/show.png").width(), 4);
}

}  // namespace
}  // namespace glint
