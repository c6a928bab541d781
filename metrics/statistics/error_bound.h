// SPDX-License-Identifier: GPL-3.0-or-later
//
// How large errors get that have been seen only a few times. Formulas: docs/theory/statistics.md.
#pragma once

#include <cstddef>
#include <span>

namespace glint {

/// Bias, spread and bound of errors, in their own unit.
struct ErrorBound {
  double bias = 0.0;    ///< their mean
  double spread = 0.0;  ///< their standard deviation (n - 1)
  double bound = 0.0;   ///< of absolute values
};

/// The bound that at least the share `content` of all such errors stays within in absolute value,
/// with this confidence: abs(bias) + k spread. The errors are taken as independent and normal; k
/// is the one-sided tolerance factor of the content (1 + content) / 2, so the bound is on the safe
/// side for two sides.
/// Source: G. J. Hahn, W. Q. Meeker, "Statistical Intervals", Wiley 1991, section 4.4.
/// @param errors      at least two, finite
/// @param content     in (0, 1)
/// @param confidence  in (0, 1)
ErrorBound error_bound(std::span<const double> errors, double content, double confidence);

/// The k of error_bound(). @param count  errors, at least two
double tolerance_factor(std::size_t count, double content, double confidence);

/// The k with which abs(mean) + k spread of so many errors bounds the absolute value of one more,
/// with this confidence: t((1 + confidence) / 2, count - 1) sqrt(1 + 1 / count). The errors are
/// taken as independent and normal.
/// Source: G. J. Hahn, W. Q. Meeker, "Statistical Intervals", Wiley 1991, chapter 4.
/// @param count       at least two
/// @param confidence  in (0, 1)
double prediction_factor(std::size_t count, double confidence);

}  // namespace glint
