// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/analysis/sobol_indices.h"

#include <array>

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/optimizer/analysis/ishigami.h"

namespace glint {
namespace {

void expect_within(const VarianceShare& share, double truth) {
  EXPECT_NEAR(share.value, truth, 0.02);
  EXPECT_LE(share.low, truth + 1e-3);
  EXPECT_GE(share.high, truth - 1e-3);
  EXPECT_LE(share.high - share.low, 0.2);
}

TEST(SobolIndices, OfIshigamisFunction) {
  const auto indices = sobol_indices(test::ishigami, 3);
  const auto truth = test::ishigami_indices();
  ASSERT_EQ(indices.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    expect_within(indices[i].first, truth[i].first);
    expect_within(indices[i].total, truth[i].total);
  }
}

TEST(SobolIndices, OfAnAdditiveFunctionWithADeadVariable) {
  constexpr std::array<double, 4> kDerivatives = {3.0, 2.0, 1.0, 0.0};
  const auto function = [&](std::span<const double> unit) {
    double sum = 100.0;  // an offset explains nothing
    for (std::size_t i = 0; i < unit.size(); ++i) {
      sum += kDerivatives[i] * unit[i];
    }
    return sum;
  };
  const auto indices = sobol_indices(function, 4);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    SCOPED_TRACE(i);
    const double share = kDerivatives[i] * kDerivatives[i] / 14.0;
    expect_within(indices[i].first, share);
    expect_within(indices[i].total, share);
  }
  EXPECT_EQ(indices[3].total.value, 0.0);
  EXPECT_EQ(indices[3].total.high, 0.0);
}

TEST(SobolIndices, OfAConstantAreZero) {
  for (const SobolIndex& index : sobol_indices([](std::span<const double>) { return 3.0; }, 2)) {
    EXPECT_EQ(index.first.value, 0.0);
    EXPECT_EQ(index.total.high, 0.0);
  }
}

TEST(SobolIndices, AreTheSameForTheSameSeed) {
  const auto function = [](std::span<const double> unit) { return unit[0] * unit[1]; };
  const auto a = sobol_indices(function, 2, {.samples = 64});
  const auto b = sobol_indices(function, 2, {.samples = 64});
  EXPECT_EQ(a[0].first.low, b[0].first.low);
  EXPECT_NE(a[0].first.value,
            sobol_indices(function, 2, {.samples = 64, .seed = 2})[0].first.value);
}

TEST(SobolIndices, RefuseSettingsWithoutAMeaning) {
  const auto function = [](std::span<const double>) { return 0.0; };
  EXPECT_THROW(sobol_indices(function, 0), ConfigError);
  EXPECT_THROW(sobol_indices(function, 1, {.samples = 1}), ConfigError);
  EXPECT_THROW(sobol_indices(function, 1, {.coverage = 1.0}), ConfigError);
}

}  // namespace
}  // namespace glint
