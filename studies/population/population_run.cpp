// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/population/population_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/cpu_clock.h"
#include "studies/inspection_line/inspection_json.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

/// @throws ConfigError with the place of the value at fault
SceneSettings population_scene(const Study& study, const PopulationDesign& design) {
  return design.prototype == nullptr ? study.scene : scene_with(study, design.prototype->overrides);
}

}  // namespace

std::vector<PopulationDesign> population_designs(const Study& study) {
  const ConfigNode* shape =
      study.resolved.at_path("lighting." + study.scene.tunnel_name + ".shape");
  const std::string title =
      shape == nullptr ? "Own lighting" : fmt::format("Own lighting ({})", shape->text);
  std::vector<PopulationDesign> designs = {{.key = "baseline", .title = title}};
  for (const Prototype& prototype : study.prototypes) {
    designs.push_back({.key = prototype.name, .title = prototype.title, .prototype = &prototype});
  }
  return designs;
}

std::unique_ptr<SimulatedLine> line_of(const PopulationTask& task, const PopulationDesign& design) {
  try {
    return std::make_unique<SimulatedLine>(task.store, population_scene(task.study, design));
  } catch (const ConfigError& error) {
    throw design.prototype == nullptr ? with_place(task.study.root, error)
                                      : prototype_error(*design.prototype, error);
  }
}

PartRecords::PartRecords(Storage& storage) : storage_(storage) {
  for (Trial& trial : storage_.trials(TrialKind::kPart)) {
    last_number_ = std::max(last_number_, trial.number);
    if (trial.outcome) {
      known_[trial.name] = std::move(trial.outcome->scores);
    }
  }
}

const Scores* PartRecords::find(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const auto found = known_.find(name);
  return found == known_.end() ? nullptr : &found->second;
}

void PartRecords::keep(const std::string& name, Scores figures) {
  const std::lock_guard lock(mutex_);
  storage_.put_trial({.kind = TrialKind::kPart,
                      .number = ++last_number_,
                      .name = name,
                      .point = {},
                      .outcome = Outcome{.scores = figures, .message = {}, .gradients = {}}});
  known_[name] = std::move(figures);
}

PopulationProgress::PopulationProgress(const PopulationTask& task, std::int64_t total)
    : task_(task), bar_(task.study.name, total, task.progress) {}

bool PopulationProgress::is_interrupted() const {
  return task_.interrupt != nullptr && *task_.interrupt > 0;
}

void PopulationProgress::add(std::int64_t steps, std::string_view note) {
  const std::lock_guard lock(mutex_);
  done_ += steps;
  bar_.update(done_, note);
}

std::optional<std::vector<Scores>> record_all(
    const PopulationTask& task,
    PartRecords& records,
    PopulationProgress& progress,
    const std::string& name,
    int count,
    const std::function<Scores(std::int64_t number)>& make) {
  const auto record_name = [&](int number) { return fmt::format("{}/{}", name, number); };
  std::vector<int> missing;
  for (int number = 0; number < count; ++number) {
    if (records.find(record_name(number)) == nullptr) {
      missing.push_back(number);
    }
  }
  const auto kept = count - static_cast<std::int64_t>(missing.size());
  progress.add(kept, name);
  task.folder.keep();
  task.store.pool().for_each(static_cast<std::int64_t>(missing.size()), [&](std::int64_t i) {
    if (progress.is_interrupted()) {
      return;
    }
    const int number = missing[static_cast<std::size_t>(i)];
    try {
      records.keep(record_name(number), make(number));
    } catch (const ConfigError& error) {
      throw in_context(with_place(task.study.root, error), record_name(number));
    }
    progress.add(1, name);
  });
  std::vector<Scores> all;
  for (int number = 0; number < count; ++number) {
    const Scores* figures = records.find(record_name(number));
    if (figures == nullptr) {
      return std::nullopt;
    }
    all.push_back(*figures);
  }
  return all;
}

double recorded_threshold(PartRecords& records,
                          const SimulatedLine& line,
                          const std::string& name) {
  if (const Scores* kept = records.find(name)) {
    return kept->at("threshold");
  }
  const double threshold = line.threshold();
  records.keep(name, {{"threshold", threshold}});
  return threshold;
}

Scores inspect_flawless(const SimulatedLine& line, double threshold, std::int64_t number) {
  const std::int64_t first = line.scene().inspection.trials.flawless;
  const ScannedPart part = line.flawless(first + number);
  return {{"blobs", static_cast<double>(line.inspect(part, threshold).size())}};
}

Json false_alarms_json(std::int64_t blobs, std::int64_t scans, double confidence) {
  return {{"scans", scans},
          {"blobs", blobs},
          {"per_part", estimate_json(poisson_rate(blobs, static_cast<double>(scans), confidence))}};
}

std::int64_t num_threshold_scans(const InspectionSettings& settings) {
  using Threshold = InspectionSettings::Threshold;
  return settings.threshold == Threshold::kFalseAlarms ? settings.trials.flawless : 0;
}

std::int64_t spread_stride(std::int64_t count) {
  constexpr double kGoldenShare = 0.6180339887498949;
  auto stride = std::max<std::int64_t>(1, std::llround(kGoldenShare * static_cast<double>(count)));
  while (std::gcd(stride, count) != 1) {
    ++stride;
  }
  return stride;
}

PopulationPace measure_pace(const SimulatedLine& line,
                            ThreadPool& pool,
                            const std::function<void(std::int64_t number)>& inspect) {
  // Parts differ: a few of them are no sample of hundreds.
  constexpr std::int64_t kMinRounds = 4;
  constexpr std::int64_t kMaxRounds = 24;
  constexpr double kLong_s = 4.0;
  const std::int64_t at_once = pool.num_threads();
  const auto seconds_each = [&](const std::function<void(std::int64_t)>& work) {
    const double start = process_cpu_s();
    double spent_s = 0.0;
    std::int64_t rounds = 0;
    while (rounds < kMinRounds || (rounds < kMaxRounds && spent_s < kLong_s)) {
      pool.for_each(at_once, [&](std::int64_t i) { work(rounds * at_once + i); });
      spent_s = process_cpu_s() - start;
      ++rounds;
    }
    return spent_s / static_cast<double>(rounds * at_once);
  };
  PopulationPace pace;
  pace.part_s = seconds_each(inspect);
  const double threshold = line.scene().inspection.threshold_grey;
  pace.flawless_s =
      seconds_each([&](std::int64_t number) { inspect_flawless(line, threshold, number); });
  return pace;
}

}  // namespace glint
