// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sorts the pixels of a picture into dark ones, plain ones (entirely on the lit wall at every
// position of the scan) and those that are summed from cells. The conditions at each corner are
// packed into the bits of a byte, so that a pixel follows from the conjunction of four bytes; tiles
// of 8 x 8 pixels whose bounds are known (sparse_intersection.h) are decided as a whole.
// docs/theory/footprints.md. Cost: one pass over the corners of those tiles that are not decided.
// Memory: 12 bytes per corner ray (20 with oblique stripes or the cosine law) and two bytes per
// pixel.
#include "simulator/render/footprint/footprints.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "simulator/render/corner_rays/sparse_kernels.h"
#include "simulator/render/footprint/pixel_dark.h"
#include "simulator/render/footprint/visible_part.h"

namespace glint {
namespace {

namespace kernels = footprint_kernels;

}  // namespace

void intersect_light(
    const RayCache& rays, const Tunnel& tunnel, std::int64_t begin, int count, WallHits& hits) {
  hits.resize(static_cast<std::size_t>(count), tunnel.settings());
  intersect_rays(rays.block(begin, count), tunnel, 0, hits);
}

WallHits intersect_light(const RayCache& rays, const Tunnel& tunnel) {
  WallHits hits;
  intersect_light(rays, tunnel, 0, static_cast<int>(rays.weight.size()), hits);
  return hits;
}

WallHits intersect_corners(const CornerRays& rays, const Tunnel& tunnel, TileLimits& limits) {
  return rays.sparse.is_empty() ? intersect_light(rays.corners, tunnel)
                                : intersect_sparse(rays.sparse, rays.corners, tunnel, limits);
}

ScanPositions::ScanPositions(const Tunnel& tunnel, const ScanSettings& scan) {
  const TunnelSettings& s = tunnel.settings();
  const StripePattern pattern = tunnel.pattern(0.0);
  period_mm = s.period_mm;
  offset_mm = s.offset_mm;
  duty = s.duty;
  dark = static_cast<double>(pattern.dark);
  bright = 1.0 - dark;
  is_dark_even = tunnel.dark().is_even();
  darkest = tunnel.dark().lowest();
  half_slot_mm = s.half_slot_mm();
  half_length_mm = 0.5 * s.length_mm;
  is_even = s.led_ripple == 0.0 && s.end_falloff == 0.0;
  unevenness = {.ripple = pattern.led_ripple,
                .per_mm = pattern.led_per_mm,
                .falloff = pattern.end_falloff,
                .half_length_mm = pattern.half_length_mm};
  const double step_mm = scan_step_mm(scan, s);
  for (int k = 0; k < scan.positions; ++k) {
    shift_mm.push_back(k * step_mm);
    const double periods = k * step_mm * std::cos(s.orientation_rad) / s.period_mm;
    shift_periods.push_back(periods - std::floor(periods));
  }
}

int ScanPositions::even_phases() const {
  constexpr double kTolerance = 1e-9;
  const double step = frames() > 1 ? shift_periods[1] : 0.0;
  for (int phases = 1; phases <= frames(); ++phases) {
    const double turns = step * phases;
    if (frames() % phases == 0 && std::abs(turns - std::round(turns)) < kTolerance * phases) {
      return phases;
    }
  }
  return 0;
}

/// The share of `phases` evenly shifted stripes that are bright is floor(phases duty) / phases, and
/// one more for a part of each phases-th of a period.
ScanPositions ScanPositions::mean_position() const {
  constexpr double kRounding = 1e-9;
  const int phases = even_phases();
  GLINT_CHECK(phases > 0 && is_even, "a scan of whole periods under even light");
  const double times_duty = phases * duty + kRounding;
  const double whole = std::floor(times_duty);
  ScanPositions mean = *this;
  mean.period_mm = period_mm / phases;
  const bool is_whole = times_duty - whole < 2.0 * kRounding;
  mean.duty = is_whole ? 0.0 : times_duty - whole - kRounding;
  mean.dark = dark + bright * whole / phases;
  mean.bright = is_whole ? 0.0 : bright / phases;
  mean.shift_periods = {0.0};
  return mean;
}

ScanPositions ScanPositions::with_stripes_at(const std::vector<double>& places) const {
  ScanPositions moved = *this;
  moved.shift_periods = places;
  return moved;
}

DistinctStripes ScanPositions::distinct_stripes() const {
  return is_even ? DistinctStripes(shift_periods, duty) : DistinctStripes(shift_periods);
}

WallView::WallView(const CornerRays& rays,
                   const Tunnel& tunnel,
                   const Eigen::Vector3d& camera_in_world_mm)
    : hits(intersect_corners(rays, tunnel, limits)),
      occluded(occluded_pixels(rays, tunnel, camera_in_world_mm)) {}

std::size_t WallView::bytes() const {
  std::size_t floats = 0;
  for (const auto* array :
       {&hits.x_mm, &hits.y_mm, &hits.margin_mm, &hits.pattern_mm, &hits.cosine}) {
    floats += array->size();
  }
  for (const auto* array :
       {&limits.x_low_mm, &limits.y_low_mm, &limits.margin_low_mm, &limits.stripes_low_mm}) {
    floats += 2 * array->size();
  }
  return sizeof(float) * floats + limits.kind.size() + occluded.whole.size() +
         sizeof(OccludedEdge) * occluded.edges.size();
}

Footprints::Footprints(const CornerRays& rays,
                       const Tunnel& tunnel,
                       const ScanSettings& scan,
                       const Eigen::Vector3d& camera_in_world_mm)
    : Footprints(
          rays, tunnel, scan, std::make_shared<const WallView>(rays, tunnel, camera_in_world_mm)) {}

Footprints::Footprints(const CornerRays& rays,
                       const Tunnel& tunnel,
                       const ScanSettings& scan,
                       std::shared_ptr<const WallView> view)
    : rays_(rays), tunnel_(tunnel), positions_(tunnel, scan), view_(std::move(view)) {
  GLINT_CHECK(view_->hits.x_mm.size() == rays.corners.weight.size(), "a view of these rays");
  classify();
  if (!positions_.is_dark_even) {
    find_dark();
  }
}

void Footprints::find_dark() {
  const DarkRadiance& dark = tunnel_.dark();
  const WallHits& hits = view_->hits;
  dark_.resize(hits.y_mm.size());
  for (std::size_t i = 0; i < dark_.size(); ++i) {
    const bool is_met = has_place(hits, rays_.corners.weight.data(), i);
    dark_[i] = is_met ? static_cast<float>(dark.at(static_cast<double>(hits.y_mm[i]),
                                                   static_cast<double>(hits.margin_mm[i])))
                      : 0.0F;
  }
}

std::array<std::size_t, 4> Footprints::corners_of(std::int32_t pixel) const {
  const auto row = static_cast<std::size_t>(rays_.width_px) + 1;
  const auto at = static_cast<std::size_t>(pixel) + static_cast<std::size_t>(pixel) / (row - 1);
  return {at, at + 1, at + row, at + row + 1};
}

kernels::LitLimits Footprints::lit_limits() const {
  const ScanPositions& p = positions_;
  return {.half_slot_mm = static_cast<float>(p.half_slot_mm),
          .x_low_mm = static_cast<float>(p.shift_mm.back() - p.half_length_mm),
          .x_high_mm = static_cast<float>(p.half_length_mm),
          .widest_mm = static_cast<float>(2.0 * std::min(p.duty, 1.0 - p.duty) * p.period_mm)};
}

void Footprints::classify() {
  state_ = Image<State>::uninitialized(rays_.width_px, rays_.height_px);
  none_occluded_.resize(static_cast<std::size_t>(rays_.width_px));
  if (view_->limits.rows > 0) {
    classify_tiles();
  } else {
    classify_pixels(0, rays_.height_px, 0, rays_.width_px);
  }
  for (const OccludedEdge& edge : view_->occluded.edges) {
    State& state = state_.values()[static_cast<std::size_t>(edge.pixel)];
    state = state == State::kPlain ? State::kCells : state;
  }
}

const OccludedEdge* Footprints::occluded_edge(std::int32_t pixel) const {
  const std::vector<OccludedEdge>& edges = view_->occluded.edges;
  const auto found = std::ranges::lower_bound(edges, pixel, {}, &OccludedEdge::pixel);
  return found != edges.end() && found->pixel == pixel ? &*found : nullptr;
}

const unsigned char* Footprints::occluded_row(int y) const {
  return occluded().empty() ? none_occluded_.data() : occluded().row(y);
}

/// Tiles that are plain as a whole need no look at their rays.
void Footprints::classify_tiles() {
  constexpr int kStep = sparse_kernels::kStep;
  const TileLimits& limits = view_->limits;
  const kernels::LitLimits lit = lit_limits();
  std::vector<unsigned char> is_even(static_cast<std::size_t>(limits.columns));
  for (int row = 0; row < limits.rows; ++row) {
    const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(row) * limits.columns;
    const auto at = [&](const std::vector<float>& values) { return values.data() + first; };
    const bool has_stripes = !limits.stripes_low_mm.empty();
    kernels::even_tiles(
        {.x_low = at(limits.x_low_mm),
         .x_high = at(limits.x_high_mm),
         .y_low = at(limits.y_low_mm),
         .y_high = at(limits.y_high_mm),
         .margin_low = at(limits.margin_low_mm),
         .stripes_low = at(has_stripes ? limits.stripes_low_mm : limits.x_low_mm),
         .stripes_high = at(has_stripes ? limits.stripes_high_mm : limits.x_high_mm),
         .kind = reinterpret_cast<const unsigned char*>(limits.kind.data()) + first},
        limits.columns,
        lit,
        is_even.data());
    const int top = row * kStep;
    const int bottom = std::min(top + kStep, rays_.height_px);
    const auto is_same = [&](int column, int other) {
      return is_even[static_cast<std::size_t>(column)] == is_even[static_cast<std::size_t>(other)];
    };
    for (int begin = 0, end = 0; begin < limits.columns; begin = end) {
      for (end = begin + 1; end < limits.columns && is_same(end, begin); ++end) {
      }
      const int left = begin * kStep;
      const int right = std::min(end * kStep, rays_.width_px);
      if (is_even[static_cast<std::size_t>(begin)] == 0) {
        classify_pixels(top, bottom, left, right);
        continue;
      }
      for (int y = top; y < bottom; ++y) {
        kernels::plain_states(reinterpret_cast<const unsigned char*>(rays_.kind.row(y)) + left,
                              occluded_row(y) + left,
                              right - left,
                              reinterpret_cast<unsigned char*>(state_.row(y)) + left);
      }
    }
  }
}

/// Pixels [left, right) of rows [top, bottom), by the corners of each.
void Footprints::classify_pixels(int top, int bottom, int left, int right) {
  if (left >= right || top >= bottom) {
    return;
  }
  static_assert(static_cast<int>(PixelKind::kDark) == static_cast<int>(State::kDark) &&
                static_cast<int>(PixelKind::kRefined) == static_cast<int>(State::kCells));
  const kernels::LitLimits limits = lit_limits();
  const auto corner_width = static_cast<std::size_t>(rays_.width_px) + 1;
  const int count = right - left;
  const auto place = [&](int y) {
    return static_cast<std::size_t>(y) * corner_width + static_cast<std::size_t>(left);
  };
  std::vector<unsigned char> above(static_cast<std::size_t>(count) + 1), below(above.size());
  const auto find_codes = [&](int y, std::vector<unsigned char>& codes) {
    kernels::corner_codes(hits().x_mm.data() + place(y),
                          hits().y_mm.data() + place(y),
                          hits().margin_mm.data() + place(y),
                          count + 1,
                          limits,
                          codes.data());
  };
  find_codes(top, below);
  for (int y = top; y < bottom; ++y) {
    above.swap(below);
    find_codes(y + 1, below);
    const float* stripes_mm = hits().stripes_mm().data() + place(y);
    kernels::classify(above.data(),
                      below.data(),
                      {.top = stripes_mm, .bottom = stripes_mm + corner_width},
                      reinterpret_cast<const unsigned char*>(rays_.kind.row(y)) + left,
                      occluded_row(y) + left,
                      count,
                      limits,
                      reinterpret_cast<unsigned char*>(state_.row(y)) + left);
  }
}

double Footprints::hidden_share() const {
  return glint::hidden_share(view_->occluded, tunnel_.settings(), rays_);
}

}  // namespace glint
