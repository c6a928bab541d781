// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner loops of the inspection over rows of pixels, compiled for wide instruction sets. Each does
// the same operations in the same order for every pixel: the same bits on any machine.
#pragma once

#include <cstdint>

namespace glint::inspection_kernels {

/// Sums of rows of up to 65,536 frames.
void sum_rows(const std::uint8_t* const* rows, int frames, int count, std::uint32_t* sum);
void sum_rows(const std::uint16_t* const* rows, int frames, int count, std::uint32_t* sum);
void sum_rows(const float* const* rows, int frames, int count, double* sum);

/// mean = sum / divisor, correctly rounded; the first needs divisor and sums up to 2^24.
void divide_small(const std::uint32_t* sum, int count, float divisor, float* mean);
void divide(const std::uint32_t* sum, int count, double divisor, float* mean);
void divide(const double* sum, int count, double divisor, float* mean);

/// Copies the values inside the mask, 0 elsewhere; in place is allowed.
/// @return whether all values, also those outside, are numbers of no more than the largest size
bool keep_inside(
    const float* values, const unsigned char* mask, int count, float largest, float* kept);

/// out = taps[0] rows[radius] + sum over k of taps[k] (rows[radius - k] + rows[radius + k]); the
/// rows may be one row, shifted.
void fold(const float* const* rows, const float* taps, int radius, int count, float* out);

/// out += weights * values
void add_weighted(const float* weights, const float* values, int count, float* out);

/// out = where |values| > |out|: values
void keep_larger(const float* values, int count, float* out);

/// out = factor * values inside the mask, 0 elsewhere
void scale_inside(
    float factor, const float* values, const unsigned char* mask, int count, float* out);

/// A value's distance from a middle (is_distance), or the value itself less the middle.
struct Reading {
  float middle = 0.0F;
  bool is_distance = false;
};

struct Counts {
  int below = 0;   ///< < low
  int within = 0;  ///< in [low, high]
};

/// Counts readings beside and within a bracket and appends the latter to `kept` (room for count).
Counts split_readings(
    const float* values, int count, Reading reading, float low, float high, float* kept);

/// The first x in [x, count) with row[x] >= high or row[x] <= low; `count` if there is none.
int find_beyond(const float* row, int x, int count, float low, float high);

}  // namespace glint::inspection_kernels
