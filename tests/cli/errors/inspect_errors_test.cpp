// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint inspect`: wrong input.
#include <limits>

#include "core/file.h"
#include "tests/cli/inspect_fixture.h"

namespace glint::test {
namespace {
namespace fs = std::filesystem;

TEST_F(InspectVerb, RefusesPicturesOfDifferentSize) {
  write_png(folder_ / "a.png", ImageF(20, 10, 0.5F), PixelDepth::k8Bit);
  write_png(folder_ / "b.png", ImageF(30, 10, 0.5F), PixelDepth::k8Bit);
  expect_refused({"a.png", "b.png"},
                 2,
                 "b\\.png: is 30 x 10 pixels, but a\\.png is 20 x 10: the pictures of a part must "
                 "have one size");
}

TEST_F(InspectVerb, RefusesMasksThatDoNotFit) {
  write_part("part");
  write_png(folder_ / "empty.png", ImageF(kWidth, kHeight), PixelDepth::k8Bit);
  expect_refused({"part"}, 2, "empty\\.png: the mask is empty: .*", {"--mask", "empty.png"});
  write_png(folder_ / "small.png", ImageF(10, 10, 1.0F), PixelDepth::k8Bit);
  expect_refused({"part"},
                 2,
                 "small\\.png: the mask is 10 x 10 pixels, the pictures are 160 x 100",
                 {"--mask", "small.png"});
  ImageF thin(kWidth, kHeight);
  thin(50, 50) = 1.0F;
  write_png(folder_ / "thin.png", thin, PixelDepth::k8Bit);
  expect_refused({"part"},
                 2,
                 "part: inspection\\.erosion_px: no pixel is left of 1 .*",
                 {"--mask", "thin.png"});
}

TEST_F(InspectVerb, RefusesBlackAndSaturatedParts) {
  write_png(folder_ / "black.png", ImageF(30, 20, 0.0F), PixelDepth::k8Bit);
  expect_refused({"black.png"}, 2, "black\\.png: black all over, .*");
  write_png(folder_ / "white.png", ImageF(30, 20, 1.0F), PixelDepth::k8Bit);
  expect_refused({"white.png"}, 2, "white\\.png: at full scale all over, .*");
  // On the part only: what is beside it does not count.
  ImageF picture(30, 20, 0.3F);
  ImageF mask(30, 20);
  for (int y = 5; y < 15; ++y) {
    for (int x = 5; x < 25; ++x) {
      picture(x, y) = 0.0F;
      mask(x, y) = 1.0F;
    }
  }
  write_png(folder_ / "hole.png", picture, PixelDepth::k8Bit);
  write_png(folder_ / "mask.png", mask, PixelDepth::k8Bit);
  expect_refused(
      {"hole.png"}, 2, "hole: the part is black in all pictures, .*", {"--mask", "mask.png"});
}

TEST_F(InspectVerb, RefusesWhatIsNoNumber) {
  ImageF picture(30, 20, 0.5F);
  picture(4, 7) = std::numeric_limits<float>::quiet_NaN();
  write_exr(folder_ / "nan.exr", picture);
  expect_refused({"nan.exr"}, 2, R"(nan\.exr: the value of pixel \(4, 7\) is no finite number)");
}

TEST_F(InspectVerb, RefusesWhatIsNoPicture) {
  fs::create_directories(folder_ / "empty");
  expect_refused({"empty"}, 2, "empty: holds no picture; .*");
  expect_refused({}, 2, "glint inspect: .*required.*");
  expect_refused({"none.png"}, 3, "none\\.png: there is no such file or folder");
  write_file(folder_ / "text.png", "no picture");
  expect_refused({"text.png"}, 2, "text\\.png: is no picture; allowed are PNG, .*");
  write_part("part");
  const std::string bytes = read_file(folder_ / "part/frame_2.png");
  write_file(folder_ / "part/frame_2.png", bytes.substr(0, bytes.size() / 2));
  expect_refused({"part"}, 2, "part/frame_2\\.png: the picture is cut short: its end is missing");
  expect_refused({"part", "text.png"}, 2, "text\\.png: is a file and part a folder: .*");
}

TEST_F(InspectVerb, RefusesWrongSettings) {
  write_part("part");
  expect_refused(
      {"part"}, 2, "--set: inspection\\.kernel_px: .*", {"--set", "inspection.kernel_px=8"});
  expect_refused({"part"},
                 2,
                 R"(--set: camera\.width_px: must begin with "inspection\.".*)",
                 {"--set", "camera.width_px=8"});
  write_file(folder_ / "a.toml", "[inspection]\nkernel_pix = 9\n");
  expect_refused({"part"},
                 2,
                 "a\\.toml:2:1: inspection\\.kernel_pix: unknown key, the nearest known one is "
                 "\"kernel_px\"",
                 {"--settings", "a.toml"});
  write_file(folder_ / "b.toml", "[camera]\n");
  expect_refused(
      {"part"}, 2, R"(b\.toml: holds no table \[inspection\])", {"--settings", "b.toml"});
  // Phases need three pictures at least.
  expect_refused({"part/frame_0.png", "part/frame_1.png"},
                 2,
                 "part: phases: 2 frames, .*",
                 {"--set", "inspection.filter=phase"});
}

TEST_F(InspectVerb, RefusesWrongLabels) {
  write_part("part");
  write_file(folder_ / "a.csv", "part,grade\npart,superb\n");
  expect_refused({"part"}, 2, "a\\.csv:2: must be a part's name, .*", {"--labels", "a.csv"});
  write_file(folder_ / "b.csv", "other,perfect\n");
  expect_refused(
      {"part"}, 2, "b\\.csv: there is no part other among those .*", {"--labels", "b.csv"});
  write_file(folder_ / "c.csv", "part,perfect\npart,rejected\n");
  expect_refused({"part"}, 2, "c\\.csv:2: part part has a grade already", {"--labels", "c.csv"});
  expect_refused({"part"}, 2, "--learn needs --labels .*", {"--learn"});
}

}  // namespace
}  // namespace glint::test
