// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner loops over masks of pixels, 0 or 1 a pixel, compiled for wide instruction sets.
#pragma once

namespace glint::mask_kernels {

/// The union of `num_rows` >= 1 rows, then of each pixel of it and those up to `radius` beside it.
/// @param scratch  2 (width + 2 radius) values, overwritten
void grow_row(const unsigned char* const* rows,
              int num_rows,
              int width,
              int radius,
              unsigned char* scratch,
              unsigned char* grown);

/// rest = a and not b
void subtract(const unsigned char* a, const unsigned char* b, int count, unsigned char* rest);

/// How many of the values, 0 or 1, are 1.
int count_ones(const unsigned char* values, int count);

/// 1 where a state is not plain (1), and where it is not dark (0).
void split_states(const unsigned char* state,
                  int count,
                  unsigned char* is_other,
                  unsigned char* is_lit);

/// is_other |= neither linear nor beside others
void add_bends(const unsigned char* is_linear,
               const unsigned char* is_beside_other,
               int count,
               unsigned char* is_other);

/// closed = region and not watched and not near others
void mark_closed(const unsigned char* region,
                 const unsigned char* watched,
                 const unsigned char* is_near_other,
                 int count,
                 unsigned char* closed);

/// frames |= region and not closed and near light
void mark_frames(const unsigned char* region,
                 const unsigned char* closed,
                 const unsigned char* is_near_light,
                 int count,
                 unsigned char* frames);

/// Largest |value| in the mask where the margin is >= 0; 0 if there is none.
float largest_size(const unsigned char* mask, const float* values, const float* margin, int count);

/// How many of the values are > 0.
int count_positive(const float* values, int count);

/// Whether one of the values is > 0.
bool is_any_positive(const float* values, int count);

/// flags |= 1 where the values differ. Arrays must not overlap.
void mark_different(const float* a, const float* b, int count, unsigned char* flags);

}  // namespace glint::mask_kernels
