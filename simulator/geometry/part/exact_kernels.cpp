// SPDX-License-Identifier: GPL-3.0-or-later
//
// A ray that Embree met at a triangle is moved onto the exact surface that the triangle stands for.
// Planes, paraboloids, spheres and cylinders are of second degree: the root next to the triangle,
// by the form of the quadratic formula that does not cancel. Involutes take Newton's method with
// two more terms of the root's series, all lanes together, until what is left is below the
// tolerance, in twenty steps at most. Some tens of operations a ray, for an involute some hundred;
// docs/theory/parts.md.
#include "simulator/geometry/part/exact_kernels.h"

#include <cmath>
#include <cstdint>

#include "core/simd.h"

namespace glint {
namespace {

using Kind = PatchCoefficients::Kind;

/// Share of the tolerance that a prediction of what is left must stay below, as it is one.
constexpr double kLeft = 0.1;

/// Angle of the point (x, y), to 2e-16 of a turn: the library's function would not be vectorised,
/// nor have the same bits everywhere. Rational approximation of the arc tangent on [-0.21, 0.66]
/// from Cephes (S. Moshier, atan.c); every other angle is reduced to it.
GLINT_INLINE double angle_of(double x, double y) {
  constexpr double kHalfPi = 1.57079632679489661923;
  const double across = std::fabs(x);
  const double up = std::fabs(y);
  const double low = up < across ? up : across;
  const double high = up < across ? across : up;
  const bool is_reduced = low > 0.66 * high;
  const double t = (is_reduced ? low - high : low) / (is_reduced ? low + high : high);
  const double z = t * t;
  const double p = (((-8.750608600031904122785e-1 * z - 1.615753718733365076637e1) * z -
                     7.500855792314704667340e1) *
                        z -
                    1.228866684490136173410e2) *
                       z -
                   6.485021904942025371773e1;
  const double q = ((((z + 2.485846490142306297962e1) * z + 1.650270098316988542046e2) * z +
                     4.328810604912902668951e2) *
                        z +
                    4.853903996359136964868e2) *
                       z +
                   1.945506571482613964425e2;
  const double reduced = t + t * (z * p / q);
  const double octant = is_reduced ? 0.5 * kHalfPi + reduced : reduced;
  const double quadrant = up > across ? kHalfPi - octant : octant;
  const double half = x < 0.0 ? 2.0 * kHalfPi - quadrant : quadrant;
  return y < 0.0 ? -half : half;
}

/// F of an involute and its gradient in the patch frame (see exact_surface.cpp), and the length of
/// the tangent from the base circle to the point: the radius of curvature there.
struct InvoluteAt {
  double value, gy, gz, tangent;
};

GLINT_INLINE InvoluteAt involute(const PatchCoefficients& patch, double y, double z) {
  // T - (atan T + hand phi): the angle of (y + i hand z) (1 + i T) is both at once.
  const double base = patch.radius_mm;
  const double r2 = y * y + z * z;
  const double above = r2 - base * base;
  const double tangent = std::sqrt(above > 0.0 ? above : 0.0);
  const double roll = tangent * (1.0 / base);
  const double side = patch.hand * z;
  const double per_r2 = 1.0 / r2;
  return {.value = base * (roll - angle_of(y - roll * side, side + roll * y)),
          .gy = per_r2 * (tangent * y + patch.hand * base * z),
          .gz = per_r2 * (tangent * z - patch.hand * base * y),
          .tangent = tangent};
}

/// A vector along the gradient of F in the patch frame.
template <Kind kKind>
GLINT_INLINE void outwards(const PatchCoefficients& patch,
                           double x,
                           double y,
                           double z,
                           double& gx,
                           double& gy,
                           double& gz) {
  if constexpr (kKind == Kind::kPlane) {
    gx = 0.0;
    gy = 0.0;
    gz = 1.0;
  } else if constexpr (kKind == Kind::kParaboloid) {
    gx = x * patch.curvature_along;
    gy = y * patch.curvature_across;
    gz = 1.0;
  } else if constexpr (kKind == Kind::kSphere) {
    gx = x;
    gy = y;
    gz = z;
  } else if constexpr (kKind == Kind::kCylinder) {
    gx = 0.0;
    gy = patch.outwards * y;
    gz = patch.outwards * z;
  } else {
    const double base = patch.radius_mm;
    const double above = y * y + z * z - base * base;
    const double tangent = std::sqrt(above > 0.0 ? above : 0.0);
    gx = 0.0;
    gy = tangent * y + patch.hand * base * z;
    gz = tangent * z - patch.hand * base * y;
  }
}

/// Start and direction in the patch frame, and how the search goes.
struct alignas(64) Search {
  double sx[kExactLanes], sy[kExactLanes], sz[kExactLanes];
  double dx[kExactLanes], dy[kExactLanes], dz[kExactLanes];
  double move[kExactLanes];
  double tolerance[kExactLanes];
  double is_found[kExactLanes];
};

/// How Newton's method goes.
struct alignas(64) Newton {
  double step[kExactLanes];           ///< the last one
  double slope[kExactLanes];          ///< where it started
  std::int64_t is_open[kExactLanes];  ///< 1 while neither converged nor given up
};

/// Surfaces drawn along the x axis of their frame: where on it a ray meets them does not matter.
constexpr bool is_straight(Kind kind) {
  return kind == Kind::kCylinder || kind == Kind::kInvolute;
}

template <Kind kKind>
GLINT_INLINE void begin(const PatchCoefficients& patch, const PolishLanes& lanes, Search& s) {
  const double* r = patch.rotation;
  const double* __restrict origin_x = lanes.origin_x;
  const double* __restrict origin_y = lanes.origin_y;
  const double* __restrict origin_z = lanes.origin_z;
  const double* __restrict direction_x = lanes.direction_x;
  const double* __restrict direction_y = lanes.direction_y;
  const double* __restrict direction_z = lanes.direction_z;
  const double* __restrict t_mm = lanes.start_t_mm;
  for (int i = 0; i < kExactLanes; ++i) {
    const double dx = direction_x[i];
    const double dy = direction_y[i];
    const double dz = direction_z[i];
    const double px = origin_x[i] - patch.translation[0] + t_mm[i] * dx;
    const double py = origin_y[i] - patch.translation[1] + t_mm[i] * dy;
    const double pz = origin_z[i] - patch.translation[2] + t_mm[i] * dz;
    s.dx[i] = is_straight(kKind) ? 0.0 : r[0] * dx + r[3] * dy + r[6] * dz;
    s.dy[i] = r[1] * dx + r[4] * dy + r[7] * dz;
    s.dz[i] = r[2] * dx + r[5] * dy + r[8] * dz;
    s.sx[i] = is_straight(kKind) ? 0.0 : r[0] * px + r[3] * py + r[6] * pz;
    s.sy[i] = r[1] * px + r[4] * py + r[7] * pz;
    s.sz[i] = r[2] * px + r[5] * py + r[8] * pz;
    const double length = std::sqrt(px * px + py * py + pz * pz);
    s.tolerance[i] = kPolished_mm * (length > 100.0 ? 1e-2 * length : 1.0);
    s.move[i] = 0.0;
    s.is_found[i] = 0.0;
  }
}

/// Half the second derivative of a m^2 + b m + c = 0, half the first, and c, along the ray: exactly
/// for the shapes of second degree.
template <Kind kKind>
GLINT_INLINE void quadratic(
    const PatchCoefficients& patch, const Search& s, int i, double& a, double& b, double& c) {
  if constexpr (kKind == Kind::kPlane) {
    a = 0.0;
    b = 0.5 * s.dz[i];
    c = s.sz[i];
  } else if constexpr (kKind == Kind::kParaboloid) {
    const double bent_x = patch.curvature_along * s.dx[i];
    const double bent_y = patch.curvature_across * s.dy[i];
    a = 0.5 * (bent_x * s.dx[i] + bent_y * s.dy[i]);
    b = 0.5 * (s.dz[i] + (s.sx[i] * bent_x + s.sy[i] * bent_y));
    c = s.sz[i] + 0.5 * (s.sx[i] * s.sx[i] * patch.curvature_along +
                         s.sy[i] * s.sy[i] * patch.curvature_across);
  } else {
    constexpr double kAlong = kKind == Kind::kSphere ? 1.0 : 0.0;  // a cylinder's axis
    const double x = kAlong * s.sx[i];
    const double dx = kAlong * s.dx[i];
    a = dx * dx + (s.dy[i] * s.dy[i] + s.dz[i] * s.dz[i]);
    b = x * dx + (s.sy[i] * s.dy[i] + s.sz[i] * s.dz[i]);
    c = x * x + (s.sy[i] * s.sy[i] + s.sz[i] * s.sz[i]) - patch.radius_mm * patch.radius_mm;
  }
}

/// The root next to the start, where Newton's method would end, in a form without cancellation.
template <Kind kKind>
GLINT_INLINE void solve(const PatchCoefficients& patch, double max_move_mm, Search& s) {
  for (int i = 0; i < kExactLanes; ++i) {
    double a = 0.0;
    double b = 0.0;
    double c = 0.0;
    quadratic<kKind>(patch, s, i, a, b, c);
    const double square = b * b - a * c;
    const double root = std::sqrt(square > 0.0 ? square : 0.0);
    const double move = -c / (b < 0.0 ? b - root : b + root);
    const bool is_found = (square > 0.0) & (std::fabs(move) <= max_move_mm);
    s.move[i] = is_found ? move : 0.0;
    s.is_found[i] = is_found ? 1.0 : 0.0;
  }
}

/// A step towards the root of an involute's F along a ray, and a bound of what it leaves.
struct InvoluteStep {
  double length, left;
};

/// Newton's step e = -F / F' with two more terms of the series of the root. With F' = n . d, the
/// share w of d across n and the length t of the tangent,
///   F'' = w^2 / t,  F''' = -w^2 (2 F' + t') / t^2,  t' = p . d / t.
/// The next term is below |A| (2.3 |A| + 0.41 H)^2 e^4 with A = F'' / (2 F') and
/// H = (2 |F'| + |t'| + 2) / t. Newton's alone where the series does not fall fast, as at the base
/// circle and within it, with nothing known of what is left.
GLINT_INLINE InvoluteStep
step_of(const InvoluteAt& at, double y, double z, double dy, double dz, double slope) {
  constexpr double kFast = 0.1;
  constexpr double kShortest_mm = 1e-30;  // for which the series never falls fast
  const double per_t = 1.0 / (at.tangent > kShortest_mm ? at.tangent : kShortest_mm);
  const double per_slope = 1.0 / slope;
  const double across = at.gy * dz - at.gz * dy;
  const double stretch = (y * dy + z * dz) * per_t;
  const double a = 0.5 * across * across * (per_t * per_slope);
  const double b = a * (2.0 * slope + stretch) * (per_t * (-1.0 / 3.0));
  const double c = 2.0 * a * a - b;
  const double h = (2.0 * std::fabs(slope) + std::fabs(stretch) + 2.0) * per_t;
  const double growth = 2.3 * std::fabs(a) + 0.41 * h;
  const double e = -at.value * per_slope;
  const double grown = std::fabs(e) * growth;
  const double series = e - e * e * (a - e * c);
  const double unknown_mm = grown < kFast ? 0.0 : 1.0;
  return {.length = grown < kFast ? series : e,
          .left = std::fabs(a) * (e * e) * (grown * grown) + unknown_mm};
}

/// One step for all open lanes of an involute; returns whether any is still open. A step is the
/// last when it leaves nothing, without a further one to see it: by the bound above, or, after
/// Newton's, by a prediction. Its error falls from a step to its square times half the bend over
/// the slope, and the bend is what the last step changed the derivative by.
GLINT_INLINE bool step(const PatchCoefficients& patch, double max_move_mm, Search& s, Newton& n) {
  for (int i = 0; i < kExactLanes; ++i) {
    const double y = s.sy[i] + s.move[i] * s.dy[i];
    const double z = s.sz[i] + s.move[i] * s.dz[i];
    const InvoluteAt at = involute(patch, y, z);
    const double slope = at.gy * s.dy[i] + at.gz * s.dz[i];
    const InvoluteStep next = step_of(at, y, z, s.dy[i], s.dz[i], slope);
    const double step_mm = next.length;
    const double moved = s.move[i] + step_mm;
    const double predicted = std::fabs(step_mm * step_mm * (slope - n.slope[i]));
    const double allowed = kLeft * s.tolerance[i] * std::fabs(slope * n.step[i]);
    const bool is_open = n.is_open[i] != 0;
    const bool is_near = std::fabs(moved) <= max_move_mm;  // false for a slope of zero, too
    const bool is_done = (std::fabs(step_mm) <= s.tolerance[i]) | (next.left < s.tolerance[i]) |
                         (predicted < allowed);
    s.move[i] = is_open && is_near ? moved : s.move[i];
    s.is_found[i] = is_open && is_near && is_done ? 1.0 : s.is_found[i];
    n.is_open[i] = is_open && is_near && !is_done ? 1 : 0;
    n.step[i] = step_mm;
    n.slope[i] = slope;
  }
  std::int64_t open = 0;
  for (int i = 0; i < kExactLanes; ++i) {
    open |= n.is_open[i];
  }
  return open != 0;
}

template <Kind kKind>
GLINT_INLINE void search(const PatchCoefficients& patch, double max_move_mm, Search& s) {
  if constexpr (kKind == Kind::kInvolute) {
    Newton n;
    for (int i = 0; i < kExactLanes; ++i) {
      n.step[i] = 0.0;  // nothing is predicted from the first step
      n.slope[i] = 0.0;
      n.is_open[i] = 1;
    }
    for (int k = 0; k < kMaxPolishSteps && step(patch, max_move_mm, s, n); ++k) {
    }
  } else {
    solve<kKind>(patch, max_move_mm, s);
  }
}

/// What goes to the caller's arrays at the end: the compiler cannot know that they do not overlap.
struct alignas(64) Result {
  double point_x[kExactLanes], point_y[kExactLanes], point_z[kExactLanes];
  double normal_x[kExactLanes], normal_y[kExactLanes], normal_z[kExactLanes];
};

GLINT_INLINE void copy(const double* from, double* to) {
  for (int i = 0; i < kExactLanes; ++i) {
    to[i] = from[i];
  }
}

template <Kind kKind>
GLINT_INLINE void polish(const PatchCoefficients& patch,
                         double max_move_mm,
                         const PolishLanes& lanes) {
  Search s;
  begin<kKind>(patch, lanes, s);
  search<kKind>(patch, max_move_mm, s);
  const double* r = patch.rotation;
  const double* __restrict origin_x = lanes.origin_x;
  const double* __restrict origin_y = lanes.origin_y;
  const double* __restrict origin_z = lanes.origin_z;
  const double* __restrict direction_x = lanes.direction_x;
  const double* __restrict direction_y = lanes.direction_y;
  const double* __restrict direction_z = lanes.direction_z;
  const double* __restrict start_t_mm = lanes.start_t_mm;
  Result at;
  for (int i = 0; i < kExactLanes; ++i) {
    const double x = is_straight(kKind) ? 0.0 : s.sx[i] + s.move[i] * s.dx[i];
    const double y = s.sy[i] + s.move[i] * s.dy[i];
    const double z = s.sz[i] + s.move[i] * s.dz[i];
    double gx = 0.0;
    double gy = 0.0;
    double gz = 0.0;
    outwards<kKind>(patch, x, y, z, gx, gy, gz);
    const double t_mm = start_t_mm[i] + s.move[i];
    at.point_x[i] = origin_x[i] + t_mm * direction_x[i];
    at.point_y[i] = origin_y[i] + t_mm * direction_y[i];
    at.point_z[i] = origin_z[i] + t_mm * direction_z[i];
    if constexpr (is_straight(kKind)) {
      const double scale = 1.0 / std::sqrt(gy * gy + gz * gz);
      const double ny = gy * scale;
      const double nz = gz * scale;
      at.normal_x[i] = r[1] * ny + r[2] * nz;
      at.normal_y[i] = r[4] * ny + r[5] * nz;
      at.normal_z[i] = r[7] * ny + r[8] * nz;
    } else {
      const double scale = 1.0 / std::sqrt(gx * gx + gy * gy + gz * gz);
      const double nx = gx * scale;
      const double ny = gy * scale;
      const double nz = gz * scale;
      at.normal_x[i] = r[0] * nx + r[1] * ny + r[2] * nz;
      at.normal_y[i] = r[3] * nx + r[4] * ny + r[5] * nz;
      at.normal_z[i] = r[6] * nx + r[7] * ny + r[8] * nz;
    }
  }
  copy(at.point_x, lanes.point_x);
  copy(at.point_y, lanes.point_y);
  copy(at.point_z, lanes.point_z);
  copy(at.normal_x, lanes.normal_x);
  copy(at.normal_y, lanes.normal_y);
  copy(at.normal_z, lanes.normal_z);
  copy(s.is_found, lanes.is_found);
}

}  // namespace

GLINT_WIDE void polish16(const PatchCoefficients& patch,
                         double max_move_mm,
                         const PolishLanes& lanes) {
  switch (patch.kind) {
    case Kind::kPlane:
      return polish<Kind::kPlane>(patch, max_move_mm, lanes);
    case Kind::kParaboloid:
      return polish<Kind::kParaboloid>(patch, max_move_mm, lanes);
    case Kind::kSphere:
      return polish<Kind::kSphere>(patch, max_move_mm, lanes);
    case Kind::kCylinder:
      return polish<Kind::kCylinder>(patch, max_move_mm, lanes);
    case Kind::kInvolute:
      return polish<Kind::kInvolute>(patch, max_move_mm, lanes);
  }
}

}  // namespace glint
