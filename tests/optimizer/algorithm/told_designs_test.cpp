// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which of many designs the models of a search know.
#include "optimizer/algorithm/told_designs.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

namespace glint {
namespace {

constexpr std::size_t kOnFront = 30;

/// With the sum of the objectives as its merit.
ToldDesign told_at(double f1, double f2, double limit) {
  return {.point = {f1, f2},
          .values = {f1, f2, limit},
          .errors = {std::nan(""), std::nan(""), std::nan("")},
          .merit = f1 + f2};
}

/// 850 designs on ZDT1: one that beats all and misses the limit, 819 near the middle of its front
/// and behind it, and at last some of the front, f2 = 1 - sqrt(f1), from end to end.
std::vector<ToldDesign> designs_on_zdt1() {
  std::vector<ToldDesign> designs = {told_at(-1.0, -1.0, 0.5)};
  for (int i = 0; i < 819; ++i) {
    const double f1 = 0.2 + 0.1 * i / 819.0;
    designs.push_back(told_at(f1, 1.05 - std::sqrt(f1), -0.5));
  }
  for (std::size_t i = 0; i < kOnFront; ++i) {
    const double f1 = static_cast<double>(i) / (kOnFront - 1.0);
    designs.push_back(told_at(f1, 1.0 - std::sqrt(f1), 0.0));
  }
  return designs;
}

TEST(ModelData, OfManyDesignsKeepsTheFront) {
  const std::vector<ToldDesign> designs = designs_on_zdt1();
  const auto known_of_front = [&](std::size_t num_front) {
    const ModelData data = model_data(designs, 3, num_front);
    EXPECT_EQ(data.told.size(), kKeptModelPoints);
    EXPECT_EQ(std::ranges::adjacent_find(data.told, std::greater_equal()), data.told.end());
    return static_cast<std::size_t>(std::ranges::count_if(
        data.told, [&](std::size_t told) { return told >= designs.size() - kOnFront; }));
  };
  EXPECT_EQ(known_of_front(2), kOnFront);
  EXPECT_LT(known_of_front(0), kOnFront) << "by their merits the ends of the front are dropped";
}

}  // namespace
}  // namespace glint
