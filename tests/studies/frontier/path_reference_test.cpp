// SPDX-License-Identifier: GPL-3.0-or-later
//
// The reference of path-traced scenes against a closed form: a matt plate under a ring of light,
// rendered in so little time that its pictures are grainy.
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "studies/evaluation/evaluation.h"
#include "studies/frontier/path_frontier.h"
#include "studies/frontier/pooled_score.h"
#include "tests/studies/scene_from.h"

namespace glint {
namespace {

// Two pixels, two batches that show (1, 3) and (2, 2): together (1.5, 2.5), d = 0.5 / 2; alone d is
// 1 / 2 and 0. d^2 is 2 / 16 - (1 / 4 + 0) / 2 = 0, as the two batches do not vary together. The
// error of d^2 is sqrt(1 / 2 (1 / 64 + 1 / 64)) = 1 / 8, and of d 1 / 16 over the root of that.
TEST(PooledScore, TakesOutWhatTwoBatchesDoNotShare) {
  const std::vector<double> without_one = {1.0, 0.5};
  const ReferenceScore h = pooled_score("homogeneity.h_rms", 0.75, without_one);
  EXPECT_DOUBLE_EQ(h.value, 1.0);
  EXPECT_DOUBLE_EQ(h.standard_error, 0.0625 / std::sqrt(0.125));
}

// 2 * 5 - (3 + 5) / 2 = 6; the error is sqrt(1 / 2 (1 + 1)).
TEST(PooledScore, OfAnyOtherScoreIsTheJackknifes) {
  const std::vector<double> without_one = {3.0, 5.0};
  const ReferenceScore score = pooled_score("defects.dent_1.weber", 5.0, without_one);
  EXPECT_DOUBLE_EQ(score.value, 6.0);
  EXPECT_DOUBLE_EQ(score.standard_error, 1.0);
}

double h_of(const std::vector<double>& pixels) {
  double mean = 0.0;
  double squares = 0.0;
  for (const double value : pixels) {
    mean += value / static_cast<double>(pixels.size());
  }
  for (const double value : pixels) {
    squares += (value - mean) * (value - mean) / static_cast<double>(pixels.size());
  }
  return 1.0 - std::sqrt(squares) / mean;
}

/// Four batches of 400 pixels about 1 with a ramp of deviation 0.02 and noise of deviation 0.06.
class GrainyBatches {
 public:
  explicit GrainyBatches(Rng& rng) {
    for (auto& batch : batches_) {
      for (int i = 0; i < kPixels; ++i) {
        double sum = -6.0;
        for (int k = 0; k < 12; ++k) {
          sum += rng.uniform();
        }
        batch.push_back(ramp(i) + 0.06 * sum);
      }
    }
  }

  static double ramp(int pixel) {
    return 1.0 + 0.02 * std::sqrt(12.0) * ((pixel + 0.5) / kPixels - 0.5);
  }

  /// h of the mean of all but one. @param left_out  4: none
  double h_without(std::size_t left_out) const {
    std::vector<double> mean(kPixels, 0.0);
    for (std::size_t b = 0; b < batches_.size(); ++b) {
      for (std::size_t i = 0; b != left_out && i < kPixels; ++i) {
        mean[i] += batches_[b][i] / (left_out < batches_.size() ? 3.0 : 4.0);
      }
    }
    return h_of(mean);
  }

  std::vector<double> h_without_each() const {
    return {h_without(0), h_without(1), h_without(2), h_without(3)};
  }

 private:
  static constexpr int kPixels = 400;
  std::array<std::vector<double>, 4> batches_;
};

// The truth is 1 - 0.02. All batches together have 0.0009 of noise's variance beside 0.0004.
TEST(PooledScore, HasNoBiasOverManyDraws) {
  Rng rng(11, Stream::kTest, 0);
  constexpr int kDraws = 300;
  double square = 0.0;
  double raw_square = 0.0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const GrainyBatches batches(rng);
    const double whole = batches.h_without(4);
    const double h = pooled_score("homogeneity.h_rms", whole, batches.h_without_each()).value;
    square += (1.0 - h) * (1.0 - h) / kDraws;
    raw_square += (1.0 - whole) * (1.0 - whole) / kDraws;
  }
  EXPECT_NEAR(square, 0.0004, 0.00002);
  EXPECT_NEAR(raw_square, 0.0013, 0.00003) << "else there was nothing to take out";
}

TEST(FramesOfBatch, AddUpToTheWhole) {
  const std::vector<ImageF> whole = {ImageF(2, 1, 0.5F)};
  const std::vector<ImageF> without = {ImageF(2, 1, 0.25F)};
  // 3 * 0.5 - 2 * 0.25
  EXPECT_FLOAT_EQ(frames_of_batch(whole, without, 3).front()(1, 0), 1.0F);
}

// The plate's upper face lies at z = 2.5 mm, 297.5 mm from a camera that sees 1.5 mm at 300 mm.
constexpr double kPixel_mm = 1.5 * 297.5 / 300.0;
constexpr int kWidth_px = 24;
constexpr int kHeight_px = 18;
constexpr double kInner_mm = 30.0;
constexpr double kOuter_mm = 45.0;
constexpr double kAbovePlate_mm = 42.5;

SceneSettings matt_plate() {
  return test::scene_from(R"(
schema = 1
[part]
shape = "plate"
length_mm = 80
width_mm = 80
thickness_mm = 5
[material]
type = "diffuse"
roughness = 0
[camera]
width_px = 24
height_px = 18
object_pixel_mm = 1.5
working_distance_mm = 300
[sensor]
wavelengths_nm = [630]
bits = 0
gain = 1
blur_px = 0
full_well_e = 0
read_noise_e = 0
[metrics]
erosion_px = 0
[lighting.ring]
mount = "scene"
position_mm = [0, 0, 5]
direction = [0, 0, -1]
inner_radius_mm = 30
outer_radius_mm = 45
height_mm = 40
radiance = [2]
[render.paths]
samples = 4
max_reflections = 1
batches = 2
)");
}

/// Share of the hemisphere's irradiance that a luminous disc gives to a parallel plane, at a
/// distance r from its axis: 1/2 (1 - (r^2 + h^2 - a^2) / sqrt((r^2 + h^2 + a^2)^2 - 4 a^2 r^2)).
double disc_share(double r_mm, double radius_mm) {
  const double a = radius_mm * radius_mm;
  const double s = r_mm * r_mm + kAbovePlate_mm * kAbovePlate_mm;
  return 0.5 * (1.0 - (s - a) / std::sqrt((s + a) * (s + a) - 4.0 * a * r_mm * r_mm));
}

/// Of the ring's light on every pixel, by 4 x 4 points of each.
double true_h() {
  std::vector<double> pixels;
  for (int y = 0; y < kHeight_px; ++y) {
    for (int x = 0; x < kWidth_px; ++x) {
      double sum = 0.0;
      for (int k = 0; k < 16; ++k) {
        const double x_px = x + (k % 4 + 0.5) / 4.0 - 0.5 * kWidth_px;
        const int row = k / 4;
        const double y_px = y + (row + 0.5) / 4.0 - 0.5 * kHeight_px;
        const double r_mm = kPixel_mm * std::hypot(x_px, y_px);
        sum += disc_share(r_mm, kOuter_mm) - disc_share(r_mm, kInner_mm);
      }
      pixels.push_back(sum);
    }
  }
  return h_of(pixels);
}

double h_of_scene(const SceneSettings& scene, int samples, int index) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const SceneSettings one = independent_paths(scene, samples, index);
  return evaluate(store, one, {}, {.defects = false, .slot = false}).scores.at("homogeneity.h_rms");
}

TEST(PathReference, ClosedFormIsWhatManySamplesShow) {
  EXPECT_NEAR(h_of_scene(matt_plate(), 4096, 7), true_h(), 0.0005);
}

/// With so short a budget that its pictures have no more than 16 samples.
Frontier grainy_frontier(int seed) {
  SceneSettings scene = matt_plate();
  scene.paths.seed = seed;
  return measure_path_frontier(scene, {.threads = 2, .budget_s = 0.001});
}

constexpr int kSeeds = 12;

TEST(PathReference, HasNoBiasInTooShortABudget) {
  double pooled = 0.0;
  double old_way = 0.0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const Frontier frontier = grainy_frontier(1000 * seed);
    EXPECT_EQ(frontier.reference.method.paths.samples, 16);
    pooled += frontier.reference.h_rms / kSeeds;
    SceneSettings scene = matt_plate();
    scene.paths.seed = 1000 * seed;
    old_way += h_of_scene(scene, 16, 0) / kSeeds;
  }
  EXPECT_NEAR(pooled, true_h(), 0.001);
  EXPECT_GT(std::abs(old_way - true_h()), 0.02) << "the mean of h over grainy pictures";
}

/// The error of h that four samples have: known from the truth and from the frontier alone.
TEST(PathReference, ErrorOfAScoreIsThatAgainstTheTruth) {
  double from_truth = 0.0;
  double told = 0.0;
  double old_way = 0.0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    SceneSettings scene = matt_plate();
    scene.paths.seed = 1000 * seed;
    const double error = h_of_scene(scene, 4, 4) - true_h();
    from_truth += error * error / kSeeds;
    const double grainy = error + true_h() - h_of_scene(scene, 16, 0);
    old_way += grainy * grainy / kSeeds;
    for (const FrontierPoint& point : grainy_frontier(1000 * seed).points) {
      if (point.method.is_current) {
        told += point.h_error_points * point.h_error_points * 1e-4 / kSeeds;
      }
    }
  }
  EXPECT_NEAR(std::sqrt(told), std::sqrt(from_truth), 0.03 * std::sqrt(from_truth));
  EXPECT_LT(std::sqrt(old_way), 0.9 * std::sqrt(from_truth)) << "against h of a grainy picture";
}

}  // namespace
}  // namespace glint
