// SPDX-License-Identifier: GPL-3.0-or-later
//
// All designs of a study scored again with what a refit has found: did the winner change? All are
// those that the run has written (winner, prototypes, finalists, baseline, of several objectives
// their front) and the 20 best trials of a search by one objective.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/pose.h"
#include "studies/definition/study.h"
#include "studies/imaging/scene_store.h"
#include "studies/validate/geometry_fit.h"
#include "studies/validate/light_changes.h"
#include "studies/validate/validate_verdict.h"

namespace glint {

/// What a refit changes in every design.
struct DesignRefit {
  SceneChange change;              ///< lights of a name that a design does not have are left out
  RigidTransform scene_from_part;  ///< motion of the part about the scene's origin
  /// Of designs all of whose lights shine at another power: in the place of the change's exposure.
  std::map<std::string, double> exposures = {};
};

/// What the findings of a validation change.
DesignRefit refit_of(const ValidationFindings& findings, const GeometryBudget& budget);

/// The scene of a design with the refit put in: exposure, roughness, blur, lights, the part's pose.
/// Where the part has moved, viewpoints of a sphere, a surface or a file become listed ones, seen
/// from where the camera then is.
/// @param store  makes the part that such viewpoints belong to
/// @param scene   exposed as its pictures are: exposed_as_acquired()
/// @param design  its name
SceneSettings refitted_scene(SceneStore& store,
                             const SceneSettings& scene,
                             const DesignRefit& refit,
                             const std::string& design);

/// @param names  of the run's folders of designs: written_designs()
/// @return { objective, designs: [ { name, of ("run", "search"), before, after } ], order_before,
///         order_after, winner_before, winner_after, changed, untold, text }; a score that cannot
///         be had is null, and the orders are without its design; changed: a design is ahead of the
///         winner by the refit that was not before, by more than two standard errors of rendering
///         (of both scores together); null where one is ahead by less, which `untold` names: it
///         cannot be told. With several objectives, which have no winner in common, of the run's
///         folders alone: { objectives: [ { objective, designs, order_before, order_after, changed
///         }
///         ], text }; changed: a design is ahead of another by the refit that was not before, by
///         more than two standard errors. Null without an objective
nlohmann::ordered_json rescore_designs(SceneStore& store,
                                       const Study& study,
                                       const std::filesystem::path& run,
                                       const std::vector<std::string>& names,
                                       const DesignRefit& refit);

}  // namespace glint
