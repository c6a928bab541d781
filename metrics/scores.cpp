// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/scores.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "core/text.h"

namespace glint {
namespace {

constexpr std::string_view kLabel = "<label>";

constexpr std::array kDocs = {
    ScoreDoc{
        "homogeneity.h_rms",
        "1 - standard deviation / mean of the aspect image over the flawless region; 1 is even"},
    ScoreDoc{"homogeneity.h_abs",
             "1 - mean absolute deviation / mean of the aspect image over the flawless region"},
    ScoreDoc{"homogeneity.robust",
             "1 - (P95 - P5) / (P95 + P5) of the aspect image over the flawless region"},
    ScoreDoc{"homogeneity.mean", "mean aspect value of the flawless region, share of full scale"},
    ScoreDoc{"homogeneity.clipped_share",
             "share of the flawless region at full scale in every frame, where nothing can show"},
    ScoreDoc{"homogeneity.lit_share", "share of the flawless region that light reaches"},
    ScoreDoc{"fringe.regularity",
             "coefficient of variation of the stripe spacing along the rows; 0 is regular"},
    ScoreDoc{"fringe.period_px", "mean stripe spacing along the rows in pixels"},
    ScoreDoc{"fringe.duty_error", "bright share of the stripes minus the nominal duty"},
    ScoreDoc{"fringe.modulation", "(max - min) / (max + min) of the stripes"},
    ScoreDoc{"defects.made", "how many defects the part has"},
    ScoreDoc{"defects.mean_depth_um", "mean depth of the defects, height of bumps"},
    ScoreDoc{"defects.removed_volume_mm3",
             "volume that imprinted and displaced defects take away; bumps count as negative"},
    ScoreDoc{"defects.min_cnr", "smallest contrast-to-noise ratio of any defect"},
    ScoreDoc{"defects.min_weber", "smallest |Weber contrast| of any defect"},
    ScoreDoc{"defects.mean_weber", "mean |Weber contrast| of the defects"},
    ScoreDoc{"defects.min_dprime", "smallest detectability d' of any defect"},
    ScoreDoc{"defects.min_signature", "smallest signature area ratio of any defect"},
    ScoreDoc{"defects.min_change", "smallest change of any defect: what the worst one shows"},
    ScoreDoc{"defects.mean_change", "mean change of the defects"},
    ScoreDoc{
        "defects.<label>.cnr",
        "|mean of the defect - mean of its background| / standard deviation of the background"},
    ScoreDoc{"defects.<label>.weber",
             "(mean of the defect - mean of its background) / mean of the background"},
    ScoreDoc{"defects.<label>.peak",
             "Weber contrast of the defect's pixel that deviates most from the background"},
    ScoreDoc{"defects.<label>.michelson", "(max - min) / (max + min) within two defect radii"},
    ScoreDoc{"defects.<label>.dprime",
             "norm of the defect's deviation image / standard deviation of the background"},
    ScoreDoc{"defects.<label>.signature",
             "area that deviates visibly from the background / true area of the defect"},
    ScoreDoc{"defects.<label>.best_frame",
             "largest |mean of the defect - mean of its background| of any single frame"},
    ScoreDoc{"defects.<label>.change",
             "largest mean |frame - the same frame of the flawless part| over the defect, share of "
             "full scale; under stripes of full contrast the share of its area that flips"},
    ScoreDoc{"view.hidden_share", "share of the part's pixels the wall hides from the camera"},
    ScoreDoc{"view.slot_margin_mm",
             "smallest distance of a sight line to the flawless region from the edge of the camera "
             "slot, across the tunnel; negative: the wall hides some of it"},
    ScoreDoc{"rays.followed_share", "share of the rays that met the part again and were followed"},
    ScoreDoc{"rays.blocked_share", "share of the rays that were given up as dark"},
};

/// The name with the label in its place; unchanged without a place for one.
std::string with_label(std::string_view name, std::string_view label) {
  const std::size_t at = name.find(kLabel);
  if (at == std::string_view::npos) {
    return std::string(name);
  }
  return fmt::format("{}{}{}", name.substr(0, at), label, name.substr(at + kLabel.size()));
}

bool has_label(std::string_view name) {
  return name.find(kLabel) != std::string_view::npos;
}

/// Whether the name is that pattern with some label.
bool matches(std::string_view name, std::string_view pattern) {
  if (!has_label(pattern)) {
    return name == pattern;
  }
  const std::string_view before = pattern.substr(0, pattern.find(kLabel));
  const std::string_view after = pattern.substr(before.size() + kLabel.size());
  return name.size() > before.size() + after.size() && name.starts_with(before) &&
         name.ends_with(after);
}

}  // namespace

std::span<const ScoreDoc> score_docs() {
  return kDocs;
}

std::optional<std::string_view> explain_score(std::string_view name) {
  const auto found = std::find_if(
      kDocs.begin(), kDocs.end(), [&](const ScoreDoc& row) { return matches(name, row.name); });
  return found == kDocs.end() ? std::nullopt : std::optional(found->doc);
}

std::vector<std::string> score_names(std::span<const std::string> labels) {
  std::vector<std::string> names;
  for (const ScoreDoc& row : kDocs) {
    const bool needs_defects = row.name.starts_with("defects.");
    if (!has_label(row.name) && !(needs_defects && labels.empty())) {
      names.emplace_back(row.name);
    }
  }
  for (const std::string& label : labels) {
    for (const ScoreDoc& row : kDocs) {
      if (has_label(row.name)) {
        names.push_back(with_label(row.name, label));
      }
    }
  }
  return names;
}

std::string unknown_score(std::string_view name, std::span<const std::string> labels) {
  const std::vector<std::string> names = score_names(labels);
  if (std::find(names.begin(), names.end(), name) != names.end()) {
    return {};
  }
  if (labels.empty() && name.starts_with("defects.")) {
    return "is no score of a scene without defects, [defects.<name>] adds one";
  }
  return fmt::format("is no score, did you mean \"{}\"?", nearest(name, names));
}

void add_scores(Scores& scores, const Homogeneity& homogeneity) {
  scores["homogeneity.h_rms"] = homogeneity.h_rms;
  scores["homogeneity.h_abs"] = homogeneity.h_abs;
  scores["homogeneity.robust"] = homogeneity.robust;
  scores["homogeneity.mean"] = homogeneity.mean;
  scores["homogeneity.clipped_share"] = homogeneity.clipped_share;
  scores["homogeneity.lit_share"] = homogeneity.lit_share;
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
  }
  if (defects.empty()) {
    return;
  }
  const DefectSummary summary = summarise(defects);
  scores["defects.min_cnr"] = summary.min_cnr;
  scores["defects.min_weber"] = summary.min_weber;
  scores["defects.mean_weber"] = summary.mean_weber;
  scores["defects.min_dprime"] = summary.min_dprime;
  scores["defects.min_signature"] = summary.min_signature;
  scores["defects.min_change"] = summary.min_change;
  scores["defects.mean_change"] = summary.mean_change;
}

}  // namespace glint
