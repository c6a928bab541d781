// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/footprints.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "simulator/render/hidden_pixels.h"
#include "simulator/render/mask_kernels.h"

namespace glint {
namespace {

namespace kernels = footprint_kernels;

/// Rays that are met together: their arrays stay in the first caches.
constexpr int kBlock = 1024;

}  // namespace

void meet_light(
    const RayCache& rays, const Tunnel& tunnel, std::int64_t begin, int count, WallHits& hits) {
  const TunnelSettings& settings = tunnel.settings();
  const bool has_details = settings.orientation_rad != 0.0 || settings.cosine_law;
  const auto total = static_cast<std::size_t>(count);
  for (auto* array : {&hits.x_mm, &hits.y_mm, &hits.margin_mm}) {
    array->resize(total);
  }
  hits.pattern_mm.resize(has_details ? total : 0);
  hits.cosine.resize(has_details ? total : 0);
  for (int done = 0; done < count; done += kBlock) {
    const RayBlock block = rays.block(begin + done, std::min(kBlock, count - done));
    float* x = hits.x_mm.data() + done;
    float* y = hits.y_mm.data() + done;
    float* margin = hits.margin_mm.data() + done;
    tunnel.meet_block(block, x, y, margin);
    if (has_details) {
      tunnel.meet_details(
          block, x, y, margin, hits.pattern_mm.data() + done, hits.cosine.data() + done);
    }
  }
}

WallHits meet_light(const RayCache& rays, const Tunnel& tunnel) {
  WallHits hits;
  meet_light(rays, tunnel, 0, static_cast<int>(rays.weight.size()), hits);
  return hits;
}

ScanPositions::ScanPositions(const Tunnel& tunnel, const ScanSettings& scan) {
  const TunnelSettings& s = tunnel.settings();
  const StripePattern pattern = tunnel.pattern(0.0);
  period_mm = s.period_mm;
  offset_mm = s.offset_mm;
  duty = s.duty;
  dark = static_cast<double>(pattern.dark);
  bright = 1.0 - dark;
  // Without a slot every y is beside it.
  half_slot_mm = s.slot_mm > 0.0 ? 0.5 * s.slot_mm : -1e30;
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

WallView::WallView(const CornerRays& rays,
                   const Tunnel& tunnel,
                   const Eigen::Vector3d& camera_in_world_mm)
    : WallView(meet_light(rays.corners, tunnel), rays, tunnel, camera_in_world_mm) {}

WallView::WallView(WallHits met,
                   const CornerRays& rays,
                   const Tunnel& tunnel,
                   const Eigen::Vector3d& camera_in_world_mm)
    : hits(std::move(met)), hidden(hidden_pixels(rays, tunnel, camera_in_world_mm)) {}

std::size_t WallView::bytes() const {
  std::size_t floats = 0;
  for (const auto* array :
       {&hits.x_mm, &hits.y_mm, &hits.margin_mm, &hits.pattern_mm, &hits.cosine}) {
    floats += array->size();
  }
  return sizeof(float) * floats + hidden.size();
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
}

void Footprints::classify() {
  state_ = Image<State>(rays_.width_px, rays_.height_px, State::kDark);
  const ScanPositions& p = positions_;
  const auto corner_width = static_cast<std::size_t>(rays_.width_px) + 1;
  const kernels::LitLimits limits = {
      .half_slot_mm = static_cast<float>(p.half_slot_mm),
      .x_low_mm = static_cast<float>(p.shift_mm.back() - p.half_length_mm),
      .x_high_mm = static_cast<float>(p.half_length_mm),
      .widest_mm = static_cast<float>(2.0 * std::min(p.duty, 1.0 - p.duty) * p.period_mm)};
  static_assert(static_cast<int>(PixelKind::kDark) == static_cast<int>(State::kDark) &&
                static_cast<int>(PixelKind::kRefined) == static_cast<int>(State::kCells));
  std::vector<unsigned char> above(corner_width), below(corner_width);
  const auto find_codes = [&](int y, std::vector<unsigned char>& codes) {
    const std::size_t at = static_cast<std::size_t>(y) * corner_width;
    kernels::corner_codes(hits().x_mm.data() + at,
                          hits().y_mm.data() + at,
                          hits().margin_mm.data() + at,
                          static_cast<int>(corner_width),
                          limits,
                          codes.data());
  };
  find_codes(0, below);
  for (int y = 0; y < rays_.height_px; ++y) {
    above.swap(below);
    find_codes(y + 1, below);
    const float* stripes_mm =
        hits().stripes_mm().data() + static_cast<std::size_t>(y) * corner_width;
    kernels::classify(above.data(),
                      below.data(),
                      {.top = stripes_mm, .bottom = stripes_mm + corner_width},
                      reinterpret_cast<const unsigned char*>(rays_.kind.row(y)),
                      hidden().row(y),
                      rays_.width_px,
                      limits,
                      reinterpret_cast<unsigned char*>(state_.row(y)));
  }
}

void Footprints::phases(int y, const kernels::PhaseRow& row) const {
  const auto corner_width = static_cast<std::size_t>(rays_.width_px) + 1;
  const float* top = hits().stripes_mm().data() + static_cast<std::size_t>(y) * corner_width;
  kernels::phases_of_corners({.top = top, .bottom = top + corner_width},
                             rays_.width_px,
                             static_cast<float>(positions_.offset_mm),
                             static_cast<float>(1.0 / positions_.period_mm),
                             row);
}

double Footprints::hidden_share() const {
  const auto count = static_cast<int>(hidden().size());
  const int num_hidden = mask_kernels::count_ones(hidden().values().data(), count);
  const int on_part = mask_kernels::count_positive(rays_.coverage.values().data(), count);
  return on_part > 0 ? static_cast<double>(num_hidden) / on_part : 0.0;
}

}  // namespace glint
