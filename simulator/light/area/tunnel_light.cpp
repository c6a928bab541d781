// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/area/tunnel_light.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/error.h"
#include "core/units.h"
#include "simulator/light/area/spherical_sampling.h"
#include "simulator/light/area/wall_outline.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Edges of stripes that are nearer to each other are one, in periods: rounding of positions.
constexpr double kSameEdge = 1e-9;

double fraction(double value) {
  const double f = value - std::floor(value);
  return f < 1.0 - kSameEdge ? f : 0.0;
}

/// How far the stripes have moved along their normal in a frame, in periods.
double moved_periods(const TunnelLight& light, int frame) {
  return frame * light.step_mm * std::cos(light.settings.orientation_rad) /
         light.settings.period_mm;
}

std::vector<double> even_bins(int count) {
  std::vector<double> ends;
  for (int i = 1; i <= count; ++i) {
    ends.push_back(static_cast<double>(i) / count);
  }
  return ends;
}

/// Where bins of phases end: at every edge of a stripe in every frame.
std::vector<double> bin_ends(const TunnelLight& light) {
  const double duty = light.settings.duty;
  if (duty <= 0.0 || duty >= 1.0) {
    return {1.0};
  }
  std::vector<double> edges = {1.0};
  for (int frame = 0; frame < light.positions; ++frame) {
    for (const double edge : {0.0, duty}) {
      const double at = fraction(moved_periods(light, frame) + edge);
      edges.push_back(at > kSameEdge ? at : 1.0);
    }
  }
  std::ranges::sort(edges);
  const auto last =
      std::unique(edges.begin(), edges.end(), [](double a, double b) { return b - a < kSameEdge; });
  edges.erase(last, edges.end());
  edges.back() = 1.0;
  return edges.size() <= kMaxTunnelBins ? edges : even_bins(kMaxTunnelBins);
}

/// How much of [0, phase) is bright when the bright stripes begin at whole numbers.
double bright_until(double phase, double duty) {
  const double whole = std::floor(phase);
  return whole * duty + std::min(phase - whole, duty);
}

void refuse_what_moves(const TunnelLight& light) {
  const auto refuse = [&](const char* key, double value) {
    if (value != 0.0) {
      throw ConfigError(
          fmt::format("lighting.{}.{}", light.name, key),
          fmt::format("is {:g}, must be 0 where paths are traced: radiance that moves with the "
                      "tunnel does not follow from the stripes' phase",
                      value));
    }
  };
  refuse("led_ripple", light.settings.led_ripple);
  refuse("end_falloff", light.settings.end_falloff);
}

/// A strip's x axis, for which a sample has least of its stratification left, is its short side.
RectangleShape wall_rectangle(const WallStrip& strip, double x_mm, double half_length_mm) {
  const Vector2d middle = 0.5 * (strip.from_mm + strip.to_mm);
  const Vector2d way = strip.to_mm - strip.from_mm;
  const Vector2d along = way.normalized();
  return {.frame = {.origin_mm = {x_mm, middle.x(), middle.y()},
                    .x = {0.0, along.x(), along.y()},
                    .y = Vector3d::UnitX(),
                    .z = {0.0, along.y(), -along.x()}},
          .half_x_mm = 0.5 * way.norm(),
          .half_y_mm = half_length_mm};
}

/// The share of the upper half of all directions that a wall fills, seen from the middle of its
/// base.
double filled_share(const Lights& lights, const StripedWall& wall, const Vector3d& eye_mm) {
  double solid_angle_sr = 0.0;
  for (std::size_t i = 0; i < wall.middle_mm.size(); ++i) {
    const auto& emitter = lights.emitters[static_cast<std::size_t>(wall.first_emitter) + i];
    const auto& s = std::get<RectangleShape>(emitter.shape);
    const Vector3d o = s.frame.local(s.frame.origin_mm - eye_mm);
    if (o.z() < 0.0) {
      solid_angle_sr += SphericalRectangle(o.x() - s.half_x_mm,
                                           o.x() + s.half_x_mm,
                                           o.y() - s.half_y_mm,
                                           o.y() + s.half_y_mm,
                                           o.z())
                            .solid_angle_sr();
    }
  }
  return solid_angle_sr / (2.0 * kPi);
}

/// Adds a strip, or its halves where the radiance of dark stripes is not nearly linear along it.
void add_linear(const Tunnel& tunnel, const WallStrip& strip, std::vector<WallStrip>& strips) {
  constexpr double kLinear = 5e-4;  // of the radiance of bright stripes
  constexpr double kShortest_mm = 0.01;
  const Vector2d way = strip.to_mm - strip.from_mm;
  const auto dark_at = [&](double t) { return tunnel.dark_at(strip.from_mm + t * way); };
  const auto is_linear_at = [&](double t) {
    return std::abs(dark_at(t) - (1.0 - t) * dark_at(0.0) - t * dark_at(1.0)) <= kLinear;
  };
  if (way.norm() < kShortest_mm ||
      (is_linear_at(0.25) && is_linear_at(0.5) && is_linear_at(0.75))) {
    strips.push_back(strip);
    return;
  }
  const Vector2d middle_mm = strip.from_mm + 0.5 * way;
  const double to_half_mm = 0.25 * way.norm();
  add_linear(tunnel,
             {.from_mm = strip.from_mm,
              .to_mm = middle_mm,
              .middle_arc_mm = strip.middle_arc_mm - to_half_mm},
             strips);
  add_linear(tunnel,
             {.from_mm = middle_mm,
              .to_mm = strip.to_mm,
              .middle_arc_mm = strip.middle_arc_mm + to_half_mm},
             strips);
}

/// The wall as strips along which the radiance of dark stripes is nearly linear.
std::vector<WallStrip> strips_of(const Tunnel& tunnel) {
  std::vector<WallStrip> strips = wall_outline(tunnel);
  if (tunnel.dark().is_even()) {
    return strips;
  }
  std::vector<WallStrip> linear;
  for (const WallStrip& strip : strips) {
    add_linear(tunnel, strip, linear);
  }
  return linear;
}

/// @return its power
Eigen::Array3f add_wall(const TunnelLight& light, Lights& lights, StripedWall& wall) {
  Emitter emitter = {.exponent = light.settings.cosine_law ? 2.0 : 1.0,
                     .group = wall.first_group,
                     .is_solid = light.settings.blocks_view};
  const double middle_x_mm = 0.5 * (light.positions - 1) * light.step_mm;
  Eigen::Array3f power_w = Eigen::Array3f::Zero();
  for (const WallStrip& strip : strips_of(Tunnel(light.settings))) {
    const RectangleShape shape = wall_rectangle(strip, middle_x_mm, 0.5 * light.settings.length_mm);
    emitter.shape = shape;
    lights.emitters.push_back(emitter);
    power_w += lobe_power_w(emitter);
    wall.middle_arc_mm.push_back(strip.middle_arc_mm);
    wall.middle_mm.push_back(shape.frame.origin_mm);
    wall.along.push_back(shape.frame.x);
  }
  return power_w;
}

/// The share of the wall in the second set of groups.
double second_share_of(const StripedWall& wall, const Lights& lights) {
  double area = 0.0;
  double second = 0.0;
  for (std::size_t i = 0; i < wall.second_share.size(); ++i) {
    const auto& emitter = lights.emitters[static_cast<std::size_t>(wall.first_emitter) + i];
    const double width_mm = std::get<RectangleShape>(emitter.shape).half_x_mm;
    area += width_mm;
    second += width_mm * wall.second_share[i];
  }
  return area > 0.0 ? second / area : 0.0;
}

/// How the light of dark stripes is shared between the darkest and the brightest of them.
void share_dark(const Tunnel& tunnel, StripedWall& wall) {
  const DarkRadiance& dark = tunnel.dark();
  if (dark.is_even()) {
    return;
  }
  const auto share_at = [&](const Vector2d& point) {
    return (tunnel.dark_at(point) - dark.lowest()) / (dark.highest() - dark.lowest());
  };
  for (const WallStrip& strip : strips_of(tunnel)) {
    const double from = share_at(strip.from_mm);
    const double to = share_at(strip.to_mm);
    wall.second_share.push_back(0.5 * (from + to));
    wall.second_share_per_mm.push_back((to - from) / (strip.to_mm - strip.from_mm).norm());
  }
}

void add_groups(const TunnelLight& light,
                const Eigen::Array3f& power_w,
                const StripedWall& wall,
                Lights& lights) {
  const auto factors = tunnel_frame_factors(light);
  const std::size_t bins = wall.bin_ends.size();
  for (std::size_t group = 0; group < factors.front().size(); ++group) {
    double sum = 0.0;
    for (const auto& of_frame : factors) {
      sum += of_frame[group];
    }
    const std::size_t bin = group % bins;
    const double width = wall.bin_ends[bin] - (bin > 0 ? wall.bin_ends[bin - 1] : 0.0);
    const double second = second_share_of(wall, lights);
    const double share = group < bins ? 1.0 - second : second;
    lights.groups.push_back({.name = fmt::format("{}.{}", light.name, group),
                             .factor = sum / light.positions,
                             .power_w = power_w * static_cast<float>(width * share)});
  }
}

}  // namespace

std::vector<std::vector<double>> tunnel_frame_factors(const TunnelLight& light) {
  GLINT_CHECK(light.positions > 0, "a scan has a position");
  const std::vector<double> ends = bin_ends(light);
  const DarkRadiance dark = Tunnel(light.settings).dark();
  const double duty = light.settings.duty;
  std::vector<std::vector<double>> factors;
  for (int frame = 0; frame < light.positions; ++frame) {
    const double moved = fraction(moved_periods(light, frame));
    std::vector<double> shares;
    double begin = 0.0;
    for (const double end : ends) {
      double share =
          (bright_until(end - moved, duty) - bright_until(begin - moved, duty)) / (end - begin);
      // What rounding of an edge takes from a bin beside it.
      share = share < 1e-6 ? 0.0 : share > 1.0 - 1e-6 ? 1.0 : share;
      shares.push_back(share);
      begin = end;
    }
    std::vector<double>& of_frame = factors.emplace_back();
    for (const double share : shares) {
      of_frame.push_back(share + (1.0 - share) * dark.lowest());
    }
    for (std::size_t i = 0; i < shares.size() && !dark.is_even(); ++i) {
      of_frame.push_back(shares[i] + (1.0 - shares[i]) * dark.highest());
    }
  }
  return factors;
}

void add_tunnel(const TunnelLight& light, Lights& lights) {
  refuse_what_moves(light);
  const TunnelSettings& s = light.settings;
  StripedWall wall = {.first_emitter = static_cast<int>(lights.emitters.size()),
                      .first_group = static_cast<int>(lights.groups.size()),
                      .bin_ends = bin_ends(light),
                      .periods_per_x_mm = std::cos(s.orientation_rad) / s.period_mm,
                      .periods_per_arc_mm = std::sin(s.orientation_rad) / s.period_mm,
                      .offset_periods = s.offset_mm / s.period_mm};
  const Eigen::Array3f power_w = add_wall(light, lights, wall);
  if (wall.middle_mm.empty()) {
    throw ConfigError("lighting." + light.name, "has no luminous area");
  }
  const Vector3d eye_mm(wall.middle_mm[0].x(), 0.0, s.base_mm);
  const bool is_drawn = filled_share(lights, wall, eye_mm) < light.drawn_below;
  for (std::size_t i = 0; i < wall.middle_mm.size(); ++i) {
    lights.emitters[static_cast<std::size_t>(wall.first_emitter) + i].is_drawn = is_drawn;
  }
  share_dark(Tunnel(s), wall);
  add_groups(light, power_w, wall, lights);
  lights.first_tunnel_group = wall.first_group;
  lights.wall = std::move(wall);
}

}  // namespace glint
