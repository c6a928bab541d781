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

/// The trapezoid of each footprint, ready for add_box_frame.
struct Trapezoids {
  float* outer = nullptr;
  float* inner = nullptr;
  float* per_major = nullptr;  ///< 1 / larger of |gx|, |gy|
  float* per_both = nullptr;   ///< 1 / (2 |gx| |gy|)
};

void trapezoids(const float* gx, const float* gy, int count, const Trapezoids& out);

/// The bright share of each footprint under stripes that have moved by `shift` periods, as
/// out = gain * (dark + (1 - dark) * share). Right for outer <= 1.
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

/// Dark stripes that shine beside black ones: out += dark * (gain - out), state not 2 (cells)
void shine_beside_cells(
    const unsigned char* state, const float* dark, const float* gain, int count, float* out);

/// The mean over the four corners of each pixel.
void means_of_corners(const CornerRows& corners, int count, float* out);

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
