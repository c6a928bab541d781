// SPDX-License-Identifier: GPL-3.0-or-later
//
// The order of visits: a short round trip, and which of several joints to take at each stop.
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

namespace glint {

/// A short round trip from 0 over all others back to 0: nearest neighbour, then exchanges of two
/// connections and moves of single stops until none shortens it. Within some per cent of the
/// shortest for tens of stops.
///
/// Source: D. S. Johnson and L. A. McGeoch, "The traveling salesman problem: a case study in local
/// optimization", 1997.
/// @param costs  n x n, symmetric, >= 0, finite
/// @return 1 to n - 1 in the order of the visits
std::vector<std::size_t> short_tour(const Eigen::MatrixXd& costs);

/// Length of the round trip.
double tour_cost(const Eigen::MatrixXd& costs, const std::vector<std::size_t>& order);

/// Which choice to take at each stop of a round trip whose order is given, so that the sum of costs
/// is the smallest (dynamic programming over the stops).
/// @param counts  choices of each stop, >= 1
/// @param cost    from choice a of stop i - 1 to choice b of stop i; i = 0 and i = counts.size()
///                are the start and the way back, whose other end has one choice, 0
std::vector<std::size_t> cheapest_choices(
    const std::vector<std::size_t>& counts,
    const std::function<double(std::size_t i, std::size_t a, std::size_t b)>& cost);

}  // namespace glint
