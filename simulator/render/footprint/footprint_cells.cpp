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
#include <numeric>
#include <span>
#include <utility>

#include "simulator/render/corner_rays/refined_groups.h"
#include "simulator/render/footprint/cell_sum.h"
#include "simulator/render/footprint/cut_batch.h"
#include "simulator/render/footprint/cut_limits.h"
#include "simulator/render/footprint/footprints.h"
#include "simulator/render/footprint/pixel_dark.h"
#include "simulator/render/footprint/refined_cells.h"
#include "simulator/render/footprint/visible_part.h"

namespace glint {
namespace {

/// Some pixels and their first corners in the grid of corner rays.
struct Places {
  std::vector<std::int32_t> pixels, corners;

  std::size_t size() const { return pixels.size(); }

  void add(std::int32_t pixel, std::int32_t row) {
    pixels.push_back(pixel);
    corners.push_back(pixel + row);  // rows of corners are longer by one
  }
};

/// Sums the cells of some pixels, for all positions or for their mean.
class CellSummer {
 public:
  /// @param near  of a mean: refined pixels elsewhere are taken from their corners
  CellSummer(const Footprints& footprints, bool wants_mean, const Spans* near = nullptr);

  PixelCells sum(const Spans& where);

 private:
  void sort_pixels(const Spans& where);
  void load_pixels(const Places& places, std::size_t first);
  void add_far();
  void add_unrefined();
  void add_simple(const std::int32_t* pixels);
  void add_shining(const std::int32_t* pixels);
  void expand_simple(const std::int32_t* pixels);
  void add_by_polygons(std::int32_t pixel, std::int32_t corner);
  void add_group(const RefinedGroup& group);
  void store(std::int32_t pixel, CellSum& sum);

  /// The pixel that is summed next. @param dark  radiance of its dark stripes
  void shine(double dark) {
    all_in_work_.shine(positions_, dark);
    inside_in_work_.shine(inside_positions_, dark);
  }

  /// Radiance of dark stripes over a pixel that is not refined or far.
  double dark_of(std::int32_t pixel) const {
    return mean_dark(footprints_.tunnel().dark(),
                     footprints_.hits(),
                     footprints_.rays().corners.weight.data(),
                     footprints_.corners_of(pixel));
  }

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
  ScanPositions all_in_work_;             ///< the same with the light of a pixel's dark stripes
  ScanPositions inside_in_work_;
  CellSum frames_;
  CellSum between_ends_;
  bool wants_mean_;
  const Spans* near_;
  cut_kernels::CutLimits limits_;
  Places unrefined_;
  Places occluded_;                    ///< not refined, hidden in part
  Places far_;                         ///< refined, far from where a mean is wanted
  std::vector<std::int32_t> refined_;  ///< other refined pixels, increasing
  CutBatch batch_;
  std::vector<std::size_t> simple_;  ///< of the batch
  std::vector<double> of_sources_;   ///< radiance of simple pixels, pixel by pixel
  RefinedCells refined_cells_;
  PixelCells cells_;
};

CellSummer::CellSummer(const Footprints& footprints, bool wants_mean, const Spans* near)
    : footprints_(footprints),
      positions_(footprints.positions()),
      stripes_(wants_mean ? DistinctStripes() : positions_.distinct_stripes()),
      inside_positions_(wants_mean ? positions_.mean_position()
                                   : positions_.with_stripes_at(stripes_.shift_periods)),
      all_in_work_(positions_),
      inside_in_work_(inside_positions_),
      frames_(all_in_work_),
      between_ends_(inside_in_work_),
      wants_mean_(wants_mean),
      near_(near),
      limits_{
          .half_slot_mm = positions_.half_slot_mm,
          .x_low_mm = static_cast<float>(positions_.shift_mm.back() - positions_.half_length_mm),
          .x_high_mm = static_cast<float>(positions_.shift_mm.front() + positions_.half_length_mm),
          .no_hit_below_mm = static_cast<float>(kNoHitBelow_mm)},
      refined_cells_(positions_, limits_) {}

PixelCells CellSummer::sum(const Spans& where) {
  sort_pixels(where);
  const std::size_t count = unrefined_.size() + occluded_.size() + far_.size() + refined_.size();
  cells_.pixels.reserve(count);
  cells_.values.reserve(count * stripes_.frames.size());
  add_far();
  add_unrefined();
  for (std::size_t i = 0; i < occluded_.size(); ++i) {
    add_by_polygons(occluded_.pixels[i], occluded_.corners[i]);
  }
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
      const bool is_edge = footprints_.occluded_edge(pixel) != nullptr;
      if (is_edge && rays.kind(x, span.y) != PixelKind::kRefined) {
        occluded_.add(pixel, span.y);
      } else if (rays.kind(x, span.y) != PixelKind::kRefined) {
        unrefined_.add(pixel, span.y);
      } else if (!is_edge && !near.has(x, span.y)) {
        far_.add(pixel, span.y);
      } else {
        refined_.push_back(pixel);
      }
    }
  }
}

/// Those of some pixels.
void CellSummer::load_pixels(const Places& places, std::size_t first) {
  const CornerRays& rays = footprints_.rays();
  batch_.load(footprints_.hits(),
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
  std::array<float, cut_kernels::kBatch> gain = {};
  std::array<unsigned char, cut_kernels::kBatch> is_clear = {};
  const std::size_t num_near = refined_.size();
  for (std::size_t first = 0; first < far_.size(); first += cut_kernels::kBatch) {
    load_pixels(far_, first);
    cut_kernels::mean_gains(batch_.corners(), limits_, gain.data(), is_clear.data());
    for (std::size_t i = 0; i < batch_.size(); ++i) {
      const std::int32_t pixel = far_.pixels[first + i];
      if (is_clear[i] == 0) {
        refined_.push_back(pixel);
        continue;
      }
      const double dark = positions_.is_dark_even ? 0.0 : dark_of(pixel);
      const float shining = mean + static_cast<float>(dark) * (1.0F - mean);
      cells_.pixels.push_back(pixel);
      cells_.values.push_back(coverage.values()[static_cast<std::size_t>(pixel)] * shining *
                              gain[i]);
    }
  }
  std::ranges::inplace_merge(refined_, refined_.begin() + static_cast<std::ptrdiff_t>(num_near));
}

/// Pixels that one straight boundary of the light cuts are cut together, others one by one.
void CellSummer::add_unrefined() {
  for (std::size_t first = 0; first < unrefined_.size(); first += cut_kernels::kBatch) {
    load_pixels(unrefined_, first);
    batch_.find_cuts(limits_);
    simple_.clear();
    for (std::size_t i = 0; i < batch_.size(); ++i) {
      if (batch_.is_simple(i) && positions_.is_even) {
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
  batch_.cut(p);
  std::array<float, cut_kernels::kBatch> radiance = {};
  of_sources_.resize(simple_.size() * sources);
  if (!positions_.is_dark_even) {
    add_shining(pixels);
    return;
  }
  for (std::size_t k = 0; k < sources; ++k) {
    batch_.integrate(p, k, radiance.data());
    for (std::size_t j = 0; j < simple_.size(); ++j) {
      of_sources_[j * sources + k] = static_cast<double>(radiance[simple_[j]]);
    }
  }
  expand_simple(pixels);
}

/// The same where the light of dark stripes depends on the pixel.
void CellSummer::add_shining(const std::int32_t* pixels) {
  const std::size_t sources = inside_positions_.shift_periods.size();
  std::array<float, cut_kernels::kBatch> radiance = {};
  std::array<float, cut_kernels::kBatch> lit = {};
  ScanPositions all_bright = inside_positions_;
  all_bright.shine(inside_positions_, 1.0);
  batch_.integrate(all_bright, 0, lit.data());
  for (std::size_t k = 0; k < sources; ++k) {
    batch_.integrate(inside_positions_, k, radiance.data());
    for (std::size_t j = 0; j < simple_.size(); ++j) {
      const auto black = static_cast<double>(radiance[simple_[j]]);
      const double dark = dark_of(pixels[simple_[j]]);
      of_sources_[j * sources + k] = black + dark * (static_cast<double>(lit[simple_[j]]) - black);
    }
  }
  expand_simple(pixels);
}

void CellSummer::expand_simple(const std::int32_t* pixels) {
  const std::size_t sources = inside_positions_.shift_periods.size();
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
  if (!positions_.is_dark_even) {
    shine(dark_of(pixel));
  }
  const auto [low, high] = std::ranges::minmax(corners.x_mm);
  CellSum& sum = sum_for(low, high);
  if (const OccludedEdge* edge = footprints_.occluded_edge(pixel)) {
    sum.add_visible(corners, 1.0, VisiblePart(*edge, footprints_.tunnel().settings()).polygons());
  } else {
    sum.add_smooth(corners, 1.0);
  }
  store(pixel, sum);
}

/// The wanted pixels of a group; neighbours in it are met together.
void CellSummer::add_group(const RefinedGroup& group) {
  constexpr std::size_t kTogether = 32;
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
    refined_cells_.intersect(group, footprints_.tunnel(), begin, end);
    for (std::size_t index = begin; index < end; ++index) {
      const auto [low_mm, high_mm] = refined_cells_.turn_to(index);
      if (!positions_.is_dark_even) {
        shine(refined_cells_.mean_dark(footprints_.tunnel().dark()));
      }
      CellSum& sum = sum_for(low_mm, high_mm);
      if (const OccludedEdge* edge = footprints_.occluded_edge(group.pixels[index])) {
        refined_cells_.add_to(sum, VisiblePart(*edge, footprints_.tunnel().settings()));
      } else {
        refined_cells_.add_to(sum);
      }
      store(group.pixels[index], sum);
    }
    begin = end - 1;
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
    const std::size_t before = cells_.values.size();
    cells_.values.resize(before + radiance.size());
    std::ranges::transform(radiance,
                           cells_.values.begin() + static_cast<std::ptrdiff_t>(before),
                           [](double value) { return static_cast<float>(value); });
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
