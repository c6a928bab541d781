// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/planning/tour.h"

#include <algorithm>
#include <limits>

namespace glint {
namespace {

constexpr double kGain = 1e-9;  ///< less is rounding

using Tour = std::vector<std::size_t>;

double between(const Eigen::MatrixXd& costs, std::size_t a, std::size_t b) {
  return costs(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
}

Tour nearest_neighbour(const Eigen::MatrixXd& costs) {
  Tour tour;
  const auto count = static_cast<std::size_t>(costs.rows());
  std::vector<bool> is_visited(count, false);
  std::size_t at = 0;
  for (std::size_t step = 1; step < count; ++step) {
    std::size_t next = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < count; ++i) {
      if (!is_visited[i] && between(costs, at, i) < least) {
        least = between(costs, at, i);
        next = i;
      }
    }
    is_visited[next] = true;
    tour.push_back(next);
    at = next;
  }
  return tour;
}

/// The stop at a place of the tour; the start before the first and after the last.
std::size_t stop_at(const Tour& tour, std::size_t place) {
  return place == 0 || place > tour.size() ? 0 : tour[place - 1];
}

/// Turns a piece of the tour around where that shortens it.
bool exchange_two(const Eigen::MatrixXd& costs, Tour& tour) {
  for (std::size_t i = 1; i < tour.size(); ++i) {
    for (std::size_t k = i + 1; k <= tour.size(); ++k) {
      const std::size_t before = stop_at(tour, i - 1);
      const std::size_t first = stop_at(tour, i);
      const std::size_t last = stop_at(tour, k);
      const std::size_t after = stop_at(tour, k + 1);
      const double gain = between(costs, before, first) + between(costs, last, after) -
                          between(costs, before, last) - between(costs, first, after);
      if (gain > kGain) {
        const auto begin = tour.begin() + static_cast<std::ptrdiff_t>(i) - 1;
        std::reverse(begin, tour.begin() + static_cast<std::ptrdiff_t>(k));
        return true;
      }
    }
  }
  return false;
}

/// Puts one stop elsewhere where that shortens the tour.
bool move_one(const Eigen::MatrixXd& costs, Tour& tour) {
  const double whole = tour_cost(costs, tour);
  for (std::size_t i = 0; i < tour.size(); ++i) {
    Tour rest = tour;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
    const double without = tour_cost(costs, rest);
    for (std::size_t place = 0; place <= rest.size(); ++place) {
      const std::size_t before = stop_at(rest, place);
      const std::size_t after = stop_at(rest, place + 1);
      const double with = without + between(costs, before, tour[i]) +
                          between(costs, tour[i], after) - between(costs, before, after);
      if (with < whole - kGain) {
        rest.insert(rest.begin() + static_cast<std::ptrdiff_t>(place), tour[i]);
        tour = std::move(rest);
        return true;
      }
    }
  }
  return false;
}

}  // namespace

double tour_cost(const Eigen::MatrixXd& costs, const std::vector<std::size_t>& order) {
  double sum = 0.0;
  for (std::size_t place = 0; place <= order.size(); ++place) {
    sum += between(costs, stop_at(order, place), stop_at(order, place + 1));
  }
  return sum;
}

std::vector<std::size_t> short_tour(const Eigen::MatrixXd& costs) {
  Tour tour = nearest_neighbour(costs);
  while (exchange_two(costs, tour) || move_one(costs, tour)) {
  }
  return tour;
}

std::vector<std::size_t> cheapest_choices(
    const std::vector<std::size_t>& counts,
    const std::function<double(std::size_t i, std::size_t a, std::size_t b)>& cost) {
  std::vector<std::vector<std::size_t>> cheapest_before(counts.size() + 1);
  std::vector<double> sums = {0.0};
  for (std::size_t i = 0; i <= counts.size(); ++i) {
    const std::size_t count = i < counts.size() ? counts[i] : 1;
    std::vector<double> next(count, std::numeric_limits<double>::infinity());
    cheapest_before[i].assign(count, 0);
    for (std::size_t b = 0; b < count; ++b) {
      for (std::size_t a = 0; a < sums.size(); ++a) {
        const double sum = sums[a] + cost(i, a, b);
        if (sum < next[b]) {
          next[b] = sum;
          cheapest_before[i][b] = a;
        }
      }
    }
    sums = std::move(next);
  }
  std::vector<std::size_t> choices(counts.size());
  std::size_t at = 0;
  for (std::size_t i = counts.size(); i-- > 0;) {
    at = cheapest_before[i + 1][at];
    choices[i] = at;
  }
  return choices;
}

}  // namespace glint
