// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/image/image_io.h"
#include "core/rng.h"
#include "tests/cli/program.h"

namespace glint::test {

/// `glint inspect` in a folder of its own.
class InspectVerb : public ::testing::Test {
 protected:
  static constexpr int kWidth = 160;
  static constexpr int kHeight = 100;

  /// A grey part on black, 20 px from the picture's rim, with noise of a hundredth.
  static ImageF plain_part(std::uint64_t seed) {
    ImageF picture(kWidth, kHeight, 0.02F);
    Rng rng(seed, Stream::kTest, 0);
    for (int y = 20; y < kHeight - 20; ++y) {
      for (int x = 20; x < kWidth - 20; ++x) {
        picture(x, y) = static_cast<float>(0.5 + rng.uniform(-0.01, 0.01));
      }
    }
    return picture;
  }

  static void add_spot(ImageF& picture, int x, int y, int radius, float change) {
    for (int dy = -radius; dy <= radius; ++dy) {
      for (int dx = -radius; dx <= radius; ++dx) {
        if (dx * dx + dy * dy <= radius * radius) {
          picture(x + dx, y + dy) += change;
        }
      }
    }
  }

  static void add_line(ImageF& picture, int x, int y, int length, float change) {
    for (int i = 0; i < length; ++i) {
      picture(x + i, y + i / 2) += change;
      picture(x + i, y + i / 2 + 1) += change;
    }
  }

  /// Four pictures of a part with a dark hole at (60, 50) and a dark scratch from (90, 40).
  void write_part(const std::string& name,
                  bool has_defects = true,
                  PixelDepth depth = PixelDepth::k8Bit) const {
    std::filesystem::create_directories(folder_ / name);
    for (int frame = 0; frame < 4; ++frame) {
      ImageF picture = plain_part(static_cast<std::uint64_t>(frame) + 1);
      if (has_defects) {
        add_spot(picture, 60, 50, 3, -0.2F);
        add_line(picture, 90, 40, 24, -0.2F);
      }
      write_png(folder_ / name / fmt::format("frame_{}.png", frame), picture, depth);
    }
  }

  ProgramResult inspect(const Arguments& inputs, const Arguments& more = {}) const {
    Arguments arguments = {"inspect"};
    arguments.insert(arguments.end(), inputs.begin(), inputs.end());
    // Of one polarity alone: beside a strong defect the filter answers with the other one.
    arguments.insert(arguments.end(),
                     {"--quiet", "--out", "out", "--set", "inspection.polarity=dark"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return glint_in(folder_, arguments);
  }

  nlohmann::json inspect_json(const Arguments& inputs, Arguments more = {}, int code = 0) const {
    more.emplace_back("--json");
    const ProgramResult result = inspect(inputs, more);
    EXPECT_EQ(result.code, code) << result.err;
    return result.out.empty() ? nlohmann::json() : nlohmann::json::parse(result.out);
  }

  /// One line on stderr, nothing on stdout, no folder.
  void expect_refused(const Arguments& inputs,
                      int code,
                      const std::string& message,
                      const Arguments& more = {}) const {
    const ProgramResult result = inspect(inputs, more);
    EXPECT_EQ(result.code, code);
    EXPECT_THAT(result.err, ::testing::MatchesRegex(message + "\n"));
    EXPECT_EQ(result.out, "");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  }

  TemporaryFolder folder_;
};

}  // namespace glint::test
