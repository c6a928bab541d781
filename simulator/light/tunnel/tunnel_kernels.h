// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner loops over many rays, in float and free of Eigen so that they can be compiled for wide
// instruction sets (docs/decisions/0002-bit-identical-results.md). Without contraction every
// instruction set gives the same bits.
#pragma once

namespace glint {

/// A ray that meets nothing has this t.
inline constexpr float kNoHit_mm = 1e30F;

/// Hits nearer than this belong to the surface the ray leaves.
inline constexpr float kNearestHit_mm = 1e-3F;

/// Rays as separate arrays; directions have any length.
struct RayBlock {
  const float* origin_x = nullptr;
  const float* origin_y = nullptr;
  const float* origin_z = nullptr;
  const float* direction_x = nullptr;
  const float* direction_y = nullptr;
  const float* direction_z = nullptr;
  int count = 0;
};

/// A straight wall in the y-z plane: points q with normal . q = offset, between two ends.
struct FlatWall {
  double normal_y = 0, normal_z = 0;  ///< unit, away from the inside
  double offset_mm = 0;
  double start_y_mm = 0, start_z_mm = 0;
  double along_y = 0, along_z = 0;  ///< unit
  double length_mm = 0;
};

/// Bright and dark stripes along a coordinate q, with the tunnel moved along x.
struct StripePattern {
  float shift_x_mm = 0.0F;
  float shift_pattern_mm = 0.0F;  ///< of the stripes along q
  float periods_per_mm = 1.0F;
  float duty = 0.5F;
  float dark = 0.0F;  ///< radiance of dark stripes
  float half_length_mm = 0.0F;
  float led_ripple = 0.0F;
  float led_per_mm = 0.0F;
  float end_falloff = 0.0F;
};

/// Distances to walls from inside, along directions of any length; kNoHit_mm for none.
/// @param is_whole  their whole lines, without ends
void hit_flat(
    const RayBlock& rays, const FlatWall* walls, int num_walls, bool is_whole, float* t_mm);

/// Upper half (z >= base) or all of an ellipse around (0, base); rays start inside.
void hit_ellipse(const RayBlock& rays,
                 float base_mm,
                 float half_width_mm,
                 float height_mm,
                 bool is_whole,
                 float* t_mm);

/// Upper half or all of a superellipse, exponent >= 1, by Halley's method from outside.
void hit_superellipse(const RayBlock& rays,
                      float base_mm,
                      float half_width_mm,
                      float height_mm,
                      float exponent,
                      bool is_whole,
                      float* t_mm);

/// From t to position along x and gain: 0 for no hit and in the slot (|y| < half_slot above floor).
void finish_hits(const RayBlock& rays,
                 const float* t_mm,
                 float half_slot_mm,
                 float slot_floor_mm,
                 float* x_mm,
                 float* gain);

/// Directions from the origins of a block to a point.
void aim_at(const RayBlock& points,
            float x_mm,
            float y_mm,
            float z_mm,
            float* to_x,
            float* to_y,
            float* to_z);

/// Clears `occluded` where a sight line meets the wall behind the camera (t >= 1) or beyond an end.
void keep_sight(
    const float* t, const float* x_mm, int count, float half_length_mm, float* occluded);

/// From t to the point of the wall, z counted from the base; kNoHitMargin_mm as z for no hit.
void points_of_hits(const RayBlock& rays,
                    const float* t_mm,
                    float base_mm,
                    float* x_mm,
                    float* y_mm,
                    float* above_base_mm);

/// z of a ray that meets nothing.
inline constexpr float kNoHitMargin_mm = -1e30F;

/// How far points on the lines of two walls, mirrored in y = 0, lie inside the walls' ends
/// (negative: outside).
/// @param touch_at_top  the walls' upper ends touch and are no ends
/// @param z_mm          heights, which become the margins; kNoHitMargin_mm stays
void margins_of_panels(
    const FlatWall& right, bool touch_at_top, const float* y_mm, int count, float* z_mm);

/// out[i] += scale * gain[i] * radiance of the stripes at (x[i], q[i]).
void add_stripes(const float* x_mm,
                 const float* q_mm,
                 const float* gain,
                 int count,
                 const StripePattern& pattern,
                 float scale,
                 float* out);

}  // namespace glint
