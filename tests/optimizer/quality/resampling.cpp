// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/optimizer/quality/resampling.h"

#include <algorithm>

#include "core/rng.h"

namespace glint::quality {
namespace {

constexpr std::size_t kResamples = 2000;
constexpr std::size_t kUpper = 1949;  // 97.5 % of them are at most this one

Pairs resampled(const Pairs& pairs, Rng& rng) {
  const std::size_t count = pairs.own.size();
  Pairs drawn;
  for (std::size_t i = 0; i < count; ++i) {
    const auto seed = static_cast<std::size_t>(rng.uniform() * static_cast<double>(count));
    drawn.own.push_back(pairs.own[seed]);
    drawn.peer.push_back(pairs.peer[seed]);
  }
  return drawn;
}

double mean_of_values(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) {
    sum += value;
  }
  return sum / static_cast<double>(values.size());
}

}  // namespace

Means means_of(const std::vector<Pairs>& tasks) {
  Means means;
  for (const Pairs& pairs : tasks) {
    means.own += mean_of_values(pairs.own) / static_cast<double>(tasks.size());
    means.peer += mean_of_values(pairs.peer) / static_cast<double>(tasks.size());
  }
  return means;
}

UpperEnds upper_ends(const std::vector<Pairs>& tasks) {
  Rng rng(1, Stream::kResampling, 0);
  std::vector<double> ratios;
  std::vector<double> differences;
  std::vector<Pairs> drawn(tasks.size());
  for (std::size_t i = 0; i < kResamples; ++i) {
    for (std::size_t k = 0; k < tasks.size(); ++k) {
      drawn[k] = resampled(tasks[k], rng);
    }
    const Means means = means_of(drawn);
    ratios.push_back(means.own / means.peer);
    differences.push_back(means.own - means.peer);
  }
  std::ranges::sort(ratios);
  std::ranges::sort(differences);
  return {.ratio = ratios[kUpper], .difference = differences[kUpper]};
}

}  // namespace glint::quality
