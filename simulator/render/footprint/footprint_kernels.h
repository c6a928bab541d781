// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner loops of footprint integration, free of Eigen so that they can be compiled for wide
// instruction sets (docs/decisions/0002-bit-identical-results.md).
//
// A pixel sees the phase v (in periods) of the stripes as v + gx a + gy b for a, b in [-1/2, 1/2].
// The share of the pixel beyond an edge at distance d is a function C(d / footprint): the
// distribution of the sum of two even numbers, a trapezoid. Its half widths are
// outer = (|gx| + |gy|) / 2 and inner = ||gx| - |gy|| / 2.
#pragma once

namespace glint::footprint_kernels {

/// Two rows of corner values around a row of pixels: pixel i has corners i and i + 1 of both.
struct CornerRows {
  const float* top = nullptr;
  const float* bottom = nullptr;
};

/// Footprints of a row of pixels; all arrays as long as the row.
struct PhaseRow {
  float* v = nullptr;   ///< periods, in the middle
  float* gx = nullptr;  ///< periods a pixel
  float* gy = nullptr;
};

/// v = scale * (mean of corners - offset), and its differences.
void phases_of_corners(
    const CornerRows& corners, int count, float offset, float scale, const PhaseRow& out);

/// The same with v less whole periods, near 0: far from the middle a float keeps too few digits of
/// an edge's place.
void phases_in_period(
    const CornerRows& corners, int count, double offset, double scale, const PhaseRow& out);

/// Where corners are lit at every position of a scan.
struct LitLimits {
  float half_slot_mm = 0.0F;
  float x_low_mm = 0.0F;
  float x_high_mm = 0.0F;
  float widest_mm = 0.0F;  ///< stripes differ by no more than this between plain corners
};

/// What holds at each corner, one bit a condition: what holds for all corners of a pixel is the
/// conjunction of their four.
void corner_codes(const float* x_mm,
                  const float* y_mm,
                  const float* margin_mm,
                  int count,
                  const LitLimits& limits,
                  unsigned char* codes);

/// For each pixel 0 where no part of it is ever lit, 1 where all of it always is, else 2. Pixels
/// that see no part (kind 0) or that the wall hides are 0, refined ones (kind 2) that are not
/// are 2.
/// @param top, bottom  codes of the corners
void classify(const unsigned char* top,
              const unsigned char* bottom,
              const CornerRows& stripes_mm,
              const unsigned char* kind,
              const unsigned char* hidden,
              int count,
              const LitLimits& limits,
              unsigned char* state);

/// Limits of the hits in tiles, and what is known of them (TileLimits).
struct TileRow {
  const float* x_low = nullptr;
  const float* x_high = nullptr;
  const float* y_low = nullptr;
  const float* y_high = nullptr;
  const float* margin_low = nullptr;
  const float* stripes_low = nullptr;
  const float* stripes_high = nullptr;
  const unsigned char* kind = nullptr;  ///< 0 unknown, 1 known, 2 no rays
};

/// 1 for tiles whose smooth pixels are all plain, or that have none.
void even_tiles(const TileRow& tiles, int count, const LitLimits& limits, unsigned char* is_even);

/// The states of pixels between corners that are lit at every position.
void plain_states(const unsigned char* kind,
                  const unsigned char* hidden,
                  int count,
                  unsigned char* state);

/// The trapezoid of each footprint, ready for add_box_frame.
struct Trapezoids {
  float* outer = nullptr;
  float* inner = nullptr;
  float* per_major = nullptr;  ///< 1 / larger of |gx|, |gy|
  float* per_both = nullptr;   ///< 1 / (2 |gx| |gy|)
};

void trapezoids(const float* gx, const float* gy, int count, const Trapezoids& out);

/// The bright share of each footprint under stripes that have moved by `shift` periods, as
/// out = gain * (dark + (1 - dark) * share). Right for outer <= min(duty, 1 - duty).
struct BoxFrame {
  float shift = 0.0F;
  float duty = 0.5F;
  float dark = 0.0F;
};

void box_frame(const float* v,
               const Trapezoids& trapezoids,
               const float* gain,
               int count,
               const BoxFrame& frame,
               float* out);

/// Footprints this wide see one edge of the stripes at most.
inline float narrow_limit(float duty) {
  return 0.5F * (duty < 1.0F - duty ? duty : 1.0F - duty);
}

/// The same bytes for footprints that all are narrow (outer <= narrow_limit(duty)) where their gain
/// is not 0.
void narrow_box_frame(const float* v,
                      const Trapezoids& trapezoids,
                      const float* gain,
                      int count,
                      const BoxFrame& frame,
                      float* out);

/// The frame whose stripes are bright where those of another frame are dark:
/// out = gain * (1 + dark) - frame
void opposite_frame(const float* frame, const float* gain, int count, float dark, float* out);

/// Of values >= 0.
float largest(const float* values, int count);

/// The same of values whose gain is > 0 only; 0 if there is none.
float largest_lit(const float* values, const float* gain, int count);

/// gain = weight * cosine where the state is 1 (plain), else 0. @param cosine  nullptr: 1
void plain_gains(
    const unsigned char* state, const float* weight, const float* cosine, int count, float* gain);

/// The same with one weight for all pixels.
void even_gains(
    const unsigned char* state, float weight, const float* cosine, int count, float* gain);

/// out = gain * (dark + bright * share) where the state is not 2 (cells)
void mix_beside_cells(const unsigned char* state,
                      const float* gain,
                      const float* share,
                      int count,
                      float dark,
                      float bright,
                      float* out);

/// Bright share of footprints of any width, phase and differences times `scale`.
void any_shares(const float* v,
                const float* gx,
                const float* gy,
                int count,
                double scale,
                double duty,
                float* shares);

/// Half widths of each footprint's trapezoid (Trapezoids).
void half_widths(const float* gx, const float* gy, int count, float* outer, float* inner);

/// The same in float, for half widths and phases that are `scale` times v's: wrong by up to 1e-3
/// where a footprint wider than the stripes is almost a line.
void any_shares_fast(const float* v,
                     const float* outer,
                     const float* inner,
                     int count,
                     float scale,
                     float duty,
                     float* shares);

/// Samples of sum_box_frames come in groups of this many, filled up with gain 0.
inline constexpr int kLanes = 16;

/// out[k] += sum over samples of gain * (dark + bright * share), for each shift.
/// @param count      a multiple of kLanes
/// @param is_narrow  all samples are narrow: outer <= narrow_limit(duty)
void sum_box_frames(const float* v,
                    const Trapezoids& trapezoids,
                    const float* gain,
                    int count,
                    const double* shift,
                    int frames,
                    double duty,
                    double dark,
                    double bright,
                    bool is_narrow,
                    double* out);

/// out[k] += sum over vertices of c * J(v - shift[k]) + e * I(v - shift[k]), with I and J the first
/// and second integral, of mean zero, of the square wave less its mean.
void sum_vertices(const double* v,
                  const double* c,
                  const double* e,
                  int vertices,
                  const double* shift,
                  int frames,
                  double duty,
                  double* out);

/// out *= (1 + ripple cos(2 pi u per_mm)) / (1 + ripple) * (1 - falloff (u / half_length)^2) with
/// u = x - shift.
struct Unevenness {
  float shift_mm = 0.0F;
  float ripple = 0.0F;
  float per_mm = 0.0F;
  float falloff = 0.0F;
  float half_length_mm = 1.0F;
};

void modulate(const float* x_mm, int count, const Unevenness& uneven, float* out);

}  // namespace glint::footprint_kernels
