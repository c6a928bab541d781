// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/poses/pose_pairing.h"

#include <gmock/gmock.h>

#include "core/error.h"

namespace glint {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Names = std::vector<std::string>;

std::string pairing_error(const Names& pictures, const Names& poses, PairBy by = PairBy::kAuto) {
  try {
    pair_poses(pictures, poses, by);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

// Pictures of the same name in a folder for each view, as glint acquire leaves them.
TEST(PairPoses, TakesTheEndsOfPathsWherePosesNameFolders) {
  const Names poses = {"views/left/sequence/frame_000.png", "views/right/sequence/frame_000.png"};
  const Pairing pairing = pair_poses(
      Names{"out/views/right/sequence/frame_000.png", "out/views/left/sequence/frame_000.png"},
      poses,
      PairBy::kAuto);
  EXPECT_THAT(pairing.pose_of, ElementsAre(1, 0));
  EXPECT_THAT(pairing.told, HasSubstr("ends of paths"));
  EXPECT_THAT(
      pairing_error(Names{"out/views/right/frame_000.png", "out/views/left/frame_000.png"}, poses),
      HasSubstr("occurs twice"));
  // The folders of others are none of ours: names decide as before.
  EXPECT_THAT(
      pair_poses(Names{"x/a.png", "x/b.png"}, Names{"y/b.png", "y/a.png"}, PairBy::kAuto).pose_of,
      ElementsAre(1, 0));
}

TEST(PairPoses, TakesNamesFirstThenLastNumbersThenTheOrder) {
  const Pairing by_name =
      pair_poses(Names{"d/a.png", "d/b.png"}, Names{"b.png", "a.png"}, PairBy::kAuto);
  EXPECT_THAT(by_name.pose_of, ElementsAre(1, 0));
  EXPECT_THAT(by_name.told, HasSubstr("pair_by = \"name\""));
  EXPECT_THAT(pair_poses(Names{"a.png", "b.png"}, Names{"b", "a"}, PairBy::kAuto).pose_of,
              ElementsAre(1, 0));
  const Pairing by_number = pair_poses(Names{"franka_image-1.png", "franka_image-10.png"},
                                       Names{"pose_10", "pose_01"},
                                       PairBy::kAuto);
  EXPECT_THAT(by_number.pose_of, ElementsAre(1, 0));
  EXPECT_THAT(by_number.told, HasSubstr("pair_by = \"last_number\""));
  const Pairing by_order = pair_poses(Names{"x.png", "y.png"}, Names{"", ""}, PairBy::kAuto);
  EXPECT_THAT(by_order.pose_of, ElementsAre(0, 1));
  EXPECT_THAT(by_order.told, HasSubstr("pair_by = \"order\""));
  EXPECT_THAT(pair_poses(Names{"x", "y"}, Names{"b", "a"}, PairBy::kOrder).pose_of,
              ElementsAre(0, 1));
}

TEST(PairPoses, RefusesWhatIsMissingSurplusOrAmbiguous) {
  EXPECT_THAT(pairing_error({"a.png", "b.png"}, {"a.png"}), HasSubstr("no pose for b.png"));
  EXPECT_THAT(pairing_error({"a.png"}, {"a.png", "b.png"}), HasSubstr("no picture for b.png"));
  EXPECT_THAT(pairing_error({"l/1.png", "r/1.png"}, {"p1", "q1"}), HasSubstr("occurs twice"));
  EXPECT_THAT(pairing_error({"x.png", "y.png"}, {"p", "q"}), HasSubstr("cannot be paired"));
  EXPECT_THAT(pairing_error({"x.png", "y.png"}, {""}), HasSubstr("2 pictures and 1 poses"));
  EXPECT_THAT(pairing_error({"a1.png"}, {"b1"}, PairBy::kName), HasSubstr("no pose for a1.png"));
}

}  // namespace
}  // namespace glint
