// SPDX-License-Identifier: GPL-3.0-or-later
//
// The reverse mode through rendered frames: from the derivatives by the mean image to those by each
// frame's grey values (0 where a frame is clipped), through the adjoint blur to its radiances, and
// from there to the hits of the rays (plain_gradient.h, cell_gradient.h). Frames are rendered
// again, four at a time. docs/theory/derivatives.md, "Frames". Cost: once more the frames of the
// pixels that count, an adjoint blur and one pass over footprints for each; the number of keys does
// not matter. Memory: images of four frames.
#include "simulator/render/derivative/frame_gradient.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "core/image/spans.h"
#include "simulator/render/derivative/adjoint_blur.h"
#include "simulator/render/derivative/blur_derivative.h"
#include "simulator/render/derivative/cell_gradient.h"
#include "simulator/render/derivative/gradient_kernels.h"
#include "simulator/render/derivative/plain_gradient.h"
#include "simulator/render/footprint/footprint_frames.h"
#include "simulator/render/footprint/visible_part.h"

namespace glint {
namespace {

/// Frames that are rendered together: footprints are read once for all of them.
constexpr int kFramesAtOnce = 4;

/// The sensor up to its gain: blur only.
SensorSettings blur_only(double blur_px) {
  return {.exposure = 1.0, .gain = 1.0, .blur_px = blur_px, .bits = 0};
}

/// Derivative of the expected grey value by the blurred radiance, as a share of the gain: 1 until
/// it clips. Of pixels that do not clip all weigh the same to the last bit; the gain would round,
/// and pixels that weigh the same would err by the same: their sum cancels against others'.
class ResponseDerivative {
 public:
  explicit ResponseDerivative(const SensorSettings& sensor)
      : linear_(sensor.gain * sensor.exposure), has_noise_(sensor.full_well_e > 0.0) {
    constexpr double kStep = 0.5 / kSteps;
    for (int i = 0; has_noise_ && i <= kSteps; ++i) {
      const double radiance = static_cast<double>(i) / kSteps;
      const double high = grey_response(sensor, radiance + kStep).mean;
      const double low = grey_response(sensor, std::max(0.0, radiance - kStep)).mean;
      gradient_.push_back(static_cast<float>(
          (high - low) / (radiance + kStep - std::max(0.0, radiance - kStep)) / linear_));
    }
  }

  /// @param gradient  as many as radiances
  void at(const float* radiance, int count, float* gradient) const {
    if (!has_noise_) {
      gradient_kernels::mark_unclipped(radiance, count, static_cast<float>(linear_), gradient);
      return;
    }
    std::transform(radiance, radiance + count, gradient, [this](float r) { return noisy_at(r); });
  }

 private:
  float noisy_at(float radiance) const {
    const float place = std::clamp(radiance, 0.0F, 1.0F) * kSteps;
    const auto i = std::min<std::size_t>(kSteps - 1, static_cast<std::size_t>(place));
    const float s = place - static_cast<float>(i);
    return (1.0F - s) * gradient_[i] + s * gradient_[i + 1];
  }

  static constexpr int kSteps = 1024;
  double linear_;
  bool has_noise_;
  std::vector<float> gradient_;
};

/// Where the blur is cut off at 0 nothing changes.
void clear_where_dark(const float* blurred, int count, float* derivative) {
  for (int i = 0; i < count; ++i) {
    derivative[i] = blurred[i] > 0.0F ? derivative[i] : 0.0F;
  }
}

/// The pixels that see light.
Spans lit_pixels(const Footprints& footprints, const Spans& pixels) {
  constexpr int kGapTolerance_px = 8;  // gaps that are not worth another start
  Spans result;
  for (const RowSpan& span : pixels) {
    const Footprints::State* state = footprints.state().row(span.y);
    const std::size_t first = result.size();
    for (int x = span.begin; x < span.end; ++x) {
      if (state[x] == Footprints::State::kDark) {
        continue;
      }
      if (result.size() > first && x - result.back().end <= kGapTolerance_px) {
        result.back().end = x + 1;
      } else {
        result.push_back({.y = span.y, .begin = x, .end = x + 1});
      }
    }
  }
  return result;
}

/// Puts a cell's derivatives where they belong.
struct CellAdder {
  GradientByHits& by_hits;
  std::size_t offset = 0;  ///< of the cell's corners in the arrays

  void operator()(const std::array<std::size_t, 4>& at, const CornerGradient& by) const {
    for (std::size_t c = 0; c < 4; ++c) {
      by_hits.x[offset + at[c]] += static_cast<float>(by.x[c]);
      by_hits.y[offset + at[c]] += static_cast<float>(by.y[c]);
      by_hits.margin[offset + at[c]] += static_cast<float>(by.margin[c]);
    }
  }
};

/// The pixels that are summed from cells, backwards.
class CellPixelGradient {
 public:
  /// @param pixels      of any state; others than those of cells add nothing
  /// @param per_weight  what a derivative by a pixel's radiance is in units of
  CellPixelGradient(const Footprints& footprints,
                    const Spans& pixels,
                    double per_weight,
                    ScanGradient& gradient)
      : footprints_(footprints),
        rays_(footprints.rays()),
        per_weight_(per_weight),
        gradient_(gradient),
        frames_(static_cast<std::size_t>(footprints.positions().frames())),
        cells_(footprints.positions()) {
    std::size_t place = 0;
    for (const RowSpan& span : pixels) {
      const Footprints::State* state = footprints_.state().row(span.y);
      for (int x = span.begin; x < span.end; ++x, ++place) {
        if (state[x] == Footprints::State::kCells) {
          cell_pixels_.push_back(span.y * rays_.width_px + x);
          places_.push_back(place);
        }
      }
    }
    cell_weights_.resize(cell_pixels_.size() * frames_);
  }

  /// @param by_radiance  derivative by each pixel's radiance in that frame, span after span
  void add_frame(int frame, const std::vector<float>& by_radiance) {
    double* weights = cell_weights_.data() + frame;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      weights[i * frames_] = per_weight_ * static_cast<double>(by_radiance[places_[i]]);
    }
  }

  void finish() {
    finish_cells();
    gradient_.duty += cells_.duty;
    gradient_.dark += cells_.dark;
    gradient_.slot_mm += cells_.slot_mm;
    gradient_.period_mm += cells_.period_mm;
    gradient_.offset_mm += cells_.offset_mm;
  }

 private:
  std::size_t corner(int x, int y) const {
    return static_cast<std::size_t>(y) * (static_cast<std::size_t>(rays_.width_px) + 1) +
           static_cast<std::size_t>(x);
  }

  void finish_cells() {
    Image<std::int32_t> index_of;
    for (std::size_t i = 0; i < cell_pixels_.size(); ++i) {
      const auto pixel = static_cast<std::size_t>(cell_pixels_[i]);
      if (!load_weights(i)) {
        continue;
      }
      if (rays_.kind.values()[pixel] == PixelKind::kRefined) {
        if (index_of.empty()) {
          index_of = Image<std::int32_t>(rays_.width_px, rays_.height_px, -1);
        }
        index_of.values()[pixel] = static_cast<std::int32_t>(i);
        continue;
      }
      const auto corner_width = static_cast<std::size_t>(rays_.width_px) + 1;
      const std::size_t at =
          corner(cell_pixels_[i] % rays_.width_px, cell_pixels_[i] / rays_.width_px);
      const auto row = static_cast<std::size_t>(cell_pixels_[i] / rays_.width_px);
      gradient_.corners.open(row);
      gradient_.corners.open(row + 1);
      turn_to(cell_pixels_[i]);
      add_cell(footprints_.hits(),
               rays_.corners.weight.data(),
               {at, at + 1, at + corner_width, at + corner_width + 1},
               {},
               {gradient_.corners});
      finish_pixel(cell_pixels_[i], {gradient_.corners});
    }
    for (std::size_t g = 0; !index_of.empty() && g < rays_.refined.size(); ++g) {
      const RefinedGroup& group = rays_.refined[g];
      for (std::size_t i = 0; i < group.pixels.size(); ++i) {
        const std::int32_t index = index_of.values()[static_cast<std::size_t>(group.pixels[i])];
        if (index >= 0) {
          add_refined(group, i, static_cast<std::size_t>(index), gradient_.refined[g]);
        }
      }
    }
  }

  void add_refined(const RefinedGroup& group,
                   std::size_t pixel,
                   std::size_t index,
                   RefinedGradient& gradient) {
    const auto n = static_cast<std::size_t>(group.cells_per_axis);
    const std::size_t first = pixel * (n + 1) * (n + 1);
    const std::size_t offset = gradient.pixels.size() * (n + 1) * (n + 1);
    GradientByHits& by_hits = gradient.by_hits;
    gradient.pixels.push_back(pixel);
    by_hits.resize(gradient.pixels.size(), (n + 1) * (n + 1));
    by_hits.open(gradient.pixels.size() - 1);
    intersect_light(group.rays,
                    footprints_.tunnel(),
                    static_cast<std::int64_t>(first),
                    static_cast<int>((n + 1) * (n + 1)),
                    hits_);
    load_weights(index);
    turn_to(group.pixels[pixel]);
    const double side = 1.0 / static_cast<double>(n);
    for (std::size_t cell = 0; cell < n * n; ++cell) {
      if (group.is_smooth[pixel * n * n + cell] == 0) {
        cells_.has_detached = true;
        continue;
      }
      const std::size_t at = cell / n * (n + 1) + cell % n;
      add_cell(hits_,
               group.rays.weight.data() + first,
               {at, at + 1, at + n + 1, at + n + 2},
               {.x = (static_cast<double>(cell % n) + 0.5) * side - 0.5,
                .y = (static_cast<double>(cell / n) + 0.5) * side - 0.5,
                .side = side},
               {by_hits, offset});
    }
    finish_pixel(group.pixels[pixel], {by_hits, offset});
  }

  /// The pixel that cells are added of next.
  void turn_to(std::int32_t pixel) {
    const OccludedEdge* edge = footprints_.occluded_edge(pixel);
    visible_.reset();
    if (edge != nullptr) {
      visible_.emplace(*edge, footprints_.tunnel().settings());
    }
  }

  /// @param square  that the cell is of the pixel
  void add_cell(const WallHits& hits,
                const float* weight,
                const std::array<std::size_t, 4>& at,
                const SquareOfPixel& square,
                const CellAdder& add) {
    const CellCorners corners(hits, weight, at);
    if (visible_) {
      cells_.add_visible(corners, at, *visible_, square, weights_, add);
    } else {
      cells_.add_smooth(corners, at, square.side * square.side, weights_, add);
    }
  }

  void finish_pixel(std::int32_t pixel, const CellAdder& add) {
    cells_.finish(weights_, add);
    gradient_.detached_pixels += cells_.has_detached ? 1 : 0;
    if (visible_) {
      add_edges(pixel);
    }
  }

  /// The slot's edges are |y| = half of its width, the ends |x| = half of the length.
  void add_edges(std::int32_t pixel) {
    const auto& [rim, start, end, left, right] = cells_.by_edges;
    const auto difference = [](const LinearGradient& a, const LinearGradient& b) {
      return LinearGradient{.value = a.value - b.value, .dx = a.dx - b.dx, .dy = a.dy - b.dy};
    };
    const auto corners = [](const LinearGradient& by) {
      OccludedEdge::Corners floats = {};
      std::ranges::transform(
          by.by_corners(), floats.begin(), [](double value) { return static_cast<float>(value); });
      return floats;
    };
    gradient_.edges.push_back({.pixel = pixel,
                               .x = corners(difference(start, end)),
                               .y = corners(difference(left, right)),
                               .margin = corners(rim)});
    gradient_.slot_mm += 0.5 * (left.value + right.value);
    cells_.by_edges = {};
  }

  /// False when the pixel has no derivative.
  bool load_weights(std::size_t index) {
    weights_.assign(cell_weights_.begin() + static_cast<std::ptrdiff_t>(index * frames_),
                    cell_weights_.begin() + static_cast<std::ptrdiff_t>((index + 1) * frames_));
    cells_.has_detached = false;
    return std::ranges::any_of(weights_, [](double weight) { return weight != 0.0; });
  }

  const Footprints& footprints_;
  const CornerRays& rays_;
  double per_weight_;
  ScanGradient& gradient_;
  std::size_t frames_;
  std::vector<std::int32_t> cell_pixels_;
  std::vector<std::size_t> places_;   ///< among the given pixels
  std::vector<double> cell_weights_;  ///< frames_ of each
  std::vector<double> weights_;
  WallHits hits_;
  CellGradient cells_;
  std::optional<VisiblePart> visible_;  ///< of the pixel in work; empty: all of it
};

/// From blurred radiances to derivatives by them, frame by frame.
class AdjointOfTheSensor {
 public:
  AdjointOfTheSensor(const Sensor& sensor,
                     const Spans& wanted,
                     const Spans& around,
                     const ImageF& by_aspect,
                     int frames,
                     const WantedDerivatives& wants,
                     ScanGradient& gradient)
      : settings_(sensor.settings()),
        wanted_(wanted),
        by_aspect_(by_aspect),
        per_weight_(settings_.gain * settings_.exposure / frames),
        gradient_(gradient),
        response_(settings_),
        has_gain_(wants.gain || wants.exposure),
        has_blur_(wants.blur && settings_.blur_px > 0.0),
        blur_(blur_only(settings_.blur_px), by_aspect.width(), by_aspect.height()),
        change_(blur_, wanted, around),
        blurred_(ImageF::uninitialized(by_aspect.width(), by_aspect.height())),
        by_blurred_(zero_in(
            grown_spans(around, blur_.blur_radius_px(), 0, by_aspect.width(), by_aspect.height()),
            by_aspect.width(),
            by_aspect.height())) {}

  /// What the derivatives by radiances are in units of.
  double per_weight() const { return per_weight_; }

  /// @return derivatives by the blurred radiances, 0 elsewhere within the blur of pixels around
  const ImageF& apply(int index, const ImageF& radiance) {
    blur_.expose(radiance, index, wanted_, blurred_);
    for (const RowSpan& span : wanted_) {
      const float* grey = blurred_.row(span.y) + span.begin;
      float* by = by_blurred_.row(span.y) + span.begin;
      response_.at(grey, span.size(), by);
      if (blur_.blur_is_cut_off()) {
        clear_where_dark(grey, span.size(), by);
      }
      gradient_kernels::multiply_by(by_aspect_.row(span.y) + span.begin, span.size(), by);
      if (has_gain_) {
        const auto count = static_cast<std::size_t>(span.size());
        const double by_grey = per_weight_ * gradient_kernels::exact_dot(by, grey, count);
        gradient_.gain += by_grey / settings_.gain;
        gradient_.exposure += by_grey / settings_.exposure;
      }
    }
    if (has_blur_) {
      gradient_.blur_px += per_weight_ * change_.derivative(radiance, by_blurred_);
    }
    return by_blurred_;
  }

 private:
  const SensorSettings& settings_;
  const Spans& wanted_;
  const ImageF& by_aspect_;
  double per_weight_;
  ScanGradient& gradient_;
  ResponseDerivative response_;
  bool has_gain_, has_blur_;
  Sensor blur_;
  BlurDerivative change_;
  ImageF blurred_, by_blurred_;
};

std::size_t count_of(const Spans& spans) {
  std::size_t count = 0;
  for (const RowSpan& span : spans) {
    count += static_cast<std::size_t>(span.size());
  }
  return count;
}

}  // namespace

void add_frame_gradient(const Footprints& footprints,
                        const Sensor& sensor,
                        const Spans& wanted,
                        const ImageF& by_aspect,
                        const WantedDerivatives& wants,
                        std::shared_ptr<const PixelCells> cells,
                        ScanGradient& gradient) {
  if (wanted.empty()) {
    return;
  }
  const int width = by_aspect.width();
  const int height = by_aspect.height();
  const Spans around = grown_spans(wanted, sensor.blur_radius_px(), 0, width, height);
  const Spans lit = lit_pixels(footprints, around);
  const FootprintFrames frames(footprints, lit, std::move(cells));
  const int total = footprints.positions().frames();
  AdjointOfTheSensor through_sensor(sensor, wanted, around, by_aspect, total, wants, gradient);
  AdjointBlur through_blur(sensor, width, height);
  PlainGradient plain(footprints, lit);
  CellPixelGradient summed(footprints, lit, through_sensor.per_weight(), gradient);
  // The blur of the pixels around reads so far, and does not use it.
  const Spans beside = grown_spans(around, sensor.blur_radius_px(), 0, width, height);
  std::vector<ImageF> radiance;
  for (int k = 0; k < std::min(kFramesAtOnce, total); ++k) {
    radiance.push_back(zero_in(beside, width, height));
  }
  std::vector<std::vector<float>> by_radiance(radiance.size(), std::vector<float>(count_of(lit)));
  for (int first = 0; first < total; first += kFramesAtOnce) {
    radiance.resize(static_cast<std::size_t>(std::min(kFramesAtOnce, total - first)));
    by_radiance.resize(radiance.size());
    frames.render(first, radiance);
    for (std::size_t k = 0; k < radiance.size(); ++k) {
      const int index = first + static_cast<int>(k);
      const ImageF& by_blurred = through_sensor.apply(index, radiance[k]);
      float* out = by_radiance[k].data();
      for (const RowSpan& span : lit) {
        through_blur.apply(by_blurred, span, out);
        out += span.size();
      }
      summed.add_frame(index, by_radiance[k]);
    }
    plain.add_frames(first, by_radiance);
  }
  plain.finish(through_sensor.per_weight(), gradient);
  summed.finish();
}

}  // namespace glint
