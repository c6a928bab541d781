// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/grey_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <Eigen/Cholesky>

#include "studies/validate/grey_model.h"

namespace glint {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using validate_detail::GreyColumns;
using validate_detail::GreyModel;

constexpr Index kLeastPixels = 200;
constexpr double kPixelsAlike = 10.0;    ///< neighbours tell about the same
constexpr double kPrice = 14.0;          ///< 3.7 standard deviations for each number
constexpr double kFloor = 0.003;         ///< of the mean grey: no model is better
constexpr double kStepMm = 1.0;          ///< of the differences by place
constexpr double kStepRoughness = 0.05;  ///< and by the logarithm of roughness
constexpr double kLongestStepMm = 15.0;
constexpr double kLongestStepRoughness = 0.4;
constexpr int kRounds = 4;
constexpr double kSettledMm = 0.2;
constexpr double kHuber = 2.5;
constexpr double kLeastPower = -1.0;  ///< of a segment against nominal: dark

/// Where a fit stands.
struct State {
  double exposure = 1.0;
  VectorXd segments;             ///< power of each minus 1
  std::vector<Vector3d> places;  ///< of each light
  double roughness = 0.0;        ///< logarithm of the factor
};

struct Fitted {
  State state;
  std::set<GreyFault> free;
  double score = std::numeric_limits<double>::max();
  VectorXd sigma;
  std::vector<GreyValue> numbers;  ///< what the columns were, without values
  double rms = 0.0;
};

class GreyFitter {
 public:
  GreyFitter(SceneStore& store, std::span<const GreyView> views) : model_(store, views) {
    can_change_roughness_ = !views.empty() && views.front().scene.material.roughness > 0.0;
  }

  GreyFit fit(const GreyOptions& options) {
    GreyFit result;
    if (model_.lights().empty() || model_.real().size() < kLeastPixels) {
      return result;
    }
    result.is_known = true;
    Fitted best = fitted(start(), {});
    const double mean = std::max(model_.real().mean(), 1e-6);
    result.before = model_.even_rms(model_.real() - predicted(start())) / mean;
    result.exposed = model_.even_rms(model_.real() - predicted(best.state)) / mean;
    while (options.is_searching && even_share(best.state) > options.good_share &&
           improve(best, options.good_share)) {
    }
    tell(best, result);
    result.after = model_.even_rms(model_.real() - predicted(best.state)) / mean;
    result.renders = model_.renders();
    return result;
  }

 private:
  State start() {
    State state;
    state.places.assign(model_.lights().size(), Vector3d::Zero());
    state.segments = VectorXd::Zero(columns_of(state).segments.cols());
    return state;
  }

  const GreyColumns& columns_of(const State& state) {
    return model_.columns(state.places, std::exp(state.roughness));
  }

  VectorXd unexposed(const State& state) {
    const GreyColumns& columns = columns_of(state);
    VectorXd grey = columns.sum;
    if (state.segments.size() > 0) {
      grey += columns.segments * state.segments;
    }
    return grey;
  }

  VectorXd predicted(const State& state) { return state.exposure * unexposed(state); }

  /// One column and its meaning.
  struct System {
    std::vector<VectorXd> columns;
    std::vector<GreyValue> numbers;
  };

  void add_segments(const State& state, System& system) {
    const MatrixXd& segments = columns_of(state).segments;
    Index column = 0;
    for (const LitLight& light : model_.lights()) {
      for (int i = 0; light.segments > 1 && i < light.segments; ++i) {
        system.columns.emplace_back(state.exposure * segments.col(column++));
        system.numbers.push_back({.fault = GreyFault::kSegments, .light = light.name, .index = i});
      }
    }
  }

  void add_places(const State& state, const VectorXd& grey, System& system) {
    for (std::size_t l = 0; l < model_.lights().size(); ++l) {
      for (int axis = 0; axis < 3; ++axis) {
        State moved = state;
        moved.places[l][axis] += kStepMm;
        system.columns.emplace_back((predicted(moved) - grey) / kStepMm);
        system.numbers.push_back(
            {.fault = GreyFault::kLightPlace, .light = model_.lights()[l].name, .index = axis});
      }
    }
  }

  System system_at(const State& state, const std::set<GreyFault>& free) {
    System system;
    const VectorXd grey = predicted(state);
    system.columns.push_back(unexposed(state));
    system.numbers.push_back({.fault = GreyFault::kExposure});
    if (free.contains(GreyFault::kSegments)) {
      add_segments(state, system);
    }
    if (free.contains(GreyFault::kLightPlace)) {
      add_places(state, grey, system);
    }
    if (free.contains(GreyFault::kRoughness)) {
      State rougher = state;
      rougher.roughness += kStepRoughness;
      system.columns.emplace_back((predicted(rougher) - grey) / kStepRoughness);
      system.numbers.push_back({.fault = GreyFault::kRoughness});
    }
    return system;
  }

  static double median_size(const VectorXd& values) {
    std::vector<double> sizes(static_cast<std::size_t>(values.size()));
    for (Index i = 0; i < values.size(); ++i) {
      sizes[static_cast<std::size_t>(i)] = std::abs(values[i]);
    }
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    return 1.4826 * *middle;
  }

  double floor() const { return kFloor * std::max(model_.real().mean(), 1e-6); }

  /// Robust least squares of a step. A weak wish for small steps keeps apart what the pictures
  /// cannot: exposure and the powers of all segments together.
  VectorXd step_of(const System& system, const VectorXd& left, VectorXd& sigma) const {
    const double noise = std::max(median_size(left), floor());
    const VectorXd weights = left.unaryExpr([&](double value) {
      const double ratio = std::abs(value) / (kHuber * noise);
      return 1.0 / std::max(1.0, ratio);
    });
    MatrixXd columns(left.size(), static_cast<Index>(system.columns.size()));
    for (std::size_t i = 0; i < system.columns.size(); ++i) {
      columns.col(static_cast<Index>(i)) = system.columns[i];
    }
    const MatrixXd weighted = weights.asDiagonal() * columns;
    MatrixXd normal = columns.transpose() * weighted;
    const double scale = normal.diagonal().maxCoeff();
    for (Index i = 0; i < normal.rows(); ++i) {
      const bool is_segment =
          system.numbers[static_cast<std::size_t>(i)].fault == GreyFault::kSegments;
      normal(i, i) += (is_segment ? 1e-4 : 1e-9) * scale;
    }
    const Eigen::LDLT<MatrixXd> solver(normal);
    const MatrixXd covariance = solver.solve(MatrixXd::Identity(normal.rows(), normal.cols()));
    sigma = noise * std::sqrt(kPixelsAlike) * covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    return solver.solve(weighted.transpose() * left);
  }

  /// The largest step by place [mm].
  double take(const System& system, const VectorXd& step, State& state) const {
    double longest_mm = 0.0;
    Index segment = 0;
    for (Index i = 0; i < step.size(); ++i) {
      const GreyValue& number = system.numbers[static_cast<std::size_t>(i)];
      switch (number.fault) {
        case GreyFault::kExposure:
          state.exposure = std::max(0.05, state.exposure + step[i]);
          break;
        case GreyFault::kSegments:
          state.segments[segment] = std::max(kLeastPower, state.segments[segment] + step[i]);
          ++segment;
          break;
        case GreyFault::kLightPlace: {
          const double by = std::clamp(step[i], -kLongestStepMm, kLongestStepMm);
          state.places[light_index(number.light)][number.index] += by;
          longest_mm = std::max(longest_mm, std::abs(by));
          break;
        }
        case GreyFault::kRoughness:
          state.roughness += std::clamp(step[i], -kLongestStepRoughness, kLongestStepRoughness);
          break;
      }
    }
    return longest_mm;
  }

  std::size_t light_index(const std::string& name) const {
    const auto found = std::ranges::find(model_.lights(), name, &LitLight::name);
    return static_cast<std::size_t>(found - model_.lights().begin());
  }

  double robust_rms(const VectorXd& left) const {
    const double noise = std::max(median_size(left), floor());
    double sum = 0.0;
    for (Index i = 0; i < left.size(); ++i) {
      const double ratio = std::abs(left[i]) / (4.0 * kHuber * noise);
      sum += left[i] * left[i] / std::max(1.0, ratio);
    }
    return std::sqrt(sum / static_cast<double>(left.size()));
  }

  /// Gauss-Newton from a state with some numbers free.
  Fitted fitted(State state, std::set<GreyFault> free) {
    Fitted best = {.free = free};
    const bool is_linear =
        !free.contains(GreyFault::kLightPlace) && !free.contains(GreyFault::kRoughness);
    System system;
    for (int round = 0; round < (is_linear ? 3 : kRounds); ++round) {
      // Slopes by place and roughness cost renderings, and hold for two steps.
      if (is_linear || round % 2 == 0) {
        system = system_at(state, free);
      }
      const VectorXd left = model_.real() - predicted(state);
      VectorXd sigma;
      const VectorXd step = step_of(system, left, sigma);
      State next = state;
      const double moved_mm = take(system, step, next);
      const double rms = robust_rms(model_.real() - predicted(next));
      const double n = static_cast<double>(left.size()) / kPixelsAlike;
      const double score = n * std::log(rms * rms + floor() * floor()) +
                           kPrice * static_cast<double>(system.numbers.size());
      if (score < best.score) {
        best.state = next;
        best.score = score;
        best.sigma = sigma;
        best.numbers = system.numbers;
        best.rms = rms;
      }
      state = next;
      if (!is_linear && moved_mm < kSettledMm && round > 1) {
        break;
      }
    }
    return best;
  }

  double even_share(const State& state) {
    return model_.even_rms(model_.real() - predicted(state)) / std::max(model_.real().mean(), 1e-6);
  }

  /// Frees what helps most. @return false: nothing does
  bool improve(Fitted& best, double good_share) {
    Fitted better = best;
    for (const GreyFault fault :
         {GreyFault::kSegments, GreyFault::kLightPlace, GreyFault::kRoughness}) {
      if (best.free.contains(fault) || !is_possible(fault)) {
        continue;
      }
      // Roughness is looked at where the lights do not explain everything.
      if (fault == GreyFault::kRoughness && even_share(better.state) <= good_share) {
        continue;
      }
      std::set<GreyFault> free = best.free;
      free.insert(fault);
      Fitted tried = fitted(best.state, free);
      if (tried.score < better.score) {
        better = std::move(tried);
      }
    }
    const bool is_better = better.free.size() > best.free.size();
    best = std::move(better);
    return is_better;
  }

  bool is_possible(GreyFault fault) {
    if (fault == GreyFault::kSegments) {
      return columns_of(start()).segments.cols() > 0;
    }
    return fault != GreyFault::kRoughness || can_change_roughness_;
  }

  /// Powers of segments are told against their median, which belongs to the exposure.
  static double median_power(const State& state) {
    std::vector<double> powers;
    for (Index i = 0; i < state.segments.size(); ++i) {
      powers.push_back(1.0 + state.segments[i]);
    }
    if (powers.empty()) {
      return 1.0;
    }
    std::ranges::sort(powers);
    return std::max(0.05, powers[powers.size() / 2]);
  }

  void tell(const Fitted& best, GreyFit& result) const {
    result.faults.assign(best.free.begin(), best.free.end());
    const bool has_segments = best.free.contains(GreyFault::kSegments);
    const double common = has_segments ? median_power(best.state) : 1.0;
    Index segment = 0;
    for (std::size_t i = 0; i < best.numbers.size(); ++i) {
      GreyValue value = best.numbers[i];
      value.sigma = best.sigma[static_cast<Index>(i)];
      switch (value.fault) {
        case GreyFault::kExposure:
          value.value = best.state.exposure * common;
          break;
        case GreyFault::kSegments:
          value.value = (1.0 + best.state.segments[segment++]) / common;
          break;
        case GreyFault::kLightPlace:
          value.value = best.state.places[light_index(value.light)][value.index];
          break;
        case GreyFault::kRoughness:
          value.value = std::exp(best.state.roughness);
          break;
      }
      result.values.push_back(value);
    }
    put_change(result);
  }

  void put_change(GreyFit& result) const {
    for (const LitLight& light : model_.lights()) {
      result.change.lights.push_back({.name = light.name});
    }
    for (const GreyValue& value : result.values) {
      if (value.fault == GreyFault::kExposure) {
        result.change.exposure = value.value;
      } else if (value.fault == GreyFault::kRoughness) {
        result.change.roughness = value.value;
      } else if (value.fault == GreyFault::kLightPlace) {
        result.change.lights[light_index(value.light)].moved_mm[value.index] = value.value;
      } else {
        result.change.lights[light_index(value.light)].segment_power.push_back(
            std::max(0.0, value.value));
      }
    }
  }

  GreyModel model_;
  bool can_change_roughness_ = false;
};

}  // namespace

std::string name_of(GreyFault fault) {
  constexpr std::array<const char*, kGreyFaults> kNames = {
      "exposure", "segment_power", "light_place", "roughness"};
  return kNames[static_cast<std::size_t>(fault)];
}

GreyFit fit_grey(SceneStore& store, std::span<const GreyView> views, const GreyOptions& options) {
  std::vector<GreyView> chosen;
  const std::size_t count = std::min(views.size(), std::max<std::size_t>(1, options.max_views));
  for (std::size_t i = 0; i < count; ++i) {
    chosen.push_back(views[i * views.size() / count]);
  }
  return GreyFitter(store, chosen).fit(options);
}

}  // namespace glint
