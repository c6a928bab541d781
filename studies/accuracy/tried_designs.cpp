// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/tried_designs.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/error.h"
#include "optimizer/algorithm/sobol.h"
#include "studies/definition/accuracy_table.h"

namespace glint {
namespace {

constexpr std::size_t kCandidatesPerDesign = 4;
constexpr std::size_t kCandidates = kCandidatesPerDesign * kTriedDesigns;
constexpr std::size_t kMaxPrototypes = 8;
constexpr std::uint64_t kSpreadSeed = 3000017;  ///< other points than any search's own design

/// Of the sequence, for each design that is wanted of a branch, four times as many as there are
/// branches: more than enough for the smallest. No fewer than of kMaxBranchValues.
std::size_t points_per_design(std::size_t branches) {
  constexpr std::size_t kPointsPerBranch = 4;
  return kPointsPerBranch * std::max(kMaxBranchValues, branches);
}

/// Point k of a Sobol sequence over the variables, from 0.
TriedDesign spread_design(const Study& study, const Sobol& sequence, std::uint32_t k) {
  const Point point = point_from_unit(study.space, sequence.point(k));
  return {fmt::format("spread {}", k + 1), overrides_of(study, point), point};
}

Sobol spread_sequence(const Study& study) {
  return {study.search.seed + kSpreadSeed, static_cast<int>(study.space.variables.size())};
}

/// "baseline" of the branch that it lies in, "baseline, lighting_use = ring" of another one.
TriedDesign baseline_design(const Study& study, const BranchSplit& split, std::size_t branch) {
  const Point point = baseline_of(study, split, branch);
  const bool is_own = split.branch_of(baseline_point(study)) == branch;
  return {is_own ? "baseline" : fmt::format("baseline, {}", split.label(branch)),
          overrides_of(study, point),
          point};
}

/// Of designs, those that can be built.
std::vector<SceneSettings> scenes_of(const Study& study, std::span<const TriedDesign> designs) {
  std::vector<SceneSettings> scenes;
  for (const TriedDesign& design : designs) {
    try {
      scenes.push_back(scene_with(study, design.overrides));
    } catch (const ConfigError&) {  // it will be replaced by another one
    }
  }
  return scenes;
}

std::vector<RenderRung> ladder_for(const Study& study, const std::vector<SceneSettings>& scenes) {
  std::vector<RenderRung> ladder = render_ladder(scenes, kept_keys(study.root));
  for (RenderRung& rung : ladder) {
    rung.is_for_search = rung.is_for_search && (rung.has_derivatives || !wants_derivatives(study));
  }
  return ladder;
}

}  // namespace

std::vector<TriedDesign> tried_designs(const Study& study) {
  const Point start = baseline_point(study);
  std::vector<TriedDesign> designs = {{"baseline", overrides_of(study, start), start}};
  for (std::size_t i = 0; i < std::min(kMaxPrototypes, study.prototypes.size()); ++i) {
    designs.push_back({study.prototypes[i].name, study.prototypes[i].overrides, {}});
  }
  const Sobol sequence = spread_sequence(study);
  for (std::uint32_t k = 0; designs.size() < kCandidates; ++k) {
    designs.push_back(spread_design(study, sequence, k));
  }
  return designs;
}

std::vector<TrialDesigns> tried_designs(const Study& study, const BranchSplit& split) {
  std::vector<TrialDesigns> branches(split.values.size(),
                                     TrialDesigns{.candidates = {}, .wanted = kTriedOfBranch});
  for (std::size_t branch = 0; branch < branches.size(); ++branch) {
    branches[branch].candidates.push_back(baseline_design(study, split, branch));
  }
  for (std::size_t i = 0; i < std::min(kMaxPrototypes, study.prototypes.size()); ++i) {
    const Prototype& prototype = study.prototypes[i];
    if (const auto branch = branch_of(study, split, prototype.overrides)) {
      branches[*branch].candidates.push_back({prototype.name, prototype.overrides, {}});
    }
  }
  const auto is_full = [](const TrialDesigns& branch) {
    return branch.candidates.size() >= kCandidatesPerDesign * kTriedOfBranch;
  };
  const Sobol sequence = spread_sequence(study);
  const std::size_t most = points_per_design(branches.size()) * kTriedOfBranch;
  for (std::uint32_t k = 0; k < most && !std::ranges::all_of(branches, is_full); ++k) {
    const TriedDesign design = spread_design(study, sequence, k);
    TrialDesigns& branch = branches[split.branch_of(*design.point)];
    if (!is_full(branch)) {
      branch.candidates.push_back(design);
    }
  }
  return branches;
}

std::vector<RenderRung> search_ladder(const Study& study) {
  std::vector<SceneSettings> scenes = scenes_of(study, tried_designs(study));
  scenes.insert(scenes.begin(), study.scene);
  return ladder_for(study, scenes);
}

std::vector<RenderRung> branch_ladder(const Study& study, const TrialDesigns& designs) {
  const std::vector<SceneSettings> scenes = scenes_of(study, designs.candidates);
  return ladder_for(study, scenes.empty() ? std::vector{study.scene} : scenes);
}

}  // namespace glint
