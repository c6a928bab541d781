// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/cell_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/key_writer.h"
#include "core/config/toml.h"
#include "core/units.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::HasSubstr;

template <class Settings>
struct ReadTable {
  Settings settings;
  std::vector<Problem> errors;

  std::string first() const { return errors.empty() ? "" : errors.front().message(); }
};

template <class Settings>
ReadTable<Settings> read_as(const std::string& name, const std::string& text) {
  const ConfigNode root = parse_toml(text, "cell.toml");
  ReadTable<Settings> read;
  KeyReader reader(root.find(name), name, read.errors);
  visit_keys(reader, read.settings);
  reader.report_unknown();
  return read;
}

ReadTable<CalibrationSettings> calibration_from(const std::string& text) {
  return read_as<CalibrationSettings>("calibration", text);
}

constexpr const char* kOnFlange =
    "[calibration.flange_from_camera]\ntranslation_mm = [0, 60, 20]\n";

/// Variances of 15 quantities with a common part of 0.5 of each standard deviation.
Eigen::MatrixXd correlated(Eigen::Index size) {
  Eigen::VectorXd sigma(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    sigma[i] = 0.1 * static_cast<double>(1 + i);
  }
  Eigen::MatrixXd correlation = Eigen::MatrixXd::Constant(size, size, 0.25);
  correlation.diagonal().setOnes();
  return sigma.asDiagonal() * correlation * sigma.asDiagonal();
}

std::string written(CalibrationSettings settings) {
  ConfigNode table = ConfigNode::table();
  KeyWriter writer(table);
  visit_keys(writer, settings);
  ConfigNode root = ConfigNode::table();
  set_path(root, "calibration", table);
  return to_toml(root);
}

TEST(CalibrationSettings, ThePoseTellsTheSetup) {
  const auto read = calibration_from(kOnFlange);
  EXPECT_EQ(read.first(), "");
  EXPECT_EQ(read.settings.setup, CalibrationSetup::kEyeInHand);
  EXPECT_EQ(read.settings.flange_from_camera->pose.translation_mm[1], 60.0);
  EXPECT_EQ(calibration_from("[calibration.base_from_camera]\n").settings.setup,
            CalibrationSetup::kEyeToHand);
  EXPECT_EQ(calibration_from("[calibration]\n").settings.setup, CalibrationSetup::kNone);
}

TEST(CalibrationSettings, ASetupWithoutItsPoseIsAnError) {
  EXPECT_THAT(calibration_from("[calibration]\nsetup = \"eye_in_hand\"\n").first(),
              HasSubstr("cell.toml:2:1: calibration.setup: must be \"eye_in_hand\" with "
                        "[calibration.flange_from_camera]"));
  EXPECT_THAT(
      calibration_from(std::string("[calibration]\nsetup = \"none\"\n") + kOnFlange).first(),
      HasSubstr("calibration.setup: must be \"eye_in_hand\""));
  EXPECT_THAT(calibration_from(std::string(kOnFlange) + "[calibration.base_from_camera]\n").first(),
              HasSubstr("cell.toml:3:14: calibration.base_from_camera: cannot be given beside"));
}

// The diagonal of the hand-eye holds squares: 1.0^2 .. 1.5^2 by the pattern of correlated().
TEST(CalibrationSettings, WhatIsWrittenIsReadBackWithSigmas) {
  CalibrationSettings settings = {.setup = CalibrationSetup::kEyeInHand};
  settings.covariance = covariance_settings(correlated(15));
  settings.flange_from_camera = MeasuredPoseSettings{};
  take_sigmas(*settings.covariance, *settings.flange_from_camera);
  const std::string text = written(settings);
  const auto read = calibration_from(text);
  EXPECT_EQ(read.first(), "");
  EXPECT_NEAR(read.settings.flange_from_camera->sigma_rad[0], 1.0, 1e-12);
  EXPECT_NEAR(read.settings.flange_from_camera->sigma_mm[2], 1.5, 1e-12);
  EXPECT_EQ(written(read.settings), text);
  EXPECT_LT((covariance_of(*read.settings.covariance) - correlated(15)).norm(), 1e-12);
}

TEST(CalibrationSettings, SigmasThatAreNotToldComeFromTheCovariance) {
  CalibrationSettings settings = {.setup = CalibrationSetup::kEyeToHand};
  settings.base_from_camera = MeasuredPoseSettings{};
  settings.covariance = covariance_settings(correlated(15));
  const auto read = calibration_from(written(settings));
  EXPECT_EQ(read.first(), "");
  EXPECT_NEAR(read.settings.base_from_camera->sigma_mm[0], 1.3, 1e-12);
}

TEST(CalibrationSettings, SigmasThatContradictTheCovarianceAreAnError) {
  CalibrationSettings settings = {.setup = CalibrationSetup::kEyeInHand};
  settings.flange_from_camera = MeasuredPoseSettings{};
  settings.covariance = covariance_settings(correlated(15));
  take_sigmas(*settings.covariance, *settings.flange_from_camera);
  ConfigNode root = parse_toml(written(settings), "cell.toml");
  set_path(root, "calibration.flange_from_camera.sigma_mm.1", ConfigNode::from_number(2.0));
  EXPECT_THAT(calibration_from(to_toml(root)).first(), HasSubstr("do not agree with"));
}

TEST(Covariance, OfIntrinsicsAloneIsNineByNine) {
  const CovarianceSettings settings = covariance_settings(correlated(9));
  EXPECT_EQ(settings.intrinsics.size(), 45U);
  EXPECT_TRUE(settings.hand_eye.empty());
  EXPECT_TRUE(settings.cross.empty());
  // Row 1, column 0 is the second number: 0.25 * 0.1 * 0.2.
  EXPECT_NEAR(settings.intrinsics[1], 0.005, 1e-15);
  EXPECT_LT((covariance_of(settings) - correlated(9)).norm(), 1e-15);
  EXPECT_EQ(covariance_of({}).rows(), 0);
}

TEST(Covariance, MustHaveItsSizesAndNoNegativeVariance) {
  EXPECT_THAT(calibration_from("[calibration.covariance]\nintrinsics = [1, 2]\n").first(),
              HasSubstr("cell.toml:2:1: calibration.covariance.intrinsics: has 2 numbers, must "
                        "have 45"));
  std::string text = "[calibration.covariance]\nintrinsics = [1, 2, 1";  // a correlation of 2
  for (int row = 2; row < 9; ++row) {
    for (int column = 0; column <= row; ++column) {
      text += column == row ? ", 1" : ", 0";
    }
  }
  EXPECT_THAT(calibration_from(text + "]\n").first(), HasSubstr("is no covariance"));
  EXPECT_THAT(calibration_from("[calibration.covariance]\nhand_eye = [" +
                               std::string("1,0,1,0,0,1,0,0,0,1,0,0,0,0,1,0,0,0,0,0,1") + "]\n")
                  .first(),
              HasSubstr("calibration.covariance: hand_eye is of a pose that is not there"));
}

TEST(CellSettings, APartIsInOnePlace) {
  EXPECT_EQ(read_as<CellSettings>("cell", "[cell.base_from_part]\n").first(), "");
  EXPECT_THAT(
      read_as<CellSettings>("cell", "[cell.base_from_part]\n[cell.flange_from_part]\n").first(),
      HasSubstr("cell.toml:2:7: cell.flange_from_part: cannot be given beside base_from_part"));
  EXPECT_THAT(read_as<CellSettings>("cell", "[cell.base_from_par]\n").first(),
              HasSubstr("the nearest known one is \"base_from_part\""));
}

TEST(ReferenceSettings, HasAMaskForEachPictureOrNone) {
  const TemporaryFolder folder;
  for (const char* name : {"a.png", "b.png"}) {
    write_file(folder / name, "");
  }
  const auto read = [&](const std::string& keys) {
    const std::filesystem::path file = folder / "scene.toml";
    write_file(file, "[reference]\n" + keys);
    ReadTable<ReferenceSettings> result;
    const ConfigNode root = load_toml(file);
    KeyReader reader(root.find("reference"), "reference", result.errors);
    visit_keys(reader, result.settings);
    reader.report_unknown();
    return result;
  };
  const auto two = read("pictures = [\"a.png\", \"b.png\"]\n");
  EXPECT_EQ(two.first(), "");
  EXPECT_EQ(two.settings.pictures[1], folder / "b.png");
  EXPECT_THAT(read("pictures = [\"a.png\", \"b.png\"]\nmasks = [\"a.png\"]\n").first(),
              HasSubstr("reference.masks: are 1, must be none or one for each of the 2 pictures"));
  EXPECT_THAT(read("pictures = [\"c.png\"]\n").first(), HasSubstr("c.png does not exist"));
  EXPECT_THAT(read("pictures = \"a.png\"\n").first(), HasSubstr("must be an array of file names"));
  EXPECT_THAT(read("pictures = [1]\n").first(), HasSubstr("must be a file name in quotes"));
}

}  // namespace
}  // namespace glint
