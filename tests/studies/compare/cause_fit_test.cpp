// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/fit/cause_fit.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

const Vector3d kMiddle(0.0, 0.0, 150.0);

PinholeIntrinsics wide_camera() {
  return {.width_px = 1224,
          .height_px = 1025,
          .focal_px = {1740.0, 1740.0},
          .center_px = {612.0, 512.5}};
}

/// Edges on a part that fills the picture and reaches in depth as far as `depth_mm`; they move as
/// the changes say, with noise.
std::vector<SpaceEdge> moved_edges(const CauseVector& changes,
                                   double noise_px,
                                   double depth_mm,
                                   std::uint64_t index) {
  const PinholeIntrinsics camera = wide_camera();
  Rng rng(21, Stream::kTest, index);
  std::vector<SpaceEdge> edges;
  for (int i = 0; i < 3000; ++i) {
    const double angle = rng.uniform(0.0, 2.0 * kPi);
    SpaceEdge edge = {.in_camera_mm = {rng.uniform(-48.0, 48.0),
                                       rng.uniform(-40.0, 40.0),
                                       150.0 + rng.uniform(-depth_mm, depth_mm)},
                      .normal = {std::cos(angle), std::sin(angle)}};
    const Vector2d moved = changed_pixel(camera, kMiddle, changes, edge.in_camera_mm) -
                           changed_pixel(camera, kMiddle, CauseVector{}, edge.in_camera_mm);
    edge.offset_px = moved.dot(edge.normal) + noise_px * rng.normal();
    edges.push_back(edge);
  }
  return edges;
}

CauseVector only(CauseParameter parameter, double value) {
  CauseVector changes = {};
  changes[static_cast<std::size_t>(parameter)] = value;
  return changes;
}

// f x / z + c with f = 1740, (10, 20, 150): 612 + 116 and 512.5 + 232; 1.5 mm nearer by z = 148.5.
TEST(ChangedPixel, IsWhatOneWorksOut) {
  const Vector3d point(10.0, 20.0, 150.0);
  const Vector2d before = changed_pixel(wide_camera(), kMiddle, CauseVector{}, point);
  EXPECT_NEAR(before.x(), 728.0, 1e-9);
  EXPECT_NEAR(before.y(), 744.5, 1e-9);
  const Vector2d nearer =
      changed_pixel(wide_camera(), kMiddle, only(CauseParameter::kDistance, -1.5), point);
  EXPECT_NEAR(nearer.x(), 612.0 + 17400.0 / 148.5, 1e-9);
  // k1 = 0.1: r^2 = (100 + 400) / 22500, radial factor 1.002222.
  const Vector2d bent =
      changed_pixel(wide_camera(), kMiddle, only(CauseParameter::kK1, 0.1), point);
  EXPECT_NEAR(bent.x(), 612.0 + 116.0 * (1.0 + 0.1 / 45.0), 1e-9);
}

TEST(FitCauses, IsSilentAboutNoise) {
  int named = 0;
  for (std::uint64_t i = 0; i < 40; ++i) {
    const auto edges = moved_edges({}, 0.05, 15.0, i);
    named += fit_causes(edges, wide_camera(), kMiddle).causes.empty() ? 0 : 1;
  }
  EXPECT_LE(named, 1);
}

// Edges of low contrast scatter ten times as much as others, and neighbours move together.
TEST(FitCauses, IsSilentAboutNoiseThatDiffersFromStretchToStretch) {
  int named = 0;
  for (std::uint64_t i = 0; i < 40; ++i) {
    std::vector<SpaceEdge> edges = moved_edges({}, 0.0, 15.0, i);
    Rng rng(22, Stream::kTest, i);
    double spread_px = 0.0;
    double alike_px = 0.0;
    for (std::size_t k = 0; k < edges.size(); ++k) {
      if (k % 12 == 0) {
        spread_px = 0.02 * std::pow(10.0, rng.uniform());
        alike_px = spread_px * rng.normal();
      }
      edges[k].offset_px = alike_px + spread_px * rng.normal();
    }
    named += fit_causes(edges, wide_camera(), kMiddle).causes.empty() ? 0 : 1;
  }
  EXPECT_LE(named, 1);
}

// Where edges are those of something else no change explains most of them, and none is told.
TEST(FitCauses, TellsNothingWhereEdgesContradict) {
  std::vector<SpaceEdge> edges = moved_edges(only(CauseParameter::kShiftX, 0.3), 0.05, 15.0, 4);
  Rng rng(23, Stream::kTest, 0);
  for (std::size_t k = 0; k < edges.size(); ++k) {
    if (k % 5 < 3) {
      edges[k].offset_px = rng.uniform(-20.0, 20.0);
    }
  }
  const CauseFit fit = fit_causes(edges, wide_camera(), kMiddle);
  EXPECT_LT(fit.agreeing, 0.5);
  EXPECT_TRUE(fit.causes.empty());
}

// Both of a pair that moves these edges alike would have values that cancel.
TEST(FitCauses, ChoosesNoTwoThatCannotBeTold) {
  CauseVector changes = only(CauseParameter::kDistance, 0.4);
  changes[static_cast<std::size_t>(CauseParameter::kFocalLength)] = 3.0;
  changes[static_cast<std::size_t>(CauseParameter::kShiftX)] = 0.05;
  for (std::uint64_t i = 0; i < 10; ++i) {
    const CauseFit fit = fit_causes(moved_edges(changes, 0.05, 1.0, i), wide_camera(), kMiddle);
    int of_group = 0;
    for (const FoundCause& cause : fit.causes) {
      of_group += cause.parameter == CauseParameter::kDistance ||
                          cause.parameter == CauseParameter::kFocalLength
                      ? 1
                      : 0;
    }
    EXPECT_EQ(of_group, 1);
  }
}

struct KnownChange {
  CauseParameter parameter;
  double value;
};

/// Each moves edges by some tenths of a pixel.
const std::vector<KnownChange> kChanges = {{CauseParameter::kTurnX, 0.003},
                                           {CauseParameter::kTurnY, -0.003},
                                           {CauseParameter::kTurnZ, 0.0008},
                                           {CauseParameter::kShiftX, 0.03},
                                           {CauseParameter::kShiftY, -0.03},
                                           {CauseParameter::kDistance, 0.2},
                                           {CauseParameter::kFocalLength, 2.5},
                                           {CauseParameter::kCentreX, 0.4},
                                           {CauseParameter::kCentreY, 0.4},
                                           {CauseParameter::kK1, 0.015},
                                           {CauseParameter::kP1, 0.001}};

/// Whether the cause, or a group that it cannot be told from, stands in the fit.
const FoundCause* find(const CauseFit& fit, CauseParameter parameter) {
  const auto found = std::ranges::find_if(fit.causes, [&](const FoundCause& cause) {
    return cause.parameter == parameter || std::ranges::count(cause.not_separable, parameter) > 0;
  });
  return found == fit.causes.end() ? nullptr : &*found;
}

// On a part of some depth each cause is named alone, with its value and an honest sigma.
TEST(FitCauses, NamesEachCauseByItself) {
  int right = 0;
  int held = 0;
  int cases = 0;
  double squares = 0.0;
  for (const KnownChange& change : kChanges) {
    for (std::uint64_t i = 0; i < 10; ++i) {
      const auto edges = moved_edges(only(change.parameter, change.value), 0.05, 15.0, i);
      const CauseFit fit = fit_causes(edges, wide_camera(), kMiddle);
      const bool is_right = fit.causes.size() == 1 && fit.causes[0].parameter == change.parameter;
      ++cases;
      right += is_right ? 1 : 0;
      if (is_right) {
        const double z = (fit.causes[0].value - change.value) / fit.causes[0].sigma;
        held += std::abs(z) < 1.96 ? 1 : 0;
        squares += z * z;
        EXPECT_GT(fit.causes[0].share, 0.5);
      }
    }
  }
  EXPECT_GE(right, 105) << "of " << cases;  // 95 %
  EXPECT_GE(held, right * 88 / 100);
  EXPECT_NEAR(std::sqrt(squares / right), 1.0, 0.25);
}

TEST(FitCauses, NamesTwoCausesTogether) {
  int right = 0;
  int cases = 0;
  for (std::size_t a = 0; a < kChanges.size(); ++a) {
    for (std::size_t b = a + 1; b < kChanges.size(); ++b) {
      CauseVector changes = only(kChanges[a].parameter, kChanges[a].value);
      changes[static_cast<std::size_t>(kChanges[b].parameter)] = kChanges[b].value;
      const CauseFit fit =
          fit_causes(moved_edges(changes, 0.05, 15.0, 100 * a + b), wide_camera(), kMiddle);
      ++cases;
      right +=
          find(fit, kChanges[a].parameter) != nullptr && find(fit, kChanges[b].parameter) != nullptr
              ? 1
              : 0;
    }
  }
  EXPECT_GE(right, cases * 95 / 100) << "of " << cases;
}

// On a flat part that faces the camera, distance and focal length do the same, and so do sideways
// shift and centre: whichever is named, the other one stands beside it.
TEST(FitCauses, NamesWhatCannotBeTold) {
  const auto nearer = moved_edges(only(CauseParameter::kDistance, 0.4), 0.05, 0.0, 0);
  const CauseFit first = fit_causes(nearer, wide_camera(), kMiddle);
  ASSERT_EQ(first.causes.size(), 1U);
  EXPECT_NE(find(first, CauseParameter::kDistance), nullptr);
  EXPECT_NE(find(first, CauseParameter::kFocalLength), nullptr);
  const auto beside = moved_edges(only(CauseParameter::kCentreX, 0.5), 0.05, 0.0, 0);
  const CauseFit second = fit_causes(beside, wide_camera(), kMiddle);
  ASSERT_EQ(second.causes.size(), 1U);
  EXPECT_NE(find(second, CauseParameter::kShiftX), nullptr);
  // A part of some depth separates distance from focal length.
  const auto deep = moved_edges(only(CauseParameter::kDistance, 0.4), 0.05, 60.0, 0);
  EXPECT_TRUE(fit_causes(deep, wide_camera(), kMiddle).causes.at(0).not_separable.empty());
}

// Wrong matches at a tenth of the edges do not count.
TEST(FitCauses, StandsOutliers) {
  auto edges = moved_edges(only(CauseParameter::kShiftX, 0.03), 0.05, 15.0, 3);
  for (std::size_t i = 0; i < edges.size(); i += 10) {
    edges[i].offset_px += 4.0;
  }
  const CauseFit fit = fit_causes(edges, wide_camera(), kMiddle);
  ASSERT_EQ(fit.causes.size(), 1U);
  EXPECT_EQ(fit.causes[0].parameter, CauseParameter::kShiftX);
  EXPECT_NEAR(fit.causes[0].value, 0.03, 0.002);
}

TEST(FitCauses, TellsNothingFromAFewEdges) {
  const auto edges = moved_edges(only(CauseParameter::kShiftX, 0.5), 0.05, 15.0, 0);
  EXPECT_TRUE(fit_causes(std::span(edges).first(30), wide_camera(), kMiddle).causes.empty());
}

}  // namespace
}  // namespace glint
