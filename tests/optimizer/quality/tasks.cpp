// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/optimizer/quality/tasks.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/rng.h"
#include "tests/optimizer/quality/mixed_tasks.h"

namespace glint::quality {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Vector = std::vector<double>;

constexpr int kNumSamples = 2000;
constexpr int kNumPeaks = 21;
constexpr int kNumKinks = 8;
constexpr int kNumSteps = 6;
constexpr int kFrontVariables = 10;

/// What differs from instance to instance.
struct Instance {
  VectorXd optimum;
  MatrixXd rotation;
  std::vector<VectorXd> centers;
  std::vector<VectorXd> weights;
  Vector heights;
};

MatrixXd random_matrix(Index rows, Index columns, Rng& rng) {
  MatrixXd matrix(rows, columns);
  for (double& value : matrix.reshaped()) {
    value = rng.normal();
  }
  return matrix;
}

Instance make_instance(Index num_variables, Rng& rng) {
  Instance instance;
  instance.optimum.resize(num_variables);
  for (double& value : instance.optimum) {
    value = rng.uniform(-3.5, 3.5);
  }
  const MatrixXd matrix = random_matrix(num_variables, num_variables, rng);
  instance.rotation = Eigen::HouseholderQR<MatrixXd>(matrix).householderQ();
  return instance;
}

/// The unit cube as the box from -5 to 5.
VectorXd in_box(const Vector& x) {
  const Eigen::Map<const VectorXd> unit(x.data(), static_cast<Index>(x.size()));
  return (-5.0 + 10.0 * unit.array()).matrix();
}

double rastrigin(const Instance& instance, const VectorXd& x) {
  const VectorXd z = 0.6 * (instance.rotation * (x - instance.optimum));
  return (10.0 + z.array().square() - 10.0 * (2.0 * std::numbers::pi * z.array()).cos()).sum();
}

double log_rosenbrock(const Instance& instance, const VectorXd& x) {
  const VectorXd z = (0.5 * (x - instance.optimum).array() + 1.0).matrix();
  double sum = 0.0;
  for (Index i = 0; i + 1 < z.size(); ++i) {
    sum += 100.0 * std::pow(z[i] * z[i] - z[i + 1], 2) + std::pow(z[i] - 1.0, 2);
  }
  return std::log1p(sum);
}

double gallagher(const Instance& instance, const VectorXd& x) {
  double highest = 0.0;
  for (std::size_t k = 0; k < instance.centers.size(); ++k) {
    const VectorXd y = instance.rotation * (x - instance.centers[k]);
    const double squared = (instance.weights[k].array() * y.array().square()).sum();
    const double width = 2.0 * static_cast<double>(x.size());
    highest = std::max(highest, instance.heights[k] * std::exp(-squared / width));
  }
  return std::pow(10.0 - highest, 2);
}

/// The worst of several absolute terms, steps (a defect falls out of view), and a weak basin.
double kinks(const Instance& instance, const VectorXd& x) {
  const VectorXd away = x - instance.optimum;
  double worst = 0.0;
  double steps = 0.0;
  for (std::size_t k = 0; k < instance.weights.size(); ++k) {
    const double value = std::abs(instance.weights[k].dot(away));
    if (k < kNumKinks) {
      worst = std::max(worst, value);
    } else {
      steps += value > 1.5 ? 0.5 : 0.0;
    }
  }
  return worst + steps + 0.02 * away.squaredNorm();
}

void add_peaks(Instance& instance, Rng& rng) {
  const Index n = instance.optimum.size();
  for (int k = 0; k < kNumPeaks; ++k) {
    VectorXd center(n);
    VectorXd weights(n);
    for (Index i = 0; i < n; ++i) {
      center[i] = k == 0 ? instance.optimum[i] : rng.uniform(-4.5, 4.5);
      weights[i] = 0.3 * std::pow(10.0, rng.uniform());
    }
    instance.centers.push_back(center);
    instance.weights.push_back(weights);
    instance.heights.push_back(k == 0 ? 10.0 : 1.1 + 8.0 * (k - 1) / 20.0);
  }
}

void add_directions(Instance& instance, Rng& rng) {
  for (int k = 0; k < kNumKinks + kNumSteps; ++k) {
    instance.weights.emplace_back(random_matrix(instance.optimum.size(), 1, rng).normalized());
  }
}

SearchSpace unit_cube(int num_variables) {
  SearchSpace space;
  for (int i = 0; i < num_variables; ++i) {
    space.variables.push_back({.name = "x" + std::to_string(i)});
  }
  return space;
}

using Scalar = double (*)(const Instance&, const VectorXd&);

Task scalar_task(int num_variables, Scalar function, Instance instance) {
  return {.space = unit_cube(num_variables),
          .truth = [function, instance = std::move(instance)](const Vector& x) {
            return Vector{function(instance, in_box(x))};
          }};
}

double sum_but_first(const Vector& x) {
  double sum = 0.0;
  for (std::size_t i = 1; i < x.size(); ++i) {
    sum += x[i];
  }
  return sum;
}

/// f2 = g - g (f1 / g)^power, where power is 1/2 in ZDT1 and 2 in ZDT2.
Task zdt(double power) {
  const double below = 1.0 - 1.0 / (power + 1.0);  // area between the axes and the front
  return {.space = unit_cube(kFrontVariables),
          .num_objectives = 2,
          .truth =
              [power](const Vector& x) {
                const double g = 1.0 + 9.0 * sum_but_first(x) / static_cast<double>(x.size() - 1);
                return Vector{x[0], g * (1.0 - std::pow(x[0] / g, power))};
              },
          .reference = {1.1, 6.0},
          .full_volume = 1.1 * 6.0 - below};
}

Task dtlz2() {
  return {.space = unit_cube(kFrontVariables),
          .num_objectives = 3,
          .truth =
              [](const Vector& x) {
                double g = 1.0;
                for (std::size_t i = 2; i < x.size(); ++i) {
                  g += (x[i] - 0.5) * (x[i] - 0.5);
                }
                const double a = 0.5 * std::numbers::pi * x[0];
                const double b = 0.5 * std::numbers::pi * x[1];
                return Vector{
                    g * std::cos(a) * std::cos(b), g * std::cos(a) * std::sin(b), g * std::sin(a)};
              },
          .reference = {2.0, 2.0, 2.0},
          .full_volume = 8.0 - std::numbers::pi / 6.0};
}

/// s_multi of the WFG toolkit with A = 30, B = 10, C = 0.35.
double with_many_hills(double y) {
  constexpr double kCenter = 0.35;
  const double part = std::abs(y - kCenter) / (2.0 * (std::floor(kCenter - y) + kCenter));
  return (1.0 + std::cos(122.0 * std::numbers::pi * (0.5 - part)) + 40.0 * part * part) / 12.0;
}

/// Two position parameters, eight of distance; the front is a quarter of an ellipse.
Task wfg4() {
  return {
      .space = unit_cube(kFrontVariables),
      .num_objectives = 2,
      .truth =
          [](const Vector& x) {
            double position = 0.0;
            double distance = 0.0;
            for (std::size_t i = 0; i < x.size(); ++i) {
              (i < 2 ? position : distance) += with_many_hills(x[i]);
            }
            position *= 0.25 * std::numbers::pi;  // mean of two, times pi / 2
            distance /= static_cast<double>(x.size() - 2);
            return Vector{distance + 2.0 * std::sin(position), distance + 4.0 * std::cos(position)};
          },
      .reference = {3.0, 5.0},
      .full_volume = 15.0 - 2.0 * std::numbers::pi};
}

/// The same sample for all searches of an instance.
void measure_scale(Task& task, Rng& rng) {
  std::vector<Vector> values(static_cast<std::size_t>(task.num_objectives));
  Vector x(task.space.variables.size());
  for (int i = 0; i < kNumSamples; ++i) {
    for (double& value : x) {
      value = rng.uniform();
    }
    const Vector f = task.truth(point_from_unit(task.space, x));
    for (std::size_t k = 0; k < f.size(); ++k) {
      values[k].push_back(f[k]);
    }
  }
  for (Vector& of_one : values) {
    const Eigen::Map<const VectorXd> f(of_one.data(), static_cast<Index>(of_one.size()));
    task.spread.push_back(std::sqrt((f.array() - f.mean()).square().mean()));
  }
  std::ranges::sort(values[0]);
  task.median = values[0][kNumSamples / 2];
}

}  // namespace

std::vector<std::string_view> tasks_of_one_objective() {
  return {"rastrigin8", "rosen6", "gallagher10", "kinks12"};
}

std::vector<std::string_view> tasks_of_several_objectives() {
  return {"zdt1", "zdt2", "dtlz2", "wfg4"};
}

std::vector<std::string_view> mixed_tasks() {
  return {"kinds", "nested"};
}

Task make_task(std::string_view name, int instance) {
  Rng rng(static_cast<std::uint64_t>(instance), Stream::kTest, 1000);
  Task task;
  if (name == "rastrigin8") {
    task = scalar_task(8, &rastrigin, make_instance(8, rng));
  } else if (name == "rosen6") {
    task = scalar_task(6, &log_rosenbrock, make_instance(6, rng));
  } else if (name == "gallagher10") {
    Instance peaks = make_instance(10, rng);
    add_peaks(peaks, rng);
    task = scalar_task(10, &gallagher, std::move(peaks));
  } else if (name == "kinks12") {
    Instance directions = make_instance(12, rng);
    add_directions(directions, rng);
    task = scalar_task(12, &kinks, std::move(directions));
  } else if (name == "zdt1" || name == "zdt2") {
    task = zdt(name == "zdt1" ? 0.5 : 2.0);
  } else if (name == "dtlz2") {
    task = dtlz2();
  } else if (name == "kinds" || name == "nested") {
    task = mixed_task(name == "kinds" ? kinds_space() : nested_space(), rng);
  } else {
    GLINT_CHECK(name == "wfg4", "a known task");
    task = wfg4();
  }
  task.name = name;
  measure_scale(task, rng);
  return task;
}

}  // namespace glint::quality
