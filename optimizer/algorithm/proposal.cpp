// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/algorithm/proposal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

namespace glint {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kProposedGlobal = 120;
constexpr int kProposedLocal = 120;
constexpr int kNumMixed = 60;
constexpr int kProposedRefined = 40;

constexpr std::size_t kNumClimbs = 6;
constexpr int kNumSteps = 16;
/// Between starts of climbs, as a part of the cube's diagonal.
constexpr double kApart = 0.05;
/// How far a climb goes from its start when the reach is near.
constexpr double kNear = 0.1;
constexpr double kFirstAscent = 0.04;
constexpr double kLongestStep = 0.25;
constexpr double kLonger = 1.3;
constexpr double kShorter = 0.5;
/// Parts of ExactScores::max_candidates.
constexpr double kAllOfThem = 1.0;
constexpr double kShareOfRefined = 0.35;

struct Scored {
  Point point;
  double score = 0.0;
  std::vector<double> exact = {};  ///< ExactValues::at(); empty: there are none
};

class Proposer {
 public:
  Proposer(const ProposalTask& task, Reach reach, Rng& rng)
      : space_(task.space),
        promise_(task.promise),
        encoding_(task.encoding),
        asked_(task.asked),
        exact_(task.exact),
        reach_(reach),
        rng_(rng) {}

  std::optional<Point> best(const std::vector<Point>& known) {
    consider(candidates(known), kAllOfThem);
    if (found_.empty()) {
      return std::nullopt;
    }
    consider(climbed(starts()), kShareOfRefined);
    if (!std::ranges::all_of(space_.variables, is_smooth)) {
      for (const double width : kRefinedWidths) {
        std::vector<Point> points;
        for (int i = 0; i < kProposedRefined; ++i) {
          points.push_back(neighbour(space_, top().point, width, false, rng_));
        }
        consider(std::move(points), kShareOfRefined);
      }
    }
    return top().point;
  }

 private:
  static bool is_smooth(const Variable& variable) {
    return is_continuous(variable) && variable.step == 0.0;
  }

  const Scored& top() const { return *std::ranges::max_element(found_, {}, &Scored::score); }

  std::vector<Point> candidates(const std::vector<Point>& known) {
    std::vector<Point> points;
    std::vector<double> unit(space_.variables.size());
    for (int i = 0; i < kProposedGlobal && reach_ == Reach::kEverywhere; ++i) {
      for (double& value : unit) {
        value = rng_.uniform();
      }
      points.push_back(point_from_unit(space_, unit));
    }
    const std::vector<std::size_t>& centers = promise_.best_points();
    for (int i = 0; i < kProposedLocal; ++i) {
      // Evenly over the front, whatever its size.
      const std::size_t at =
          static_cast<std::size_t>(i / 2) * centers.size() / (kProposedLocal / 2);
      const double width = kLocalWidths[static_cast<std::size_t>(i % 2)];
      points.push_back(neighbour(space_, known[centers[at]], width, true, rng_));
    }
    for (int i = 0; i < kNumMixed; ++i) {
      const std::size_t at = static_cast<std::size_t>(i) * centers.size() / kNumMixed;
      points.push_back(mixed(known[centers[at]]));
    }
    return points;
  }

  /// One or some coordinates drawn anew.
  Point mixed(const Point& point) {
    std::vector<double> unit = unit_from_point(space_, point);
    const auto count = static_cast<double>(unit.size());
    const auto always = static_cast<std::size_t>(rng_.uniform() * count);
    for (std::size_t i = 0; i < unit.size(); ++i) {
      const bool is_drawn = rng_.uniform() < 1.0 / count;
      const double anew = rng_.uniform();
      unit[i] = i == always || is_drawn ? anew : unit[i];
    }
    return point_from_unit(space_, unit);
  }

  /// @param share  of the candidates that exact values may be told of
  void consider(std::vector<Point> points, double share) {
    std::erase_if(points, [this](const Point& point) { return asked_.contains(point); });
    if (points.empty()) {
      return;
    }
    const VectorXd scores = promise_.scores(encoding_.rows(points));
    if (exact_ != nullptr) {
      consider_exactly(std::move(points), scores, share);
      return;
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      found_.push_back({std::move(points[i]), scores[static_cast<Index>(i)]});
    }
  }

  /// Those of them that promise most by the models alone.
  void consider_exactly(std::vector<Point> points, const VectorXd& scores, double share) {
    const std::vector<std::size_t> order =
        descending(points.size(), [&](std::size_t i) { return scores[static_cast<Index>(i)]; });
    const double room = std::ceil(share * exact_->max_candidates());
    const std::size_t count = std::min(points.size(), static_cast<std::size_t>(room));
    std::vector<Scored> kept;
    std::vector<Point> chosen;
    for (std::size_t i = 0; i < count; ++i) {
      chosen.push_back(std::move(points[order[i]]));
      kept.push_back({.point = chosen.back(), .exact = exact_->at(chosen.back())});
    }
    const VectorXd exactly = promise_.scores_knowing(encoding_.rows(chosen), exact_of(kept));
    for (std::size_t i = 0; i < count; ++i) {
      kept[i].score = exactly[static_cast<Index>(i)];
      found_.push_back(std::move(kept[i]));
    }
  }

  /// One row each; no columns where nothing is exact.
  static MatrixXd exact_of(const std::vector<Scored>& scored) {
    const std::size_t columns = scored.empty() ? 0 : scored.front().exact.size();
    MatrixXd exact(static_cast<Index>(scored.size()), static_cast<Index>(columns));
    for (std::size_t i = 0; i < scored.size(); ++i) {
      for (std::size_t k = 0; k < columns; ++k) {
        exact(static_cast<Index>(i), static_cast<Index>(k)) = scored[i].exact[k];
      }
    }
    return exact;
  }

  /// Indices by falling scores; of equal ones the earlier first.
  template <class Score>
  static std::vector<std::size_t> descending(std::size_t count, const Score& score) {
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::ranges::greater(), score);
    return order;
  }

  /// The best that lie apart; of equal ones the earlier.
  std::vector<Scored> starts() const {
    const std::vector<std::size_t> order =
        descending(found_.size(), [this](std::size_t i) { return found_[i].score; });
    const double apart = kApart * std::sqrt(static_cast<double>(space_.variables.size()));
    std::vector<Scored> starts;
    MatrixXd rows(0, encoding_.num_columns() + 1);
    for (const std::size_t i : order) {
      const Eigen::RowVectorXd row = encoding_.row(found_[i].point);
      const bool is_near =
          rows.rows() > 0 && (rows.rowwise() - row).rowwise().norm().minCoeff() < apart;
      if (starts.size() < kNumClimbs && !is_near) {
        starts.push_back(found_[i]);
        rows.conservativeResize(rows.rows() + 1, Eigen::NoChange);
        rows.row(rows.rows() - 1) = row;
      }
    }
    return starts;
  }

  /// 1 where a column of a row may climb, else 0.
  MatrixXd movable(const std::vector<Point>& points) const {
    MatrixXd mask = MatrixXd::Zero(static_cast<Index>(points.size()), encoding_.num_columns());
    for (Index c = 0; c < mask.cols(); ++c) {
      const std::size_t variable = encoding_.columns()[static_cast<std::size_t>(c)].variable;
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (is_continuous(space_.variables[variable]) && is_active(space_, points[i], variable)) {
          mask(static_cast<Index>(i), c) = 1.0;
        }
      }
    }
    return mask;
  }

  std::vector<Point> climbed(const std::vector<Scored>& starts) const {
    std::vector<Point> from;
    std::ranges::transform(starts, std::back_inserter(from), &Scored::point);
    const MatrixXd mask = movable(from);
    MatrixXd rows = encoding_.rows(from);
    const MatrixXd shifts = promise_.shifts(rows, exact_of(starts));
    MatrixXd best_rows = rows;
    const double reach = reach_ == Reach::kEverywhere ? 1.0 : kNear;
    const MatrixXd low = (rows.array() - reach).max(0.0).matrix();
    const MatrixXd high = (rows.array() + reach).min(1.0).matrix();
    VectorXd best = VectorXd::Constant(rows.rows(), -std::numeric_limits<double>::infinity());
    MatrixXd steps = kFirstAscent * mask;
    MatrixXd before = MatrixXd::Zero(mask.rows(), mask.cols());
    for (int step = 0; step < kNumSteps; ++step) {
      MatrixXd derivatives;
      const VectorXd scores = promise_.scores(rows, shifts, derivatives);
      for (Index i = 0; i < rows.rows(); ++i) {
        if (scores[i] > best[i]) {
          best[i] = scores[i];
          best_rows.row(i) = rows.row(i);
        }
        for (Index c = 0; c < mask.cols(); ++c) {
          const double turn = derivatives(i, c) * before(i, c);
          if (turn < 0.0) {
            steps(i, c) *= kShorter;
            derivatives(i, c) = 0.0;
          } else if (turn > 0.0) {
            steps(i, c) = std::min(kLongestStep * mask(i, c), kLonger * steps(i, c));
          }
          const double sign = derivatives(i, c) > 0.0 ? 1.0 : derivatives(i, c) < 0.0 ? -1.0 : 0.0;
          if (mask(i, c) > 0.0) {
            const double next = rows(i, c) + sign * steps(i, c);
            rows(i, c) = std::clamp(next, low(i, c), high(i, c));
          }
          before(i, c) = derivatives(i, c);
        }
      }
    }
    std::vector<Point> points;
    for (std::size_t i = 0; i < starts.size(); ++i) {
      points.push_back(
          moved(from[i], best_rows.row(static_cast<Index>(i)), mask.row(static_cast<Index>(i))));
    }
    return points;
  }

  Point moved(const Point& start,
              const Eigen::RowVectorXd& row,
              const Eigen::RowVectorXd& mask) const {
    std::vector<double> unit = unit_from_point(space_, start);
    for (Index c = 0; c < mask.size(); ++c) {
      if (mask[c] > 0.0) {
        unit[encoding_.columns()[static_cast<std::size_t>(c)].variable] = row[c];
      }
    }
    return point_from_unit(space_, unit);
  }

  const SearchSpace& space_;
  const Promise& promise_;
  const Encoding& encoding_;
  const std::set<Point>& asked_;
  const ExactValues* exact_;
  Reach reach_;
  Rng& rng_;
  std::vector<Scored> found_;
};

}  // namespace

Point neighbour(
    const SearchSpace& space, const Point& point, double width, bool is_sparse, Rng& rng) {
  std::vector<double> unit = unit_from_point(space, point);
  const double rate = std::max(0.3, 4.0 / static_cast<double>(unit.size()));
  for (std::size_t i = 0; i < unit.size(); ++i) {
    const bool is_moved = !is_sparse || rng.uniform() < rate;
    const bool is_choice = space.variables[i].kind == Variable::Kind::kChoice;
    const double step = width * rng.normal();
    const double anew = rng.uniform();
    if (is_choice) {
      unit[i] = is_moved && rng.uniform() < 0.3 ? anew : unit[i];
    } else if (is_moved) {
      const double cell = 1.0 / num_values(space.variables[i]);
      unit[i] = std::clamp(unit[i] + step * std::max(1.0, cell / width), 0.0, 1.0);
    }
  }
  return point_from_unit(space, unit);
}

std::optional<Point> propose(const ProposalTask& task, Reach reach, Rng& rng) {
  return Proposer(task, reach, rng).best(task.known);
}

}  // namespace glint
