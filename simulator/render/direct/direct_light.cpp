// SPDX-License-Identifier: GPL-3.0-or-later
//
// Cost: some 0.1 us for each panel of a light and 15 ns for each place on it; a ring at alpha 0.3
// takes some 40 places.
#include "simulator/render/direct/direct_light.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/error.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// Longest arc of a panel of a ring or a cap [rad]: its edges' middles then tell of all of it.
constexpr double kLongestArc_rad = kPi / 2.0;
constexpr int kMaxPlacesOfPanel = 32;
constexpr std::size_t kMaxPanels = 128;
/// Panels are cut in halves to this share of their surface at most.
constexpr float kSmallestHalf = 0.5F / 64.0F;
/// A rule misses a fiftieth of a panel that the horizon runs through, as a binary logarithm.
constexpr float kLog2Cut = 5.6F;
/// Where a shadow's edge may run between places they are chosen for so many times less error, again
/// as a binary logarithm.
constexpr float kLog2Shadowed = 10.0F;
/// Errors of rules are up to this many times bound rho^(-2 n), as a binary logarithm.
constexpr float kLog2Safety = 4.0F;

void copy_to(const Vector3d& from, float* to) {
  for (Eigen::Index i = 0; i < 3; ++i) {
    to[i] = static_cast<float>(from[i]);
  }
}

/// Into the frame of a point.
class ToLocal {
 public:
  explicit ToLocal(const DirectPoint& point) : point_(point) {}

  void direction(const Vector3d& v, float* to) const {
    const ShadingFrame& f = point_.frame;
    copy_to({f.tangent.dot(v), f.bitangent.dot(v), f.normal.dot(v)}, to);
  }

  void place(const Vector3d& at_mm, float* to) const { direction(at_mm - point_.point_mm, to); }

  void axes(const EmitterFrame& frame, LocalEmitter& to) const {
    place(frame.origin_mm, to.origin);
    direction(frame.x, to.x);
    direction(frame.y, to.y);
    direction(frame.z, to.z);
  }

 private:
  const DirectPoint& point_;
};

void set_shape(const RectangleShape& s, const ToLocal& local, LocalEmitter& e) {
  const Vector3d along = 2.0 * s.half_x_mm * s.frame.x;
  const Vector3d across = 2.0 * s.half_y_mm * s.frame.y;
  local.place(s.frame.origin_mm - 0.5 * (along + across), e.origin);
  local.direction(along, e.x);
  local.direction(across, e.y);
  local.direction(s.frame.z, e.normal);
  e.area_mm2 = static_cast<float>(4.0 * s.half_x_mm * s.half_y_mm);
}

void set_shape(const TriangleShape& s, const ToLocal& local, LocalEmitter& e) {
  const Vector3d normal = (s.b_mm - s.a_mm).cross(s.c_mm - s.a_mm);
  local.place(s.a_mm, e.origin);
  local.direction(s.b_mm - s.a_mm, e.x);
  local.direction(s.c_mm - s.b_mm, e.z);
  local.direction(normal.normalized(), e.normal);
  e.area_per_s = static_cast<float>(normal.norm());
}

void set_shape(const RingShape& s, const ToLocal& local, LocalEmitter& e) {
  e.kind = LocalEmitter::Kind::kRing;
  local.axes(s.frame, e);
  e.radius_mm = static_cast<float>(s.middle_radius_mm);
  e.width_mm = static_cast<float>(s.width_mm);
  e.tilt_cosine = static_cast<float>(std::cos(s.tilt_rad));
  e.tilt_sine = static_cast<float>(std::sin(s.tilt_rad));
  e.first_rad = static_cast<float>(s.first_rad);
  e.span_rad = static_cast<float>(s.span_rad);
}

void set_shape(const CapShape& s, const ToLocal& local, LocalEmitter& e) {
  e.kind = LocalEmitter::Kind::kCap;
  local.axes(s.frame, e);
  e.radius_mm = static_cast<float>(s.radius_mm);
  e.top_rad = static_cast<float>(s.top_rad);
  e.height_rad = static_cast<float>(s.rim_rad - s.top_rad);
  e.span_rad = static_cast<float>(2.0 * kPi);
}

/// Panels that wait to be looked at.
class PanelStack {
 public:
  explicit PanelStack(const LocalEmitter& e) {
    const int along_s = pieces(e.height_rad);
    const int along_t = pieces(e.span_rad);
    for (int i = 0; i < along_s * along_t; ++i) {
      const int row = i / along_s;
      push({.s = (static_cast<float>(i % along_s) + 0.5F) / static_cast<float>(along_s),
            .t = (static_cast<float>(row) + 0.5F) / static_cast<float>(along_t),
            .half_s = 0.5F / static_cast<float>(along_s),
            .half_t = 0.5F / static_cast<float>(along_t)});
    }
  }

  bool empty() const { return count_ == 0; }

  Panel pop() { return panels_[--count_]; }

  bool has_room() const { return count_ + 2 <= panels_.size(); }

  void push_halves(const Panel& panel, bool along_s) {
    Panel half = panel;
    (along_s ? half.half_s : half.half_t) *= 0.5F;
    for (const float sign : {1.0F, -1.0F}) {
      Panel next = half;
      next.s = along_s ? panel.s + sign * half.half_s : panel.s;
      next.t = along_s ? panel.t : panel.t + sign * half.half_t;
      push(next);
    }
  }

 private:
  static int pieces(float arc_rad) {
    return std::max(
        1, static_cast<int>(std::ceil(static_cast<double>(arc_rad) / kLongestArc_rad - 1e-3)));
  }

  void push(const Panel& panel) { panels_[count_++] = panel; }

  std::array<Panel, kMaxPanels> panels_;
  std::size_t count_ = 0;
};

/// How many places along s and t a panel asks for.
struct PlaceCounts {
  int s = 1;
  int t = 1;
  bool ask_for_halves = false;
  bool along_s = false;  ///< of the halves
};

int places_for(float digits, float log2_rho) {
  constexpr float kMax = 1000.0F;
  const float count = digits / (2.0F * std::max(log2_rho, 1e-3F));
  return static_cast<int>(std::ceil(std::clamp(count, 1.0F, kMax)));
}

PlaceCounts counts_of(const PanelSmoothness& smoothness, float log2_tolerance) {
  const float digits = std::log2(smoothness.bound) - log2_tolerance;
  const int s = places_for(digits + kLog2Safety, smoothness.log2_rho_s);
  const int t = places_for(digits + kLog2Safety, smoothness.log2_rho_t);
  const bool is_too_many = s > kMaxPlaces || t > kMaxPlaces || s * t > kMaxPlacesOfPanel;
  return {.s = std::min(s, kMaxPlaces),
          .t = std::min(t, kMaxPlaces),
          .ask_for_halves = is_too_many || (smoothness.is_cut && digits > kLog2Cut),
          .along_s = s > t};
}

/// Packets that so many places take, and one for what they are filled up by.
std::size_t packets_for(int places) {
  return static_cast<std::size_t>(places) / kPacketSize + 1;
}

/// Sixteen times the same direction.
VectorLanes lanes_of(const LocalDirection& v) {
  VectorLanes lanes;
  std::fill_n(lanes.x, kPacketSize, static_cast<float>(v.x));
  std::fill_n(lanes.y, kPacketSize, static_cast<float>(v.y));
  std::fill_n(lanes.z, kPacketSize, static_cast<float>(v.z));
  return lanes;
}

}  // namespace

std::string lights_without_direct_sum(const Lights& lights) {
  if (lights.environment) {
    return "an environment is no surface";
  }
  if (lights.wall) {
    return "a tunnel's stripes are not even";
  }
  for (const Emitter& emitter : lights.emitters) {
    if (emitter.body >= 0) {
      return "a measured lamp's table is not smooth";
    }
  }
  return {};
}

LocalEmitter local_emitter(const Emitter& emitter, const DirectPoint& point) {
  LocalEmitter e;
  e.exponent = static_cast<float>(emitter.exponent);
  e.strongest = emitter.radiance.maxCoeff();
  std::visit([&](const auto& shape) { set_shape(shape, ToLocal(point), e); }, emitter.shape);
  return e;
}

DirectLight::DirectLight(const Lights& lights,
                         const ConductorNumbers& metal,
                         int channels,
                         double tolerance)
    : lights_(lights),
      metal_(metal),
      channels_(channels),
      log2_tolerance_(static_cast<float>(std::log2(tolerance))) {
  const std::string reason = lights_without_direct_sum(lights);
  if (!reason.empty()) {
    throw ConfigError("lighting", "has no direct sum: " + reason);
  }
  has_lobes_ =
      std::ranges::any_of(lights.emitters, [](const Emitter& e) { return e.exponent != 1.0; });
}

int DirectLight::place_emitter(const LocalEmitter& emitter,
                               const PanelView& view,
                               int index,
                               int first,
                               float log2_tolerance,
                               std::vector<PlaceLanes>& places) const {
  PanelStack stack(emitter);
  while (!stack.empty()) {
    const Panel panel = stack.pop();
    const PanelSmoothness smoothness = smoothness_of(emitter, view, panel);
    if (smoothness.bound == 0.0F) {
      continue;
    }
    const PlaceCounts counts = counts_of(smoothness, log2_tolerance);
    const float half = counts.along_s ? panel.half_s : panel.half_t;
    if (counts.ask_for_halves && half > kSmallestHalf && stack.has_room()) {
      stack.push_halves(panel, counts.along_s);
      continue;
    }
    const int end = first + counts.s * counts.t;
    places.resize(std::max(places.size(), packets_for(end)));
    place_nodes(emitter, panel, counts.s, counts.t, index, first, places.data());
    first = end;
  }
  return first;
}

int DirectLight::choose_places(const DirectPoint& point,
                               bool is_shadowed,
                               std::vector<PlaceLanes>& places) const {
  const float log2_tolerance = log2_tolerance_ - (is_shadowed ? kLog2Shadowed : 0.0F);
  PanelView view = {.alpha_x = metal_.alpha_x, .alpha_y = metal_.alpha_y};
  copy_to({point.to_viewer.x, point.to_viewer.y, point.to_viewer.z}, view.viewer);
  ToLocal(point).direction(point.side, view.side);
  int count = 0;
  for (std::size_t i = 0; i < lights_.emitters.size(); ++i) {
    const Emitter& emitter = lights_.emitters[i];
    if (shows_front(emitter.shape, point.point_mm)) {
      const LocalEmitter local = local_emitter(emitter, point);
      count = place_emitter(local, view, static_cast<int>(i), count, log2_tolerance, places);
    }
  }
  const auto lanes = static_cast<std::size_t>(kPacketSize);
  for (auto i = static_cast<std::size_t>(count); i % lanes != 0; ++i) {  // the rest is dark
    places[i / lanes].area_mm2[i % lanes] = 0.0F;
    places[i / lanes].emitter[i % lanes] = 0;
    places[i / lanes].exponent[i % lanes] = 1.0F;
  }
  return count;
}

void DirectLight::add_packet(const PlaceLanes& places,
                             const LitLanes& lit,
                             std::vector<double>& sums) const {
  for (int i = 0; i < kPacketSize; ++i) {
    const Emitter& emitter = lights_.emitters[static_cast<std::size_t>(places.emitter[i])];
    for (int c = 0; c < channels_; ++c) {
      const float value = lit.reflection.value.c[c][i] * lit.solid_angle[i] * emitter.radiance[c];
      sums[static_cast<std::size_t>(emitter.group * channels_ + c)] += static_cast<double>(value);
    }
  }
}

int DirectLight::at(const DirectPoint& point,
                    const ShadowTest& shadows,
                    Scratch& scratch,
                    std::span<float> radiance) const {
  scratch.sums.assign(size(), 0.0);
  const int count =
      point.to_viewer.z > 0.0 ? choose_places(point, shadows != nullptr, scratch.places) : 0;
  const VectorLanes viewer = lanes_of(point.to_viewer);
  LobeLanes lobes;
  choose_lobes16(metal_, viewer, lobes);
  float side[3];
  ToLocal(point).direction(point.side, side);
  LitLanes lit;
  for (int first = 0; first < count; first += kPacketSize) {
    const PlaceLanes& places = scratch.places[static_cast<std::size_t>(first / kPacketSize)];
    light_places16(metal_, lobes, viewer, side, has_lobes_, places, lit);
    if (shadows) {
      shadows(point, places, lit);
    }
    add_packet(places, lit, scratch.sums);
  }
  std::ranges::transform(
      scratch.sums, radiance.begin(), [](double sum) { return static_cast<float>(sum); });
  return count;
}

}  // namespace glint
