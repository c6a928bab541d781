// SPDX-License-Identifier: GPL-3.0-or-later
//
// Evolutionary methods of pagmo 2 as bodies of an AskTellThread: cmaes for one objective (the merit
// with its penalties), nsga2 and nspso for several.
//
// The only file that includes pagmo, and it must be compiled without -march: pagmo 2.18's CMA-ES
// crashes where its headers and its library disagree on how Eigen aligns.
//
// nsga2 and nspso know no limits: a design outside them is told as worse than all that was seen, by
// as much as it is outside, so that populations come inside first.
#pragma once

#include <string_view>

#include "optimizer/algorithm/ask_tell_thread.h"
#include "optimizer/algorithm/nlopt_methods.h"

namespace glint {

/// cmaes, nsga2, nspso.
bool is_pagmo_method(std::string_view method);
/// nsga2, nspso: they need several objectives and look at all of them.
bool is_population_of_several(std::string_view method);

/// The optimiser, minimising, to be run by an AskTellThread. Points it asks lie in the box.
AskTellThread::Body pagmo_body(const MethodRun& run);

}  // namespace glint
