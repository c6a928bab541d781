// SPDX-License-Identifier: GPL-3.0-or-later
//
// Weights of the sensor's blur: a Gaussian of sigma pixels for pictures whose pixels already hold
// the mean over their own box. From 1 px on it is the Gaussian at whole pixels. Up to 0.7 px, where
// whole pixels are too far apart for that, three weights to each side have the Gaussian's variance
// and its contrast (MTF) at 0.3 and 0.45 cycles a pixel; between the two a smooth mixture.
//
// Below 0.683 px the second weight is negative: no weights >= 0 have both that variance and that
// contrast. A picture within [0, 1] then blurs to [-o, 1 + o] with o <= 0.08 (blur_overshoot),
// 0.015 beside a straight edge; the sensor cuts it off at 0. docs/theory/sensor.md, "Narrow blur".
// Own derivation.
#pragma once

#include <vector>

namespace glint {

/// Centre and one side of the weights along one axis; centre and both sides sum to 1.
/// @param sigma_px  >= 0; 0: the centre alone
std::vector<double> blur_kernel(double sigma_px);

/// Their derivatives by sigma [1 / px], as many; the kernel's reach is kept fixed.
std::vector<double> blur_kernel_derivative(double sigma_px);

/// How far the blur of a picture within [0, 1] may lie outside, along both axes; 0 where no weight
/// is negative.
double blur_overshoot(double sigma_px);

}  // namespace glint
