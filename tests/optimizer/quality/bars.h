// SPDX-License-Identifier: GPL-3.0-or-later
//
// What searches must reach on the test tasks, and whether the results at hand show it.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tests/optimizer/quality/judge.h"

namespace glint::quality {

/// Seeds of a part below which its mean shows nothing.
inline constexpr int kSeedsOfOne = 30;
inline constexpr int kSeedsOfSeveral = 20;

using Row = std::map<int, Result>;           ///< by seed
using Results = std::map<std::string, Row>;  ///< by part: TASK/NOISE/METHOD

std::vector<std::string> noises_of_one();
std::vector<std::string> noises_of_several();
std::vector<std::string> peers_of_one();
bool is_of_several(const std::string& task);

/// Searched once, for the memory that the search takes.
inline constexpr const char* kLongPart = "rosen6/0.05/growth:auto";
/// Of results files from before that part: under this name they hold the largest resident set of a
/// whole process or, later, what kLongPart holds. Which of them is not told, so that it counts for
/// nothing.
inline constexpr const char* kFormerLongPart = "rosen6/0.05/long:auto";

/// All that the bars need, and more peers.
std::vector<std::string> all_parts();

double mean_of(const Row& row, double Result::*score);

struct Bar {
  std::string what;
  std::optional<double> value;  ///< empty: not shown
  double bound = 0.0;
  bool is_lower_bound = false;  ///< the value must not be below the bound, else not above it
};

bool is_met(const Bar& bar);

/// @param development  what the best peer is chosen by; may be `results` itself
std::vector<Bar> bars_of(const Results& results, const Results& development);

}  // namespace glint::quality
