// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far scores of a picture are from those of a dearer one, from random squares of both: the
// cheap picture is known as a whole and serves as a control variate, so that only the difference is
// estimated. Formulas: docs/theory/statistics.md, "A score from random squares".
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "metrics/scores.h"
#include "studies/imaging/sampled/sampled_squares.h"

namespace glint {

/// Of a score: that of the dearer picture less that of the cheap one, and its standard error.
struct SampledError {
  double difference = 0.0;
  double error = 0.0;
  /// The cheap score of the squares' pixels less that of the whole picture, and its standard error:
  /// where they have missed what makes the score, as a highlight, it is larger than that tells.
  double off = 0.0;
  double off_error = 0.0;
};

/// Whether the score follows from means over the region's pixels: homogeneity.h_rms, h_abs and
/// mean. Percentiles, shares, defects and all others do not.
bool follows_from_squares(std::string_view score);

/// The error of a score by squares that were drawn with the same chance; the standard error is that
/// of the jackknife over them, as if they were drawn of infinitely many.
/// @param score    with follows_from_squares()
/// @param cheap    scores of the whole cheap picture
/// @param squares  two or more, each of one pixel or more
/// @return nothing where cheap lacks what is needed, and of black pictures
std::optional<SampledError> sampled_error(std::string_view score,
                                          const Scores& cheap,
                                          std::span<const SampledSquare> squares);

}  // namespace glint
