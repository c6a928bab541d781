// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pixels that footprint_kernels.h does not cover: on a boundary of the light, wider than the
// stripes, or refined. Each takes the cheapest method that fits: batches for pixels that one line
// crosses (cut_kernels.h), polygons for other unrefined pixels (stripe_integral.h), and cell by
// cell for refined ones, where only cells on a boundary are cut. For a mean, refined pixels far
// from the region are their coverage times the mean radiance at their corners.
// docs/theory/footprints.md. Cost: corner rays of refined pixels are intersected with the wall for
// each candidate, up to 32 pixels at a time. Memory: one float per pixel and frame, or one per
// pixel for a mean.
#include "simulator/render/footprint/footprint_cells.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <numeric>
#include <span>
#include <utility>

#include "simulator/render/corner_rays/refined_groups.h"
#include "simulator/render/footprint/cell_samples.h"
#include "simulator/render/footprint/cell_sum.h"
#include "simulator/render/footprint/cut_kernels.h"
#include "simulator/render/footprint/cut_limits.h"
#include "simulator/render/footprint/footprints.h"
#include "simulator/render/footprint/lit_cells.h"

namespace glint {
namespace {

namespace kernels = cut_kernels;

/// Some pixels and their first corners in the grid of corner rays.
struct Places {
  std::vector<std::int32_t> pixels, corners;

  std::size_t size() const { return pixels.size(); }

  void add(std::int32_t pixel, std::int32_t row) {
    pixels.push_back(pixel);
    corners.push_back(pixel + row);  // rows of corners are longer by one
  }
};

/// A refined pixel in work.
struct Refined {
  std::size_t first = 0;          ///< of its corners among the hits
  const float* weight = nullptr;  ///< of its corners
  const unsigned char* is_smooth = nullptr;
  int cells_per_axis = 0;
};

/// Sums the cells of some pixels, for all positions or for their mean.
class CellSummer {
 public:
  /// @param near  of a mean: refined pixels elsewhere are taken from their corners
  CellSummer(const Footprints& footprints, bool wants_mean, const Spans* near = nullptr);

  PixelCells sum(const Spans& where);

 private:
  void sort_pixels(const Spans& where);
  void load(const WallHits& hits,
            const float* weight,
            std::size_t first,
            std::int32_t below,
            std::span<const std::int32_t> corners);
  void load_pixels(const Places& places, std::size_t first);
  void add_far();
  void add_unrefined();
  void add_simple(const std::int32_t* pixels);
  void add_by_polygons(std::int32_t pixel, std::int32_t corner);
  void add_group(const RefinedGroup& group);
  void add_refined(const RefinedGroup& group, std::size_t index, std::size_t first);
  const unsigned char* find_cut_cells(const Refined& pixel, CellSum& sum);
  void add_smooth_cells(const Refined& pixel, CellSum& sum);
  void add_cut_cells(double share, CellSum& sum);
  void add_corners(const Refined& pixel, CellSum& sum);
  void store(std::int32_t pixel, CellSum& sum);

  /// Of places that the ends do not pass not every position is needed.
  CellSum& sum_for(double low_mm, double high_mm) {
    CellSum& sum = positions_.is_inside_ends(low_mm, high_mm) ? between_ends_ : frames_;
    sum.clear();
    return sum;
  }

  const Footprints& footprints_;
  const ScanPositions& positions_;
  const DistinctStripes stripes_;         ///< of the frames, or of their mean
  const ScanPositions inside_positions_;  ///< of these stripes
  CellSum frames_;
  CellSum between_ends_;
  bool wants_mean_;
  const Spans* near_;
  kernels::CutLimits limits_;
  Places unrefined_, far_;             ///< far: refined, far from where a mean is wanted
  std::vector<std::int32_t> refined_;  ///< other refined pixels, increasing
  kernels::CornerBatch batch_;
  kernels::LinearBatch inside_;
  kernels::CutSums sums_;
  std::array<unsigned char, kernels::kBatch> is_simple_ = {};
  std::vector<std::size_t> simple_;  ///< of the batch
  std::vector<double> of_sources_;   ///< radiance of simple pixels, pixel by pixel
  std::array<unsigned char, kernels::kMostCells* kernels::kMostCells> is_lit_ = {};  ///< cells
  std::array<unsigned char, kernels::kMostCells* kernels::kMostCells> is_cut_ = {};
  std::vector<std::int32_t> cell_corners_;  ///< first corners of a pixel's cut cells
  PixelCells cells_;
  WallHits hits_;              ///< of some refined pixels, corner by corner
  std::vector<float> gain_;    ///< of the light at the corners of the pixel in work
  std::vector<float> weight_;  ///< what of the pixel its corners stand for by themselves
};

CellSummer::CellSummer(const Footprints& footprints, bool wants_mean, const Spans* near)
    : footprints_(footprints),
      positions_(footprints.positions()),
      stripes_(wants_mean ? DistinctStripes() : positions_.distinct_stripes()),
      inside_positions_(wants_mean ? positions_.mean_position()
                                   : positions_.with_stripes_at(stripes_.shift_periods)),
      frames_(positions_),
      between_ends_(inside_positions_),
      wants_mean_(wants_mean),
      near_(near),
      limits_{
          .half_slot_mm = positions_.half_slot_mm,
          .x_low_mm = static_cast<float>(positions_.shift_mm.back() - positions_.half_length_mm),
          .x_high_mm = static_cast<float>(positions_.shift_mm.front() + positions_.half_length_mm),
          .nowhere_mm = static_cast<float>(kNoPlace_mm)} {}

PixelCells CellSummer::sum(const Spans& where) {
  sort_pixels(where);
  const std::size_t count = unrefined_.size() + far_.size() + refined_.size();
  cells_.pixels.reserve(count);
  cells_.values.reserve(count * stripes_.frames.size());
  add_far();
  add_unrefined();
  for (const RefinedGroup& group : footprints_.rays().refined) {
    add_group(group);
  }
  return std::move(cells_);
}

void CellSummer::sort_pixels(const Spans& where) {
  static_assert(sizeof(Footprints::State) == 1);
  const CornerRays& rays = footprints_.rays();
  SpanWalk near(near_ != nullptr ? *near_ : where);
  for (const RowSpan& span : where) {
    const Footprints::State* row = footprints_.state().row(span.y);
    const auto next_cells = [&](int from) {
      const auto count = static_cast<std::size_t>(span.end - from);
      const auto* found = static_cast<const Footprints::State*>(
          std::memchr(row + from, static_cast<int>(Footprints::State::kCells), count));
      return found != nullptr ? static_cast<int>(found - row) : span.end;
    };
    for (int x = next_cells(span.begin); x < span.end; x = next_cells(x + 1)) {
      const std::int32_t pixel = span.y * rays.width_px + x;
      if (rays.kind(x, span.y) != PixelKind::kRefined) {
        unrefined_.add(pixel, span.y);
      } else if (!near.has(x, span.y)) {
        far_.add(pixel, span.y);
      } else {
        refined_.push_back(pixel);
      }
    }
  }
}

/// The corners of some places of a grid, as many as go together.
/// @param first  of the grid's corners among the hits
/// @param below  from a corner to the one below it
void CellSummer::load(const WallHits& hits,
                      const float* weight,
                      std::size_t first,
                      std::int32_t below,
                      std::span<const std::int32_t> corners) {
  batch_.count = static_cast<int>(std::min<std::size_t>(kernels::kBatch, corners.size()));
  const auto read = [&](const float* values, kernels::Corners& to) {
    kernels::gather(values, corners.data(), below, batch_.count, to);
  };
  read(hits.x_mm.data() + first, batch_.x_mm);
  read(hits.y_mm.data() + first, batch_.y_mm);
  read(hits.margin_mm.data() + first, batch_.margin_mm);
  read(weight, batch_.gain);
  if (!hits.cosine.empty()) {
    read(hits.cosine.data() + first, batch_.stripes_mm);
    kernels::scale(batch_.stripes_mm, batch_.count, batch_.gain);
  }
  if (hits.pattern_mm.empty()) {
    batch_.stripes_mm = batch_.x_mm;
  } else {
    read(hits.pattern_mm.data() + first, batch_.stripes_mm);
  }
}

/// Those of some pixels.
void CellSummer::load_pixels(const Places& places, std::size_t first) {
  const CornerRays& rays = footprints_.rays();
  load(footprints_.hits(),
       rays.corners.weight.data(),
       0,
       rays.width_px + 1,
       std::span(places.corners).subspan(first));
}

/// The mean of refined pixels of which little light spreads to where the mean is wanted: their
/// coverage times what their corners on the part see. Where a boundary of the light is as near as
/// these corners are to each other they are refined as others are.
void CellSummer::add_far() {
  const ImageF& coverage = footprints_.rays().coverage;
  const auto mean = static_cast<float>(inside_positions_.dark +
                                       inside_positions_.bright * inside_positions_.duty);
  std::array<float, kernels::kBatch> gain = {};
  std::array<unsigned char, kernels::kBatch> is_clear = {};
  const std::size_t num_near = refined_.size();
  for (std::size_t first = 0; first < far_.size(); first += kernels::kBatch) {
    load_pixels(far_, first);
    kernels::mean_gains(batch_, limits_, gain.data(), is_clear.data());
    for (std::size_t i = 0; i < static_cast<std::size_t>(batch_.count); ++i) {
      const std::int32_t pixel = far_.pixels[first + i];
      if (is_clear[i] == 0) {
        refined_.push_back(pixel);
        continue;
      }
      cells_.pixels.push_back(pixel);
      cells_.values.push_back(coverage.values()[static_cast<std::size_t>(pixel)] * mean * gain[i]);
    }
  }
  std::ranges::inplace_merge(refined_, refined_.begin() + static_cast<std::ptrdiff_t>(num_near));
}

/// Pixels that one straight boundary cuts are cut together, others one by one.
void CellSummer::add_unrefined() {
  for (std::size_t first = 0; first < unrefined_.size(); first += kernels::kBatch) {
    load_pixels(unrefined_, first);
    kernels::find_cuts(batch_, limits_, inside_, is_simple_.data());
    simple_.clear();
    for (std::size_t i = 0; i < static_cast<std::size_t>(batch_.count); ++i) {
      if (is_simple_[i] != 0 && positions_.is_even) {
        simple_.push_back(i);
      } else {
        add_by_polygons(unrefined_.pixels[first + i], unrefined_.corners[first + i]);
      }
    }
    if (!simple_.empty()) {
      add_simple(unrefined_.pixels.data() + first);
    }
  }
}

/// The simple ones among the pixels of the batch.
void CellSummer::add_simple(const std::int32_t* pixels) {
  const ScanPositions& p = inside_positions_;
  const std::size_t sources = p.shift_periods.size();
  kernels::cut(batch_, inside_, p.offset_mm, 1.0 / p.period_mm, sums_);
  std::array<float, kernels::kBatch> radiance = {};
  of_sources_.resize(simple_.size() * sources);
  for (std::size_t k = 0; k < sources; ++k) {
    kernels::integrate(
        batch_,
        sums_,
        {.shift = p.shift_periods[k], .duty = p.duty, .dark = p.dark, .bright = p.bright},
        radiance.data());
    for (std::size_t j = 0; j < simple_.size(); ++j) {
      of_sources_[j * sources + k] = static_cast<double>(radiance[simple_[j]]);
    }
  }
  for (std::size_t j = 0; j < simple_.size(); ++j) {
    cells_.pixels.push_back(pixels[simple_[j]]);
    stripes_.expand(of_sources_.data() + j * sources, cells_.values);
  }
}

void CellSummer::add_by_polygons(std::int32_t pixel, std::int32_t corner) {
  const CornerRays& rays = footprints_.rays();
  const auto at = static_cast<std::size_t>(corner);
  const std::size_t below = at + static_cast<std::size_t>(rays.width_px) + 1;
  const CellCorners corners(
      footprints_.hits(), rays.corners.weight.data(), {at, at + 1, below, below + 1});
  const auto [low, high] = std::ranges::minmax(corners.x_mm);
  CellSum& sum = sum_for(low, high);
  sum.add_smooth(corners, 1.0);
  store(pixel, sum);
}

/// The wanted pixels of a group; neighbours in it are met together.
void CellSummer::add_group(const RefinedGroup& group) {
  constexpr std::size_t kTogether = 32;
  const auto n = static_cast<std::size_t>(group.cells_per_axis);
  const std::size_t corners = (n + 1) * (n + 1);
  auto wanted = refined_.begin();
  const auto is_wanted = [&](std::size_t index) {
    while (wanted != refined_.end() && *wanted < group.pixels[index]) {
      ++wanted;
    }
    return wanted != refined_.end() && *wanted == group.pixels[index];
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

/// @param first  of the pixel's corners among the hits
void CellSummer::add_refined(const RefinedGroup& group, std::size_t index, std::size_t first) {
  const auto n = static_cast<std::size_t>(group.cells_per_axis);
  const std::size_t corners = (n + 1) * (n + 1);
  const Refined pixel = {.first = first,
                         .weight = group.rays.weight.data() + index * corners,
                         .is_smooth = group.is_smooth.data() + index * n * n,
                         .cells_per_axis = group.cells_per_axis};
  gain_.assign(pixel.weight, pixel.weight + corners);
  for (std::size_t i = 0; i < corners && !hits_.cosine.empty(); ++i) {
    gain_[i] *= hits_.cosine[first + i];
  }
  const kernels::PlaceLimits limits = kernels::find_limits(hits_.x_mm.data() + first,
                                                           hits_.y_mm.data() + first,
                                                           hits_.margin_mm.data() + first,
                                                           pixel.weight,
                                                           static_cast<int>(corners));
  const std::array<double, 2> x_mm = {static_cast<double>(limits.x_low_mm),
                                      static_cast<double>(limits.x_high_mm)};
  const std::array<double, 2> y_mm = {static_cast<double>(limits.y_low_mm),
                                      static_cast<double>(limits.y_high_mm)};
  CellSum& sum = sum_for(x_mm[0], x_mm[1]);
  if (x_mm[0] <= x_mm[1]) {
    const bool is_added =
        sum.is_lit_throughout(x_mm, y_mm, static_cast<double>(limits.margin_low_mm)) &&
        sum.add_lit_cells({.stripes_mm = hits_.stripes_mm().data() + first,
                           .gain = gain_.data(),
                           .is_smooth = pixel.is_smooth,
                           .cells_per_axis = group.cells_per_axis});
    if (!is_added) {
      add_smooth_cells(pixel, sum);
    }
    add_corners(pixel, sum);
  }
  store(group.pixels[index], sum);
}

/// Adds those of the smooth cells that are lit throughout. @return 1 for those that may be cut
const unsigned char* CellSummer::find_cut_cells(const Refined& pixel, CellSum& sum) {
  if (!positions_.is_even) {
    return pixel.is_smooth;
  }
  const int n = pixel.cells_per_axis;
  kernels::sort_cells({.x_mm = hits_.x_mm.data() + pixel.first,
                       .y_mm = hits_.y_mm.data() + pixel.first,
                       .margin_mm = hits_.margin_mm.data() + pixel.first},
                      pixel.is_smooth,
                      n,
                      limits_,
                      is_lit_.data(),
                      is_cut_.data());
  const bool has_lit = std::memchr(is_lit_.data(), 1, static_cast<std::size_t>(n * n)) != nullptr;
  const bool is_added =
      !has_lit || sum.add_lit_cells({.stripes_mm = hits_.stripes_mm().data() + pixel.first,
                                     .gain = gain_.data(),
                                     .is_smooth = is_lit_.data(),
                                     .cells_per_axis = n});
  return is_added ? is_cut_.data() : pixel.is_smooth;
}

/// Cells that lie on the light as a whole are summed as samples. Of the others those that one
/// straight boundary cuts are cut together, the rest one by one.
void CellSummer::add_smooth_cells(const Refined& pixel, CellSum& sum) {
  const int n = pixel.cells_per_axis;
  const unsigned char* is_cut = find_cut_cells(pixel, sum);
  cell_corners_.clear();
  for (int cell = 0; cell < n * n; ++cell) {
    if (is_cut[cell] != 0) {
      cell_corners_.push_back(cell / n * (n + 1) + cell % n);
    }
  }
  const double share = 1.0 / (n * n);
  for (std::size_t begin = 0; begin < cell_corners_.size(); begin += kernels::kBatch) {
    const auto corners = std::span(cell_corners_).subspan(begin);
    load(hits_, pixel.weight, pixel.first, n + 1, corners);
    is_simple_.fill(0);
    if (positions_.is_even) {
      kernels::find_cuts(batch_, limits_, inside_, is_simple_.data());
      add_cut_cells(share, sum);
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(batch_.count); ++i) {
      if (is_simple_[i] == 0) {
        const std::size_t a = pixel.first + static_cast<std::size_t>(corners[i]);
        const std::size_t b = a + static_cast<std::size_t>(n) + 1;
        sum.add_smooth(CellCorners(hits_, pixel.weight - pixel.first, {a, a + 1, b, b + 1}), share);
      }
    }
  }
}

/// The simple ones among the cells of the batch.
void CellSummer::add_cut_cells(double share, CellSum& sum) {
  const ScanPositions& p = sum.positions();
  kernels::cut(batch_, inside_, p.offset_mm, 1.0 / p.period_mm, sums_);
  std::array<float, kernels::kBatch> radiance = {};
  for (std::size_t k = 0; k < p.shift_periods.size(); ++k) {
    kernels::integrate(
        batch_,
        sums_,
        {.shift = p.shift_periods[k], .duty = p.duty, .dark = p.dark, .bright = p.bright},
        radiance.data());
    const float of_cells = kernels::sum_simple(radiance.data(), is_simple_.data());
    sum.add_radiance(k, share * static_cast<double>(of_cells));
  }
}

/// What cells that are not smooth leave to their corners.
void CellSummer::add_corners(const Refined& pixel, CellSum& sum) {
  const auto n = static_cast<std::size_t>(pixel.cells_per_axis);
  if (std::memchr(pixel.is_smooth, 0, n * n) == nullptr) {
    return;
  }
  static_assert(kCellCounts.back() <= kernels::kMostCells);
  weight_.resize(gain_.size());
  kernels::corner_weights(pixel.is_smooth, pixel.cells_per_axis, weight_.data());
  for (std::size_t i = 0; i < weight_.size(); ++i) {
    const float gain = weight_[i] * gain_[i];
    if (gain > 0.0F) {
      const std::size_t at = pixel.first + i;
      sum.add_place(static_cast<double>(hits_.x_mm[at]),
                    static_cast<double>(hits_.stripes_mm()[at]),
                    static_cast<double>(hits_.y_mm[at]),
                    static_cast<double>(hits_.margin_mm[at]),
                    static_cast<double>(gain));
    }
  }
}

void CellSummer::store(std::int32_t pixel, CellSum& sum) {
  const std::vector<double>& radiance = sum.radiance();
  cells_.pixels.push_back(pixel);
  if (&sum == &between_ends_) {
    stripes_.expand(radiance.data(), cells_.values);
  } else if (wants_mean_) {
    const double total = std::accumulate(radiance.begin(), radiance.end(), 0.0);
    cells_.values.push_back(static_cast<float>(total / static_cast<double>(radiance.size())));
  } else {
    std::ranges::transform(radiance, std::back_inserter(cells_.values), [](double value) {
      return static_cast<float>(value);
    });
  }
}

}  // namespace

PixelCells sum_cells(const Footprints& footprints, const Spans& where) {
  return CellSummer(footprints, false).sum(where);
}

PixelCells mean_of_cells(const Footprints& footprints, const Spans& where, const Spans& near) {
  return CellSummer(footprints, true, &near).sum(where);
}

}  // namespace glint
