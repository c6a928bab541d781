// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/population/sorting.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/cpu_clock.h"
#include "core/csv.h"
#include "core/file.h"
#include "metrics/inspection/learn_limits.h"
#include "studies/inspection_line/inspection_json.h"
#include "studies/population/sorting_parts.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<Grade, 3> kGrades = {Grade::kPerfect, Grade::kAcceptable, Grade::kRejected};
constexpr double kBorderShare = 0.05;

/// What came out at one lighting.
struct SortedDesign {
  PopulationDesign design;
  double threshold = 0.0;
  double region_share = 0.0;
  std::vector<SortedPart> parts;
  std::int64_t flawless_scans = 0;
  std::int64_t flawless_blobs = 0;
  LearnedLimits limits;  ///< learned at this lighting
};

std::string grade_text(Grade grade) {
  return std::string(grade_name(grade));
}

int parts_of(const SortingSettings& settings, const PopulationDesign& design) {
  return design.prototype == nullptr ? settings.parts
                                     : std::min(settings.parts, settings.prototype_parts);
}

std::vector<SortedPart> tested(const std::vector<SortedPart>& parts) {
  std::vector<SortedPart> some;
  std::ranges::copy_if(
      parts, std::back_inserter(some), [](const SortedPart& p) { return !p.is_for_learning(); });
  return some;
}

int count_right(const std::vector<SortedPart>& parts, const LearnedLimits& limits) {
  return static_cast<int>(std::ranges::count_if(
      parts, [&](const SortedPart& part) { return grade_of(part, limits) == part.expert; }));
}

Json share_json(int hits, std::size_t trials, double confidence) {
  return estimate_json(wilson(hits, static_cast<std::int64_t>(trials), confidence));
}

/// Rows are the expert's classes, columns the line's.
Json confusion_json(const std::vector<SortedPart>& parts, const LearnedLimits& limits) {
  Json confusion = Json::object();
  for (const Grade expert : kGrades) {
    Json row = Json::object();
    for (const Grade sorted : kGrades) {
      row[grade_text(sorted)] = std::ranges::count_if(parts, [&](const SortedPart& part) {
        return part.expert == expert && grade_of(part, limits) == sorted;
      });
    }
    confusion[grade_text(expert)] = row;
  }
  return confusion;
}

/// Parts whose grade hangs on a hair, and how many of the wrong ones are among them.
Json border_json(const std::vector<SortedPart>& parts,
                 const LearnedLimits& limits,
                 const ExpertRule& rule) {
  int near = 0;
  int wrong = 0;
  int wrong_near = 0;
  for (const SortedPart& part : parts) {
    const bool is_near = is_near_border(part.truth, rule, kBorderShare);
    const bool is_wrong = grade_of(part, limits) != part.expert;
    near += is_near ? 1 : 0;
    wrong += is_wrong ? 1 : 0;
    wrong_near += is_near && is_wrong ? 1 : 0;
  }
  return {{"within", kBorderShare},
          {"parts", near},
          {"share", static_cast<double>(near) / static_cast<double>(parts.size())},
          {"wrong", wrong},
          {"wrong_near_border", wrong_near}};
}

Json wrong_parts_json(const std::vector<SortedPart>& parts, const LearnedLimits& limits) {
  Json list = Json::array();
  for (const SortedPart& part : parts) {
    if (grade_of(part, limits) != part.expert) {
      list.push_back({{"part", part.number},
                      {"expert", grade_text(part.expert)},
                      {"sorted", grade_text(grade_of(part, limits))},
                      {"widest_hole_mm", part.truth.widest_hole_mm},
                      {"holes", part.truth.holes},
                      {"longest_scratch_mm", part.truth.longest_scratch_mm},
                      {"imprinted", part.is_imprinted}});
    }
  }
  return list;
}

template <class Member>
std::int64_t total(const std::vector<SortedPart>& parts, Member member) {
  std::int64_t sum = 0;
  for (const SortedPart& part : parts) {
    sum += part.*member;
  }
  return sum;
}

/// @param own  limits learned at the study's own lighting
Json design_json(const SortedDesign& sorted, const LearnedLimits& own, const Study& study) {
  const double confidence = study.scene.inspection.trials.confidence;
  const std::vector<SortedPart> test = tested(sorted.parts);
  const int right = count_right(test, sorted.limits);
  const int right_with_own = count_right(test, own);
  const std::int64_t defects = total(sorted.parts, &SortedPart::defects);
  const std::int64_t found = total(sorted.parts, &SortedPart::found);
  Json json = {{"title", sorted.design.title},
               {"parts", sorted.parts.size()},
               {"learned_from", sorted.parts.size() - test.size()},
               {"wrong_of_learned", sorted.limits.wrong},
               {"tested", test.size()},
               {"right", right},
               {"share_right", share_json(right, test.size(), confidence)},
               {"share_right_with_own_limits", share_json(right_with_own, test.size(), confidence)},
               {"confusion", confusion_json(test, sorted.limits)},
               {"limits",
                {{"holes", limits_json(sorted.limits.holes)},
                 {"scratches", limits_json(sorted.limits.scratches)}}},
               {"near_border", border_json(test, sorted.limits, study.sorting->expert)},
               {"wrong_parts", wrong_parts_json(test, sorted.limits)},
               {"defects", defects},
               {"found", found}};
  if (defects > 0) {
    json["share_found"] = estimate_json(wilson(found, defects, confidence));
  }
  json["other_kind"] = total(sorted.parts, &SortedPart::other_kind);
  json["false_alarms"] =
      false_alarms_json(sorted.flawless_blobs, sorted.flawless_scans, confidence);
  json["false_alarms_beside_defects"] =
      false_alarms_json(total(sorted.parts, &SortedPart::false_alarms),
                        static_cast<std::int64_t>(sorted.parts.size()),
                        confidence);
  json["threshold"] = sorted.threshold;
  json["region_share"] = sorted.region_share;
  return json;
}

std::string parts_csv(const std::vector<SortedDesign>& designs, const LearnedLimits& own) {
  std::string csv =
      "design,part,half,imprinted,expert,sorted,sorted_with_own_limits,widest_hole_mm,holes,"
      "longest_scratch_mm,holes_biggest,holes_sum,scratches_biggest,scratches_sum,defects,found,"
      "other_kind,false_alarms\n";
  for (const SortedDesign& design : designs) {
    for (const SortedPart& part : design.parts) {
      csv += csv_row_of(design.design.key,
                        part.number,
                        part.is_for_learning() ? "learned" : "tested",
                        part.is_imprinted ? "yes" : "no",
                        grade_name(part.expert),
                        grade_name(grade_of(part, design.limits)),
                        grade_name(grade_of(part, own)),
                        part.truth.widest_hole_mm,
                        part.truth.holes,
                        part.truth.longest_scratch_mm,
                        part.holes.biggest,
                        part.holes.sum,
                        part.scratches.biggest,
                        part.scratches.sum,
                        part.defects,
                        part.found,
                        part.other_kind,
                        part.false_alarms);
    }
  }
  return csv;
}

/// The expert's grade by holes alone, or by scratches alone.
Grade grade_by_kind(ExpertView view, const ExpertRule& rule, DefectKind kind) {
  if (kind == DefectKind::kHole) {
    view.longest_scratch_mm = 0.0;
  } else {
    view.widest_hole_mm = 0.0;
    view.holes = 0;
  }
  return expert_grade(view, rule);
}

/// Biggest and sum of every part for one kind of defects, with the limits: a chart of the report.
Json sizes_json(const SortedDesign& sorted, const Study& study, DefectKind kind) {
  const bool is_area = study.scene.inspection.measure == InspectionSettings::Measure::kArea;
  const bool is_hole = kind == DefectKind::kHole;
  const GradeLimits& limits = is_hole ? sorted.limits.holes : sorted.limits.scratches;
  Json points = Json::array();
  for (const SortedPart& part : sorted.parts) {
    const DefectSizes& sizes = is_hole ? part.holes : part.scratches;
    const Grade expert = grade_by_kind(part.truth, study.sorting->expert, kind);
    points.push_back({{"biggest", sizes.biggest},
                      {"sum", sizes.sum},
                      {"grade", grade_text(expert)},
                      {"is_tested", !part.is_for_learning()},
                      {"is_wrong", grade_by(sizes, limits) != expert}});
  }
  return {{"title",
           fmt::format("{} on {} parts, classes by {} alone",
                       is_hole ? "Holes and bumps" : "Scratches",
                       sorted.parts.size(),
                       is_hole ? "holes" : "scratches")},
          {"unit", is_area ? "px" : "weight"},
          {"limits", limits_json(limits)},
          {"points", points}};
}

class Sorting {
 public:
  explicit Sorting(const PopulationTask& task)
      : task_(task),
        settings_(*task.study.sorting),
        records_(task.storage),
        progress_(task, sorting_counts(task.study).parts + sorting_counts(task.study).flawless) {}

  std::optional<Json> execute() {
    for (const PopulationDesign& design : population_designs(task_.study)) {
      std::optional<SortedDesign> sorted = sort(design);
      if (!sorted) {
        return std::nullopt;
      }
      designs_.push_back(std::move(*sorted));
    }
    return write();
  }

 private:
  std::optional<SortedDesign> sort(const PopulationDesign& design) {
    const std::string name = "sorting/" + design.key;
    const std::unique_ptr<SimulatedLine> line = line_of(task_, design);
    SortedDesign sorted = {.design = design, .parts = {}, .limits = {}};
    sorted.threshold = recorded_threshold(records_, *line, name + "/threshold");
    sorted.region_share = line->region_share();
    const auto parts = record_all(task_,
                                  records_,
                                  progress_,
                                  name + "/part",
                                  parts_of(settings_, design),
                                  [&](std::int64_t number) {
                                    return inspect_part(*line, settings_, sorted.threshold, number);
                                  });
    if (!parts) {
      return std::nullopt;
    }
    for (std::size_t i = 0; i < parts->size(); ++i) {
      sorted.parts.push_back(sorted_part((*parts)[i], static_cast<int>(i)));
    }
    sorted.limits = limits_from(sorted.parts);
    return count_false_alarms(*line, name, sorted) ? std::optional(std::move(sorted))
                                                   : std::nullopt;
  }

  /// @return false when interrupted
  bool count_false_alarms(const SimulatedLine& line,
                          const std::string& name,
                          SortedDesign& sorted) {
    const int scans = flawless_of(settings_, sorted.design);
    const auto flawless =
        record_all(task_, records_, progress_, name + "/flawless", scans, [&](std::int64_t number) {
          return inspect_flawless(line, sorted.threshold, number);
        });
    if (!flawless) {
      return false;
    }
    sorted.flawless_scans = scans;
    for (const Scores& scan : *flawless) {
      sorted.flawless_blobs += static_cast<std::int64_t>(scan.at("blobs"));
    }
    return true;
  }

  Json write() const {
    const LearnedLimits& own = designs_.front().limits;
    Json designs = Json::object();
    for (const SortedDesign& sorted : designs_) {
      designs[sorted.design.key] = design_json(sorted, own, task_.study);
    }
    write_file(task_.out / "sorting.csv", parts_csv(designs_, own));
    const Json sizes = {sizes_json(designs_.front(), task_.study, DefectKind::kHole),
                        sizes_json(designs_.front(), task_.study, DefectKind::kScratch)};
    write_file(task_.out / "sorting_sizes.json", sizes.dump() + "\n");
    return {{"confidence", task_.study.scene.inspection.trials.confidence}, {"designs", designs}};
  }

  const PopulationTask& task_;
  const SortingSettings& settings_;
  PartRecords records_;
  PopulationProgress progress_;
  std::vector<SortedDesign> designs_;
};

}  // namespace

std::optional<Json> run_sorting(const PopulationTask& task) {
  return Sorting(task).execute();
}

SortingCounts sorting_counts(const Study& study) {
  SortingCounts counts;
  for (const PopulationDesign& design : population_designs(study)) {
    counts.parts += parts_of(*study.sorting, design);
    counts.flawless += flawless_of(*study.sorting, design);
  }
  return counts;
}

namespace {

/// The numbers of parts without imprinted defects, in order.
std::int64_t plain_number(const SortingSettings& settings, std::int64_t index) {
  if (settings.imprinted_every == 1) {
    return index;  // there are none
  }
  std::int64_t number = 0;
  for (std::int64_t left = index; left > 0 || is_imprinted(settings, number); ++number) {
    left -= is_imprinted(settings, number) ? 0 : 1;
  }
  return number;
}

}  // namespace

double predicted_sorting_s(const Study& study, SceneStore& store) {
  const SortingSettings& settings = *study.sorting;
  const SimulatedLine line(store, study.scene);
  const double threshold = study.scene.inspection.threshold_grey;
  const PopulationPace pace = measure_pace(line, store.pool(), [&](std::int64_t index) {
    inspect_part(line, settings, threshold, plain_number(settings, index));
  });
  const SortingCounts counts = sorting_counts(study);
  const std::int64_t imprinted =
      settings.imprinted_every > 0 ? counts.parts / settings.imprinted_every : 0;
  double imprinted_s = 0.0;
  if (imprinted > 0) {
    const double start = process_cpu_s();
    inspect_part(line, settings, threshold, 0);  // the first one is imprinted
    imprinted_s = process_cpu_s() - start;
  }
  const auto designs = static_cast<std::int64_t>(population_designs(study).size());
  const std::int64_t flawless =
      counts.flawless + designs * num_threshold_scans(study.scene.inspection);
  return pace.part_s * static_cast<double>(counts.parts - imprinted) +
         imprinted_s * static_cast<double>(imprinted) +
         pace.flawless_s * static_cast<double>(flawless);
}

}  // namespace glint
