// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "core/error.h"
#include "simulator/render/cell_sum.h"
#include "simulator/render/footprints.h"

namespace glint {
namespace {

namespace kernels = footprint_kernels;

/// Pixels that are worked on together.
constexpr int kTile = 256;

struct Extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }

  double size() const { return high - low; }
};

}  // namespace

void FootprintFrames::Cells::add(std::int32_t pixel, const std::vector<double>& radiance) {
  pixels.push_back(pixel);
  for (const double value : radiance) {
    values.push_back(static_cast<float>(value));
  }
}

/// Sums the cells of some pixels, for all positions or for their mean.
class FootprintFrames::CellSummer {
 public:
  /// @param near  of a mean: refined pixels elsewhere are taken from their corners
  CellSummer(const Footprints& footprints, bool wants_mean, const Mask* near = nullptr)
      : footprints_(footprints),
        positions_(footprints.positions()),
        mean_position_(wants_mean ? positions_.mean_position() : positions_),
        frames_(positions_),
        mean_(mean_position_),
        wants_mean_(wants_mean),
        near_(near) {}

  Cells sum(const Spans& where);

 private:
  struct Limits;

  CellCorners corners_of(std::int32_t pixel) const;
  bool add_far(int x, int y);
  void add_unrefined(std::int32_t pixel);
  void add_group(const RefinedGroup& group, const Mask& wanted);
  void add_refined(const RefinedGroup& group, std::size_t index, std::size_t first);
  void add_cells(
      const RefinedGroup& group, std::size_t index, std::size_t first, bool is_lit, CellSum& sum);
  void add_corners(std::size_t first, CellSum& sum);
  void store(std::int32_t pixel, CellSum& sum);

  /// The ends pass none of these places: the mean is one position.
  CellSum& sum_for(double low_mm, double high_mm) {
    CellSum& sum = wants_mean_ && positions_.is_inside_ends(low_mm, high_mm) ? mean_ : frames_;
    sum.clear();
    return sum;
  }

  const Footprints& footprints_;
  const ScanPositions& positions_;
  const ScanPositions mean_position_;
  CellSum frames_;
  CellSum mean_;
  bool wants_mean_;
  const Mask* near_;
  Cells cells_;
  WallHits hits_;              ///< of some refined pixels, corner by corner
  std::vector<float> gain_;    ///< of the light at the corners of the pixel in work
  std::vector<float> weight_;  ///< what of the pixel its corners stand for by themselves
};

FootprintFrames::Cells FootprintFrames::CellSummer::sum(const Spans& where) {
  static_assert(sizeof(Footprints::State) == 1);
  const CornerRays& rays = footprints_.rays();
  Mask refined;
  for (const RowSpan& span : where) {
    const Footprints::State* row = footprints_.state().row(span.y);
    const auto next_cells = [&](int from) {
      const auto count = static_cast<std::size_t>(span.end - from);
      const auto* found = static_cast<const Footprints::State*>(
          std::memchr(row + from, static_cast<int>(Footprints::State::kCells), count));
      return found != nullptr ? static_cast<int>(found - row) : span.end;
    };
    for (int x = next_cells(span.begin); x < span.end; x = next_cells(x + 1)) {
      if (rays.kind(x, span.y) != PixelKind::kRefined) {
        add_unrefined(span.y * rays.width_px + x);
        continue;
      }
      const bool is_far = near_ != nullptr && (*near_)(x, span.y) == 0;
      if (is_far && add_far(x, span.y)) {
        continue;
      }
      if (refined.empty()) {
        refined = Mask(rays.width_px, rays.height_px);
      }
      refined(x, span.y) = 1;
    }
  }
  for (const RefinedGroup& group : rays.refined) {
    if (!refined.empty()) {
      add_group(group, refined);
    }
  }
  return std::move(cells_);
}

CellCorners FootprintFrames::CellSummer::corners_of(std::int32_t pixel) const {
  const CornerRays& rays = footprints_.rays();
  const auto corner_width = static_cast<std::size_t>(rays.width_px) + 1;
  const auto y = static_cast<std::size_t>(pixel / rays.width_px);
  const std::size_t at = y * corner_width + static_cast<std::size_t>(pixel % rays.width_px);
  return {footprints_.hits(),
          rays.corners.weight.data(),
          {at, at + 1, at + corner_width, at + corner_width + 1}};
}

/// The mean of a refined pixel of which little light spreads to where the mean is wanted: its
/// coverage times what its corners on the part see. False when a boundary of the light is as near
/// as these corners are to each other.
bool FootprintFrames::CellSummer::add_far(int x, int y) {
  const CornerRays& rays = footprints_.rays();
  const std::int32_t pixel = y * rays.width_px + x;
  const CellCorners corners = corners_of(pixel);
  int seen = 0;
  double gain = 0.0;
  Extent x_mm, y_mm, margin_mm;
  for (std::size_t i = 0; i < 4; ++i) {
    if (corners.gain[i] > 0.0) {
      seen += 1;
      gain += corners.gain[i];
      x_mm.add(corners.x_mm[i]);
      y_mm.add(corners.y_mm[i]);
      margin_mm.add(corners.margin_mm[i]);
    }
  }
  const bool is_beside_slot = y_mm.low - y_mm.size() >= positions_.half_slot_mm ||
                              y_mm.high + y_mm.size() <= -positions_.half_slot_mm;
  if (seen < 2 || !is_beside_slot || margin_mm.low < margin_mm.size() ||
      !positions_.is_inside_ends(x_mm.low - x_mm.size(), x_mm.high + x_mm.size())) {
    return false;
  }
  const double mean = mean_position_.dark + mean_position_.bright * mean_position_.duty;
  cells_.add(pixel, {static_cast<double>(rays.coverage(x, y)) * mean * gain / seen});
  return true;
}

void FootprintFrames::CellSummer::add_unrefined(std::int32_t pixel) {
  const CellCorners corners = corners_of(pixel);
  const auto [low, high] = std::ranges::minmax(corners.x_mm);
  CellSum& sum = sum_for(low, high);
  sum.add_smooth(corners, 1.0);
  store(pixel, sum);
}

/// Neighbours in the group are met together.
void FootprintFrames::CellSummer::add_group(const RefinedGroup& group, const Mask& wanted) {
  constexpr std::size_t kTogether = 32;
  const auto n = static_cast<std::size_t>(group.cells_per_axis);
  const std::size_t corners = (n + 1) * (n + 1);
  const auto is_wanted = [&](std::size_t index) {
    return wanted.values()[static_cast<std::size_t>(group.pixels[index])] != 0;
  };
  for (std::size_t begin = 0; begin < group.pixels.size(); ++begin) {
    std::size_t end = begin;
    while (end < group.pixels.size() && end - begin < kTogether && is_wanted(end)) {
      ++end;
    }
    if (end == begin) {
      continue;
    }
    meet_light(group.rays,
               footprints_.tunnel(),
               static_cast<std::int64_t>(begin * corners),
               static_cast<int>((end - begin) * corners),
               hits_);
    for (std::size_t index = begin; index < end; ++index) {
      add_refined(group, index, (index - begin) * corners);
    }
    begin = end - 1;
  }
}

/// Limits of the places of a pixel's corners that count.
struct FootprintFrames::CellSummer::Limits {
  std::array<double, 2> x_mm, y_mm;
  double lowest_margin_mm = 0.0;
  bool is_empty = true;

  Limits(const WallHits& hits, std::size_t first, std::size_t corners, const float* weight) {
    constexpr float kHuge = std::numeric_limits<float>::max();
    float x_low = kHuge, x_high = -kHuge, y_low = kHuge, y_high = -kHuge, margin = kHuge;
    for (std::size_t i = 0; i < corners; ++i) {
      if (weight[i] > 0.0F) {
        is_empty = false;
        x_low = std::min(x_low, hits.x_mm[first + i]);
        x_high = std::max(x_high, hits.x_mm[first + i]);
        y_low = std::min(y_low, hits.y_mm[first + i]);
        y_high = std::max(y_high, hits.y_mm[first + i]);
        margin = std::min(margin, hits.margin_mm[first + i]);
      }
    }
    x_mm = {static_cast<double>(x_low), static_cast<double>(x_high)};
    y_mm = {static_cast<double>(y_low), static_cast<double>(y_high)};
    lowest_margin_mm = static_cast<double>(margin);
  }
};

/// @param first  of the pixel's corners among the hits
void FootprintFrames::CellSummer::add_refined(const RefinedGroup& group,
                                              std::size_t index,
                                              std::size_t first) {
  const auto n = static_cast<std::size_t>(group.cells_per_axis);
  const std::size_t corners = (n + 1) * (n + 1);
  gain_.resize(corners);
  const float* ray_weight = group.rays.weight.data() + index * corners;
  for (std::size_t i = 0; i < corners; ++i) {
    gain_[i] = ray_weight[i] * (hits_.cosine.empty() ? 1.0F : hits_.cosine[first + i]);
  }
  const Limits limits(hits_, first, corners, ray_weight);
  CellSum& sum = sum_for(limits.x_mm[0], limits.x_mm[1]);
  if (!limits.is_empty) {
    const bool is_lit = sum.is_lit_throughout(limits.x_mm, limits.y_mm, limits.lowest_margin_mm);
    add_cells(group, index, first, is_lit, sum);
    add_corners(first, sum);
  }
  store(group.pixels[index], sum);
}

/// Smooth cells are added, the corners of others collect what they stand for.
void FootprintFrames::CellSummer::add_cells(
    const RefinedGroup& group, std::size_t index, std::size_t first, bool is_lit, CellSum& sum) {
  const auto n = static_cast<std::size_t>(group.cells_per_axis);
  const unsigned char* is_smooth = group.is_smooth.data() + index * n * n;
  const float share = 1.0F / static_cast<float>(n * n);
  const float* stripes_mm = hits_.stripes_mm().data() + first;
  const std::size_t corners = (n + 1) * (n + 1);
  const float* ray_weight = group.rays.weight.data() + (index * corners - first);
  weight_.assign(corners, 0.0F);
  for (std::size_t cell = 0; cell < n * n; ++cell) {
    const std::size_t a = cell / n * (n + 1) + cell % n;
    const std::size_t b = a + n + 1;
    if (is_smooth[cell] == 0) {
      for (const std::size_t place : {a, a + 1, b, b + 1}) {
        weight_[place] += 0.25F * share;
      }
      continue;
    }
    const float gain = 0.25F * share * (gain_[a] + gain_[a + 1] + gain_[b] + gain_[b + 1]);
    const bool is_added =
        is_lit &&
        sum.add_lit({stripes_mm[a], stripes_mm[a + 1], stripes_mm[b], stripes_mm[b + 1]}, gain);
    if (!is_added) {
      sum.add_smooth(
          CellCorners(hits_, ray_weight, {first + a, first + a + 1, first + b, first + b + 1}),
          static_cast<double>(share));
    }
  }
}

void FootprintFrames::CellSummer::add_corners(std::size_t first, CellSum& sum) {
  for (std::size_t i = 0; i < weight_.size(); ++i) {
    const float gain = weight_[i] * gain_[i];
    if (gain > 0.0F) {
      const std::size_t at = first + i;
      sum.add_place(static_cast<double>(hits_.x_mm[at]),
                    static_cast<double>(hits_.stripes_mm()[at]),
                    static_cast<double>(hits_.y_mm[at]),
                    static_cast<double>(hits_.margin_mm[at]),
                    static_cast<double>(gain));
    }
  }
}

void FootprintFrames::CellSummer::store(std::int32_t pixel, CellSum& sum) {
  const std::vector<double>& radiance = sum.radiance();
  if (wants_mean_ && &sum == &frames_) {
    double total = 0.0;
    for (const double value : radiance) {
      total += value;
    }
    cells_.add(pixel, {total / static_cast<double>(radiance.size())});
  } else {
    cells_.add(pixel, radiance);
  }
}

FootprintFrames::FootprintFrames(const Footprints& footprints, const Spans& where)
    : footprints_(footprints), where_(where) {}

/// Footprints of some pixels of a row.
struct FootprintFrames::Tile {
  using Values = std::array<float, kTile>;
  int count = 0;
  Values v, gx, gy, outer, inner, per_major, per_both, gain, x_mm;

  kernels::Trapezoids shape() {
    return {.outer = outer.data(),
            .inner = inner.data(),
            .per_major = per_major.data(),
            .per_both = per_both.data()};
  }
};

void FootprintFrames::load(const RowSpan& span, int begin, Tile& tile) const {
  const CornerRays& rays = footprints_.rays();
  const ScanPositions& p = footprints_.positions();
  const WallHits& hits = footprints_.hits();
  const auto corner_width = static_cast<std::size_t>(rays.width_px) + 1;
  const std::size_t top =
      static_cast<std::size_t>(span.y) * corner_width + static_cast<std::size_t>(begin);
  const auto rows = [&](const FloatArray& values) {
    return kernels::CornerRows{.top = values.data() + top,
                               .bottom = values.data() + top + corner_width};
  };
  tile.count = std::min(kTile, span.end - begin);
  const kernels::PhaseRow phases = {.v = tile.v.data(), .gx = tile.gx.data(), .gy = tile.gy.data()};
  if (!p.is_even) {
    kernels::phases_of_corners(rows(hits.x_mm), tile.count, 0.0F, 1.0F, phases);
    std::copy_n(tile.v.data(), tile.count, tile.x_mm.data());
  }
  kernels::phases_of_corners(rows(hits.stripes_mm()),
                             tile.count,
                             static_cast<float>(p.offset_mm),
                             static_cast<float>(1.0 / p.period_mm),
                             phases);
  const auto* state =
      reinterpret_cast<const unsigned char*>(footprints_.state().row(span.y) + begin);
  static_assert(static_cast<int>(Footprints::State::kPlain) == 1);
  const float* cosine = hits.cosine.empty() ? nullptr : hits.cosine.data() + top;
  if (rays.smooth_weight >= 0.0F) {
    kernels::even_gains(state, rays.smooth_weight, cosine, tile.count, tile.gain.data());
  } else {
    kernels::plain_gains(
        state, rays.corners.weight.data() + top, cosine, tile.count, tile.gain.data());
  }
  kernels::trapezoids(tile.gx.data(), tile.gy.data(), tile.count, tile.shape());
}

void FootprintFrames::render_span(int first,
                                  const RowSpan& span,
                                  std::vector<ImageF>& frames) const {
  const ScanPositions& p = footprints_.positions();
  Tile tile;
  for (int begin = span.begin; begin < span.end; begin += kTile) {
    load(span, begin, tile);
    const bool is_narrow = kernels::largest_lit(tile.outer.data(), tile.gain.data(), tile.count) <=
                           kernels::narrow_limit(static_cast<float>(p.duty));
    const auto box_frame = is_narrow ? kernels::narrow_box_frame : kernels::box_frame;
    for (std::size_t k = 0; k < frames.size(); ++k) {
      const std::size_t frame = static_cast<std::size_t>(first) + k;
      float* out = frames[k].row(span.y) + begin;
      box_frame(tile.v.data(),
                tile.shape(),
                tile.gain.data(),
                tile.count,
                {.shift = static_cast<float>(p.shift_periods[frame]),
                 .duty = static_cast<float>(p.duty),
                 .dark = static_cast<float>(p.dark)},
                out);
      if (!p.is_even) {
        kernels::Unevenness uneven = p.unevenness;
        uneven.shift_mm = static_cast<float>(p.shift_mm[frame]);
        kernels::modulate(tile.x_mm.data(), tile.count, uneven, out);
      }
    }
  }
}

void FootprintFrames::render_mean(const Mask& near, ImageF& mean) const {
  // The fast form errs where stripes are thin, and by less the more phases share the error.
  constexpr int kFastPhases = 8;
  constexpr double kFastDuty = 0.1;
  const ScanPositions p = footprints_.positions().mean_position();
  const int phases = footprints_.positions().even_phases();
  const bool is_fast = phases >= kFastPhases && std::min(p.duty, 1.0 - p.duty) >= kFastDuty;
  Tile tile;
  tile.x_mm.fill(0.0F);
  for (const RowSpan& span : where_) {
    for (int begin = span.begin; begin < span.end; begin += kTile) {
      load(span, begin, tile);
      float* shares = tile.x_mm.data();
      if (is_fast) {
        kernels::any_shares_fast(tile.v.data(),
                                 tile.shape(),
                                 tile.count,
                                 static_cast<float>(phases),
                                 static_cast<float>(p.duty),
                                 shares);
      } else if (p.duty > 0.0) {
        kernels::any_shares(
            tile.v.data(), tile.gx.data(), tile.gy.data(), tile.count, phases, p.duty, shares);
      }
      kernels::mix(tile.gain.data(),
                   shares,
                   tile.count,
                   static_cast<float>(p.dark),
                   static_cast<float>(p.bright),
                   mean.row(span.y) + begin);
    }
  }
  const Cells cells = CellSummer(footprints_, true, &near).sum(where_);
  for (std::size_t i = 0; i < cells.pixels.size(); ++i) {
    mean.values()[static_cast<std::size_t>(cells.pixels[i])] = cells.values[i];
  }
}

void FootprintFrames::render(int first, std::vector<ImageF>& frames) const {
  if (!cells_) {
    cells_ = CellSummer(footprints_, false).sum(where_);
  }
  for (const RowSpan& span : where_) {
    render_span(first, span, frames);
  }
  const auto total = static_cast<std::size_t>(footprints_.positions().frames());
  for (std::size_t i = 0; i < cells_->pixels.size(); ++i) {
    const float* values = cells_->values.data() + i * total + first;
    for (std::size_t k = 0; k < frames.size(); ++k) {
      frames[k].values()[static_cast<std::size_t>(cells_->pixels[i])] = values[k];
    }
  }
}

}  // namespace glint
