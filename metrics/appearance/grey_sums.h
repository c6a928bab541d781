// SPDX-License-Identifier: GPL-3.0-or-later
//
// What least squares between the grey values of two pictures need.
#pragma once

namespace glint {

/// Sums over pixels of a simulated and a real picture; which ones, the caller says.
struct GreySums {
  double pixels = 0.0;
  double simulated = 0.0;
  double real = 0.0;
  double simulated_squares = 0.0;
  double real_squares = 0.0;
  double products = 0.0;
  double differences = 0.0;  ///< of squares

  void add(double simulated_grey, double real_grey) {
    pixels += 1.0;
    simulated += simulated_grey;
    real += real_grey;
    simulated_squares += simulated_grey * simulated_grey;
    real_squares += real_grey * real_grey;
    products += simulated_grey * real_grey;
    differences += (real_grey - simulated_grey) * (real_grey - simulated_grey);
  }

  /// Squares, products and differences about the means, as a match with an offset takes them: of
  /// the differences what is left beyond a common one. Of >= 1 pixel.
  GreySums centred() const {
    GreySums sums = *this;
    sums.simulated_squares -= simulated * simulated / pixels;
    sums.real_squares -= real * real / pixels;
    sums.products -= simulated * real / pixels;
    sums.differences -= (real - simulated) * (real - simulated) / pixels;
    return sums;
  }
};

}  // namespace glint
