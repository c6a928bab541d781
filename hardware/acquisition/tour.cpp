// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/acquisition/tour.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

namespace glint {
namespace {

struct Nearest {
  double share = 0.0;  ///< of the leg
  double off_rad = 0.0;
};

/// The place of a leg that is nearest by the sum of squares.
Nearest nearest_on_leg(const JointVector& from, const JointVector& to, const JointVector& joints) {
  const JointVector way = to - from;
  const double length2 = way.squaredNorm();
  const double share =
      length2 > 0.0 ? std::clamp((joints - from).dot(way) / length2, 0.0, 1.0) : 0.0;
  return {.share = share, .off_rad = (joints - from - share * way).cwiseAbs().maxCoeff()};
}

std::size_t difference(std::size_t a, std::size_t b) {
  return a > b ? a - b : b - a;
}

std::string name_of_point(const Tour& tour, std::size_t point) {
  const std::string& name = tour[point].name;
  return name.empty() ? fmt::format("point {} of the way", point + 1) : name;
}

}  // namespace

std::optional<TourPlace> place_on(const Tour& tour,
                                  const JointVector& joints_rad,
                                  std::size_t near) {
  std::optional<TourPlace> best;
  const auto offer = [&](const TourPlace& place) {
    const bool is_better = !best || (place.is_point && !best->is_point) ||
                           (place.is_point == best->is_point &&
                            difference(place.leg, near) < difference(best->leg, near));
    if (place.off_rad <= kOnTourRad && is_better) {
      best = place;
    }
  };
  for (std::size_t i = 0; i < tour.size(); ++i) {
    const double off_rad = (joints_rad - tour[i].joints_rad).cwiseAbs().maxCoeff();
    offer({.leg = i, .is_point = true, .off_rad = off_rad});
    if (i + 1 < tour.size()) {
      const Nearest nearest =
          nearest_on_leg(tour[i].joints_rad, tour[i + 1].joints_rad, joints_rad);
      offer({.leg = i, .is_point = false, .off_rad = nearest.off_rad});
    }
  }
  return best;
}

double distance_from_tour_rad(const Tour& tour, const JointVector& joints_rad) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < tour.size(); ++i) {
    const std::size_t next = std::min(i + 1, tour.size() - 1);
    least = std::min(least,
                     nearest_on_leg(tour[i].joints_rad, tour[next].joints_rad, joints_rad).off_rad);
  }
  return least;
}

std::vector<std::size_t> way_to(const TourPlace& place, std::size_t goal) {
  std::vector<std::size_t> way;
  std::size_t at = place.leg;
  if (!place.is_point) {
    at = goal > place.leg ? place.leg + 1 : place.leg;
    way.push_back(at);
    if (at == goal && goal > place.leg) {
      return way;
    }
  }
  // Back to the point before the goal, then forwards.
  for (; at > 0 && at + 1 > goal; --at) {
    way.push_back(at - 1);
  }
  for (; at < goal; ++at) {
    way.push_back(at + 1);
  }
  return way;
}

std::vector<std::size_t> way_back(const Tour& tour, const TourPlace& place) {
  std::vector<std::size_t> way;
  if (place.is_point && tour[place.leg].is_safe) {
    return way;
  }
  for (std::size_t i = place.is_point ? place.leg : place.leg + 1; i > 0; --i) {
    way.push_back(i - 1);
    if (tour[i - 1].is_safe) {
      break;
    }
  }
  return way;
}

std::vector<std::size_t> way_to_safe_point(const Tour& tour, const TourPlace& place) {
  const std::vector<std::size_t> back = way_back(tour, place);
  std::vector<std::size_t> on;
  for (std::size_t i = place.leg + 1; i < tour.size() && on.size() < back.size(); ++i) {
    on.push_back(i);
    if (tour[i].is_safe) {
      return on;
    }
  }
  return back;
}

std::string place_text(const Tour& tour, const TourPlace& place) {
  if (place.is_point) {
    return name_of_point(tour, place.leg);
  }
  return fmt::format(
      "between {} and {}", name_of_point(tour, place.leg), name_of_point(tour, place.leg + 1));
}

}  // namespace glint
