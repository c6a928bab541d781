// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/real_pictures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using testing::HasSubstr;

std::string error_of(const std::filesystem::path& folder) {
  try {
    read_real_design("ring", folder);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(RealPictures, ReadsWhatWasAcquired) {
  const TemporaryFolder folder;
  make_folder(folder.path() / "views/a");
  write_file(folder.path() / "views/a/one.png", "x");
  write_file(folder.path() / "acquired.json",
             R"({"kind": "acquired", "status": "partial", "twin": true,
    "calibration": "calibration.toml", "pictures": [
    {"view": "a", "file": "views/a/one.png", "accepted": true, "base_from_flange": [1, 2, 3, 0, 0, 0], "position_sigma_mm": 0.1},
    {"view": "b", "file": "views/b/one.png", "accepted": false, "reason": "blurred"}]})");
  const RealDesign design = read_real_design("ring", folder.path());
  ASSERT_EQ(design.views.size(), 1U);
  EXPECT_EQ(design.views[0].name, "a");
  EXPECT_DOUBLE_EQ(design.views[0].base_from_flange->translation_mm.z(), 3.0);
  EXPECT_DOUBLE_EQ(design.views[0].position_sigma_mm, 0.1);
  EXPECT_EQ(design.calibration, folder.path() / "calibration.toml");
  EXPECT_TRUE(design.is_of_twin);
  EXPECT_EQ(design.notes.size(), 2U);
}

TEST(RealPictures, RefusesWhatIsNoListOfPictures) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "acquired.json";
  write_file(file, "{]");
  EXPECT_THAT(error_of(folder.path()), HasSubstr("acquired.json: is no list of acquired pictures"));
  write_file(file, R"({"kind": "acquired"})");
  EXPECT_THAT(error_of(folder.path()), HasSubstr("has no list \"pictures\""));
  write_file(file, R"({"kind": "acquired", "pictures": [{"view": 3}]})");
  EXPECT_THAT(error_of(folder.path()), HasSubstr("without \"view\" or \"file\""));
  write_file(file, R"({"kind": "acquired", "pictures": [{"view": "a", "file": "no.png"}]})");
  EXPECT_THAT(error_of(folder.path()), HasSubstr("there is no such file"));
  write_file(file, R"({"kind": "acquired", "pictures": []})");
  EXPECT_THAT(error_of(folder.path()), HasSubstr("has no accepted picture"));
}

}  // namespace
}  // namespace glint
