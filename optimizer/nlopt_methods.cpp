// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/nlopt_methods.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlopt.hpp>

#include "core/error.h"

namespace glint {

namespace {

constexpr std::array<std::string_view, 7> kMethods = {
    "direct_l", "crs2", "isres", "mlsl", "bobyqa", "sbplx", "cobyla"};

/// Calls a local search may take before another start gets its chance.
constexpr int kLocalCallsPerDimension = 100;
/// The same for the many small searches inside MLSL.
constexpr int kInnerCallsPerDimension = 20;
/// Global methods end only when they have collapsed to a point.
constexpr double kGlobalTolerance = 1e-9;

/// BOBYQA needs two dimensions; SBPLX does its job in one.
nlopt::algorithm quadratic_method(std::size_t num_dimensions) {
  return num_dimensions < 2 ? nlopt::LN_SBPLX : nlopt::LN_BOBYQA;
}

nlopt::algorithm algorithm_of(const MethodRun& run) {
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
  GLINT_CHECK(run.method == "bobyqa", "an NLopt method");
  return quadratic_method(run.start.size());
}

nlopt::opt make_optimizer(const MethodRun& run) {
  const auto n = static_cast<unsigned>(run.start.size());
  nlopt::opt optimizer(algorithm_of(run), n);
  optimizer.set_lower_bounds(run.low);
  optimizer.set_upper_bounds(run.high);
  if (is_local_method(run.method)) {
    optimizer.set_xtol_abs(run.tolerance);
    optimizer.set_initial_step(run.initial_step);
    optimizer.set_maxeval(kLocalCallsPerDimension * static_cast<int>(n + 1));
  } else {
    optimizer.set_xtol_abs(kGlobalTolerance);
  }
  if (run.method == "mlsl") {
    nlopt::opt local(quadratic_method(n), n);
    local.set_xtol_abs(run.tolerance);
    local.set_maxeval(kInnerCallsPerDimension * static_cast<int>(n + 1));
    optimizer.set_local_optimizer(local);
  }
  return optimizer;
}

/// What the C callback sees.
struct Bridge {
  const MethodRun* run;
  const AskTellThread::Call* call;
  std::vector<double> point;
};

double call_through(unsigned n, const double* x, double* /*gradient*/, void* data) {
  Bridge& bridge = *static_cast<Bridge*>(data);
  for (unsigned i = 0; i < n; ++i) {
    const double value = std::isfinite(x[i]) ? x[i] : bridge.run->start[i];
    bridge.point[i] = std::clamp(value, bridge.run->low[i], bridge.run->high[i]);
  }
  const std::optional<double> value = (*bridge.call)(bridge.point);
  if (!value) {
    throw nlopt::forced_stop();
  }
  return *value;
}

}  // namespace

bool is_nlopt_method(std::string_view method) {
  return std::ranges::find(kMethods, method) != kMethods.end();
}

bool is_local_method(std::string_view method) {
  return method == "bobyqa" || method == "sbplx" || method == "cobyla";
}

AskTellThread::Body nlopt_body(const MethodRun& run) {
  return [run](const AskTellThread::Call& call) -> std::string {
    nlopt::srand(static_cast<unsigned long>(run.seed));
    nlopt::opt optimizer = make_optimizer(run);
    Bridge bridge{&run, &call, run.start};
    optimizer.set_min_objective(&call_through, &bridge);
    std::vector<double> x = run.start;
    double value = 0.0;
    try {
      const nlopt::result code = optimizer.optimize(x, value);
      return code == nlopt::MAXEVAL_REACHED ? "used up its calls" : "converged";
    } catch (const nlopt::roundoff_limited&) {
      return "converged to rounding";
    } catch (const nlopt::forced_stop&) {
      return "stopped";
    }
  };
}

}  // namespace glint
