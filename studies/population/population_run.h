// SPDX-License-Identifier: GPL-3.0-or-later
//
// What studies of many simulated parts have in common: lightings that see the same parts, results
// that are kept part by part, and numbers with their intervals as JSON.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/progress.h"
#include "metrics/statistics/estimate.h"
#include "optimizer/storage/storage.h"
#include "studies/definition/study.h"
#include "studies/inspection_line/simulated_line.h"
#include "studies/output/output_folder.h"

namespace glint {

/// Where a population study gets its parts from and puts its results.
struct PopulationTask {
  const Study& study;
  SceneStore& store;
  Storage& storage;
  OutputFolder& folder;       ///< kept as soon as parts are inspected
  std::filesystem::path out;  ///< the folder's path
  Progress::Style progress = Progress::Style::kAuto;
  const std::atomic<int>* interrupt = nullptr;  ///< how often the user interrupted
};

/// A lighting that a population passes under: the study's own, then its prototypes.
struct PopulationDesign {
  std::string key;    ///< "baseline" or the prototype's name
  std::string title;  ///< for people
  const Prototype* prototype = nullptr;
};

/// How many flawless parts are scanned of a design. @param settings  of [pod] or [sorting]
template <class Settings>
int flawless_of(const Settings& settings, const PopulationDesign& design) {
  return design.prototype == nullptr ? settings.flawless : settings.prototype_flawless;
}

std::vector<PopulationDesign> population_designs(const Study& study);

/// Its simulated line. @throws ConfigError with the place of the value at fault
std::unique_ptr<SimulatedLine> line_of(const PopulationTask& task, const PopulationDesign& design);

/// Figures of parts that were inspected, by name, each kept in the study's database as soon as it
/// is there: a killed process loses what was being made and nothing else.
class PartRecords {
 public:
  explicit PartRecords(Storage& storage);

  /// The figures of that name; nullptr: not made yet. The pointer stays good.
  const Scores* find(const std::string& name) const;

  /// Safe to call from several threads.
  void keep(const std::string& name, Scores figures);

 private:
  Storage& storage_;
  mutable std::mutex mutex_;
  std::map<std::string, Scores> known_;
  int last_number_ = 0;
};

/// The progress of all steps of a study, which may be made by several threads.
class PopulationProgress {
 public:
  /// @param total  >= 1
  PopulationProgress(const PopulationTask& task, std::int64_t total);

  bool is_interrupted() const;
  void add(std::int64_t steps, std::string_view note);

 private:
  const PopulationTask& task_;
  Progress bar_;
  std::mutex mutex_;
  std::int64_t done_ = 0;
};

/// Figures of the numbers 0, 1, ... in that order; those without a record are made, several at
/// once. Empty when it was interrupted.
/// @param name  of the records: "<name>/<number>"
std::optional<std::vector<Scores>> record_all(
    const PopulationTask& task,
    PartRecords& records,
    PopulationProgress& progress,
    const std::string& name,
    int count,
    const std::function<Scores(std::int64_t number)>& make);

/// The line's threshold of |response|, kept like the parts. @param name  of the record
double recorded_threshold(PartRecords& records, const SimulatedLine& line, const std::string& name);

/// Blobs on scans of the flawless part, which are all false alarms: {"blobs"} of one scan.
/// Numbers begin where those of the threshold's own scans end.
Scores inspect_flawless(const SimulatedLine& line, double threshold, std::int64_t number);

/// { scans, blobs, per_part: { value, low, high } } with Garwood's interval
nlohmann::ordered_json false_alarms_json(std::int64_t blobs, std::int64_t scans, double confidence);

/// Flawless scans that each lighting's threshold is set with.
std::int64_t num_threshold_scans(const InspectionSettings& settings);

/// CPU seconds one inspected part and one flawless scan take at the study's own lighting.
struct PopulationPace {
  double part_s = 0.0;
  double flawless_s = 0.0;
};

/// The first multiples of it, modulo count, are spread over 0 to count - 1 and are all different:
/// parts of all sizes, as those whose defects are found take longer.
/// @param count  >= 1
std::int64_t spread_stride(std::int64_t count);

/// @param inspect  one part of that number
PopulationPace measure_pace(const SimulatedLine& line,
                            ThreadPool& pool,
                            const std::function<void(std::int64_t number)>& inspect);

}  // namespace glint
