// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/scores.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/text.h"
#include "metrics/score_table.h"

namespace glint {
namespace {

constexpr std::string_view kLabel = "<label>";
constexpr std::string_view kGroup = "<group>";
constexpr std::string_view kLow = ".low";
constexpr std::string_view kHigh = ".high";
constexpr std::string_view kError = ".error";

/// The name with the label in its place; unchanged without a place for one.
std::string with_label(std::string_view name,
                       std::string_view label,
                       std::string_view place = kLabel) {
  const std::size_t at = name.find(place);
  if (at == std::string_view::npos) {
    return std::string(name);
  }
  return fmt::format("{}{}{}", name.substr(0, at), label, name.substr(at + place.size()));
}

/// The place for a label or a group; empty: there is none.
std::string_view place_in(std::string_view name) {
  for (const std::string_view place : {kLabel, kGroup}) {
    if (name.find(place) != std::string_view::npos) {
      return place;
    }
  }
  return {};
}

/// Whether the name is that pattern with some label.
bool matches(std::string_view name, std::string_view pattern) {
  const std::string_view place = place_in(pattern);
  if (place.empty()) {
    return name == pattern;
  }
  const std::string_view before = pattern.substr(0, pattern.find(place));
  const std::string_view after = pattern.substr(before.size() + place.size());
  return name.size() > before.size() + after.size() && name.starts_with(before) &&
         name.ends_with(after);
}

const ScoreDoc* find_doc(std::string_view name) {
  const std::span<const ScoreDoc> docs = score_table();
  const auto found =
      std::ranges::find_if(docs, [&](const ScoreDoc& row) { return matches(name, row.name); });
  return found == docs.end() ? nullptr : &*found;
}

/// Scores of an inspection line that need no defect.
bool is_of_flawless(std::string_view name) {
  return name == "inspection.false_alarms" || name == "inspection.threshold" ||
         name == "inspection.region_share" || name == "inspection.rendering_share";
}

}  // namespace

std::span<const ScoreDoc> score_docs() {
  return score_table();
}

bool is_bound(std::string_view name) {
  return name.ends_with(kLow) || name.ends_with(kHigh);
}

std::string_view without_bound(std::string_view name) {
  for (const std::string_view end : {kLow, kHigh}) {
    if (name.ends_with(end)) {
      return name.substr(0, name.size() - end.size());
    }
  }
  return name;
}

std::string error_name(std::string_view score) {
  return fmt::format("{}{}", score, kError);
}

bool is_error(std::string_view name) {
  return name.ends_with(kError);
}

std::string_view without_error(std::string_view name) {
  return is_error(name) ? name.substr(0, name.size() - kError.size()) : name;
}

ScoreInterval interval_of(std::string_view name) {
  name = without_bound(name);
  if (find_doc(name) == nullptr || name == "inspection.threshold" ||
      name == "inspection.region_share" || name == "inspection.rendering_share" ||
      name == "inspection.rendering_error") {
    return ScoreInterval::kNone;
  }
  if (name.starts_with("inspection.")) {
    return ScoreInterval::kTrials;
  }
  const bool is_of_part = name == "defects.made" || name == "defects.mean_depth_um" ||
                          name == "defects.removed_volume_mm3";
  const bool is_of_picture = name.starts_with("homogeneity.") || name.starts_with("fringe.") ||
                             name.starts_with("defects.");
  return is_of_picture && !is_of_part ? ScoreInterval::kScans : ScoreInterval::kNone;
}

namespace {

/// @param whole  the score whose standard error is explained
std::optional<std::string> explain_error(std::string_view whole) {
  const ScoreDoc* of_whole = find_doc(whole);
  if (of_whole == nullptr || interval_of(whole) != ScoreInterval::kScans || is_bound(whole)) {
    return std::nullopt;
  }
  return fmt::format(
      "standard error of {} by the noise of path tracing, from the scatter of "
      "render.paths.batches independent pictures; {}",
      whole,
      of_whole->doc);
}

}  // namespace

std::optional<std::string> explain_score(std::string_view name) {
  if (is_error(name)) {
    return explain_error(without_error(name));
  }
  const ScoreDoc* row = find_doc(without_bound(name));
  if (row == nullptr || (is_bound(name) && interval_of(name) == ScoreInterval::kNone)) {
    return std::nullopt;
  }
  if (!is_bound(name)) {
    return std::string(row->doc);
  }
  return fmt::format(
      "{} bound of the interval of {} (confidence: inspection.trials.confidence), from {}; {}",
      name.ends_with(kLow) ? "lower" : "upper",
      without_bound(name),
      interval_of(name) == ScoreInterval::kTrials
          ? "the parts and scans of inspection.trials"
          : "inspection.trials.noise_seeds scans with other noise",
      row->doc);
}

std::vector<std::string> score_names(std::span<const std::string> labels,
                                     std::span<const std::string> groups) {
  std::vector<std::string> names;
  for (const ScoreDoc& row : score_table()) {
    const bool lacks_defects = row.name.starts_with("defects.") && labels.empty();
    const bool lacks_groups =
        row.name.starts_with("inspection.") && groups.empty() && !is_of_flawless(row.name);
    if (place_in(row.name).empty() && !lacks_defects && !lacks_groups) {
      names.emplace_back(row.name);
    }
  }
  for (const auto& [place, all] : {std::pair{kLabel, labels}, std::pair{kGroup, groups}}) {
    for (const std::string& label : all) {
      for (const ScoreDoc& row : score_table()) {
        if (place_in(row.name) == place) {
          names.push_back(with_label(row.name, label, place));
        }
      }
    }
  }
  return names;
}

std::string unknown_score(std::string_view name,
                          std::span<const std::string> labels,
                          std::span<const std::string> groups) {
  const std::vector<std::string> names = score_names(labels, groups);
  if (is_error(name) && std::ranges::find(names, without_error(name)) != names.end()) {
    return fmt::format("is a standard error, which comes with {} and is no aim of its own",
                       without_error(name));
  }
  const std::string_view whole = without_bound(name);
  if (std::ranges::find(names, whole) != names.end()) {
    const bool has_it = !is_bound(name) || interval_of(name) != ScoreInterval::kNone;
    return has_it ? ""
                  : fmt::format("has no interval: {} is no estimate from scans or trials", whole);
  }
  const bool is_of_defects = name.starts_with("defects.") && labels.empty();
  const bool is_of_groups =
      name.starts_with("inspection.") && groups.empty() && find_doc(whole) != nullptr;
  if (is_of_defects || is_of_groups) {
    return "is no score of a scene without defects, [defects.<name>] adds one";
  }
  return fmt::format(
      "is no score, did you mean \"{}{}\"?", nearest(whole, names), name.substr(whole.size()));
}

void add_scores(Scores& scores, const Homogeneity& homogeneity) {
  scores["homogeneity.h_rms"] = homogeneity.h_rms;
  scores["homogeneity.h_abs"] = homogeneity.h_abs;
  if (homogeneity.robust) {
    scores["homogeneity.robust"] = *homogeneity.robust;
  }
  scores["homogeneity.mean"] = homogeneity.mean;
  scores["homogeneity.clipped_share"] = homogeneity.clipped_share;
  scores["homogeneity.lit_share"] = homogeneity.lit_share;
}

void add_scores(Scores& scores, const HomogeneityFamily& family) {
  scores["homogeneity.u0"] = family.u0;
  scores["homogeneity.residual"] = family.residual;
  scores["homogeneity.low_share"] = family.low_share;
  scores["homogeneity.high_share"] = family.high_share;
  scores["homogeneity.worst_region"] = family.worst_region;
  if (family.ripple) {
    scores["homogeneity.ripple"] = *family.ripple;
  }
}

bool is_of_coverage(std::string_view name) {
  return name.starts_with("coverage.");
}

bool is_of_reference(std::string_view name) {
  return name.starts_with("overlap.") || name.starts_with("appearance.");
}

bool is_of_reach(std::string_view name) {
  return name.starts_with("reach.");
}

bool is_of_family(std::string_view name) {
  Scores scores;
  add_scores(scores, HomogeneityFamily{.ripple = 0.0});
  return scores.contains(std::string(without_bound(name)));
}

bool needs_fringes(std::string_view name) {
  return name.starts_with("fringe") || name.starts_with("homogeneity.ripple");
}

bool needs_flawless(std::string_view name) {
  name = without_bound(name);
  if (name.ends_with(".error")) {
    name.remove_suffix(std::string_view(".error").size());
  }
  return name.starts_with("defects.") && (name.ends_with("change") || name.ends_with("union"));
}

void add_scores(Scores& scores, const FringeScores& fringes) {
  scores["fringe.regularity"] = fringes.regularity;
  scores["fringe.period_px"] = fringes.period_px;
  scores["fringe.duty_error"] = fringes.duty_error;
  scores["fringe.modulation"] = fringes.modulation;
}

void add_scores(Scores& scores, const DefectTotals& totals) {
  if (totals.made > 0) {
    scores["defects.made"] = totals.made;
    scores["defects.mean_depth_um"] = totals.mean_depth_um;
    scores["defects.removed_volume_mm3"] = totals.removed_volume_mm3;
  }
}

namespace {

void add_summary(Scores& scores, const DefectSummary& summary) {
  scores["defects.min_cnr"] = summary.min_cnr;
  scores["defects.min_weber"] = summary.min_weber;
  scores["defects.mean_weber"] = summary.mean_weber;
  scores["defects.min_dprime"] = summary.min_dprime;
  scores["defects.min_signature"] = summary.min_signature;
  scores["defects.min_change"] = summary.min_change;
  scores["defects.mean_change"] = summary.mean_change;
  scores["defects.min_rms_contrast"] = summary.min_rms_contrast;
  scores["defects.min_best_frame"] = summary.min_best_frame;
  scores["defects.min_union"] = summary.min_union;
}

}  // namespace

void add_scores(Scores& scores, std::span<const DefectScores> defects) {
  for (const DefectScores& defect : defects) {
    scores[with_label("defects.<label>.cnr", defect.label)] = defect.cnr;
    scores[with_label("defects.<label>.weber", defect.label)] = defect.weber;
    scores[with_label("defects.<label>.peak", defect.label)] = defect.peak;
    scores[with_label("defects.<label>.michelson", defect.label)] = defect.michelson;
    scores[with_label("defects.<label>.dprime", defect.label)] = defect.dprime;
    scores[with_label("defects.<label>.signature", defect.label)] = defect.signature;
    scores[with_label("defects.<label>.best_frame", defect.label)] = defect.best_frame;
    scores[with_label("defects.<label>.change", defect.label)] = defect.change;
    scores[with_label("defects.<label>.rms_contrast", defect.label)] = defect.rms_contrast;
    scores[with_label("defects.<label>.union", defect.label)] = defect.union_area;
  }
  if (!defects.empty()) {
    add_summary(scores, summarise(defects));
  }
}

}  // namespace glint
