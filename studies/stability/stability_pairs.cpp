// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/stability/stability_pairs.h"

#include <algorithm>
#include <cmath>

#include "studies/definition/overrides.h"

namespace glint::stability {
namespace {

constexpr const char* kH = "homogeneity.h_rms";
constexpr const char* kFirst_mm = "200";
constexpr const char* kSecond_mm = "215";

double h_at(SceneStore& store, ConfigNode root, const char* radius_mm) {
  put_set(root, "lighting.tunnel.radius_mm", radius_mm);
  return evaluated(store, root).evaluation.scores.at(kH);
}

CellError change_error(double change, double other, const Bounds& bounds) {
  return {.quantity = "contrast_percent",
          .error = 100.0 * std::abs(change - other) / std::max(other, kMinContrast),
          .bound = bounds.contrast_percent,
          .measured = change,
          .reference = other};
}

/// Of the defect whose change differs most; none where no defect is in both.
std::vector<CellError> worst_change(const Outcome& outcome,
                                    const Outcome& other,
                                    const Bounds& bounds) {
  std::vector<CellError> worst;
  for (const DefectScores& defect : outcome.evaluation.defects) {
    const std::vector<DefectScores>& others = other.evaluation.defects;
    const auto same = std::ranges::find(others, defect.label, &DefectScores::label);
    if (same == others.end()) {
      continue;
    }
    const CellError error = change_error(defect.change, same->change, bounds);
    if (worst.empty() || error.error > worst.front().error) {
      worst = {error};
    }
  }
  return worst;
}

}  // namespace

DesignPair design_pair(SceneStore& store, const ConfigNode& root) {
  return {.h_first = h_at(store, root, kFirst_mm), .h_second = h_at(store, root, kSecond_mm)};
}

CellError flip_error(const DesignPair& undisturbed,
                     const DesignPair& disturbed,
                     const Bounds& bounds) {
  const double before = undisturbed.lead_points();
  const double now = disturbed.lead_points();
  const bool is_flipped = before * now < 0.0;
  return {.quantity = "h_points",
          .error = is_flipped ? std::min(std::abs(before), std::abs(now)) : 0.0,
          .bound = bounds.h_points,
          .measured = now / 100.0,
          .reference = before / 100.0};
}

std::vector<CellError> errors_of_switch(const Outcome& outcome,
                                        const Outcome& other,
                                        const Bounds& bounds) {
  const double h = outcome.evaluation.scores.at(kH);
  const double other_h = other.evaluation.scores.at(kH);
  constexpr const char* kMeanGrey = "homogeneity.mean";
  const double mean = outcome.evaluation.scores.at(kMeanGrey);
  const double other_mean = other.evaluation.scores.at(kMeanGrey);
  std::vector<CellError> errors = worst_change(outcome, other, bounds);
  errors.push_back({.quantity = "h_points",
                    .error = 100.0 * std::abs(h - other_h),
                    .bound = bounds.h_points,
                    .measured = h,
                    .reference = other_h});
  errors.push_back({.quantity = "mean",
                    .error = std::abs(mean - other_mean),
                    .bound = bounds.picture,
                    .measured = mean,
                    .reference = other_mean});
  return errors;
}

}  // namespace glint::stability
