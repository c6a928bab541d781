// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/tried_designs.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/error.h"
#include "optimizer/algorithm/sobol.h"
#include "studies/definition/accuracy_table.h"

namespace glint {
namespace {

constexpr std::size_t kCandidates = 4 * kTriedDesigns;
constexpr std::size_t kMaxPrototypes = 8;
constexpr std::uint64_t kSpreadSeed = 3000017;  ///< other points than any search's own design

}  // namespace

std::vector<TriedDesign> tried_designs(const Study& study) {
  const Point start = baseline_point(study);
  std::vector<TriedDesign> designs = {{"baseline", overrides_of(study, start), start}};
  for (std::size_t i = 0; i < std::min(kMaxPrototypes, study.prototypes.size()); ++i) {
    designs.push_back({study.prototypes[i].name, study.prototypes[i].overrides, {}});
  }
  const Sobol sequence(study.search.seed + kSpreadSeed,
                       static_cast<int>(study.space.variables.size()));
  for (std::uint32_t k = 0; designs.size() < kCandidates; ++k) {
    const Point point = point_from_unit(study.space, sequence.point(k));
    designs.push_back({fmt::format("spread {}", k + 1), overrides_of(study, point), point});
  }
  return designs;
}

std::vector<RenderRung> search_ladder(const Study& study) {
  std::vector<SceneSettings> scenes = {study.scene};
  for (const TriedDesign& design : tried_designs(study)) {
    try {
      scenes.push_back(scene_with(study, design.overrides));
    } catch (const ConfigError&) {  // it will be replaced by another one
    }
  }
  std::vector<RenderRung> ladder = render_ladder(scenes, kept_keys(study.root));
  for (RenderRung& rung : ladder) {
    rung.is_for_search = rung.is_for_search && (rung.has_derivatives || !wants_derivatives(study));
  }
  return ladder;
}

}  // namespace glint
