// SPDX-License-Identifier: GPL-3.0-or-later
//
// The designs of a front after the search: which of them are shown, what they are worth with fresh
// seeds, and what is left of the front then.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "optimizer/problem/goal.h"
#include "optimizer/problem/trial.h"

namespace glint {

/// The numbers of an object of scores.
Scores scores_from_json(const nlohmann::ordered_json& json);

/// The standard error of a fresh score: 0 of scores that follow from settings (of the lighting, of
/// coverage and of reach); else the score's own, the standard deviation of the scans with other
/// noise, or a quarter of the width of its interval of 95 %; empty where nothing tells.
/// @param written  the object of a scores.json, with `rescored` and, if scanned so, `repeated`
std::optional<double> fresh_error(const nlohmann::ordered_json& written, const std::string& score);

/// Designs of a front that are written with all their pictures and scored again, the chosen one
/// among them; and of the others those that get a small picture.
inline constexpr int kFullDesigns = 12;
inline constexpr int kThumbnailDesigns = 240;

/// Adds to each design of a front:
///   contribution  the hypervolume that is lost without it
///   shown         "full": one of the kFullDesigns with the largest contributions, or the chosen
///                 one; "thumbnail": one of the next ones; "none"
///   folder        of its files, in the run's: "winner" or "front/trial_017"; absent for "none"
/// @param front  front_json() of studies/run/study_search.h, where all this is described
void plan_front(const Goal& goal, nlohmann::ordered_json& front);

/// Adds to a design what it is worth with fresh seeds:
///   rescored         scores of objectives and limits
///   rescored_errors  their standard errors, fresh_error(); absent for a score that has none
///   told             { objective: { value, low, high } }, told_value() of the scans with other
///   noise
///                    and of what the search's model expects; absent without such scans
///   keeps_limits     whether these scores are within all limits; absent without limits
/// Nothing where the design was not scored again.
/// @param written  the object of its scores.json
void add_rescored(const Goal& goal,
                  const nlohmann::ordered_json& written,
                  nlohmann::ordered_json& design);

/// Compares the designs of a front that were scored again, those within the limits with each other:
///   dominated_by          trial of the first one that is nowhere worse and somewhere better by the
///                         fresh scores; absent: none is
///   probability_on_front  of being beaten by none of them, errors taken as normal and independent;
///                         absent unless every fresh score has an error
/// @return { designs: that were scored again, dominated: how many of them are,
///           hypervolume: of them by the fresh scores, noise: half its interval or
///           null, searched: by those of the search }
nlohmann::ordered_json judge_front(const Goal& goal, nlohmann::ordered_json& front);

}  // namespace glint
