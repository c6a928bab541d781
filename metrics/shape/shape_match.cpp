// SPDX-License-Identifier: GPL-3.0-or-later
//
// Places a reference mask on a silhouette: shift by the centres of mass, scale by the areas, turn
// by the axes of the equivalent ellipses. An ellipse leaves open which end is which; third moments
// decide it, or the overlap of both ways. The angle is then refined by correlating the complex
// moments of order 1 to 8 with Newton's method (own derivation), which uses what an outline has
// besides its elongation. docs/theory/inspection_masks.md, "Laying a reference onto a part". Cost:
// a few passes over both masks; no memory beyond them.
#include "metrics/shape/shape_match.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "core/units.h"
#include "metrics/shape/equivalent_ellipse.h"

namespace glint {
namespace {

/// Below these a direction is that of pixels and noise, not of the shape.
constexpr double kMinElongation = 0.01;
constexpr double kMinSkewness = 0.02;
constexpr double kMinOverlapGain = 0.002;

/// The direction of a shape's third moments: that of the mean of |z|^2 z. It turns with the shape,
/// by whole turns.
struct Pointer {
  double angle_rad = 0.0;
  double strength = 0.0;  ///< over (l1 + l2)^1.5
};

Pointer pointer_of(const ShapeMoments& m) {
  const double x = m.xxx + m.xyy;
  const double y = m.xxy + m.yyy;
  return {.angle_rad = std::atan2(y, x), .strength = std::hypot(x, y) / std::pow(m.xx + m.yy, 1.5)};
}

double wrapped(double angle_rad) {
  return std::remainder(angle_rad, 2.0 * kPi);
}

/// Mean of |z|^2 (z / |z|)^k for k = 1 to 8 about the centre, over that of |z|^2. The k-th turns by
/// k times the shape's turn. k = 2 is the long axis; the others hold what the outline has besides.
struct Harmonics {
  static constexpr std::size_t kCount = 8;
  std::array<double, kCount> real = {};
  std::array<double, kCount> imaginary = {};
};

void add_harmonics(double w, double x, double y, Harmonics& sums) {
  const double r = std::hypot(x, y);
  if (w == 0.0 || r == 0.0) {
    return;
  }
  const double c = x / r;
  const double s = y / r;
  double real = w * r * r;
  double imaginary = 0.0;
  for (std::size_t k = 0; k < Harmonics::kCount; ++k) {
    const double next = real * c - imaginary * s;
    imaginary = real * s + imaginary * c;
    real = next;
    sums.real[k] += real;
    sums.imaginary[k] += imaginary;
  }
}

Harmonics harmonics_of(const ImageF& weights, const ShapeMoments& m) {
  Harmonics sums;
  for (int y = 0; y < weights.height(); ++y) {
    for (int x = 0; x < weights.width(); ++x) {
      const auto w = static_cast<double>(weights(x, y));
      add_harmonics(w, x + 0.5 - m.x_px, y + 0.5 - m.y_px, sums);
    }
  }
  const double squares = m.area_px * (m.xx + m.yy);
  for (std::size_t k = 0; k < Harmonics::kCount; ++k) {
    sums.real[k] /= squares;
    sums.imaginary[k] /= squares;
  }
  return sums;
}

/// The rotation near `start_rad` at which the harmonics correlate best, by Newton's steps; the
/// start when there is no such maximum within 0.1 rad.
double refined_turn(const Harmonics& from, const Harmonics& to, double start_rad) {
  double angle = start_rad;
  for (int step = 0; step < 20; ++step) {
    double slope = 0.0;
    double bend = 0.0;
    for (std::size_t k = 0; k < Harmonics::kCount; ++k) {
      const double order = static_cast<double>(k) + 1.0;
      const double c = std::cos(order * angle);
      const double s = std::sin(order * angle);
      const double along = from.real[k] * to.real[k] + from.imaginary[k] * to.imaginary[k];
      const double across = from.real[k] * to.imaginary[k] - from.imaginary[k] * to.real[k];
      slope += order * (across * c - along * s);
      bend -= order * order * (along * c + across * s);
    }
    if (!(bend < 0.0)) {
      return start_rad;
    }
    angle -= slope / bend;
    if (std::abs(angle - start_rad) > 0.1) {
      return start_rad;
    }
  }
  return angle;
}

struct Box {
  int left = 0;
  int top = 0;
  int right = 0;
  int bottom = 0;
};

/// The pixels of a picture onto which the reference's picture may fall.
Box box_of(const ImageF& reference, const Similarity& t, int width_px, int height_px) {
  const double c = t.scale * std::cos(t.angle_rad);
  const double s = t.scale * std::sin(t.angle_rad);
  double left = width_px;
  double top = height_px;
  double right = 0.0;
  double bottom = 0.0;
  for (const double x : {0.0, 1.0 * reference.width()}) {
    for (const double y : {0.0, 1.0 * reference.height()}) {
      const double u = t.to_x_px + c * (x - t.from_x_px) - s * (y - t.from_y_px);
      const double v = t.to_y_px + s * (x - t.from_x_px) + c * (y - t.from_y_px);
      left = std::min(left, u - 1.0);
      right = std::max(right, u + 1.0);
      top = std::min(top, v - 1.0);
      bottom = std::max(bottom, v + 1.0);
    }
  }
  const auto within = [](double value, int limit) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(limit)));
  };
  return {.left = within(std::floor(left), width_px),
          .top = within(std::floor(top), height_px),
          .right = within(std::ceil(right), width_px),
          .bottom = within(std::ceil(bottom), height_px)};
}

double value_or_zero(const ImageF& image, int x, int y) {
  const bool is_inside = x >= 0 && y >= 0 && x < image.width() && y < image.height();
  return is_inside ? static_cast<double>(image(x, y)) : 0.0;
}

double bilinear(const ImageF& image, double x_px, double y_px) {
  const double x = x_px - 0.5;
  const double y = y_px - 0.5;
  if (!(x > -1.0 && y > -1.0 && x < image.width() && y < image.height())) {
    return 0.0;
  }
  const int left = static_cast<int>(std::floor(x));
  const int top = static_cast<int>(std::floor(y));
  const double u = x - left;
  const double v = y - top;
  return (1.0 - v) * ((1.0 - u) * value_or_zero(image, left, top) +
                      u * value_or_zero(image, left + 1, top)) +
         v * ((1.0 - u) * value_or_zero(image, left, top + 1) +
              u * value_or_zero(image, left + 1, top + 1));
}

/// Where points of a picture lie in the reference's.
class Unwarp {
 public:
  explicit Unwarp(const Similarity& t)
      : t_(t), cos_(std::cos(t.angle_rad) / t.scale), sin_(std::sin(t.angle_rad) / t.scale) {}

  double sample(const ImageF& reference, double x_px, double y_px) const {
    const double x = x_px - t_.to_x_px;
    const double y = y_px - t_.to_y_px;
    return bilinear(
        reference, t_.from_x_px + cos_ * x + sin_ * y, t_.from_y_px - sin_ * x + cos_ * y);
  }

 private:
  Similarity t_;
  double cos_;
  double sin_;
};

double overlap_of(const ImageF& a, const ImageF& b) {
  double both = 0.0;
  double either = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    both += static_cast<double>(std::min(a.values()[i], b.values()[i]));
    either += static_cast<double>(std::max(a.values()[i], b.values()[i]));
  }
  return either > 0.0 ? both / either : 0.0;
}

/// Finds the rotation between two shapes whose place and scale are known.
class Matching {
 public:
  Matching(const ImageF& reference,
           const ImageF& part,
           const ShapeMoments& from,
           const ShapeMoments& to)
      : reference_(reference),
        part_(part),
        from_(from),
        to_(to),
        harmonics_from_(harmonics_of(reference, from)),
        harmonics_to_(harmonics_of(part, to)) {}

  ShapeMatch run() const {
    const EquivalentEllipse from = ellipse_of(from_);
    const EquivalentEllipse to = ellipse_of(to_);
    const Pointer pointer_from = pointer_of(from_);
    const Pointer pointer_to = pointer_of(to_);
    if (std::min(from.elongation, to.elongation) < kMinElongation) {
      return std::min(pointer_from.strength, pointer_to.strength) < kMinSkewness
                 ? turned(0.0, RotationRule::kNone)
                 : turned(pointer_to.angle_rad - pointer_from.angle_rad,
                          RotationRule::kThirdMoments);
    }
    const double along = to.angle_rad - from.angle_rad;
    if (std::min(std::abs(from.skewness), std::abs(to.skewness)) < kMinSkewness) {
      return better_of(along, along + kPi);
    }
    const bool is_same_end = (from.skewness > 0.0) == (to.skewness > 0.0);
    return turned(is_same_end ? along : along + kPi, RotationRule::kSkewness);
  }

 private:
  ShapeMatch turned(double angle_rad, RotationRule rule) const {
    const bool is_known = rule != RotationRule::kNone;
    const double turn =
        is_known ? refined_turn(harmonics_from_, harmonics_to_, angle_rad) : angle_rad;
    ShapeMatch match{.to_part = {.from_x_px = from_.x_px,
                                 .from_y_px = from_.y_px,
                                 .to_x_px = to_.x_px,
                                 .to_y_px = to_.y_px,
                                 .angle_rad = wrapped(turn),
                                 .scale = std::sqrt(to_.area_px / from_.area_px)},
                     .rule = rule};
    const ImageF laid = warped(reference_, match.to_part, part_.width(), part_.height());
    match.overlap = overlap_of(laid, part_);
    return match;
  }

  ShapeMatch better_of(double a_rad, double b_rad) const {
    const ShapeMatch a = turned(a_rad, RotationRule::kOverlap);
    const ShapeMatch b = turned(b_rad, RotationRule::kOverlap);
    ShapeMatch better = b.overlap > a.overlap ? b : a;
    if (std::abs(a.overlap - b.overlap) < kMinOverlapGain) {
      better.rule = RotationRule::kEitherWay;
    }
    return better;
  }

  const ImageF& reference_;
  const ImageF& part_;
  ShapeMoments from_;
  ShapeMoments to_;
  Harmonics harmonics_from_;
  Harmonics harmonics_to_;
};

}  // namespace

std::string_view warning(RotationRule rule) {
  switch (rule) {
    case RotationRule::kSkewness:
    case RotationRule::kOverlap:
    case RotationRule::kThirdMoments:
      return "";
    case RotationRule::kEitherWay:
      return "the part's outline fits the reference as well after half a turn: the mask may lie "
             "the wrong way round unless it has that symmetry too";
    case RotationRule::kNone:
      return "the part's outline is round: its rotation cannot be determined, the mask is moved "
             "and "
             "scaled only; use a mask that is round too, or pictures in a fixed position";
  }
  return "";
}

std::optional<ShapeMatch> match_shapes(const ImageF& reference, const ImageF& part) {
  const std::optional<ShapeMoments> from = moments_of(reference);
  const std::optional<ShapeMoments> to = moments_of(part);
  if (!from.has_value() || !to.has_value()) {
    return std::nullopt;
  }
  return Matching(reference, part, *from, *to).run();
}

std::optional<ShapeMatch> match_shapes(const Mask& reference, const Mask& part) {
  return match_shapes(coverage_of(reference), coverage_of(part));
}

ImageF warped(const ImageF& reference, const Similarity& to_part, int width_px, int height_px) {
  GLINT_CHECK(to_part.scale > 0.0, "a similarity without size");
  const Box box = box_of(reference, to_part, width_px, height_px);
  const Unwarp unwarp(to_part);
  const int samples = static_cast<int>(std::clamp(std::ceil(2.0 / to_part.scale), 2.0, 8.0));
  ImageF result(width_px, height_px);
  for (int y = box.top; y < box.bottom; ++y) {
    for (int x = box.left; x < box.right; ++x) {
      double sum = 0.0;
      for (int k = 0; k < samples * samples; ++k) {
        const int row = k / samples;
        const double u = (k % samples + 0.5) / samples;
        const double v = (row + 0.5) / samples;
        sum += unwarp.sample(reference, x + u, y + v);
      }
      result(x, y) = static_cast<float>(sum / (samples * samples));
    }
  }
  return result;
}

Mask warped(const Mask& reference, const Similarity& to_part, int width_px, int height_px) {
  const ImageF coverage = warped(coverage_of(reference), to_part, width_px, height_px);
  Mask mask(width_px, height_px);
  std::ranges::transform(coverage.values(), mask.values().begin(), [](float share) {
    return static_cast<unsigned char>(share >= 0.5F ? 1 : 0);
  });
  return mask;
}

}  // namespace glint
