// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/sampled_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "metrics/statistics/estimate.h"

namespace glint {
namespace {

constexpr std::string_view kRmsScore = "homogeneity.h_rms";
constexpr std::string_view kAbsoluteScore = "homogeneity.h_abs";
constexpr std::string_view kMeanScore = "homogeneity.mean";

/// What the scores tell of the whole cheap picture's grey values.
struct CheapGrey {
  double mean = 0.0;
  double uniformity = 1.0;  ///< h_rms or h_abs; of kMeanScore not needed

  /// Root mean square, or mean absolute, deviation from the mean.
  double deviation() const { return (1.0 - uniformity) * mean; }
};

std::optional<CheapGrey> cheap_grey(std::string_view score, const Scores& scores) {
  const auto mean = scores.find(std::string(kMeanScore));
  const auto found = scores.find(std::string(score));
  if (mean == scores.end() || found == scores.end() || !(mean->second > 0.0)) {
    return std::nullopt;
  }
  return CheapGrey{.mean = mean->second, .uniformity = found->second};
}

/// Random squares, one of which may be left out.
struct SquaresWithout {
  std::span<const SampledSquare> squares;
  std::size_t left_out;  ///< their number: none is

  /// The mean of a figure over the pixels.
  template <class OfPair>
  double mean_of(const OfPair& of_pair) const {
    double sum = 0.0;
    double count = 0.0;
    for (std::size_t i = 0; i < squares.size(); ++i) {
      if (i == left_out) {
        continue;
      }
      for (const GreyPair& pair : squares[i]) {
        sum += of_pair(pair);
        count += 1.0;
      }
    }
    return sum / count;
  }
};

/// The score of the dearer picture: each mean over its pixels is that of the cheap one and the mean
/// difference over the squares' pixels. No number of a picture that would be black.
double score_of_dearer(std::string_view score,
                       const CheapGrey& cheap,
                       const SquaresWithout& sample) {
  const double shift =
      sample.mean_of([](const GreyPair& pair) { return pair.dearer - pair.cheap; });
  const double mean = cheap.mean + shift;
  if (score == kMeanScore) {
    return mean;
  }
  if (!(mean > 0.0)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  if (score == kAbsoluteScore) {
    const double change = sample.mean_of([&](const GreyPair& pair) {
      return std::abs(pair.dearer - mean) - std::abs(pair.cheap - cheap.mean);
    });
    return 1.0 - (cheap.deviation() + change) / mean;
  }
  const double change = sample.mean_of([&](const GreyPair& pair) {
    const double dearer = pair.dearer - cheap.mean;
    const double before = pair.cheap - cheap.mean;
    return dearer * dearer - before * before;
  });
  const double variance = cheap.deviation() * cheap.deviation() + change - shift * shift;
  return 1.0 - std::sqrt(std::max(0.0, variance)) / mean;
}

/// The score of the cheap picture as if there were no other pixels.
double score_of_squares(std::string_view score, const SquaresWithout& sample) {
  const double mean = sample.mean_of([](const GreyPair& pair) { return pair.cheap; });
  if (score == kMeanScore) {
    return mean;
  }
  if (!(mean > 0.0)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  if (score == kAbsoluteScore) {
    return 1.0 -
           sample.mean_of([&](const GreyPair& pair) { return std::abs(pair.cheap - mean); }) / mean;
  }
  const double variance = sample.mean_of(
      [&](const GreyPair& pair) { return (pair.cheap - mean) * (pair.cheap - mean); });
  return 1.0 - std::sqrt(variance) / mean;
}

/// A statistic of squares and its standard error.
struct Statistic {
  double value = 0.0;
  double error = 0.0;
};

template <class OfSquares>
Statistic statistic_of(std::span<const SampledSquare> squares, const OfSquares& of_squares) {
  std::vector<double> without_one;
  for (std::size_t i = 0; i < squares.size(); ++i) {
    without_one.push_back(of_squares(SquaresWithout{squares, i}));
  }
  return {.value = of_squares(SquaresWithout{squares, squares.size()}),
          .error = jackknife_error(without_one)};
}

}  // namespace

bool follows_from_squares(std::string_view score) {
  return score == kRmsScore || score == kAbsoluteScore || score == kMeanScore;
}

std::optional<SampledError> sampled_error(std::string_view score,
                                          const Scores& cheap,
                                          std::span<const SampledSquare> squares) {
  const std::optional<CheapGrey> grey = cheap_grey(score, cheap);
  if (!grey) {
    return std::nullopt;
  }
  const Statistic dearer = statistic_of(
      squares, [&](const SquaresWithout& sample) { return score_of_dearer(score, *grey, sample); });
  const Statistic own = statistic_of(
      squares, [&](const SquaresWithout& sample) { return score_of_squares(score, sample); });
  const double known = cheap.find(std::string(score))->second;
  const SampledError found = {.difference = dearer.value - known,
                              .error = dearer.error,
                              .off = own.value - known,
                              .off_error = own.error};
  const bool is_told = std::isfinite(found.difference) && std::isfinite(found.error) &&
                       std::isfinite(found.off) && std::isfinite(found.off_error);
  return is_told ? std::optional(found) : std::nullopt;
}

}  // namespace glint
