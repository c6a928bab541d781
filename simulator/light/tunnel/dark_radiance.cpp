// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/tunnel/dark_radiance.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace glint {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

/// Pieces of half a cross-section.
constexpr int kPieces = 96;

/// Points at equal distances along a polyline, its ends among them.
std::vector<Vector2d> spread_along(const std::vector<Vector2d>& line, int pieces) {
  std::vector<double> way = {0.0};
  for (std::size_t i = 1; i < line.size(); ++i) {
    way.push_back(way.back() + (line[i] - line[i - 1]).norm());
  }
  std::vector<Vector2d> points;
  std::size_t i = 1;
  for (int k = 0; k <= pieces; ++k) {
    const double wanted = way.back() * k / pieces;
    while (i + 1 < way.size() && way[i] < wanted) {
      ++i;
    }
    const double length = way[i] - way[i - 1];
    const double t = length > 0.0 ? std::min(1.0, (wanted - way[i - 1]) / length) : 0.0;
    points.emplace_back(line[i - 1] + t * (line[i] - line[i - 1]));
  }
  return points;
}

/// What a place of the wall sees to one side of it. The wall is met piece after piece, each at a
/// larger angle from the tangent than all before unless those hide it: nothing else can, as every
/// line from the middle of the base meets the wall once.
class SideView {
 public:
  SideView(const Vector2d& eye, const Vector2d& tangent, const Vector2d& normal)
      : eye_(eye), tangent_(tangent), normal_(normal) {}

  /// Goes on to where the next piece ends. @return the view factor to that piece
  double next(const Vector2d& end) {
    const Vector2d way = end - eye_;
    const double ahead = tangent_.dot(way);
    const double cosine = normal_.dot(way) >= 0.0 ? ahead / way.norm() : std::copysign(1.0, ahead);
    const double seen = std::max(0.0, lowest_ - cosine);
    lowest_ = std::min(lowest_, cosine);
    return 0.5 * seen;
  }

 private:
  Vector2d eye_, tangent_, normal_;
  double lowest_ = 1.0;  ///< cosine to the tangent of what was met so far
};

/// View factors from the middles of the pieces of one half to those of both halves together.
/// @param ends  of the pieces at y <= 0, from the rim on
MatrixXd view_factors(const std::vector<Vector2d>& ends) {
  const auto mirrored = [](const Vector2d& p) { return Vector2d(-p.x(), p.y()); };
  const int count = static_cast<int>(ends.size()) - 1;
  const auto end = [&](int i) { return ends[static_cast<std::size_t>(i)]; };
  MatrixXd factors = MatrixXd::Zero(count, count);
  for (int i = 0; i < count; ++i) {
    const Vector2d tangent = (end(i + 1) - end(i)).normalized();
    const Vector2d inwards(tangent.y(), -tangent.x());
    const Vector2d eye = 0.5 * (end(i) + end(i + 1));
    SideView back(eye, -tangent, inwards);
    back.next(end(i));
    for (int k = i - 1; k >= 0; --k) {
      factors(i, k) += back.next(end(k));
    }
    SideView ahead(eye, tangent, inwards);
    ahead.next(end(i + 1));
    for (int k = i + 1; k < count; ++k) {
      factors(i, k) += ahead.next(end(k + 1));
    }
    ahead.next(mirrored(end(count)));  // across the slot
    for (int k = count - 1; k >= 0; --k) {
      factors(i, k) += ahead.next(mirrored(end(k)));
    }
  }
  return factors;
}

/// The table's piece; 0 for a place that is none (a hit that no ray had).
int piece_of(const DarkRadiance::Place& place) {
  const double node = place.at * (DarkRadiance::kNodes - 1);
  return node > 0.0 ? std::min(static_cast<int>(node), DarkRadiance::kNodes - 2) : 0;
}

/// Between the given places, and straight on for half of the last distance beyond them.
double value_at(const std::vector<double>& places, const std::vector<double>& values, double at) {
  const std::size_t last = places.size() - 1;
  const double low = 1.5 * places[0] - 0.5 * places[1];
  const double high = 1.5 * places[last] - 0.5 * places[last - 1];
  const double c = std::clamp(at, low, high);
  const auto after = std::upper_bound(places.begin() + 1, places.end() - 1, c);
  const auto i = static_cast<std::size_t>(after - places.begin());
  const double step = places[i] - places[i - 1];
  const double t = step > 0.0 ? (c - places[i - 1]) / step : 0.0;
  return std::max(0.0, values[i - 1] + t * (values[i] - values[i - 1]));
}

}  // namespace

DarkRadiance::DarkRadiance(const TunnelSettings& settings,
                           const std::vector<Vector2d>& half_yz_mm,
                           double panel_mm,
                           bool touch)
    : panel_mm_(panel_mm) {
  if (half_yz_mm.size() < 2 || (half_yz_mm.back() - half_yz_mm.front()).norm() < 1e-9) {
    return;
  }
  const double foot_y_mm = std::abs(half_yz_mm.front().x());
  const double rise_y_mm = std::abs(half_yz_mm.back().x()) - foot_y_mm;
  const std::vector<Vector2d> ends = spread_along(half_yz_mm, kPieces);
  const MatrixXd factors = view_factors(ends);
  const double fed = settings.dark_reflectance * (1.0 - settings.duty);
  const MatrixXd system = MatrixXd::Identity(kPieces, kPieces) - fed * factors;
  const VectorXd first = settings.dark_reflectance * settings.duty * factors.rowwise().sum();
  const VectorXd dark = system.partialPivLu().solve(first);
  view_factor_ = factors.sum() / kPieces;
  mean_ = lowest_ = highest_ = dark.mean();
  if (std::max(dark.maxCoeff() - mean_, mean_ - dark.minCoeff()) <= kEven) {
    return;
  }
  if (panel_mm_ > 0.0) {
    const double length_mm = (half_yz_mm.back() - half_yz_mm.front()).norm();
    const double by_mm = rise_y_mm / length_mm;
    leans_ = !touch && std::abs(by_mm) > 1e-9;
    table_mm_ = std::exp2(std::ceil(std::log2(touch ? panel_mm_ : 0.5 * panel_mm_)));
    middle_y_mm_ = foot_y_mm + 0.5 * panel_mm_ * by_mm;
  }
  std::vector<double> along;
  for (int i = 0; i < kPieces; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Vector2d middle = 0.5 * (ends[k] + ends[k + 1]);
    const double margin_mm = middle.y() - settings.base_mm;
    along.push_back(panel_mm_ > 0.0 ? (middle - half_yz_mm.front()).norm()
                                    : margin_mm / (std::abs(middle.x()) + margin_mm));
  }
  tabulate(along, {dark.data(), dark.data() + kPieces});
}

void DarkRadiance::tabulate(const std::vector<double>& along, const std::vector<double>& dark) {
  for (int part = 0; part <= (leans_ ? 1 : 0); ++part) {
    for (int k = 0; k < kNodes; ++k) {
      const double at = static_cast<double>(k) / (kNodes - 1);
      const double from_end = panel_mm_ > 0.0 ? at * table_mm_ : at;
      nodes_.push_back(value_at(along, dark, part == 0 ? from_end : panel_mm_ - from_end));
    }
  }
  const auto [low, high] = std::ranges::minmax(nodes_);
  lowest_ = low;
  highest_ = high;
}

DarkRadiance::Place DarkRadiance::place_of(double y_mm, double margin_mm) const {
  const double y = std::abs(y_mm);
  if (panel_mm_ > 0.0) {
    const bool is_upper = leans_ && y < middle_y_mm_;
    const double at = margin_mm / table_mm_;
    const bool is_inside = at > 0.0 && at < 1.0;
    return {.part = is_upper ? 1 : 0,
            .at = std::clamp(at, 0.0, 1.0),
            .by_margin = is_inside ? 1.0 / table_mm_ : 0.0};
  }
  if (!(margin_mm > 0.0)) {
    return {};
  }
  const double sum = y + margin_mm;
  return {.at = margin_mm / sum, .by_y = -margin_mm / (sum * sum), .by_margin = y / (sum * sum)};
}

/// Catmull and Rom's cubic through four nodes. Beyond the rim and a panel's end it goes straight
/// on; beyond the top of a curve it is mirrored, so that there is no bend in the middle.
DarkRadiance::Stencil DarkRadiance::stencil_of(const Place& place) const {
  const int i = piece_of(place);
  const double t = place.at * (kNodes - 1) - i;
  const double t2 = t * t;
  const double t3 = t2 * t;
  Stencil s;
  s.weight = {0.5 * (-t + 2.0 * t2 - t3),
              0.5 * (2.0 - 5.0 * t2 + 3.0 * t3),
              0.5 * (t + 4.0 * t2 - 3.0 * t3),
              0.5 * (t3 - t2)};
  s.slope = {0.5 * (-1.0 + 4.0 * t - 3.0 * t2),
             0.5 * (-10.0 * t + 9.0 * t2),
             0.5 * (1.0 + 8.0 * t - 9.0 * t2),
             0.5 * (3.0 * t2 - 2.0 * t)};
  for (int k = 0; k < 4; ++k) {
    const int node = std::clamp(i - 1 + k, 0, kNodes - 1);
    s.node[static_cast<std::size_t>(k)] = static_cast<std::size_t>(place.part * kNodes + node);
  }
  for (auto* w : {&s.weight, &s.slope}) {
    auto& [before, from, to, after] = *w;
    if (i == 0) {
      from += 2.0 * before;
      to -= before;
      before = 0.0;
    }
    if (i == kNodes - 2) {
      from += panel_mm_ > 0.0 ? -after : after;
      to += panel_mm_ > 0.0 ? 2.0 * after : 0.0;
      after = 0.0;
    }
    for (double& weight : *w) {
      weight *= w == &s.slope ? kNodes - 1 : 1;
    }
  }
  return s;
}

double DarkRadiance::at(const Place& place) const {
  if (is_even()) {
    return mean_;
  }
  const Stencil s = stencil_of(place);
  double sum = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    sum += s.weight[k] * nodes_[s.node[k]];
  }
  return sum;
}

double DarkRadiance::slope_at(const Place& place) const {
  if (is_even()) {
    return 0.0;
  }
  const Stencil s = stencil_of(place);
  double sum = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    sum += s.slope[k] * nodes_[s.node[k]];
  }
  return sum;
}

void DarkRadiance::add_gradient(const Place& place,
                                double factor,
                                std::span<double> by_nodes) const {
  if (is_even()) {
    return;
  }
  const Stencil s = stencil_of(place);
  for (std::size_t k = 0; k < 4; ++k) {
    by_nodes[s.node[k]] += factor * s.weight[k];
  }
}

double DarkRadiance::at_node_of(const DarkRadiance& other, int node) const {
  Place place = {.part = node / kNodes, .at = static_cast<double>(node % kNodes) / (kNodes - 1)};
  if (panel_mm_ > 0.0) {
    place.at = std::min(1.0, place.at * other.table_mm_ / table_mm_);
  }
  if (leans_ && !other.leans_) {  // upright panels see the same from both of their ends
    return 0.5 * (at(place) + at({.part = 1, .at = place.at}));
  }
  place.part = leans_ ? place.part : 0;
  return at(place);
}

}  // namespace glint
