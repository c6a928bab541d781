// SPDX-License-Identifier: GPL-3.0-or-later
//
// NLopt's derivative-free methods as bodies of an AskTellThread. What NLopt 2.7.1 needs, measured:
//
// - its random generator is thread-local, so the seed is set on the thread the method runs on;
// - a value that is not finite makes methods stop, crash or return NaN, so none is ever passed;
// - `maxtime` is not honoured everywhere and COBYLA can hang, so time is the caller's business;
// - with noise all local methods stop early, so the caller restarts them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "optimizer/ask_tell_thread.h"

namespace glint {

/// One run of a method inside a box of the unit cube.
struct MethodRun {
  std::string method;         ///< see is_nlopt_method()
  std::vector<double> start;  ///< inside [low, high]; global methods may ignore it
  std::vector<double> low;
  std::vector<double> high;
  double initial_step = 0.25;  ///< of local methods
  double tolerance = 1e-4;     ///< local methods end when their steps are below it
  std::uint64_t seed = 1;
  bool is_first =
      true;  ///< false: another instance beside a first one, so use a randomised variant
};

/// direct_l, crs2, isres, mlsl, bobyqa, sbplx, cobyla.
bool is_nlopt_method(std::string_view method);
/// bobyqa, sbplx, cobyla: they descend from a start point.
bool is_local_method(std::string_view method);

/// The optimiser, minimising, to be run by an AskTellThread. Points it asks lie in the box.
AskTellThread::Body nlopt_body(const MethodRun& run);

}  // namespace glint
