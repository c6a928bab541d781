// SPDX-License-Identifier: GPL-3.0-or-later
//
// The frontier of a scene: what each method of rendering costs and how wrong it is. Mirrors under a
// tunnel are compared with 16 x 16 rays a pixel by plain sampling, without noise and quantisation,
// so that methods are compared and nothing else; path-traced scenes with several independent
// pictures together, whose own noise is taken out of the errors (docs/frontier.md).
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "metrics/statistics/rank_agreement.h"
#include "optimizer/problem/goal.h"
#include "studies/definition/ladder/branch_split.h"
#include "studies/definition/scene.h"
#include "studies/frontier/frontier_errors.h"

namespace glint {

/// A score of the reference.
struct ReferenceScore {
  double value = 0.0;
  double standard_error = 0.0;  ///< from the scatter of independent batches of samples
};

struct FrontierReference {
  ComparedMethod method;
  int pictures = 1;  ///< independent ones, of which the reference is the mean
  double h_rms = 0.0;
  std::map<std::string, double> weber;
  std::map<std::string, double> change;
  /// How wrong the reference's own frames are, extrapolated from 16 and 64 rays a pixel, or by the
  /// scatter of its pictures.
  std::optional<double> own_frame_rmse;
  std::map<std::string, ReferenceScore> scores;  ///< standard errors are those of paths
};

/// How a method orders designs, against the finest one that was tried.
struct MethodRanking {
  std::string label;        ///< of the point
  std::string score;        ///< the objective that it orders worst
  double cpu_s = 0.0;       ///< of one design, mean
  RankAgreement agreement;  ///< by what a search minimises, limits counted in
  bool is_right = false;    ///< by every objective
};

/// Designs spread evenly over the variables.
struct DesignRanking {
  std::string score;        ///< the study's first objective
  std::string reference;    ///< label of the method that the others are compared with
  int designs = 0;          ///< that could be evaluated
  double mean_error = 0.0;  ///< standard error of the reference's first figures, mean
  std::vector<MethodRanking> methods;
};

struct Frontier {
  FrontierReference reference;
  std::vector<FrontierPoint> points;
  int pixel_factor = 1;  ///< by which the scene's pixels were made larger before all else
  int width_px = 0;      ///< of pictures at full resolution
  int height_px = 0;
  std::vector<std::string> unseen;       ///< defects that the camera does not see
  std::optional<DesignRanking> ranking;  ///< with variables and time for it
  std::string choice_rule;               ///< of mark_choice(): what the automatic choice does
  bool is_choice_by_order = false;       ///< the rule is the order of designs
  std::optional<BranchSplit> split;      ///< of the study's search; empty: it has one ladder
  std::optional<std::size_t> branch;     ///< that the scene lies in; empty: in none
};

struct FrontierOptions {
  int threads = 1;             ///< for the reference; methods are measured with one
  int repeats = 3;             ///< of each warm candidate, at least; the best counts
  double budget_s = 600.0;     ///< wall clock; what would go beyond it is left out and named
  const Goal* goal = nullptr;  ///< whose scores are wanted beside the usual ones; nullptr: none
  /// Called with the part of the work that is done, 0 to 1, and what comes next; may be empty.
  std::function<void(double done, const std::string& next)> on_progress;
};

/// Whether a point is as the reference but for its number of rays.
bool is_like_reference(const FrontierPoint& point, const Frontier& frontier);

/// Renders the scene by every method. @throws ConfigError beginning with the key at fault, IoError
Frontier measure_frontier(const SceneSettings& scene, const FrontierOptions& options);

}  // namespace glint
