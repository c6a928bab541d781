// SPDX-License-Identifier: GPL-3.0-or-later
//
// A binary tree over the emitters, halved at the median along the longest side of their middles;
// going down it, a child is taken with a probability by its estimate at the point (Conty Estevez
// and Kulla, HPG 2018; the header has the estimate). Choosing costs two estimates a level, log2 of
// the emitters levels; what a ray meets is found by the same boxes. docs/theory/path_tracing.md.
#include "simulator/light/area/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace glint {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// Halving 2^63 emitters never needs more.
constexpr std::size_t kMaxDepth = 64;
/// Trees of eight emitters and fewer are not descended: weighing each leaf costs as much and wastes
/// no samples on nodes whose emitters all look away.
constexpr std::size_t kFewNodes = 15;
/// Flat boxes get a thickness, so that no slab is empty.
constexpr double kPadding = 1e-9;

double angle_rad(const Vector3d& a, const Vector3d& b) {
  return std::acos(std::clamp(a.dot(b), -1.0, 1.0));
}

/// The smallest cone that holds both.
NormalCone merged(const NormalCone& a, const NormalCone& b) {
  const double between = angle_rad(a.axis, b.axis);
  if (between + b.half_angle_rad <= a.half_angle_rad) {
    return a;
  }
  if (between + a.half_angle_rad <= b.half_angle_rad) {
    return b;
  }
  const double half = 0.5 * (between + a.half_angle_rad + b.half_angle_rad);
  const Vector3d turn_axis = a.axis.cross(b.axis);
  if (half >= kPi || turn_axis.norm() < 1e-12) {
    return {.axis = a.axis, .half_angle_rad = kPi};
  }
  const Eigen::AngleAxisd turn(half - a.half_angle_rad, turn_axis.normalized());
  return {.axis = turn * a.axis, .half_angle_rad = half};
}

AlignedBox3d padded(AlignedBox3d box) {
  const double size = std::max(box.diagonal().norm(), box.center().cwiseAbs().maxCoeff());
  const Vector3d padding = Vector3d::Constant(kPadding * (1.0 + size));
  return {box.min() - padding, box.max() + padding};
}

double axis_intensity(const Emitter& emitter, const std::vector<IesBody>& bodies) {
  if (!emitter.is_drawn) {
    return 0.0;
  }
  const double area_m2 = area_mm2(emitter.shape) * kM2PerMm2;
  const double radiance = static_cast<double>(emitter.radiance.mean());
  if (emitter.body < 0) {
    return radiance * area_m2;
  }
  const IesBody& body = bodies[static_cast<std::size_t>(emitter.body)];
  const Vector3d& s = body.size_mm;
  const double all_m2 = 2.0 * (s.x() * s.y() + s.y() * s.z() + s.z() * s.x()) * kM2PerMm2;
  return radiance * body.table.highest() * std::min(1.0, 2.0 * area_m2 / all_m2);
}

/// Where the ray enters the box, or infinity.
double entry_mm(const AlignedBox3d& box,
                const Vector3d& origin,
                const Vector3d& inverse,
                double max_mm) {
  const Vector3d low = (box.min() - origin).cwiseProduct(inverse);
  const Vector3d high = (box.max() - origin).cwiseProduct(inverse);
  const double enter = std::max(0.0, low.cwiseMin(high).maxCoeff());
  const double leave = std::min(max_mm, low.cwiseMax(high).minCoeff());
  return enter <= leave * (1.0 + 1e-14) ? enter : std::numeric_limits<double>::infinity();
}

/// Dividing by a component that is 0 must not give infinity times zero.
Vector3d inverse_of(const Vector3d& direction) {
  constexpr double kMin = 1e-200;
  return direction.unaryExpr(
      [](double d) { return 1.0 / (std::abs(d) < kMin ? std::copysign(kMin, d) : d); });
}

}  // namespace

LightTree::LightTree(const std::vector<Emitter>& emitters, const std::vector<IesBody>& bodies)
    : trails_(emitters.size(), 0) {
  std::vector<int> order;
  for (std::size_t i = 0; i < emitters.size(); ++i) {
    const Emitter& e = emitters[i];
    leaves_.push_back({.box_mm = padded(bounds_mm(e.shape)),
                       .cone = normal_cone(e.shape),
                       .intensity = axis_intensity(e, bodies),
                       .exponent = e.body < 0 ? e.exponent : 0.0,
                       .emitter = static_cast<int>(i)});
    order.push_back(static_cast<int>(i));
  }
  if (!order.empty()) {
    nodes_.reserve(2 * order.size());
    build(order, 0, order.size(), 0, 0);
  }
  leaves_ = {};
}

int LightTree::build(
    std::vector<int>& order, std::size_t begin, std::size_t end, std::uint64_t trail, int depth) {
  const auto leaf = [this](int i) -> const Node& { return leaves_[static_cast<std::size_t>(i)]; };
  const auto index = nodes_.size();
  if (end - begin == 1) {
    nodes_.push_back(leaf(order[begin]));
    trails_[static_cast<std::size_t>(order[begin])] = trail;
    return static_cast<int>(index);
  }
  nodes_.emplace_back();
  AlignedBox3d centres;
  for (std::size_t i = begin; i < end; ++i) {
    centres.extend(leaf(order[i]).box_mm.center());
  }
  Eigen::Index axis = 0;
  centres.diagonal().maxCoeff(&axis);
  const std::size_t middle = begin + (end - begin) / 2;
  const auto at = [&order](std::size_t i) {
    return order.begin() + static_cast<std::ptrdiff_t>(i);
  };
  std::nth_element(at(begin), at(middle), at(end), [&](int a, int b) {
    const double pa = leaf(a).box_mm.center()[axis];
    const double pb = leaf(b).box_mm.center()[axis];
    return pa != pb ? pa < pb : a < b;
  });
  const int left = build(order, begin, middle, trail, depth + 1);
  const int right = build(order, middle, end, trail | (std::uint64_t{1} << depth), depth + 1);
  const Node& a = nodes_[static_cast<std::size_t>(left)];
  const Node& b = nodes_[static_cast<std::size_t>(right)];
  nodes_[index] = {.box_mm = a.box_mm.merged(b.box_mm),
                   .cone = merged(a.cone, b.cone),
                   .intensity = a.intensity + b.intensity,
                   .exponent = std::min(a.exponent, b.exponent),
                   .right = right};
  return static_cast<int>(index);
}

double LightTree::importance(const std::vector<Emitter>& emitters,
                             const Node& node,
                             const Vector3d& point_mm) const {
  if (!(node.intensity > 0.0) ||
      (node.emitter >= 0 &&
       !shows_front(emitters[static_cast<std::size_t>(node.emitter)].shape, point_mm))) {
    return 0.0;
  }
  const Vector3d way = point_mm - node.box_mm.center();
  const double distance = way.norm();
  const double radius = 0.5 * node.box_mm.diagonal().norm();
  double cosine = 1.0;
  if (distance > radius) {
    const double angle = angle_rad(node.cone.axis, way / distance) - node.cone.half_angle_rad -
                         std::asin(radius / distance);
    cosine = std::cos(std::clamp(angle, 0.0, kPi));
  }
  if (cosine <= 0.0) {
    return 0.0;
  }
  const double reach = std::max(distance, radius);
  const double lobe = node.exponent == 1.0   ? cosine
                      : node.exponent == 0.0 ? 1.0
                                             : std::pow(cosine, node.exponent);
  return node.intensity * lobe / (reach * reach);
}

std::optional<LightTree::Choice> LightTree::choose_of_few(const std::vector<Emitter>& emitters,
                                                          const Vector3d& point_mm,
                                                          double u) const {
  std::array<double, kFewNodes> weights = {};
  double sum = 0.0;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    weights[i] = nodes_[i].emitter >= 0 ? importance(emitters, nodes_[i], point_mm) : 0.0;
    sum += weights[i];
  }
  if (!(sum > 0.0)) {
    return std::nullopt;
  }
  // Rounding may carry u beyond the last weight: then the last that is not zero is taken.
  Choice choice;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const double share = weights[i] / sum;
    if (share > 0.0) {
      choice = {.emitter = nodes_[i].emitter,
                .probability = share,
                .u = std::clamp(u / share, 0.0, 1.0 - 1e-16)};
      if (u < share) {
        break;
      }
    }
    u -= share;
  }
  return choice;
}

double LightTree::probability_of_few(const std::vector<Emitter>& emitters,
                                     const Vector3d& point_mm,
                                     int emitter) const {
  double sum = 0.0;
  double wanted = 0.0;
  for (const Node& node : nodes_) {
    const double weight = node.emitter >= 0 ? importance(emitters, node, point_mm) : 0.0;
    sum += weight;
    wanted = node.emitter == emitter ? weight : wanted;
  }
  return sum > 0.0 ? wanted / sum : 0.0;
}

std::optional<LightTree::Choice> LightTree::choose(const std::vector<Emitter>& emitters,
                                                   const Vector3d& point_mm,
                                                   double u) const {
  if (nodes_.size() <= kFewNodes) {
    return choose_of_few(emitters, point_mm, u);
  }
  if (!(importance(emitters, nodes_[0], point_mm) > 0.0)) {
    return std::nullopt;
  }
  std::size_t at = 0;
  double probability = 1.0;
  while (nodes_[at].emitter < 0) {
    const auto right = static_cast<std::size_t>(nodes_[at].right);
    const double of_left = importance(emitters, nodes_[at + 1], point_mm);
    const double sum = of_left + importance(emitters, nodes_[right], point_mm);
    if (!(sum > 0.0)) {
      return std::nullopt;
    }
    const double share = of_left / sum;
    const bool is_left = u < share;
    probability *= is_left ? share : 1.0 - share;
    u = is_left ? u / share : (u - share) / (1.0 - share);
    u = std::min(u, 1.0 - 1e-16);
    at = is_left ? at + 1 : right;
  }
  return Choice{.emitter = nodes_[at].emitter, .probability = probability, .u = u};
}

double LightTree::probability(const std::vector<Emitter>& emitters,
                              const Vector3d& point_mm,
                              int emitter) const {
  if (nodes_.size() <= kFewNodes) {
    return probability_of_few(emitters, point_mm, emitter);
  }
  if (!(importance(emitters, nodes_[0], point_mm) > 0.0)) {
    return 0.0;
  }
  std::uint64_t trail = trails_[static_cast<std::size_t>(emitter)];
  std::size_t at = 0;
  double probability = 1.0;
  for (; nodes_[at].emitter < 0; trail >>= 1) {
    const auto right = static_cast<std::size_t>(nodes_[at].right);
    const double of_left = importance(emitters, nodes_[at + 1], point_mm);
    const double sum = of_left + importance(emitters, nodes_[right], point_mm);
    if (!(sum > 0.0)) {
      return 0.0;
    }
    const bool is_right = (trail & 1) != 0;
    probability *= is_right ? 1.0 - of_left / sum : of_left / sum;
    at = is_right ? right : at + 1;
  }
  return probability;
}

double LightTree::estimate_w_m2(const std::vector<Emitter>& emitters,
                                const Vector3d& point_mm) const {
  return nodes_.empty() ? 0.0 : importance(emitters, nodes_[0], point_mm) / kM2PerMm2;
}

std::optional<LightTree::Hit> LightTree::hit(const std::vector<Emitter>& emitters,
                                             const Ray& ray,
                                             double max_mm) const {
  std::optional<Hit> best;
  if (nodes_.empty()) {
    return best;
  }
  const Vector3d inverse = inverse_of(ray.direction);
  std::array<std::size_t, 2 * kMaxDepth> stack = {};
  std::size_t size = 1;
  while (size > 0) {
    const std::size_t at = stack[--size];
    const Node& node = nodes_[at];
    if (!std::isfinite(entry_mm(node.box_mm, ray.origin_mm, inverse, max_mm))) {
      continue;
    }
    if (node.emitter < 0) {
      stack[size++] = static_cast<std::size_t>(node.right);
      stack[size++] = at + 1;
      continue;
    }
    const Emitter& emitter = emitters[static_cast<std::size_t>(node.emitter)];
    if (const auto crossing = cross(emitter.shape, ray, max_mm, !emitter.is_solid)) {
      max_mm = crossing->distance_mm;
      best = Hit{.emitter = node.emitter, .crossing = *crossing};
    }
  }
  return best;
}

}  // namespace glint
