// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/population/sorting_parts.h"

#include <algorithm>
#include <cmath>

#include "core/rng.h"

namespace glint {
namespace {

/// Beyond every index that defects and seeds of parts draw from.
constexpr std::uint64_t kSourceIndex = std::uint64_t{1} << 61;

/// The source of a part, by shares.
const PartSource& source_of(const SortingSettings& settings, int seed, std::int64_t number) {
  double total = 0.0;
  for (const PartSource& source : settings.sources) {
    total += source.share;
  }
  Rng rng(static_cast<std::uint64_t>(seed),
          Stream::kDefects,
          kSourceIndex + static_cast<std::uint64_t>(number));
  double left = total * rng.uniform();
  for (const PartSource& source : settings.sources) {
    left -= source.share;
    if (left < 0.0) {
      return source;
    }
  }
  return settings.sources.back();
}

DefectKind kind_of(DefectType type) {
  return is_line(type) ? DefectKind::kScratch : DefectKind::kHole;
}

/// Defects that were found, and how many of them as the other kind: the biggest blob says which.
void count_found(const ScannedPart& part,
                 const std::vector<FoundDefect>& blobs,
                 const DetectionMatches& matches,
                 Scores& figures) {
  int found = 0;
  int other_kind = 0;
  for (std::size_t i = 0; i < part.defects.size(); ++i) {
    if (!matches.is_found(i)) {
      continue;
    }
    ++found;
    const FoundDefect* biggest = nullptr;
    for (std::size_t k = 0; k < blobs.size(); ++k) {
      const bool is_its = matches.defect_of_blob[k] == static_cast<int>(i);
      if (is_its && (biggest == nullptr || blobs[k].area_px > biggest->area_px)) {
        biggest = &blobs[k];
      }
    }
    const DefectType type = part.defects[i].defect.type;
    other_kind += biggest != nullptr && biggest->kind != kind_of(type) ? 1 : 0;
  }
  figures["found"] = found;
  figures["other_kind"] = other_kind;
}

}  // namespace

ExpertView expert_view(std::span<const Defect> defects, const ExpertRule& rule) {
  ExpertView view;
  for (const Defect& defect : defects) {
    if (defect.depth_mm < rule.noticed_mm || defect.type == DefectType::kStain) {
      continue;
    }
    if (is_line(defect.type)) {
      view.longest_scratch_mm = std::max(view.longest_scratch_mm, defect.length_mm);
    } else {
      view.widest_hole_mm = std::max(view.widest_hole_mm, defect.diameter_mm);
      ++view.holes;
    }
  }
  return view;
}

Grade expert_grade(const ExpertView& view, const ExpertRule& rule) {
  if (view.longest_scratch_mm > rule.perfect_scratch_mm ||
      view.widest_hole_mm > rule.acceptable_hole_mm || view.holes > rule.acceptable_holes) {
    return Grade::kRejected;
  }
  const bool is_perfect =
      view.widest_hole_mm <= rule.perfect_hole_mm && view.holes <= rule.perfect_holes;
  return is_perfect ? Grade::kPerfect : Grade::kAcceptable;
}

bool is_near_border(const ExpertView& view, const ExpertRule& rule, double share) {
  const auto is_near = [&](double size_mm, double limit_mm) {
    return size_mm > 0.0 && std::abs(size_mm - limit_mm) <= share * limit_mm;
  };
  return is_near(view.widest_hole_mm, rule.perfect_hole_mm) ||
         is_near(view.widest_hole_mm, rule.acceptable_hole_mm) ||
         is_near(view.longest_scratch_mm, rule.perfect_scratch_mm);
}

Grade grade_of(const SortedPart& part, const LearnedLimits& limits) {
  return std::max(grade_by(part.holes, limits.holes), grade_by(part.scratches, limits.scratches));
}

LearnedLimits limits_from(std::span<const SortedPart> parts) {
  std::vector<LabelledPart> labelled;
  for (const SortedPart& part : parts) {
    if (part.is_for_learning()) {
      labelled.push_back({.holes = part.holes, .scratches = part.scratches, .grade = part.expert});
    }
  }
  return learn_limits(labelled);
}

bool is_imprinted(const SortingSettings& settings, std::int64_t number) {
  const std::int64_t every = settings.imprinted_every;
  if (every == 0) {
    return false;
  }
  const std::int64_t block = number / every;
  const std::int64_t place = every % 2 == 0 ? block % 2 : 0;  // odd steps alternate by themselves
  return number % every == place;
}

std::vector<NamedGroup> groups_of_part(const SortingSettings& settings,
                                       const std::vector<NamedGroup>& defects,
                                       int seed,
                                       std::int64_t number) {
  std::vector<NamedGroup> groups = defects;
  if (!settings.sources.empty()) {
    const std::vector<std::string>& wanted = source_of(settings, seed, number).groups;
    std::erase_if(groups, [&](const NamedGroup& group) {
      return std::ranges::find(wanted, group.first) == wanted.end();
    });
  }
  if (is_imprinted(settings, number)) {
    for (auto& [name, group] : groups) {
      if (group.type != DefectType::kStain) {
        group.realisation = Realisation::kImprinted;
      }
    }
  }
  return groups;
}

Scores inspect_part(const SimulatedLine& line,
                    const SortingSettings& settings,
                    double threshold,
                    std::int64_t number) {
  const SceneSettings& scene = line.scene();
  const ScannedPart part =
      line.part_with(groups_of_part(settings, scene.defects, scene.imprint.seed, number), number);
  const std::vector<FoundDefect> blobs = line.inspect(part, threshold);
  const DetectionMatches matches = match_detections(blobs, part.defects, scene.inspection.trials);
  std::vector<Defect> defects;
  for (const TrueDefect& truth : part.defects) {
    defects.push_back(truth.defect);
  }
  const ExpertView view = expert_view(defects, settings.expert);
  const InspectionSettings::Measure measure = scene.inspection.measure;
  const DefectSizes holes = sizes_of(blobs, DefectKind::kHole, measure);
  const DefectSizes scratches = sizes_of(blobs, DefectKind::kScratch, measure);
  Scores figures = {{"true.hole_mm", view.widest_hole_mm},
                    {"true.holes", view.holes},
                    {"true.scratch_mm", view.longest_scratch_mm},
                    {"expert", static_cast<double>(expert_grade(view, settings.expert))},
                    {"holes.biggest", holes.biggest},
                    {"holes.sum", holes.sum},
                    {"scratches.biggest", scratches.biggest},
                    {"scratches.sum", scratches.sum},
                    {"defects", static_cast<double>(part.defects.size())},
                    {"false_alarms", matches.false_alarms()},
                    {"imprinted", is_imprinted(settings, number) ? 1.0 : 0.0}};
  count_found(part, blobs, matches, figures);
  return figures;
}

SortedPart sorted_part(const Scores& figures, int number) {
  const auto whole = [&](const char* name) { return static_cast<int>(figures.at(name)); };
  return {
      .number = number,
      .truth = {.widest_hole_mm = figures.at("true.hole_mm"),
                .holes = whole("true.holes"),
                .longest_scratch_mm = figures.at("true.scratch_mm")},
      .expert = static_cast<Grade>(whole("expert")),
      .holes = {.biggest = figures.at("holes.biggest"), .sum = figures.at("holes.sum")},
      .scratches = {.biggest = figures.at("scratches.biggest"), .sum = figures.at("scratches.sum")},
      .defects = whole("defects"),
      .found = whole("found"),
      .other_kind = whole("other_kind"),
      .false_alarms = whole("false_alarms"),
      .is_imprinted = figures.at("imprinted") != 0.0};
}

}  // namespace glint
