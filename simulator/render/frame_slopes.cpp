// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/frame_slopes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "simulator/render/cell_slopes.h"
#include "simulator/render/slope_kernels.h"

namespace glint {
namespace {

constexpr int kBridge_px = 8;
constexpr int kFramesAtOnce = 2;

/// The sensor up to its gain: blur only.
SensorSettings blur_only(double blur_px) {
  return {.exposure = 1.0, .gain = 1.0, .blur_px = blur_px, .bits = 0};
}

/// Slope of the expected grey value by the blurred radiance: the gain, until it clips.
class ResponseSlope {
 public:
  explicit ResponseSlope(const SensorSettings& sensor)
      : linear_(static_cast<float>(sensor.gain * sensor.exposure)),
        has_noise_(sensor.full_well_e > 0.0) {
    constexpr double kStep = 0.5 / kSteps;
    for (int i = 0; has_noise_ && i <= kSteps; ++i) {
      const double radiance = static_cast<double>(i) / kSteps;
      const double high = grey_response(sensor, radiance + kStep).mean;
      const double low = grey_response(sensor, std::max(0.0, radiance - kStep)).mean;
      slopes_.push_back(
          static_cast<float>((high - low) / (radiance + kStep - std::max(0.0, radiance - kStep))));
    }
  }

  /// @param slopes  as many as radiances
  void at(const float* radiance, int count, float* slopes) const {
    if (!has_noise_) {
      slope_kernels::unclipped_slopes(radiance, count, linear_, slopes);
      return;
    }
    std::transform(radiance, radiance + count, slopes, [this](float r) { return noisy_at(r); });
  }

 private:
  float noisy_at(float radiance) const {
    const float place = std::clamp(radiance, 0.0F, 1.0F) * kSteps;
    const auto i = std::min<std::size_t>(kSteps - 1, static_cast<std::size_t>(place));
    const float s = place - static_cast<float>(i);
    return (1.0F - s) * slopes_[i] + s * slopes_[i + 1];
  }

  static constexpr int kSteps = 1024;
  float linear_;
  bool has_noise_;
  std::vector<float> slopes_;
};

/// The blur backwards: slopes by blurred pixels to slopes by radiances, at the image's border, too,
/// whose pixels stand for those beyond.
class BlurBackwards {
 public:
  BlurBackwards(
      const Sensor& sensor, const Spans& wanted, const Spans& rendered, int width, int height)
      : weights_(sensor.blur_weights()),
        wanted_(wanted),
        rendered_(rendered),
        across_(width, height),
        result_(width, height) {}

  const ImageF& apply(const ImageF& by_blurred) {
    for (const RowSpan& span : rendered_) {
      std::fill_n(across_.row(span.y) + span.begin, span.size(), 0.0F);
      std::fill_n(result_.row(span.y) + span.begin, span.size(), 0.0F);
    }
    const int radius = static_cast<int>(weights_.size()) - 1;
    for (const RowSpan& span : wanted_) {
      const float* from = by_blurred.row(span.y);
      float* to = across_.row(span.y);
      for (int k = -radius; k <= radius; ++k) {
        const float weight = weights_[static_cast<std::size_t>(std::abs(k))];
        const int low = std::clamp(-k, span.begin, span.end);
        const int high = std::clamp(across_.width() - k, low, span.end);
        for (int x = span.begin; x < low; ++x) {
          to[0] += weight * from[x];
        }
        slope_kernels::add_scaled(from + low, high - low, weight, to + low + k);
        for (int x = high; x < span.end; ++x) {
          to[across_.width() - 1] += weight * from[x];
        }
      }
    }
    for (const RowSpan& span : rendered_) {
      const float* from = across_.row(span.y) + span.begin;
      for (int k = -radius; k <= radius; ++k) {
        const float weight = weights_[static_cast<std::size_t>(std::abs(k))];
        const int y = std::clamp(span.y + k, 0, across_.height() - 1);
        float* to = result_.row(y) + span.begin;
        slope_kernels::add_scaled(from, span.size(), weight, to);
      }
    }
    return result_;
  }

 private:
  const std::vector<float>& weights_;
  const Spans& wanted_;
  const Spans& rendered_;
  ImageF across_;
  ImageF result_;
};

/// How a blurred frame changes with the blur's sigma. A weight w at the distance k changes by
/// w (k^2 - m) / sigma^3, m the mean of k^2. So the sum with weights w_x w_y (k_x^2 + k_y^2) says it,
/// to the rounding of a sum; the difference of two blurs would have that over a short step.
class BlurChange {
 public:
  BlurChange(const Sensor& sensor, const Spans& wanted, const Spans& rendered)
      : weights_(sensor.blur_weights()), wanted_(wanted), rendered_(rendered) {
    const double sigma = sensor.settings().blur_px;
    per_cube_ = 1.0 / (sigma * sigma * sigma);
    mean_square_ = sensor.blur_variance_px2();
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      squares_.push_back(static_cast<float>(k * k) * weights_[k]);
    }
  }

  /// The change of a number with these slopes by blurred pixels.
  double slope(const ImageF& radiance, const ImageF& blurred, const ImageF& by_blurred) {
    blur_rows(radiance);
    const int radius = static_cast<int>(weights_.size()) - 1;
    const auto twice_mean = static_cast<float>(2.0 * mean_square_);
    double sum = 0.0;
    for (const RowSpan& span : wanted_) {
      row_.assign(static_cast<std::size_t>(span.size()), 0.0F);
      for (int k = -radius; k <= radius; ++k) {
        const auto at = static_cast<std::size_t>(std::abs(k));
        const int y = std::clamp(span.y + k, 0, radiance.height() - 1);
        slope_kernels::add_scaled(
            across_squares_.row(y) + span.begin, span.size(), weights_[at], row_.data());
        slope_kernels::add_scaled(
            across_.row(y) + span.begin, span.size(), squares_[at], row_.data());
      }
      const float* grey = blurred.row(span.y) + span.begin;
      const float* by = by_blurred.row(span.y) + span.begin;
      for (std::size_t i = 0; i < row_.size(); ++i) {
        sum += static_cast<double>(by[i] * (row_[i] - twice_mean * grey[i]));
      }
    }
    return sum * per_cube_;
  }

 private:
  /// Along the rows, with the weights and with their squares of distances.
  void blur_rows(const ImageF& radiance) {
    if (across_.empty()) {
      across_ = ImageF(radiance.width(), radiance.height());
      across_squares_ = across_;
    }
    const int radius = static_cast<int>(weights_.size()) - 1;
    for (const RowSpan& span : rendered_) {
      padded_.resize(static_cast<std::size_t>(span.size() + 2 * radius));
      for (int i = 0; i < span.size() + 2 * radius; ++i) {
        const int x = std::clamp(span.begin + i - radius, 0, radiance.width() - 1);
        padded_[static_cast<std::size_t>(i)] = radiance(x, span.y);
      }
      float* plain = across_.row(span.y) + span.begin;
      float* squares = across_squares_.row(span.y) + span.begin;
      std::fill_n(plain, span.size(), 0.0F);
      std::fill_n(squares, span.size(), 0.0F);
      for (int k = -radius; k <= radius; ++k) {
        const auto at = static_cast<std::size_t>(std::abs(k));
        const float* from = padded_.data() + radius + k;
        slope_kernels::add_scaled(from, span.size(), weights_[at], plain);
        slope_kernels::add_scaled(from, span.size(), squares_[at], squares);
      }
    }
  }

  const std::vector<float>& weights_;
  const Spans& wanted_;
  const Spans& rendered_;
  std::vector<float> squares_;  ///< weights times squares of their distances
  double mean_square_ = 0.0;
  double per_cube_ = 0.0;
  ImageF across_, across_squares_;
  std::vector<float> padded_, row_;
};

/// Footprints of the rendered pixels and what is summed for them over the frames.
struct PlainSums {
  std::vector<float> v, gx, gy, gain, weight;
  std::vector<float> by_v, by_gx, by_gy, by_duty, share, weights;
  bool is_narrow = true;  ///< each sees one edge of the stripes at most

  explicit PlainSums(const RowSpan& span) {
    const auto size = static_cast<std::size_t>(span.size());
    for (auto* row :
         {&v, &gx, &gy, &gain, &weight, &by_v, &by_gx, &by_gy, &by_duty, &share, &weights}) {
      row->resize(size);
    }
  }
};

/// Puts a cell's slopes where they belong.
struct CellAdder {
  SlopesByHits& by_hits;
  std::size_t offset = 0;  ///< of the cell's corners in the arrays

  void operator()(const std::array<std::size_t, 4>& at, const CornerSlopes& by) const {
    for (std::size_t c = 0; c < 4; ++c) {
      by_hits.x[offset + at[c]] += static_cast<float>(by.x[c]);
      by_hits.y[offset + at[c]] += static_cast<float>(by.y[c]);
      by_hits.margin[offset + at[c]] += static_cast<float>(by.margin[c]);
    }
  }
};

class FrameSlopes {
 public:
  FrameSlopes(const Footprints& footprints, const Spans& rendered, ScanSlopes& slopes)
      : footprints_(footprints),
        rays_(footprints.rays()),
        p_(footprints.positions()),
        rendered_(rendered),
        slopes_(slopes),
        frames_(static_cast<std::size_t>(p_.frames())),
        cells_(p_) {
    constexpr float kNarrowest = 1e-6F;  // footprints are taken as no narrower than this
    const float limit = footprint_kernels::narrow_limit(static_cast<float>(p_.duty));
    std::vector<float> v(static_cast<std::size_t>(rays_.width_px)), gx(v), gy(v);
    for (const RowSpan& span : rendered_) {
      footprints_.phases(span.y, {.v = v.data(), .gx = gx.data(), .gy = gy.data()});
      PlainSums& sums = plain_.emplace_back(span);
      for (int x = span.begin; x < span.end; ++x) {
        const auto from = static_cast<std::size_t>(x);
        const auto to = static_cast<std::size_t>(x - span.begin);
        sums.v[to] = v[from];
        sums.gx[to] = gx[from];
        sums.gy[to] = gy[from];
        const Footprints::State state = footprints_.state()(x, span.y);
        sums.gain[to] =
            state == Footprints::State::kPlain ? rays_.corners.weight[corner(x, span.y)] : 0.0F;
        const float outer = 0.5F * (std::abs(gx[from]) + std::abs(gy[from])) + kNarrowest;
        sums.is_narrow = sums.is_narrow && (sums.gain[to] == 0.0F || outer <= limit);
        if (state == Footprints::State::kCells) {
          cell_pixels_.push_back(span.y * rays_.width_px + x);
        }
      }
    }
    cell_weights_.resize(cell_pixels_.size() * frames_);
  }

  /// @param by_radiance  slope by each pixel's radiance in that frame
  void add_frame(int frame, const ImageF& by_radiance) {
    const auto k = static_cast<std::size_t>(frame);
    for (std::size_t s = 0; s < rendered_.size(); ++s) {
      const RowSpan& span = rendered_[s];
      PlainSums& sums = plain_[s];
      const float* by = by_radiance.row(span.y) + span.begin;
      slope_kernels::multiply(by, sums.gain.data(), span.size(), sums.weight.data());
      const auto add_slopes =
          sums.is_narrow ? slope_kernels::add_narrow_slopes : slope_kernels::add_box_slopes;
      add_slopes(sums.v.data(),
                 sums.gx.data(),
                 sums.gy.data(),
                 sums.weight.data(),
                 span.size(),
                 static_cast<float>(p_.shift_periods[k]),
                 static_cast<float>(p_.duty),
                 {.v = sums.by_v.data(),
                  .gx = sums.by_gx.data(),
                  .gy = sums.by_gy.data(),
                  .duty = sums.by_duty.data(),
                  .share = sums.share.data(),
                  .weight = sums.weights.data()});
    }
    for (std::size_t i = 0; i < cell_pixels_.size(); ++i) {
      cell_weights_[i * frames_ + k] =
          static_cast<double>(by_radiance.values()[static_cast<std::size_t>(cell_pixels_[i])]);
    }
  }

  void finish() {
    for (std::size_t s = 0; s < rendered_.size(); ++s) {
      finish_span(rendered_[s], plain_[s]);
    }
    finish_cells();
    slopes_.duty += cells_.duty;
    slopes_.dark += cells_.dark;
    slopes_.slot_mm += cells_.slot_mm;
    slopes_.period_mm += cells_.period_mm;
  }

 private:
  std::size_t corner(int x, int y) const {
    return static_cast<std::size_t>(y) * (static_cast<std::size_t>(rays_.width_px) + 1) +
           static_cast<std::size_t>(x);
  }

  void finish_span(const RowSpan& span, const PlainSums& sums) {
    const double bright = 1.0 - p_.dark;
    const double per_period = 1.0 / p_.period_mm;
    const auto corner_width = static_cast<std::size_t>(rays_.width_px) + 1;
    for (std::size_t i = 0; i < sums.v.size(); ++i) {
      const double by_v = bright * static_cast<double>(sums.by_v[i]);
      const double by_gx = bright * static_cast<double>(sums.by_gx[i]);
      const double by_gy = bright * static_cast<double>(sums.by_gy[i]);
      const LinearSlopes by_phase = {.value = by_v, .dx = by_gx, .dy = by_gy};
      const std::array<double, 4> by_corner = by_phase.by_corners();
      const std::size_t at = corner(span.begin + static_cast<int>(i), span.y);
      const std::array<std::size_t, 4> corners = {
          at, at + 1, at + corner_width, at + corner_width + 1};
      for (std::size_t c = 0; c < 4; ++c) {
        slopes_.corners.x[corners[c]] += static_cast<float>(per_period * by_corner[c]);
      }
      slopes_.period_mm -= per_period * (by_v * static_cast<double>(sums.v[i]) +
                                         by_gx * static_cast<double>(sums.gx[i]) +
                                         by_gy * static_cast<double>(sums.gy[i]));
      slopes_.duty += bright * static_cast<double>(sums.by_duty[i]);
      slopes_.dark += static_cast<double>(sums.weights[i]) - static_cast<double>(sums.share[i]);
    }
  }

  void finish_cells() {
    Image<std::int32_t> index_of(rays_.width_px, rays_.height_px, -1);
    bool has_refined = false;
    for (std::size_t i = 0; i < cell_pixels_.size(); ++i) {
      const auto pixel = static_cast<std::size_t>(cell_pixels_[i]);
      if (rays_.kind.values()[pixel] == PixelKind::kRefined) {
        index_of.values()[pixel] = static_cast<std::int32_t>(i);
        has_refined = true;
        continue;
      }
      const auto corner_width = static_cast<std::size_t>(rays_.width_px) + 1;
      const std::size_t at =
          corner(cell_pixels_[i] % rays_.width_px, cell_pixels_[i] / rays_.width_px);
      load_weights(i);
      add_cell(footprints_.hits(),
               rays_.corners.weight.data(),
               {at, at + 1, at + corner_width, at + corner_width + 1},
               0,
               1.0,
               slopes_.corners);
      cells_.finish(weights_, CellAdder{slopes_.corners});
      count_held();
    }
    for (std::size_t g = 0; has_refined && g < rays_.refined.size(); ++g) {
      const RefinedGroup& group = rays_.refined[g];
      for (std::size_t i = 0; i < group.pixels.size(); ++i) {
        const std::int32_t index = index_of.values()[static_cast<std::size_t>(group.pixels[i])];
        if (index >= 0) {
          add_refined(group, i, static_cast<std::size_t>(index), slopes_.refined[g]);
        }
      }
    }
  }

  void add_refined(const RefinedGroup& group,
                   std::size_t pixel,
                   std::size_t index,
                   RefinedSlopes& slopes) {
    const auto n = static_cast<std::size_t>(group.cells_per_axis);
    const std::size_t first = pixel * (n + 1) * (n + 1);
    const std::size_t offset = slopes.pixels.size() * (n + 1) * (n + 1);
    SlopesByHits& by_hits = slopes.by_hits;
    slopes.pixels.push_back(pixel);
    by_hits.resize(offset + (n + 1) * (n + 1));
    meet_light(group.rays,
               footprints_.tunnel(),
               static_cast<std::int64_t>(first),
               static_cast<int>((n + 1) * (n + 1)),
               hits_);
    load_weights(index);
    for (std::size_t cell = 0; cell < n * n; ++cell) {
      if (group.is_smooth[pixel * n * n + cell] == 0) {
        cells_.has_held = true;
        continue;
      }
      const std::size_t at = cell / n * (n + 1) + cell % n;
      add_cell(hits_,
               group.rays.weight.data() + first,
               {at, at + 1, at + n + 1, at + n + 2},
               offset,
               1.0 / static_cast<double>(n * n),
               by_hits);
    }
    cells_.finish(weights_, CellAdder{by_hits, offset});
    count_held();
  }

  /// @param offset  of the hits' arrays in those of the slopes
  void add_cell(const WallHits& hits,
                const float* weight,
                const std::array<std::size_t, 4>& at,
                std::size_t offset,
                double share,
                SlopesByHits& by_hits) {
    cells_.add_smooth(
        CellCorners(hits, weight, at), at, share, weights_, CellAdder{by_hits, offset});
  }

  /// A pixel that no score looks at, as beside those that do, leaves nothing out.
  void count_held() {
    const bool has_weight = std::ranges::any_of(weights_, [](double w) { return w != 0.0; });
    slopes_.held_pixels += cells_.has_held && has_weight ? 1 : 0;
  }

  void load_weights(std::size_t index) {
    weights_.assign(cell_weights_.begin() + static_cast<std::ptrdiff_t>(index * frames_),
                    cell_weights_.begin() + static_cast<std::ptrdiff_t>((index + 1) * frames_));
    cells_.has_held = false;
  }

  const Footprints& footprints_;
  const CornerRays& rays_;
  const ScanPositions& p_;
  const Spans& rendered_;
  ScanSlopes& slopes_;
  std::size_t frames_;
  std::vector<PlainSums> plain_;  ///< one for each rendered span
  std::vector<std::int32_t> cell_pixels_;
  std::vector<double> cell_weights_;  ///< frames_ of each
  std::vector<double> weights_;
  WallHits hits_;
  CellSlopes cells_;
};

}  // namespace

void add_frame_slopes(const Footprints& footprints,
                      const Sensor& sensor,
                      const Mask& by_frames,
                      const ImageF& by_aspect,
                      bool wants_blur,
                      ScanSlopes& slopes) {
  const Spans wanted = spans_of(by_frames);
  if (wanted.empty()) {
    return;
  }
  const int width = by_aspect.width();
  const int height = by_aspect.height();
  const SensorSettings& settings = sensor.settings();
  const Spans rendered = spans_of(dilated(by_frames, sensor.blur_radius_px()), kBridge_px);
  const FootprintFrames frames(footprints, rendered);
  FrameSlopes by_footprints(footprints, rendered, slopes);
  BlurBackwards backwards(sensor, wanted, rendered, width, height);
  const ResponseSlope response(settings);
  const Sensor blur(blur_only(settings.blur_px), width, height);
  const bool has_blur = wants_blur && settings.blur_px > 0.0;
  BlurChange blur_change(blur, wanted, rendered);
  const int total = footprints.positions().frames();
  std::vector<ImageF> radiance(static_cast<std::size_t>(std::min(kFramesAtOnce, total)),
                               ImageF(width, height));
  ImageF blurred(width, height);
  ImageF by_blurred(width, height);
  for (int k = 0; k < total; ++k) {
    const int slot = k % kFramesAtOnce;
    if (slot == 0) {
      radiance.resize(static_cast<std::size_t>(std::min(kFramesAtOnce, total - k)));
      frames.render(k, radiance);
    }
    const ImageF& frame = radiance[static_cast<std::size_t>(slot)];
    blur.expose(frame, k, wanted, blurred);
    for (const RowSpan& span : wanted) {
      const float* grey = blurred.row(span.y) + span.begin;
      float* by = by_blurred.row(span.y) + span.begin;
      response.at(grey, span.size(), by);
      const double by_grey = slope_kernels::weigh_slopes(by_aspect.row(span.y) + span.begin,
                                                         grey,
                                                         span.size(),
                                                         1.0F / static_cast<float>(total),
                                                         by);
      slopes.gain += by_grey / settings.gain;
      slopes.exposure += by_grey / settings.exposure;
    }
    slopes.blur_px += has_blur ? blur_change.slope(frame, blurred, by_blurred) : 0.0;
    by_footprints.add_frame(k, backwards.apply(by_blurred));
  }
  by_footprints.finish();
}

}  // namespace glint
