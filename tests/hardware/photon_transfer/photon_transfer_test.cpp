// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/photon_transfer/photon_transfer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "core/error.h"

namespace glint {
namespace {

/// A sensor as the model has it: 0.25 DN per electron, 8 electrons of read noise, 40 of dark
/// signal.
struct Model {
  double gain = 0.25;
  double read_e = 8.0;
  double dark_e = 40.0;
  double full_dn = 4095.0;
  double bend = 0.0;  ///< share that the response loses at full scale

  LevelStatistics level(double exposure, bool is_dark) const {
    const double light_e = is_dark ? 0.0 : 1000.0 * exposure;
    const double mean = gain * (light_e * (1.0 - bend * light_e * gain / full_dn) + dark_e);
    const double variance = gain * gain * (light_e + dark_e + read_e * read_e) + 1.0 / 12.0;
    LevelStatistics level{.is_dark = is_dark, .exposure = exposure, .pictures = 2};
    level.photons = is_dark ? 0.0 : 2000.0 * exposure;
    level.mean_dn = std::min(mean, full_dn);
    level.temporal_variance_dn2 = mean < full_dn ? variance : 0.0;
    level.clipped_share = mean < full_dn ? 0.0 : 1.0;
    level.variance_error_dn2 = 0.002 * level.temporal_variance_dn2;
    return level;
  }

  std::vector<LevelStatistics> series(double most) const {
    std::vector<LevelStatistics> levels;
    for (int i = 1; i <= 12; ++i) {
      levels.push_back(level(most * i / 12.0, false));
      levels.push_back(level(most * i / 12.0, true));
    }
    return levels;
  }
};

TEST(PhotonTransfer, FindsTheModelThatMadeTheLevels) {
  const Model model;
  const PhotonTransfer found = photon_transfer(model.series(20.0), model.full_dn);
  EXPECT_NEAR(found.fit.slope, 0.25, 1e-9);
  // 0.0625 x 64 + 1/12 = 4.0833 DN^2 at mean 0.
  EXPECT_NEAR(found.fit.offset, 4.08333, 1e-5);
  EXPECT_NEAR(found.read_noise_e, 8.0, 1e-6);
  EXPECT_NEAR(found.dark_e, 40.0, 1e-9);
  EXPECT_NEAR(found.full_scale_e, 4095.0 / 0.25, 1e-6);
  EXPECT_NEAR(found.quantum_efficiency, 0.5, 1e-9);
  EXPECT_NEAR(found.linearity_error.value(), 0.0, 1e-9);
  EXPECT_TRUE(found.has_saturated);
  // Of 1.667, 3.333, ... thousand electrons the last below 4095 DN is 15 thousand: 3760 DN.
  EXPECT_NEAR(found.saturation_dn, 3760.0, 1e-6);
  EXPECT_EQ(found.warnings, std::vector<std::string>());
}

TEST(PhotonTransfer, LevelsAboveSeventyPerCentDoNotCount) {
  const Model model;
  const std::vector<LevelStatistics> levels = model.series(20.0);
  const PhotonTransfer found = photon_transfer(levels, model.full_dn);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    EXPECT_EQ(found.is_fitted[i], levels[i].is_dark || levels[i].mean_dn < 0.7 * 3760.0 + 3.0)
        << levels[i].mean_dn;
  }
}

TEST(PhotonTransfer, TellsAResponseThatIsBent) {
  const Model straight;
  const Model bent{.bend = 0.05};
  EXPECT_GT(photon_transfer(bent.series(14.0), bent.full_dn).linearity_error.value(), 0.004);
  EXPECT_LT(photon_transfer(straight.series(14.0), 4095.0).linearity_error.value(), 1e-9);
}

// Levels by light at one exposure: light over exposure says nothing.
TEST(PhotonTransfer, KnowsNoLinearityWhereExposuresDoNotDiffer) {
  const Model model;
  std::vector<LevelStatistics> levels = model.series(20.0);
  for (LevelStatistics& level : levels) {
    level.exposure = 10.0;
  }
  const PhotonTransfer found = photon_transfer(levels, model.full_dn);
  EXPECT_FALSE(found.linearity_error.has_value());
  EXPECT_EQ(found.rate_dn, 0.0);
  EXPECT_NEAR(found.fit.slope, 0.25, 1e-9);
  ASSERT_EQ(found.warnings.size(), 1U);
  EXPECT_NE(found.warnings[0].find("do not differ in exposure"), std::string::npos);
}

TEST(PhotonTransfer, WarnsWhereTheSimulatedSensorCannotFollow) {
  Model black_level;
  std::vector<LevelStatistics> levels = black_level.series(14.0);
  for (LevelStatistics& level : levels) {
    level.mean_dn += 100.0;
  }
  const PhotonTransfer found = photon_transfer(levels, black_level.full_dn);
  EXPECT_NEAR(found.fit.slope, 0.25, 1e-9);
  EXPECT_EQ(found.read_noise_e, 0.0);
  ASSERT_EQ(found.warnings.size(), 2U);  // and no level saturates
  EXPECT_NE(found.warnings[0].find("black level"), std::string::npos);
}

/// 8 bits without a black level: 5 electrons of noise are 0.1 DN, so all codes in the dark are 0.
TEST(PhotonTransfer, DoesNotFitADarkLevelBelowRounding) {
  const Model model{.gain = 0.02, .read_e = 5.0, .dark_e = 0.0, .full_dn = 255.0};
  std::vector<LevelStatistics> levels;
  for (const LevelStatistics& level : model.series(14.0)) {
    if (!level.is_dark) {
      levels.push_back(level);
    }
  }
  levels.push_back({.is_dark = true, .exposure = 1.0, .pictures = 2, .zero_share = 1.0});
  const PhotonTransfer found = photon_transfer(levels, model.full_dn);
  EXPECT_FALSE(found.is_fitted.back());
  EXPECT_NEAR(found.fit.slope, 0.02, 1e-9);
  EXPECT_LT(found.fit.slope_sigma, 0.05 * 0.02);
  // sqrt(0.24 - 1/12) / 0.02 = 19.79 electrons: the true 5 are within the bound.
  EXPECT_NEAR(found.read_noise_e, 19.79, 0.01);
  EXPECT_NEAR(found.dark_noise_e, 19.79, 0.01);
  ASSERT_EQ(found.warnings.size(), 1U);
  EXPECT_NE(found.warnings[0].find("read_noise_e is only an upper bound"), std::string::npos);
}

/// Half of a noise of 2 DN about 0 is cut off: its mean is 0.4 sigma, its variance 0.34 of the
/// whole.
TEST(PhotonTransfer, TellsOfNoiseThatIsCutOffAtZero) {
  const Model model{.dark_e = 0.0};
  std::vector<LevelStatistics> levels = model.series(20.0);
  for (LevelStatistics& level : levels) {
    if (level.is_dark) {
      level.mean_dn = 0.8;
      level.temporal_variance_dn2 = 1.39;
      level.zero_share = 0.6;
    }
  }
  const PhotonTransfer found = photon_transfer(levels, model.full_dn);
  EXPECT_NEAR(found.fit.slope, 0.25, 1e-9);
  EXPECT_NEAR(found.fit.offset, 4.08333, 1e-5);
  ASSERT_EQ(found.warnings.size(), 1U);
  EXPECT_NE(found.warnings[0].find("cut off at code 0"), std::string::npos);
}

TEST(PhotonTransfer, RefusesWhatSaysNothingOfNoise) {
  const Model model;
  std::vector<LevelStatistics> bright;
  for (const LevelStatistics& level : model.series(10.0)) {
    if (!level.is_dark) {
      bright.push_back(level);
    }
  }
  EXPECT_THROW(photon_transfer(bright, model.full_dn), ConfigError);
  const std::vector<LevelStatistics> two = {
      model.level(1.0, false), model.level(2.0, false), model.level(1.0, true)};
  EXPECT_THROW(photon_transfer(two, model.full_dn), ConfigError);
  std::vector<LevelStatistics> quiet = model.series(10.0);
  for (LevelStatistics& level : quiet) {
    level.temporal_variance_dn2 = 5.0 - 1e-4 * level.mean_dn;
  }
  EXPECT_THROW(photon_transfer(quiet, model.full_dn), ConfigError);
}

// Copies have the noise of one picture over the pixels, and none between them.
TEST(PhotonTransfer, NamesALevelOfCopies) {
  const Model model;
  std::vector<LevelStatistics> levels = model.series(12.0);
  levels[4].spatial_variance_dn2 = levels[4].temporal_variance_dn2;
  levels[4].temporal_variance_dn2 = 1e-20;
  try {
    photon_transfer(levels, model.full_dn);
    FAIL() << "no error";
  } catch (const ConfigError& error) {
    // 0.25 (3000 + 40) = 760 DN.
    EXPECT_NE(std::string(error.what()).find("exposure 3 (mean 760 DN) are all alike"),
              std::string::npos)
        << error.what();
  }
}

// All pixels but a dead one are at full scale, in every picture.
TEST(PhotonTransfer, TakesASaturatedLevelWithADeadPixelForNoCopies) {
  const Model model;
  std::vector<LevelStatistics> levels = model.series(12.0);
  const PhotonTransfer without = photon_transfer(levels, model.full_dn);
  LevelStatistics full = levels.back();
  full.exposure = 1000.0;
  full.is_dark = false;
  full.mean_dn = model.full_dn - 0.1;
  full.temporal_variance_dn2 = 0.0;
  full.spatial_variance_dn2 = 16.0;
  full.clipped_share = 0.999999;
  levels.push_back(full);
  EXPECT_NEAR(photon_transfer(levels, model.full_dn).fit.slope,
              without.fit.slope,
              0.01 * without.fit.slope);
}

/// Three bright levels of at most 85 of 4095 DN, as of codes of 8 bits that are read as 12.
TEST(PhotonTransfer, RefusesLevelsThatAreAllFarBelowSaturation) {
  const Model model;
  try {
    photon_transfer(model.series(0.3), model.full_dn);
    FAIL() << "no error";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("between 5 and 95 % of saturation (4095 DN)"),
              std::string::npos)
        << error.what();
  }
}

TEST(FittedLine, WeighsItsPoints) {
  // Two points on y = 1 + 2 x that count and one that hardly does.
  const std::array x = {0.0, 1.0, 2.0};
  const std::array y = {1.0, 3.0, 9.0};
  const std::array one = {1.0, 1.0, 1.0};
  const LineFit fit = fitted_line(x, y, std::array{1e6, 1e6, 1e-6}, one);
  EXPECT_NEAR(fit.offset, 1.0, 1e-6);
  EXPECT_NEAR(fit.slope, 2.0, 1e-6);
  // Equal weights: slope 4, offset 1/3; residuals 2/3, -4/3, 2/3, their squares' sum 8/3 over one
  // degree of freedom, xx = 2: sigma = sqrt(8/3 / 2).
  const LineFit even = fitted_line(x, y, one, one);
  EXPECT_DOUBLE_EQ(even.slope, 4.0);
  EXPECT_NEAR(even.offset, 1.0 / 3.0, 1e-12);
  EXPECT_NEAR(even.slope_sigma, std::sqrt(4.0 / 3.0), 1e-12);
  // Points on a line: what the errors say, sqrt(1 / 2).
  EXPECT_NEAR(fitted_line(x, x, one, one).slope_sigma, std::sqrt(0.5), 1e-12);
}

}  // namespace
}  // namespace glint
