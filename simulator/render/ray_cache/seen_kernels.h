// SPDX-License-Identifier: GPL-3.0-or-later
//
// What camera rays see of the part, summed and averaged pixel by pixel: kernels as those of
// packet_kernels.h.
#pragma once

namespace glint {

/// Adds points that were seen (is_seen 1, else 0) to sums, for count numbers. The others must be
/// finite.
struct SeenSums {
  double* hits = nullptr;
  double* x_mm = nullptr;
  double* y_mm = nullptr;
  double* z_mm = nullptr;
};

void add_seen(const double* x_mm,
              const double* y_mm,
              const double* z_mm,
              const double* is_seen,
              int count,
              const SeenSums& sums);

/// Share of `samples` that hit and the mean of their points; zeros without a hit.
void mean_seen(const SeenSums& sums,
               int samples,
               int count,
               float* coverage,
               float* x_mm,
               float* y_mm,
               float* z_mm);

/// mean_seen() of one sample without sums.
void one_seen(const double* from_x_mm,
              const double* from_y_mm,
              const double* from_z_mm,
              const double* is_seen,
              int count,
              float* coverage,
              float* x_mm,
              float* y_mm,
              float* z_mm);

}  // namespace glint
