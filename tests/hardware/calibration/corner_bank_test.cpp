// SPDX-License-Identifier: GPL-3.0-or-later
//
// Banks of corner errors: their file, their groups, and noise drawn from them.
#include "tests/hardware/calibration/corner_bank.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "tests/hardware/calibration/corner_bank_file.h"
#include "tests/hardware/calibration/monte_carlo.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using ::testing::HasSubstr;

const BankHeader kBankHeader = {.seed = 1, .scene = "1224 x 1025 px, f/4", .inputs = "a1"};

/// A picture whose corners are all blurred alike.
BankPicture alike(const std::vector<Vector2d>& errors_px, double blur_px, double turn_deg) {
  BankPicture picture{.f_number = 4.0, .tilt_deg = 12.5, .turn_deg = turn_deg};
  for (const Vector2d& error : errors_px) {
    picture.corners.push_back(
        {.error_px = error, .blur_px = blur_px, .distance_mm = 150.5, .radius_px = 320.5});
  }
  return picture;
}

/// Normal errors of two sizes along axes that are turned by 30 degrees, and a bias.
std::vector<Vector2d> skew_errors(int count, double size_px, const Vector2d& bias_px) {
  Rng rng(7, Stream::kTest, 0);
  std::vector<Vector2d> errors;
  for (int i = 0; i < count; ++i) {
    const double along = size_px * rng.normal();
    const double across = 0.3 * size_px * rng.normal();
    errors.emplace_back(bias_px + Vector2d(std::sqrt(0.75) * along - 0.5 * across,
                                           0.5 * along + std::sqrt(0.75) * across));
  }
  return errors;
}

TEST(CornerBlur, IsThatOfTheDiscTheSensorAndThePixel) {
  const CornerBlur blur = {.aperture_mm = 3.0,
                           .focus_mm = 100.0,
                           .image_distance_mm = 10.0,
                           .pixel_mm = 0.01,
                           .sensor_px = 0.4};
  EXPECT_NEAR(blur.sigma_px(100.0), std::sqrt(0.16 + 1.0 / 12.0), 1e-12);
  // 3 mm x 10 mm x (1/100 - 1/200) / mm = 0.15 mm, 15 px across, a quarter of which is sigma.
  EXPECT_NEAR(blur.sigma_px(200.0), std::sqrt(3.75 * 3.75 + 0.16 + 1.0 / 12.0), 1e-12);
}

TEST(TurnOnPixels, IsTheSameAfterAQuarterTurn) {
  const Vector2d from(100.0, 200.0);
  const double turn_deg = turn_on_pixels_deg(from, from + Vector2d(10.0, -1.0));
  EXPECT_NEAR(turn_deg, -5.7106, 1e-4);
  for (const Vector2d& along : {Vector2d(1.0, 10.0), Vector2d(-10.0, 1.0), Vector2d(-1.0, -10.0)}) {
    EXPECT_NEAR(turn_on_pixels_deg(from, from + along), turn_deg, 1e-9);
  }
  EXPECT_NEAR(turn_on_pixels_deg(from, from + Vector2d(10.0, 9.0)), 41.9872, 1e-4);
  EXPECT_NEAR(turn_on_pixels_deg(from, from + Vector2d(9.0, 10.0)), -41.9872, 1e-4);
}

TEST(CornerErrors, AreBiasAndCovariance) {
  const CornerErrors errors =
      corner_errors(std::vector<Vector2d>{{1.0, 0.0}, {3.0, 0.0}, {1.0, 2.0}, {3.0, 2.0}});
  EXPECT_EQ(errors.corners, 4);
  EXPECT_LT((errors.bias_px - Vector2d(2.0, 1.0)).norm(), 1e-12);
  EXPECT_LT((errors.covariance_px2 - Eigen::Matrix2d::Identity()).norm(), 1e-12);
  EXPECT_NEAR(errors.rms_px(), std::sqrt(3.5), 1e-12);  // (2 + 5) / 2
  EXPECT_EQ(corner_errors({}).rms_px(), 0.0);
}

TEST(CornerBank, DrawsErrorsOfTheBanksBiasAndCovariance) {
  const std::vector<Vector2d> sharp = skew_errors(400, 0.04, {0.01, -0.02});
  const std::vector<Vector2d> blurred = skew_errors(400, 0.2, {0.0, 0.0});
  const CornerBank bank(std::vector{alike(sharp, 0.7, 5.0), alike(blurred, 2.0, 5.0)});
  Rng rng(1, Stream::kTest, 1);
  std::vector<Vector2d> drawn;
  for (int i = 0; i < 20'000; ++i) {
    drawn.push_back(bank.draw(0.75, -10.0, rng));
  }
  for (int i = 0; i < 100; ++i) {
    const Vector2d& one = drawn[static_cast<std::size_t>(i)];
    EXPECT_TRUE(std::ranges::any_of(sharp, [&](const Vector2d& error) { return error == one; }))
        << "a whole error of the bank";
  }
  const CornerErrors of_bank = corner_errors(sharp);
  const CornerErrors of_drawn = corner_errors(drawn);
  // A mean of 20,000 scatters by 0.7 % of sigma, a variance by 1 %.
  EXPECT_LT((of_drawn.bias_px - of_bank.bias_px).norm(), 0.04 * of_bank.rms_px());
  EXPECT_LT((of_drawn.covariance_px2 - of_bank.covariance_px2).norm(),
            0.06 * of_bank.covariance_px2.norm());
  // Negative control: the other group's are not these.
  EXPECT_GT(corner_errors(bank.like(2.0, 0.0)).rms_px(), 3.0 * of_drawn.rms_px());
}

TEST(CornerBank, AGroupOfTooFewGivesWayToTheNextBlurOfTheSameTurn) {
  const std::vector<Vector2d> few(49, Vector2d(1.0, 0.0));
  const std::vector<Vector2d> sharp(50, Vector2d(2.0, 0.0));
  const std::vector<Vector2d> blurred(50, Vector2d(3.0, 0.0));
  const std::vector<Vector2d> turned(50, Vector2d(4.0, 0.0));
  const CornerBank bank(std::vector{alike(few, 0.9, 0.0),
                                    alike(sharp, 0.7, 0.0),
                                    alike(blurred, 2.0, 0.0),
                                    alike(turned, 0.9, 30.0)});
  EXPECT_EQ(bank.like(0.9, 0.0).front().x(), 2.0);
  EXPECT_EQ(bank.like(0.1, 0.0).front().x(), 2.0);
  EXPECT_EQ(bank.like(9.0, 14.9).front().x(), 3.0);
  EXPECT_EQ(bank.like(9.0, 15.1).front().x(), 4.0);
  EXPECT_EQ(bank.like(0.7, -30.0).front().x(), 2.0) << "no corner was turned so: the next turn";
  EXPECT_THROW(CornerBank(std::vector{alike(few, 0.9, 0.0)}), ConfigError);
  EXPECT_THROW(CornerBank(std::vector<BankPicture>{}), ConfigError);
}

TEST(CornerBank, TellsWhatTheCornersOfAPictureShare) {
  const std::vector<Vector2d> right(50, Vector2d(0.1, 0.0));
  const std::vector<Vector2d> left(50, Vector2d(-0.1, 0.0));
  const CornerBank sharing(std::vector{alike(right, 0.7, 0.0), alike(left, 0.7, 0.0)});
  EXPECT_NEAR(sharing.shared_px(), 0.1 / std::sqrt(2.0), 1e-12);
  std::vector<Vector2d> both = right;
  both.insert(both.end(), left.begin(), left.end());
  const CornerBank apart(std::vector{alike(both, 0.7, 0.0), alike(both, 0.7, 0.0)});
  EXPECT_EQ(apart.shared_px(), 0.0);
}

TEST(CornerBank, HasATableOfItsGroups) {
  const CornerBank bank(
      std::vector{alike(std::vector<Vector2d>(60, Vector2d(0.01, -0.02)), 3.0, 40.0)});
  const std::string table = bank.table();
  EXPECT_THAT(table, HasSubstr("| 0 to 0.6 | -45 to -15 | 0 | "));
  EXPECT_THAT(table, HasSubstr("| 2.4 to ... | 15 to 45 | 60 | 0.0100, -0.0200 | 0.0158 | "));
  EXPECT_EQ(std::ranges::count(table, '\n'), 2 + CornerBank::kGroups);
}

class CornerBankFiles : public ::testing::Test {
 protected:
  /// Three pictures, the second without corners.
  std::string whole_bank() const {
    CornerBankFile file(path_, kBankHeader);
    file.append(alike({{0.0123, -0.0045}, {0.02, 0.0}}, 0.71, -12.5));
    file.append({.outcome = "blurred", .f_number = 2.0});
    file.append(alike({{-0.1, 0.3}}, 1.4, 44.0));
    return read_file(path_);
  }

  std::string refusal(const BankHeader& header) const {
    return text_thrown_by<ConfigError>([&] { CornerBankFile(path_, header); });
  }

  std::string refusal_of(const std::string& text) const {
    write_file(path_, text);
    return refusal(kBankHeader);
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "bank.jsonl";
};

TEST_F(CornerBankFiles, ReadBackAsTheyWereWritten) {
  const std::string text = whole_bank();
  EXPECT_EQ(std::ranges::count(text, '\n'), 4);
  EXPECT_EQ(folder_.count(), 1);
  const std::vector<BankPicture> pictures = read_corner_bank(path_);
  ASSERT_EQ(pictures.size(), 3u);
  ASSERT_EQ(pictures[0].corners.size(), 2u);
  EXPECT_EQ(pictures[0].turn_deg, -12.5);
  EXPECT_EQ(pictures[0].tilt_deg, 12.5);
  EXPECT_EQ(pictures[0].corners[0].error_px, Vector2d(0.0123, -0.0045));
  EXPECT_EQ(pictures[0].corners[0].blur_px, 0.71);
  EXPECT_EQ(pictures[0].corners[0].distance_mm, 150.5);
  EXPECT_EQ(pictures[0].corners[0].radius_px, 320.5);
  EXPECT_EQ(pictures[1].outcome, "blurred");
  EXPECT_FALSE(pictures[1].is_accepted());
  EXPECT_EQ(pictures[1].f_number, 2.0);
}

TEST_F(CornerBankFiles, GoOnAfterALineThatWasCutOff) {
  const std::string text = whole_bank();
  write_file(path_, text.substr(0, text.size() - 9));
  EXPECT_EQ(read_corner_bank(path_).size(), 2u);
  CornerBankFile file(path_, kBankHeader);
  ASSERT_EQ(file.pictures().size(), 2u);
  file.append(alike({{-0.1, 0.3}}, 1.4, 44.0));
  EXPECT_EQ(read_file(path_), text);
}

TEST_F(CornerBankFiles, OfAnotherSeedSceneOrInputsAreRefused) {
  whole_bank();
  EXPECT_EQ(CornerBankFile(path_, kBankHeader).pictures().size(), 3u);
  BankHeader other = kBankHeader;
  other.seed = 2;
  EXPECT_THAT(refusal(other), HasSubstr("bank.jsonl:1:1: seed: is 1, must be 2"));
  other = kBankHeader;
  other.scene = "1224 x 1025 px, f/8";
  EXPECT_THAT(refusal(other), HasSubstr("bank.jsonl:1:1: scene: is \"1224 x 1025 px, f/4\""));
  other = kBankHeader;
  other.inputs = "b2";
  EXPECT_THAT(refusal(other), HasSubstr("bank.jsonl:1:1: inputs: is that of another study"));
}

TEST_F(CornerBankFiles, WithoutInputsAreReadButDoNotGrow) {
  EXPECT_THAT(refusal_of("{\"schema\":1,\"seed\":1,\"scene\":\"1224 x 1025 px, f/4\"}\n"),
              HasSubstr("inputs: is that of another study"));
  EXPECT_TRUE(read_corner_bank(path_).empty());
}

TEST_F(CornerBankFiles, WithALineThatIsNoneAreRefused) {
  const std::string text = whole_bank();
  const std::string head = text.substr(0, text.find('\n') + 1);
  EXPECT_THAT(refusal_of(head + "{\"picture\":1}\n"),
              HasSubstr("bank.jsonl:2:1: picture: is 1, must be 0"));
  EXPECT_THAT(refusal_of(head + "{\"picture\":0}\n"), HasSubstr("bank.jsonl:2:1: is no line of"));
  EXPECT_THAT(refusal_of(head + "[]\n"), HasSubstr("bank.jsonl:2:1: is no JSON object"));
  EXPECT_THAT(refusal_of(text + "\n" + text), HasSubstr("bank.jsonl:5:1: is no JSON object"));
  EXPECT_THAT(refusal_of("{\"schema\":9}\n"), HasSubstr("bank.jsonl:1:1: schema: is 9, must be 1"));
  EXPECT_THAT(refusal_of(""), HasSubstr("bank.jsonl:1:1: is no JSON object"));
}

TEST(SimulatedCell, HasTheErrorsThatItIsGiven) {
  CellSettings exact = {.num_poses = 3, .noise = {.corner_px = 0.0}};
  CellSettings moved = exact;
  moved.corner_error = [](double, const Vector2d&, Rng&) { return Vector2d(0.3, 0.4); };
  const SimulatedCell a = simulate_cell(exact, 5);
  const SimulatedCell b = simulate_cell(moved, 5);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 80; ++k) {
      const Vector2d error = b.pictures[i].picture_px[k] - a.pictures[i].picture_px[k];
      ASSERT_LT((error - Vector2d(0.3, 0.4)).norm(), 1e-9);
    }
  }
  EXPECT_NEAR(b.settings.noise.corner_px, std::sqrt(0.125), 1e-12);
  EXPECT_EQ(b.settings.noise.robot_mm, exact.noise.robot_mm);
}

TEST(BankCases, DrawTheCornersErrorsFromTheBank) {
  std::vector<Vector2d> errors(30, Vector2d(0.05, 0.0));
  errors.insert(errors.end(), 30, Vector2d(0.0, -0.05));
  const auto bank = std::make_shared<const CornerBank>(std::vector{alike(errors, 0.7, 0.0)});
  const std::vector<MonteCarloCase> cases = bank_cases(bank);
  ASSERT_EQ(cases.size(), 4u);
  EXPECT_EQ(cases[0].name, "bank_mid");
  EXPECT_EQ(cases[0].settings.noise.robot_mm, 0.05);
  const SimulatedCell cell = simulate_cell(cases[1].settings, 3);
  EXPECT_EQ(cell.pictures.size(), 20u);
  // All have a length of 0.05 px: along one axis 0.05 / sqrt(2).
  EXPECT_NEAR(cell.settings.noise.corner_px, 0.05 / std::sqrt(2.0), 1e-9);
}

}  // namespace
}  // namespace glint
