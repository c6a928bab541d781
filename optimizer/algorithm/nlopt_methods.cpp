// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/algorithm/nlopt_methods.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlopt.hpp>
#include <optional>
#include <utility>

#include "core/error.h"
#include "optimizer/algorithm/merit.h"

namespace glint {

namespace {

constexpr std::array<std::string_view, 10> kMethods = {
    "direct_l", "crs2", "isres", "mlsl", "bobyqa", "sbplx", "cobyla", "slsqp", "mma", "lbfgs"};

/// Calls a local search may take before another start gets its chance.
constexpr int kLocalCallsPerDimension = 100;
/// The same for the many small searches inside MLSL.
constexpr int kInnerCallsPerDimension = 20;
/// Gradient methods need few calls, and hardly more in more dimensions.
constexpr int kGradientCalls = 80;
constexpr int kGradientCallsPerDimension = 10;
/// They end below this part of the tolerance: close to the optimum each step is far smaller than
/// the one before, so the last ones cost little.
constexpr double kGradientTolerance = 0.01;
/// Steps back that may fail one after the other.
constexpr int kMaxFailuresInARow = 5;
/// A flat objective is not blown up beyond this.
constexpr double kMaxScale = 1e12;
/// What counts as inside a limit: half of what is to remain.
constexpr double kLimitTolerance = 0.5 * MeritFunction::kLimitMargin;
/// Global methods end only when they have collapsed to a point.
constexpr double kGlobalTolerance = 1e-9;

/// BOBYQA needs two dimensions; SBPLX does its job in one.
nlopt::algorithm quadratic_method(std::size_t num_dimensions) {
  return num_dimensions < 2 ? nlopt::LN_SBPLX : nlopt::LN_BOBYQA;
}

/// L-BFGS knows no limits; NLopt's augmented Lagrangian around it turns them into smooth penalties.
bool has_penalties(const MethodRun& run) {
  return run.method == "lbfgs" && run.num_limits > 0;
}

nlopt::algorithm nlopt_algorithm(const MethodRun& run) {
  if (run.method == "direct_l") {
    return run.is_first ? nlopt::GN_DIRECT_L : nlopt::GN_DIRECT_L_RAND;
  }
  if (run.method == "mlsl") {
    return run.is_first ? nlopt::G_MLSL_LDS : nlopt::G_MLSL;
  }
  if (run.method == "crs2") {
    return nlopt::GN_CRS2_LM;
  }
  if (run.method == "isres") {
    return nlopt::GN_ISRES;
  }
  if (run.method == "sbplx") {
    return nlopt::LN_SBPLX;
  }
  if (run.method == "cobyla") {
    return nlopt::LN_COBYLA;
  }
  if (run.method == "slsqp") {
    return nlopt::LD_SLSQP;
  }
  if (run.method == "mma") {
    return nlopt::LD_MMA;
  }
  if (run.method == "lbfgs") {
    return has_penalties(run) ? nlopt::AUGLAG : nlopt::LD_LBFGS;
  }
  GLINT_CHECK(run.method == "bobyqa", "an NLopt method");
  return quadratic_method(run.start.size());
}

/// The method that searches within the other.
void set_inner(nlopt::algorithm method, double tolerance, int calls, nlopt::opt& optimizer) {
  nlopt::opt inner(method, optimizer.get_dimension());
  inner.set_xtol_abs(tolerance);
  inner.set_maxeval(calls);
  optimizer.set_local_optimizer(inner);
}

nlopt::opt make_optimizer(const MethodRun& run) {
  const auto n = static_cast<unsigned>(run.start.size());
  nlopt::opt optimizer(nlopt_algorithm(run), n);
  optimizer.set_lower_bounds(run.low);
  optimizer.set_upper_bounds(run.high);
  if (is_gradient_method(run.method)) {
    optimizer.set_xtol_abs(kGradientTolerance * run.tolerance);
    optimizer.set_maxeval(kGradientCalls + kGradientCallsPerDimension * static_cast<int>(n));
  } else if (is_local_method(run.method)) {
    optimizer.set_xtol_abs(run.tolerance);
    optimizer.set_initial_step(run.initial_step);
    optimizer.set_maxeval(kLocalCallsPerDimension * static_cast<int>(n + 1));
  } else {
    optimizer.set_xtol_abs(kGlobalTolerance);
  }
  if (has_penalties(run)) {
    set_inner(nlopt::LD_LBFGS, kGradientTolerance * run.tolerance, kGradientCalls, optimizer);
  }
  if (run.method == "mlsl") {
    const int calls = kInnerCallsPerDimension * static_cast<int>(n + 1);
    set_inner(quadratic_method(n), run.tolerance, calls, optimizer);
  }
  return optimizer;
}

/// What the C callbacks see.
class Bridge {
 public:
  Bridge(const MethodRun& run, const AskTellThread::Call& call)
      : run_(run), call_(call), point_(run.start), is_gradient_(is_gradient_method(run.method)) {}

  double objective(const double* x, double* gradient) {
    const Answer& answer = answer_at(x);
    if (!is_gradient_) {
      return answer.merit;
    }
    const ValueWithGradient& told = answer.objective;
    if (gradient != nullptr) {
      std::ranges::transform(
          told.gradient, gradient, [this](double derivative) { return scale_ * derivative; });
    }
    return scale_ * told.value;
  }

  void limits(const double* x, double* values, double* gradients) {
    const Answer& answer = answer_at(x);
    for (std::size_t i = 0; i < answer.limits.size(); ++i) {
      const ValueWithGradient& limit = answer.limits[i];
      values[i] = limit.value;
      if (gradients != nullptr) {
        std::ranges::copy(limit.gradient, gradients + i * limit.gradient.size());
      }
    }
  }

  /// Why it stopped the method.
  const std::string& ending() const { return ending_; }

 private:
  const Answer& answer_at(const double* x) {
    std::vector<double> point(point_.size());
    for (std::size_t i = 0; i < point.size(); ++i) {
      const double value = std::isfinite(x[i]) ? x[i] : run_.start[i];
      point[i] = std::clamp(value, run_.low[i], run_.high[i]);
    }
    if (is_gradient_ && has_answer_ && point == point_) {
      return answer_;
    }
    point_ = std::move(point);
    has_answer_ = false;
    std::optional<Answer> answer = is_over_ ? std::nullopt : call_(point_);
    if (!answer) {
      throw nlopt::forced_stop();
    }
    answer_ = std::move(*answer);
    if (is_gradient_) {
      prepare_answer();
    }
    has_answer_ = true;
    return answer_;
  }

  void prepare_answer() {
    if (answer_.is_failed) {
      replace_failed();
      return;
    }
    num_failures_ = 0;
    if (!worst_) {
      set_scale();
      worst_ = answer_;
    }
    worst_->objective.value = std::max(worst_->objective.value, answer_.objective.value);
    for (std::size_t i = 0; i < answer_.limits.size(); ++i) {
      worst_->limits[i].value = std::max(worst_->limits[i].value, answer_.limits[i].value);
    }
  }

  /// The first step of a method is its gradient: now as long as the run's initial step.
  void set_scale() {
    double steepest = 0.0;
    for (const double derivative : answer_.objective.gradient) {
      steepest = std::max(steepest, std::abs(derivative));
    }
    scale_ = steepest > 0.0 ? std::min(run_.initial_step / steepest, kMaxScale) : 1.0;
  }

  void replace_failed() {
    if (!worst_ || ++num_failures_ > kMaxFailuresInARow) {
      is_over_ = true;
      ending_ = worst_ ? "too many failures in a row" : "its first evaluation failed";
      throw nlopt::forced_stop();
    }
    const double merit = answer_.merit;
    answer_ = *worst_;
    answer_.objective.value = std::max(answer_.objective.value, merit);
    answer_.objective.gradient.assign(point_.size(), 0.0);
    for (ValueWithGradient& limit : answer_.limits) {
      limit.gradient.assign(point_.size(), 0.0);
    }
  }

  const MethodRun& run_;
  const AskTellThread::Call& call_;
  std::vector<double> point_;
  bool is_gradient_;
  Answer answer_;  ///< at point_, once has_answer_
  bool has_answer_ = false;
  bool is_over_ = false;
  std::string ending_ = "stopped";
  double scale_ = 1.0;  ///< of the objective, as the method sees it
  int num_failures_ = 0;
  std::optional<Answer> worst_;  ///< highest values so far; empty: none succeeded yet
};

double objective_through(unsigned /*n*/, const double* x, double* gradient, void* data) {
  return static_cast<Bridge*>(data)->objective(x, gradient);
}

void limits_through(unsigned /*m*/,
                    double* values,
                    unsigned /*n*/,
                    const double* x,
                    double* gradients,
                    void* data) {
  static_cast<Bridge*>(data)->limits(x, values, gradients);
}

}  // namespace

bool is_nlopt_method(std::string_view method) {
  return std::ranges::find(kMethods, method) != kMethods.end();
}

bool is_local_method(std::string_view method) {
  return method == "bobyqa" || method == "sbplx" || method == "cobyla" ||
         is_gradient_method(method);
}

bool is_gradient_method(std::string_view method) {
  return method == "slsqp" || method == "mma" || method == "lbfgs";
}

AskTellThread::Body nlopt_body(const MethodRun& run) {
  return [run](const AskTellThread::Call& call) -> std::string {
    nlopt::srand(static_cast<unsigned long>(run.seed));
    nlopt::opt optimizer = make_optimizer(run);
    Bridge bridge(run, call);
    optimizer.set_min_objective(&objective_through, &bridge);
    if (run.num_limits > 0) {
      const std::vector<double> tolerance(static_cast<std::size_t>(run.num_limits),
                                          kLimitTolerance);
      optimizer.add_inequality_mconstraint(&limits_through, &bridge, tolerance);
    }
    std::vector<double> x = run.start;
    double value = 0.0;
    try {
      const nlopt::result code = optimizer.optimize(x, value);
      return code == nlopt::MAXEVAL_REACHED ? "used up its calls" : "converged";
    } catch (const nlopt::roundoff_limited&) {
      return "converged to rounding";
    } catch (const nlopt::forced_stop&) {
      return bridge.ending();
    }
  };
}

}  // namespace glint
