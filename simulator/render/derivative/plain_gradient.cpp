// SPDX-License-Identifier: GPL-3.0-or-later
//
// The reverse mode for pixels that lie entirely on the lit wall: the derivative of the trapezoid of
// footprint_kernels.h, summed over the frames. Pieces of 256 pixels that see one edge at most take
// a shorter loop and leave the factors that all frames share to the end. Phases are fractions of a
// period in fixed point, because what the two edges of a stripe change almost cancels.
// docs/theory/derivatives.md, "Digits". Cost: one trapezoid per pixel and frame. Memory: some 40
// bytes per pixel.
#include "simulator/render/derivative/plain_gradient.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "simulator/render/footprint/pixel_dark.h"

namespace glint {
namespace {

/// Pixels that are worked on together.
constexpr std::size_t kTile = 256;

/// A row's values between two zeros.
class PaddedRow {
 public:
  explicit PaddedRow(int longest) : values_(static_cast<std::size_t>(longest) + 2) {}

  void set(const float* from, int count, float factor) {
    for (int i = 0; i < count; ++i) {
      values_[static_cast<std::size_t>(i) + 1] = factor * from[i];
    }
    values_[static_cast<std::size_t>(count) + 1] = 0.0F;
  }

  const float* data() const { return values_.data() + 1; }

 private:
  std::vector<float> values_;
};

}  // namespace

struct PlainGradient::Tile {
  using Values = std::array<float, kTile>;
  std::size_t count = 0;
  Values outer, inner, per_major, per_minor, flatness, weight;
  Values rising, falling, major, minor, dark;
  Values by_duty, by_dark;

  int size() const { return static_cast<int>(count); }

  gradient_kernels::BoxShapes shapes() {
    return {.outer = outer.data(),
            .inner = inner.data(),
            .per_major = per_major.data(),
            .per_minor = per_minor.data(),
            .flatness = flatness.data()};
  }

  gradient_kernels::NarrowSums sums() {
    return {.rising = rising.data(),
            .falling = falling.data(),
            .major = major.data(),
            .minor = minor.data(),
            .dark = dark.data()};
  }
};

PlainGradient::PlainGradient(const Footprints& footprints, const Spans& pixels)
    : footprints_(footprints), pixels_(pixels) {
  constexpr float kNarrowest = 1e-6F;  // footprints are taken as no narrower than this
  const CornerRays& rays = footprints.rays();
  std::size_t count = 0;
  for (const RowSpan& span : pixels) {
    count += static_cast<std::size_t>(span.size());
  }
  phase_.resize(count);
  v_.resize(count);
  for (auto* array : {&gx_, &gy_, &gain_, &by_v_, &by_gx_, &by_gy_}) {
    array->resize(count);
  }
  const ScanPositions& p = footprints.positions();
  const auto corner_width = static_cast<std::size_t>(rays.width_px) + 1;
  std::size_t at = 0;
  for (const RowSpan& span : pixels) {
    const std::size_t corner = static_cast<std::size_t>(span.y) * corner_width;
    const float* top = footprints.hits().stripes_mm().data() + corner + span.begin;
    gradient_kernels::exact_phases({.top = top, .bottom = top + corner_width},
                                   span.size(),
                                   p.offset_mm,
                                   1.0 / p.period_mm,
                                   {.phase = phase_.data() + at,
                                    .v = v_.data() + at,
                                    .gx = gx_.data() + at,
                                    .gy = gy_.data() + at});
    const Footprints::State* state = footprints.state().row(span.y);
    for (int x = span.begin; x < span.end; ++x, ++at) {
      const bool is_plain = state[x] == Footprints::State::kPlain;
      gain_[at] = is_plain ? rays.corners.weight[corner + static_cast<std::size_t>(x)] : 0.0F;
    }
  }
  if (!p.is_dark_even) {
    find_dark();
  }
  const float limit = footprint_kernels::narrow_limit(static_cast<float>(p.duty));
  for (std::size_t begin = 0; begin < count; begin += kTile) {
    bool is_narrow = true;
    for (std::size_t i = begin; i < std::min(count, begin + kTile); ++i) {
      const float outer = 0.5F * (std::abs(gx_[i]) + std::abs(gy_[i])) + kNarrowest;
      is_narrow = is_narrow && (gain_[i] == 0.0F || outer <= limit);
    }
    is_narrow_.push_back(is_narrow ? 1 : 0);
  }
}

/// What bright stripes add is a factor of all derivatives but that by the dark ones.
void PlainGradient::find_dark() {
  bright_.reserve(gain_.size());
  by_dark_.resize(gain_.size());
  const float* dark = footprints_.dark().data();
  for (const RowSpan& span : pixels_) {
    for (int x = span.begin; x < span.end; ++x) {
      const auto [a, b, c, d] = footprints_.corners_of(span.y * footprints_.rays().width_px + x);
      bright_.push_back(1.0F - 0.25F * ((dark[a] + dark[b]) + (dark[c] + dark[d])));
    }
  }
  gradient_kernels::multiply(
      gain_.data(), bright_.data(), static_cast<int>(gain_.size()), gain_.data());
}

void PlainGradient::add_dark_nodes(double per_weight, ScanGradient& gradient) const {
  const CornerRays& rays = footprints_.rays();
  std::size_t at = 0;
  for (const RowSpan& span : pixels_) {
    gradient.corners.open(static_cast<std::size_t>(span.y));
    gradient.corners.open(static_cast<std::size_t>(span.y) + 1);
    for (int x = span.begin; x < span.end; ++x, ++at) {
      if (by_dark_[at] != 0.0) {
        add_mean_dark_gradient(
            footprints_.tunnel().dark(),
            footprints_.hits(),
            rays.corners.weight.data(),
            footprints_.corners_of(span.y * rays.width_px + x),
            per_weight * by_dark_[at] / static_cast<double>(bright_[at]),
            gradient.dark_nodes,
            {.y = gradient.corners.y.data(), .margin = gradient.corners.margin.data()});
      }
    }
  }
}

void PlainGradient::add_frames(int first, const std::vector<std::vector<float>>& by_radiance) {
  Tile tile;
  for (std::size_t begin = 0; begin < v_.size(); begin += kTile) {
    tile.count = std::min(kTile, v_.size() - begin);
    tile.by_duty.fill(0.0F);
    tile.by_dark.fill(0.0F);
    if (is_narrow_[begin / kTile] != 0) {
      add_narrow(first, by_radiance, begin, tile);
    } else {
      add_wide(first, by_radiance, begin, tile);
    }
    duty_ += gradient_kernels::exact_sum(tile.by_duty.data(), tile.count);
    dark_ += gradient_kernels::exact_sum(tile.by_dark.data(), tile.count);
    for (std::size_t i = 0; i < tile.count && !by_dark_.empty(); ++i) {
      by_dark_[begin + i] += static_cast<double>(tile.by_dark[i]);
    }
  }
}

void PlainGradient::add_narrow(int first,
                               const std::vector<std::vector<float>>& by_radiance,
                               std::size_t begin,
                               Tile& tile) {
  const ScanPositions& p = footprints_.positions();
  gradient_kernels::box_shapes(gx_.data() + begin, gy_.data() + begin, tile.size(), tile.shapes());
  for (auto* values : {&tile.rising, &tile.falling, &tile.major, &tile.minor, &tile.dark}) {
    values->fill(0.0F);
  }
  for (std::size_t k = 0; k < by_radiance.size(); ++k) {
    gradient_kernels::multiply(
        by_radiance[k].data() + begin, gain_.data() + begin, tile.size(), tile.weight.data());
    gradient_kernels::add_narrow_frame(v_.data() + begin,
                                       tile.shapes(),
                                       tile.weight.data(),
                                       tile.size(),
                                       p.shift_periods[static_cast<std::size_t>(first) + k],
                                       p.duty,
                                       tile.sums());
  }
  gradient_kernels::add_narrow_sums(gx_.data() + begin,
                                    gy_.data() + begin,
                                    tile.shapes(),
                                    tile.sums(),
                                    tile.size(),
                                    {.v = by_v_.data() + begin,
                                     .gx = by_gx_.data() + begin,
                                     .gy = by_gy_.data() + begin,
                                     .duty = tile.by_duty.data(),
                                     .dark = tile.by_dark.data()});
}

void PlainGradient::add_wide(int first,
                             const std::vector<std::vector<float>>& by_radiance,
                             std::size_t begin,
                             Tile& tile) {
  const ScanPositions& p = footprints_.positions();
  for (std::size_t k = 0; k < by_radiance.size(); ++k) {
    gradient_kernels::multiply(
        by_radiance[k].data() + begin, gain_.data() + begin, tile.size(), tile.weight.data());
    gradient_kernels::add_box_gradients(v_.data() + begin,
                                        gx_.data() + begin,
                                        gy_.data() + begin,
                                        tile.weight.data(),
                                        tile.size(),
                                        p.shift_periods[static_cast<std::size_t>(first) + k],
                                        p.duty,
                                        {.v = by_v_.data() + begin,
                                         .gx = by_gx_.data() + begin,
                                         .gy = by_gy_.data() + begin,
                                         .duty = tile.by_duty.data(),
                                         .dark = tile.by_dark.data()});
  }
}

void PlainGradient::finish(double per_weight, ScanGradient& gradient) const {
  const ScanPositions& p = footprints_.positions();
  const double bright = per_weight * (1.0 - p.dark);
  const double scale = bright / p.period_mm;
  const auto corner_width = static_cast<std::size_t>(footprints_.rays().width_px) + 1;
  const int longest = footprints_.rays().width_px;
  PaddedRow by_v(longest), by_gx(longest), by_gy(longest);
  std::size_t from = 0;
  for (const RowSpan& span : pixels_) {
    const int size = span.size();
    by_v.set(by_v_.data() + from, size, static_cast<float>(scale));
    by_gx.set(by_gx_.data() + from, size, static_cast<float>(scale));
    by_gy.set(by_gy_.data() + from, size, static_cast<float>(scale));
    float* top = gradient.corners.x.data() + static_cast<std::size_t>(span.y) * corner_width +
                 static_cast<std::size_t>(span.begin);
    gradient_kernels::add_means_to_corners(by_v.data(), size, top, top + corner_width);
    gradient_kernels::add_gradients_to_corners(
        by_gx.data(), by_gy.data(), size, top, top + corner_width);
    from += static_cast<std::size_t>(size);
  }
  const std::size_t count = v_.size();
  gradient.period_mm -= scale * (gradient_kernels::exact_dot(by_v_.data(), phase_.data(), count) +
                                 gradient_kernels::exact_dot(by_gx_.data(), gx_.data(), count) +
                                 gradient_kernels::exact_dot(by_gy_.data(), gy_.data(), count));
  gradient.offset_mm -= scale * gradient_kernels::exact_sum(by_v_.data(), count);
  gradient.duty += bright * duty_;
  if (p.is_dark_even) {
    gradient.dark += per_weight * dark_;
  } else {
    add_dark_nodes(per_weight, gradient);
  }
}

}  // namespace glint
