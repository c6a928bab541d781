// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate_cell/placement_record.h"

#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "studies/acquire/acquired.h"
#include "studies/acquire/journal.h"
#include "tests/support/temporary_folder.h"

namespace glint::calibrate_cell_detail {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;
namespace fs = std::filesystem;

class Placements : public testing::Test {
 protected:
  fs::path pictures(int number) const { return record_.numbered("placement", number); }

  /// Two pictures, one of which was rejected, as `glint acquire` leaves them.
  void photograph(int number, const std::string& seen, const std::string& status) const {
    make_folder(pictures(number));
    AcquireJournal journal(pictures(number), "plan");
    journal.keep(
        {.view = "view_1", .file = "rejected/view_1/frame_000_try_1.png", .is_accepted = false},
        "blurred" + seen);
    journal.keep({.view = "view_1", .file = "views/view_1/sequence/frame_000.png"}, seen);
    Json acquired = {{"kind", "acquired"}, {"status", status}, {"counts", {{"accepted", 1}}}};
    acquired["pictures"] = Json::array();
    for (const AcquiredPicture& picture : journal.pictures()) {
      acquired["pictures"].push_back(picture_json(picture));
    }
    write_file(pictures(number) / "acquired.json", acquired.dump());
  }

  /// Put down, photographed and found.
  void finish(int number, const std::string& seen) const {
    record_.put_down(number);
    photograph(number, seen, "complete");
    write_file(record_.numbered("edges", number, ".csv"), "x_px\n");
    record_.keep_found(number, kScene, told_);
  }

  static constexpr const char* kScene = "schema = 2\n";

  TemporaryFolder folder_;
  PlacementRecord record_{folder_.path()};
  Json told_ = {{"settled", true}, {"rms_px", 0.1}};
};

TEST_F(Placements, AreFoundOnceInTheSamePicturesOfTheSameScene) {
  finish(1, "as it lay");
  EXPECT_EQ(record_.found(1, kScene), told_);
  EXPECT_FALSE(record_.found(1, "schema = 1\n").has_value());
  EXPECT_FALSE(record_.found(2, kScene).has_value());
  // Earlier programs did not tell of which pictures.
  write_file(record_.numbered("found", 1, ".json"),
             Json{{"scene", kScene}, {"told", told_}}.dump());
  EXPECT_FALSE(record_.found(1, kScene).has_value());
}

TEST_F(Placements, AreLookedForAnewInPicturesThatWereTakenAnew) {
  finish(1, "as it lay");
  fs::remove_all(pictures(1));
  photograph(1, "as it lies now", "complete");
  EXPECT_FALSE(record_.found(1, kScene).has_value());
  record_.keep_found(1, kScene, {{"settled", false}});
  EXPECT_EQ(record_.found(1, kScene).value()["settled"], false);
}

TEST_F(Placements, ArePutDownAnewWhereTheirPicturesWereRemoved) {
  EXPECT_FALSE(record_.is_put_down(1));
  record_.put_down(1);
  EXPECT_TRUE(record_.is_put_down(1)) << "nothing is photographed yet";
  photograph(1, "badly seated", "stopped");  // nothing was looked for in these pictures
  fs::remove_all(pictures(1));
  EXPECT_FALSE(record_.is_put_down(1));
  finish(1, "first");
  finish(2, "second");
  EXPECT_TRUE(record_.is_put_down(1));
  EXPECT_TRUE(record_.is_put_down(2));
  EXPECT_FALSE(record_.is_put_down(3));
  for (const int number : {1, 2}) {
    fs::remove_all(pictures(number));
    EXPECT_FALSE(record_.is_put_down(number)) << number;
    record_.put_down(number);
    EXPECT_TRUE(record_.is_put_down(number));
    finish(number, "anew");
  }
  EXPECT_TRUE(record_.is_put_down(1));
  EXPECT_TRUE(record_.is_put_down(2));
}

// The part has lain in two ways since the first of these pictures.
TEST_F(Placements, AreNotCompletedAfterThePartWasPutDownForAnother) {
  finish(1, "first");
  record_.put_down(2);
  photograph(2, "second", "stopped");
  EXPECT_TRUE(record_.is_put_down(2)) << "the same command goes on";
  fs::remove_all(pictures(1));
  finish(1, "anew");
  EXPECT_THAT([&] { record_.is_put_down(2); },
              testing::ThrowsMessage<ConfigError>(
                  HasSubstr("placement_2: holds only some of the pictures of placement 2, and the "
                            "part has been put down for placement 1 since; remove this folder")));
  fs::remove_all(pictures(2));
  EXPECT_FALSE(record_.is_put_down(2));
}

}  // namespace
}  // namespace glint::calibrate_cell_detail
