// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspect/inspect_marks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/units.h"
#include "studies/report/report.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using MarkColour = std::array<float, 3>;

constexpr double kSpacePx = 3.5;         ///< between a defect and its outline
constexpr int kCorners = 40;             ///< of an ellipse
constexpr int kGoodWidthPx = 900;        ///< pictures are enlarged up to about this
constexpr double kPxPerLineWidth = 900;  ///< larger pictures have thicker lines
constexpr float kOutside = 0.45F;        ///< brightness beyond the region

/// Along the long axis, across it; image axes.
struct Axes {
  Vector2d centre;
  Vector2d along;
  Vector2d across;
};

Axes axes_of(const FoundDefect& defect) {
  const Vector2d direction(std::cos(defect.angle_rad), std::sin(defect.angle_rad));
  return {.centre = {defect.x_px, defect.y_px},
          .along = (0.5 * defect.length_px + kSpacePx) * direction,
          .across = (0.5 * defect.width_px + kSpacePx) * Vector2d(-direction.y(), direction.x())};
}

std::vector<Vector2d> ellipse(const Axes& axes) {
  std::vector<Vector2d> points;
  for (int i = 0; i < kCorners; ++i) {
    const double angle_rad = 2.0 * kPi * i / kCorners;
    points.emplace_back(axes.centre + std::cos(angle_rad) * axes.along +
                        std::sin(angle_rad) * axes.across);
  }
  return points;
}

std::vector<Vector2d> rectangle(const Axes& axes) {
  return {axes.centre + axes.along + axes.across,
          axes.centre - axes.along + axes.across,
          axes.centre - axes.along - axes.across,
          axes.centre + axes.along - axes.across};
}

MarkColour colour_of(DefectMark::Kind kind) {
  switch (kind) {
    case DefectMark::Kind::kHole:
      return {255.0F, 149.0F, 0.0F};
    case DefectMark::Kind::kScratch:
      return {0.0F, 190.0F, 255.0F};
    case DefectMark::Kind::kMissed:
      return {255.0F, 45.0F, 200.0F};
  }
  return {};
}

class Canvas {
 public:
  Canvas(const ImageF& grey, int factor)
      : factor_(factor), image_(grey.width() * factor, grey.height() * factor) {
    for (int y = 0; y < image_.height(); ++y) {
      for (int x = 0; x < image_.width(); ++x) {
        const float value = std::clamp(grey(x / factor, y / factor), 0.0F, 1.0F);
        image_(x, y).fill(static_cast<std::uint8_t>(std::lround(255.0F * value)));
      }
    }
    width_ = std::max(1.6, image_.width() / kPxPerLineWidth);
  }

  void draw(const DefectMark& mark) {
    const bool is_broken = mark.kind == DefectMark::Kind::kMissed;
    for (const bool is_rim : {true, false}) {
      const std::size_t count = mark.outline.size();
      for (std::size_t i = 0; i < count; ++i) {
        if (is_broken && i % 4 >= 2) {
          continue;
        }
        const Vector2d a = factor_ * mark.outline[i];
        const Vector2d b = factor_ * mark.outline[(i + 1) % count];
        if (is_rim) {
          stroke(a, b, width_ + 1.6, {0.0F, 0.0F, 0.0F}, 0.6F);
        } else {
          stroke(a, b, width_, colour_of(mark.kind), 1.0F);
        }
      }
    }
  }

  ImageRgb take() { return std::move(image_); }

 private:
  void stroke(
      const Vector2d& a, const Vector2d& b, double width, const MarkColour& colour, float opacity) {
    const double reach = 0.5 * width + 1.0;
    const Vector2d low = a.cwiseMin(b).array() - reach;
    const Vector2d high = a.cwiseMax(b).array() + reach;
    const Vector2d along = b - a;
    const double length2 = std::max(along.squaredNorm(), 1e-12);
    const auto first = [](double at) { return std::max(0, static_cast<int>(std::floor(at))); };
    for (int y = first(low.y()); y < std::min<double>(image_.height(), high.y()); ++y) {
      for (int x = first(low.x()); x < std::min<double>(image_.width(), high.x()); ++x) {
        const Vector2d from_a = Vector2d(x + 0.5, y + 0.5) - a;
        const double share = std::clamp(from_a.dot(along) / length2, 0.0, 1.0);
        const double distance = (from_a - share * along).norm();
        const auto cover =
            static_cast<float>(std::clamp(0.5 * width + 0.5 - distance, 0.0, 1.0)) * opacity;
        blend(image_(x, y), colour, cover);
      }
    }
  }

  static void blend(std::array<std::uint8_t, 3>& pixel, const MarkColour& colour, float cover) {
    for (std::size_t k = 0; k < 3; ++k) {
      const float old = pixel[k];
      pixel[k] = static_cast<std::uint8_t>(std::lround(old + cover * (colour[k] - old)));
    }
  }

  int factor_;
  ImageRgb image_;
  double width_ = 1.0;
};

}  // namespace

std::vector<DefectMark> marks_of(std::span<const FoundDefect> found) {
  std::vector<DefectMark> marks;
  for (const FoundDefect& defect : found) {
    const Axes axes = axes_of(defect);
    const bool is_hole = defect.kind == DefectKind::kHole;
    marks.push_back({.kind = is_hole ? DefectMark::Kind::kHole : DefectMark::Kind::kScratch,
                     .outline = is_hole ? ellipse(axes) : rectangle(axes),
                     .number = static_cast<int>(marks.size()) + 1});
  }
  return marks;
}

std::vector<DefectMark> missed_marks(std::span<const KnownDefect> known,
                                     const DetectionMatches& comparison) {
  std::vector<DefectMark> marks;
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (comparison.blob_of_defect[i] >= 0) {
      continue;
    }
    const Vector2d half = 0.5 * (known[i].to_px - known[i].from_px);
    const double length = half.norm();
    const Vector2d direction = length > 0.0 ? Vector2d(half / length) : Vector2d::UnitX();
    const double radius = known[i].radius_px + kSpacePx;
    marks.push_back(
        {.kind = DefectMark::Kind::kMissed,
         .outline = ellipse({.centre = known[i].middle_px(),
                             .along = (length + radius) * direction,
                             .across = radius * Vector2d(-direction.y(), direction.x())}),
         .number = static_cast<int>(i) + 1});
  }
  return marks;
}

ImageF shown_aspect(const ImageF& aspect, const Mask& region) {
  std::vector<float> inside;
  for (std::size_t i = 0; i < aspect.size(); ++i) {
    if (region.values()[i] != 0) {
      inside.push_back(aspect.values()[i]);
    }
  }
  float low = 0.0F;
  float high = 1.0F;
  if (!inside.empty()) {
    const auto at_share = [&](double share) {
      const auto nth = inside.begin() +
                       static_cast<std::ptrdiff_t>(share * static_cast<double>(inside.size() - 1));
      std::ranges::nth_element(inside, nth);
      return *nth;
    };
    low = at_share(0.002);
    high = at_share(0.998);
  }
  ImageF shown = stretched(aspect, low, high);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const float value = std::clamp(shown.values()[i], 0.0F, 1.0F);
    shown.values()[i] = region.values()[i] != 0 ? value : kOutside * value;
  }
  return shown;
}

ImageRgb overlay(const ImageF& shown, std::span<const DefectMark> marks) {
  const int factor = std::clamp(kGoodWidthPx / std::max(1, shown.width()), 1, 4);
  Canvas canvas(shown, factor);
  for (const DefectMark& mark : marks) {
    canvas.draw(mark);
  }
  return canvas.take();
}

}  // namespace glint
