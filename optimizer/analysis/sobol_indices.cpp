// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/analysis/sobol_indices.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/error.h"
#include "core/rng.h"
#include "optimizer/algorithm/sobol.h"

namespace glint {
namespace {

/// The function at all rows of A and B, and of A with one column of B.
struct Answers {
  std::vector<double> a;
  std::vector<double> b;
  std::vector<std::vector<double>> mixed;  ///< for each coordinate
};

Answers ask(const CubeFunction& function, int dimension, const SobolSettings& settings) {
  const Sobol sequence(settings.seed, 2 * dimension);
  const auto size = static_cast<std::size_t>(dimension);
  Answers answers;
  answers.mixed.resize(size);
  for (int row = 0; row < settings.samples; ++row) {
    const std::vector<double> both = sequence.point(static_cast<std::uint32_t>(row));
    std::vector<double> at(both.begin(), both.begin() + dimension);
    answers.a.push_back(function(at));
    for (std::size_t i = 0; i < size; ++i) {
      at[i] = both[size + i];
      answers.mixed[i].push_back(function(at));
      at[i] = both[i];
    }
    answers.b.push_back(function(std::span(both).subspan(size)));
  }
  return answers;
}

/// Of both designs, of these rows.
double variance_of(const Answers& answers, std::span<const std::size_t> rows) {
  double sum = 0.0;
  for (const std::size_t row : rows) {
    sum += answers.a[row] + answers.b[row];
  }
  const double mean = sum / (2.0 * static_cast<double>(rows.size()));
  double squares = 0.0;
  for (const std::size_t row : rows) {
    squares += std::pow(answers.a[row] - mean, 2) + std::pow(answers.b[row] - mean, 2);
  }
  return squares / (2.0 * static_cast<double>(rows.size()));
}

struct Shares {
  double first = 0.0;
  double total = 0.0;
};

Shares shares_of(const Answers& answers,
                 std::size_t coordinate,
                 double variance,
                 std::span<const std::size_t> rows) {
  double explained = 0.0;
  double lost = 0.0;
  for (const std::size_t row : rows) {
    const double mixed = answers.mixed[coordinate][row];
    explained += answers.b[row] * (mixed - answers.a[row]);
    lost += 0.5 * std::pow(answers.a[row] - mixed, 2);
  }
  const double scale = variance * static_cast<double>(rows.size());
  return {.first = explained / scale, .total = lost / scale};
}

VarianceShare with_interval(double value, std::vector<double> drawn, double coverage) {
  std::ranges::sort(drawn);
  const auto at = [&](double share) {
    const double rank = share * static_cast<double>(drawn.size() - 1);
    return drawn[static_cast<std::size_t>(std::lround(rank))];
  };
  const double tail = 0.5 * (1.0 - coverage);
  return {.value = value, .low = at(tail), .high = at(1.0 - tail)};
}

/// The answers less their mean, which makes the products of the first-order index less noisy.
void centre(Answers& answers) {
  double mean = 0.0;
  for (const double value : answers.a) {
    mean += value / static_cast<double>(answers.a.size());
  }
  const auto shift = [&](std::vector<double>& values) {
    for (double& value : values) {
      value -= mean;
    }
  };
  shift(answers.a);
  shift(answers.b);
  std::ranges::for_each(answers.mixed, shift);
}

/// Rows drawn with replacement: the same for all coordinates.
std::vector<std::vector<std::size_t>> resampled_rows(const SobolSettings& settings) {
  Rng rng(settings.seed, Stream::kResampling, 0);
  std::vector<std::vector<std::size_t>> all(static_cast<std::size_t>(settings.resamples));
  for (std::vector<std::size_t>& rows : all) {
    for (int k = 0; k < settings.samples; ++k) {
      rows.push_back(rng.next_u32() % static_cast<std::size_t>(settings.samples));
    }
  }
  return all;
}

void check(int dimension, const SobolSettings& settings) {
  if (dimension < 1 || settings.samples < 2 || settings.resamples < 2 ||
      !(settings.coverage > 0.0 && settings.coverage < 1.0)) {
    throw ConfigError(
        "Sobol indices need a dimension, two samples and resamples at least, and a "
        "coverage between 0 and 1");
  }
}

/// @param drawn  rows of the resamples, for the intervals
SobolIndex index_of(const Answers& answers,
                    std::size_t coordinate,
                    double variance,
                    std::span<const std::size_t> all,
                    std::span<const std::vector<std::size_t>> drawn,
                    double coverage) {
  std::vector<double> first;
  std::vector<double> total;
  for (const std::vector<std::size_t>& rows : drawn) {
    const double of_rows = std::max(variance_of(answers, rows), 1e-12 * variance);
    const Shares shares = shares_of(answers, coordinate, of_rows, rows);
    first.push_back(shares.first);
    total.push_back(shares.total);
  }
  const Shares shares = shares_of(answers, coordinate, variance, all);
  return {.first = with_interval(shares.first, std::move(first), coverage),
          .total = with_interval(shares.total, std::move(total), coverage)};
}

}  // namespace

std::vector<SobolIndex> sobol_indices(const CubeFunction& function,
                                      int dimension,
                                      const SobolSettings& settings) {
  check(dimension, settings);
  Answers answers = ask(function, dimension, settings);
  centre(answers);
  std::vector<std::size_t> all(answers.a.size());
  for (std::size_t row = 0; row < all.size(); ++row) {
    all[row] = row;
  }
  const double variance = variance_of(answers, all);
  std::vector<SobolIndex> indices(static_cast<std::size_t>(dimension));
  if (!(variance > 0.0)) {
    return indices;
  }
  const auto drawn = resampled_rows(settings);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    indices[i] = index_of(answers, i, variance, all, drawn, settings.coverage);
  }
  return indices;
}

}  // namespace glint
