// SPDX-License-Identifier: GPL-3.0-or-later
//
// NLopt's methods as bodies of an AskTellThread. What NLopt 2.7.1 needs, measured:
//
// - its random generator is thread-local, so the seed is set on the thread the method runs on;
// - a value that is not finite makes methods stop, crash or return NaN, so none is ever passed;
// - `maxtime` is not honoured everywhere and COBYLA can hang, so time is the caller's business;
// - with noise all local methods stop early, so the caller restarts them;
// - gradient methods ignore the initial step: their first step is as long as the gradient, so the
//   objective is scaled for each run; they ask for one point several times, so it is kept.
//
// A gradient method steps back from a failed evaluation, which looks to it as bad as the worst of
// its run, without derivative. A run whose first evaluation fails ends, and so does one after
// several failures in a row.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "optimizer/algorithm/ask_tell_thread.h"

namespace glint {

/// One run of a method inside a box of the unit cube.
struct MethodRun {
  std::string method;         ///< see is_nlopt_method()
  std::vector<double> start;  ///< inside [low, high]; global methods may ignore it
  std::vector<double> low;
  std::vector<double> high;
  double initial_step = 0.25;  ///< of local methods
  double tolerance = 1e-4;     ///< local methods end when their steps are below it
  int num_limits = 0;          ///< that a gradient method keeps to; others see the merit only
  int num_objectives = 1;      ///< of methods that look at all of them
  std::uint64_t seed = 1;
  bool is_first =
      true;  ///< false: another instance beside a first one, so use a randomised variant
};

/// direct_l, crs2, isres, mlsl, bobyqa, sbplx, cobyla, slsqp, mma, lbfgs.
bool is_nlopt_method(std::string_view method);
/// bobyqa, sbplx, cobyla and the gradient methods: they descend from a start point.
bool is_local_method(std::string_view method);
/// slsqp, mma, lbfgs: they look at objective and limits with their gradients, not at the merit.
bool is_gradient_method(std::string_view method);

/// The optimiser, minimising, to be run by an AskTellThread. Points it asks lie in the box.
AskTellThread::Body nlopt_body(const MethodRun& run);

}  // namespace glint
