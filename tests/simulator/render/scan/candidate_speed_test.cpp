// SPDX-License-Identifier: GPL-3.0-or-later
//
// Short cuts of a candidate's evaluation against the long way.
#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "simulator/render/derivative/gradient_kernels.h"
#include "simulator/render/footprint/stripe_shares.h"
#include "tests/simulator/render/footprint/footprint_fixtures.h"

namespace glint {
namespace {

namespace kernels = footprint_kernels;

const test::FootprintBench& strip_bench() {
  static const test::FootprintBench bench(test::bench_strip(), test::bench_camera(), 0.4);
  return bench;
}

// Stripes do not change where the wall is met.
TEST(WallView, ServesAllTunnelsThatDifferInTheirStripes) {
  const test::FootprintBench& bench = strip_bench();
  TunnelSettings settings = test::bench_tunnel();
  const auto view = std::make_shared<const WallView>(bench.rays, Tunnel(settings), bench.camera_mm);
  settings.period_mm = 7.0;
  settings.duty = 0.3;
  settings.offset_mm = 2.5;
  settings.dark_reflectance = 0.2;
  settings.led_ripple = 0.1;
  const Tunnel tunnel(settings);
  const Footprints again(bench.rays, tunnel, {.positions = 5}, view);
  const Footprints fresh(bench.rays, tunnel, {.positions = 5}, bench.camera_mm);
  EXPECT_EQ(again.state(), fresh.state());
  EXPECT_EQ(test::integrated_frames(again), test::integrated_frames(fresh));
}

// All frames at once are each frame by itself, to the bit.
TEST(RenderFrames, AreTheFramesOneByOne) {
  const test::FootprintBench& bench = strip_bench();
  const RayCache rays = bench.sampled(2);
  TunnelSettings settings = test::bench_tunnel();
  settings.dark_reflectance = 0.02;  // one radiance for all places
  for (const double orientation_rad : {0.0, 0.4}) {
    settings.orientation_rad = orientation_rad;
    const Tunnel tunnel(settings);
    const WallRays met = intersect_wall(rays, tunnel, bench.camera_mm);
    std::vector<StripePattern> patterns;
    for (int k = 0; k < 7; ++k) {
      patterns.push_back(tunnel.pattern(1.3 * k));
    }
    std::vector<ImageF> together(patterns.size());
    render_frames(rays, met, patterns, together);
    for (std::size_t k = 0; k < patterns.size(); ++k) {
      ImageF sum(rays.width_px, rays.height_px);
      const auto& pattern_mm = met.pattern_mm.empty() ? met.x_mm : met.pattern_mm;
      for (std::int64_t sample = 0; sample < rays.samples; ++sample) {
        const std::int64_t begin = sample * rays.num_pixels();
        add_stripes(met.x_mm.data() + begin,
                    pattern_mm.data() + begin,
                    met.gain.data() + begin,
                    static_cast<int>(rays.num_pixels()),
                    patterns[k],
                    0.25F,
                    sum.values().data());
      }
      EXPECT_EQ(together[k], sum) << k;
    }
  }
}

/// Random footprints and what kernels make of them.
struct RandomFootprints {
  std::vector<float> v, gx, gy, outer, inner, per_major, per_both, gain;

  RandomFootprints(std::uint64_t seed, int count, double widest) {
    Rng rng(seed, Stream::kTest, 0);
    for (int i = 0; i < count; ++i) {
      v.push_back(static_cast<float>(rng.uniform(-20.0, 20.0)));
      gx.push_back(static_cast<float>(rng.uniform(-widest, widest)));
      gy.push_back(static_cast<float>(rng.uniform(-widest, widest) * rng.uniform()));
      gain.push_back(static_cast<float>(rng.uniform(0.0, 1.0)));
    }
    for (auto* array : {&outer, &inner, &per_major, &per_both}) {
      array->resize(v.size());
    }
    kernels::trapezoids(gx.data(), gy.data(), count, shape());
  }

  int count() const { return static_cast<int>(v.size()); }

  kernels::Trapezoids shape() {
    return {.outer = outer.data(),
            .inner = inner.data(),
            .per_major = per_major.data(),
            .per_both = per_both.data()};
  }
};

// Widths up to (0.1 + 0.1) / 2 = 0.1 see one edge of stripes of duty 0.3: the limit is 0.15.
TEST(NarrowBoxFrame, GivesTheBytesOfBoxFrame) {
  RandomFootprints prints(5, 4096, 0.1);
  const kernels::BoxFrame frame = {.shift = 0.37F, .duty = 0.3F, .dark = 0.2F};
  EXPECT_FLOAT_EQ(kernels::narrow_limit(frame.duty), 0.15F);
  EXPECT_LE(kernels::largest(prints.outer.data(), prints.count()), 0.15F);
  EXPECT_EQ(kernels::largest(prints.outer.data(), prints.count()),
            *std::ranges::max_element(prints.outer));
  std::vector<float> any(prints.v.size());
  std::vector<float> narrow(prints.v.size());
  kernels::box_frame(
      prints.v.data(), prints.shape(), prints.gain.data(), prints.count(), frame, any.data());
  kernels::narrow_box_frame(
      prints.v.data(), prints.shape(), prints.gain.data(), prints.count(), frame, narrow.data());
  EXPECT_EQ(any, narrow);
}

TEST(EvenGains, AreThePlainGainsOfOneWeight) {
  const std::vector<unsigned char> state = {0, 1, 2, 1, 1, 0, 2, 1, 1};
  const auto count = static_cast<int>(state.size());
  const std::vector<float> weight(state.size(), 0.8F);
  std::vector<float> cosine;
  for (int i = 0; i < count; ++i) {
    cosine.push_back(0.1F * static_cast<float>(i));
  }
  const std::array<const float*, 2> cosines = {nullptr, cosine.data()};
  for (const float* of_wall : cosines) {
    std::vector<float> plain(state.size()), even(state.size());
    kernels::plain_gains(state.data(), weight.data(), of_wall, count, plain.data());
    kernels::even_gains(state.data(), 0.8F, of_wall, count, even.data());
    EXPECT_EQ(plain, even);
  }
}

// Every smooth pixel's first corner has it.
TEST(CornerRays, KnowTheOneWeightOfTheirSmoothPixels) {
  const CornerRays& rays = strip_bench().rays;
  ASSERT_GE(rays.smooth_weight, 0.0F);
  int smooth = 0;
  for (int y = 0; y < rays.height_px; ++y) {
    for (int x = 0; x < rays.width_px; ++x) {
      if (rays.kind(x, y) == PixelKind::kSmooth) {
        const auto at = static_cast<std::size_t>(y * (rays.width_px + 1) + x);
        ASSERT_EQ(rays.corners.weight[at], rays.smooth_weight);
        ++smooth;
      }
    }
  }
  EXPECT_GT(smooth, 1000);
}

// Widths from 0 to 3 stripes, so that chunks are narrow, wide and mixed.
TEST(AnySharesFast, AFootprintGetsTheSameWhateverStandsBesideIt) {
  for (const double widest : {0.02, 0.3, 3.0}) {
    RandomFootprints prints(8, 777, widest);
    const std::size_t size = prints.v.size();
    std::vector<float> together(size);
    kernels::any_shares_fast(prints.v.data(),
                             prints.outer.data(),
                             prints.inner.data(),
                             prints.count(),
                             3.0F,
                             0.4F,
                             together.data());
    for (std::size_t i = 0; i < size; ++i) {
      float alone = 0.0F;
      kernels::any_shares_fast(
          &prints.v[i], &prints.outer[i], &prints.inner[i], 1, 3.0F, 0.4F, &alone);
      EXPECT_EQ(alone, together[i]) << i;
    }
  }
}

/// What add_box_gradients() and its like sum up.
struct GradientSums {
  std::vector<float> v, gx, gy, duty, dark;

  explicit GradientSums(std::size_t size) : v(size), gx(size), gy(size), duty(size), dark(size) {}

  gradient_kernels::BoxGradients out() {
    return {
        .v = v.data(), .gx = gx.data(), .gy = gy.data(), .duty = duty.data(), .dark = dark.data()};
  }
};

// Widths up to 0.1 under stripes of duty 0.3, as above. Slopes are as large as 1 / width.
TEST(NarrowGradients, AreTheDerivativesOfOneEdge) {
  RandomFootprints prints(9, 4096, 0.1);
  const std::size_t size = prints.v.size();
  GradientSums any(size);
  GradientSums narrow(size);
  std::array<std::vector<float>, 5> shape, sum;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    shape[i].resize(size);
    sum[i].resize(size);
  }
  const gradient_kernels::BoxShapes shapes = {.outer = shape[0].data(),
                                              .inner = shape[1].data(),
                                              .per_major = shape[2].data(),
                                              .per_minor = shape[3].data(),
                                              .flatness = shape[4].data()};
  const gradient_kernels::NarrowSums sums = {.rising = sum[0].data(),
                                             .falling = sum[1].data(),
                                             .major = sum[2].data(),
                                             .minor = sum[3].data(),
                                             .dark = sum[4].data()};
  gradient_kernels::box_shapes(prints.gx.data(), prints.gy.data(), prints.count(), shapes);
  std::vector<gradient_kernels::FixedPhase> turns;
  for (const float v : prints.v) {
    turns.push_back(gradient_kernels::fixed_phase_of(static_cast<double>(v)));
  }
  for (const double shift : {0.0, 0.37, 0.81}) {
    gradient_kernels::add_box_gradients(turns.data(),
                                        prints.gx.data(),
                                        prints.gy.data(),
                                        prints.gain.data(),
                                        prints.count(),
                                        shift,
                                        0.3,
                                        any.out());
    gradient_kernels::add_narrow_frame(
        turns.data(), shapes, prints.gain.data(), prints.count(), shift, 0.3, sums);
  }
  gradient_kernels::add_narrow_sums(
      prints.gx.data(), prints.gy.data(), shapes, sums, prints.count(), narrow.out());
  int lit = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const float largest = prints.per_major[i];
    const float per_minor = 2.0F * prints.per_both[i] / prints.per_major[i];
    EXPECT_NEAR(any.v[i], narrow.v[i], 4e-5F * largest * per_minor) << i;
    EXPECT_NEAR(any.duty[i], narrow.duty[i], 4e-5F * largest * per_minor) << i;
    EXPECT_NEAR(any.gx[i], narrow.gx[i], 4e-5F * largest * per_minor) << i;
    EXPECT_NEAR(any.gy[i], narrow.gy[i], 4e-5F * largest * per_minor) << i;
    EXPECT_NEAR(any.dark[i], narrow.dark[i], 4e-5F * largest) << i;
    lit += any.v[i] != 0.0F ? 1 : 0;
  }
  EXPECT_GT(lit, 500);
}

// One edge or two: where a footprint is narrow, both formulas hold.
TEST(BoxFrame, OneEdgeIsTheSecondIntegralsAnswer) {
  RandomFootprints prints(6, 4096, 0.12);
  std::vector<float> narrow(prints.v.size());
  std::vector<float> exact(prints.v.size());
  const std::vector<float> one(prints.v.size(), 1.0F);
  kernels::narrow_box_frame(
      prints.v.data(), prints.shape(), one.data(), prints.count(), {.duty = 0.6F}, narrow.data());
  kernels::any_shares(
      prints.v.data(), prints.gx.data(), prints.gy.data(), prints.count(), 1.0, 0.6, exact.data());
  for (std::size_t i = 0; i < narrow.size(); ++i) {
    // Footprints below 1e-4 are widened in one of the two.
    const bool is_thin = std::abs(prints.gy[i]) < 1e-3F || std::abs(prints.gx[i]) < 1e-3F;
    ASSERT_NEAR(narrow[i], exact[i], is_thin ? 1e-2F : 1e-4F) << i;
  }
}

TEST(AnySharesFast, IsTheExactShareForFootprintsOfAnyWidth) {
  for (const double scale : {8.0, 24.0}) {
    for (const double duty : {0.1, 0.5, 0.72}) {
      RandomFootprints prints(7, 8192, 0.2);
      std::vector<float> fast(prints.v.size());
      std::vector<float> exact(prints.v.size());
      kernels::any_shares_fast(prints.v.data(),
                               prints.outer.data(),
                               prints.inner.data(),
                               prints.count(),
                               static_cast<float>(scale),
                               static_cast<float>(duty),
                               fast.data());
      kernels::any_shares(prints.v.data(),
                          prints.gx.data(),
                          prints.gy.data(),
                          prints.count(),
                          scale,
                          duty,
                          exact.data());
      double squares = 0.0;
      for (std::size_t i = 0; i < fast.size(); ++i) {
        // v of 20 periods is good to 1e-6, times scale, over footprints of 0.02 times scale.
        ASSERT_NEAR(fast[i], exact[i], 5e-3F) << scale << " " << duty << " " << i;
        squares += std::pow(static_cast<double>(fast[i]) - static_cast<double>(exact[i]), 2);
      }
      EXPECT_LE(std::sqrt(squares / static_cast<double>(fast.size())), 2e-4);
    }
  }
}

// 24 positions, duty 0.37: 24 * 0.37 = 8.88, so 8 of 24 are bright everywhere and one more on 0.88
// of a step: dark = 0 + 8 / 24, bright adds 1 / 24.
TEST(ScanPositions, MeanPositionIsAWaveOfManyTimesTheFrequency) {
  TunnelSettings settings = test::bench_tunnel();
  settings.duty = 0.37;
  const ScanPositions mean = ScanPositions(Tunnel(settings), {.positions = 24}).mean_position();
  EXPECT_NEAR(mean.period_mm, 12.0 / 24.0, 1e-12);
  EXPECT_NEAR(mean.duty, 0.88, 1e-6);
  EXPECT_NEAR(mean.dark, 8.0 / 24.0, 1e-12);
  EXPECT_NEAR(mean.bright, 1.0 / 24.0, 1e-12);
  settings.duty = 0.5;
  EXPECT_EQ(ScanPositions(Tunnel(settings), {.positions = 24}).mean_position().bright, 0.0);
}

}  // namespace
}  // namespace glint
