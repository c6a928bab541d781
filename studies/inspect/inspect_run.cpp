// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspect/inspect_run.h"

#include <chrono>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/wall_clock.h"
#include "metrics/inspection/calibration.h"
#include "metrics/inspection/learn_limits.h"
#include "studies/definition/scene_file.h"
#include "studies/inspect/inspect_files.h"
#include "studies/inspect/inspect_folder.h"
#include "studies/inspect/inspect_page.h"
#include "studies/inspect/inspect_rules.h"
#include "studies/inspect/inspected_part.h"
#include "studies/inspection_line/simulated_line.h"
#include "studies/output/output_folder.h"
#include "studies/output/provenance.h"
#include "studies/output/result_folder.h"
#include "studies/output/staged_folder.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;
using Threshold = InspectionSettings::Threshold;

/// Thrown between two parts.
struct Interrupted {};

class InspectRun {
 public:
  explicit InspectRun(const InspectOptions& options)
      : options_(options),
        masks_{.mask = options.mask, .reference = options.reference_mask},
        pool_(options.threads) {}

  Json execute() {
    prepare();
    OutputFolder folder(options_.out);
    remove_stale_stages(options_.out);
    StagedFolder stage(options_.out, "");
    try {
      inspect_all(stage.path());
    } catch (const Interrupted&) {
      return {{"schema", 1}, {"status", "interrupted"}};
    }
    Json result = judge();
    write_all(stage.path(), result);
    remove_outdated_maps(options_.out, stage.path(), sources_);
    stage.commit();
    folder.keep();
    result["report"] = (options_.out / "report.html").string();
    result["folder"] = options_.out.string();
    return result;
  }

 private:
  /// Everything that can be refused before pictures are read.
  void prepare() {
    if (!options_.mask.empty() && !options_.reference_mask.empty()) {
      throw ConfigError("--mask and --reference_mask exclude each other");
    }
    if (options_.is_learning && options_.labels.empty()) {
      throw ConfigError("--learn needs --labels FILE.csv with the grades of parts");
    }
    sources_ = part_sources(options_.inputs, options_.is_each);
    if (!options_.flawless.empty()) {
      flawless_ = part_sources(options_.flawless, options_.is_each);
    }
    for (const PicturedPart& source : sources_) {
      rules_of(source);
    }
    if (!options_.labels.empty()) {
      labels_ = read_labels(options_.labels);
      check_labels();
    }
    check_folder();
  }

  void check_folder() const {
    std::vector<fs::path> inputs = options_.settings;
    inputs.insert(inputs.end(), {options_.mask, options_.reference_mask, options_.labels});
    for (const PicturedPart& source : flawless_) {
      inputs.insert(inputs.end(), source.pictures.begin(), source.pictures.end());
    }
    check_inspect_folder(options_.out, sources_, inputs, options_.is_learning);
  }

  void check_labels() const {
    std::set<std::string> names;
    for (const PicturedPart& source : sources_) {
      names.insert(source.name);
    }
    for (const auto& [name, grade] : labels_) {
      if (names.count(name) == 0) {
        throw ConfigError(fmt::format("{}: there is no part {} among those inspected, as {}",
                                      options_.labels.string(),
                                      name,
                                      *names.begin()));
      }
    }
  }

  const InspectionRules& rules_of(const PicturedPart& source) {
    const auto key = std::pair(source.scene, source.is_photograph());
    const auto found = rules_.find(key);
    if (found != rules_.end()) {
      return found->second;
    }
    const InspectionSettings base =
        source.is_photograph() ? photograph_settings() : InspectionSettings{};
    return rules_
        .emplace(key, read_inspection_rules(base, source.scene, options_.settings, options_.sets))
        .first->second;
  }

  /// The threshold at which flawless parts have the wanted number of false alarms.
  std::optional<double> calibrated(const PicturedPart& source, const InspectionSettings& settings) {
    if (settings.threshold != Threshold::kFalseAlarms) {
      return std::nullopt;
    }
    const std::string key = inspection_toml(settings) + (flawless_.empty() ? source.name : "");
    const auto found = thresholds_.find(key);
    if (found != thresholds_.end()) {
      return found->second;
    }
    if (flawless_.empty() && source.scene.empty()) {
      throw ConfigError("inspection.threshold",
                        "\"false_alarms\" is calibrated with flawless parts: give their pictures "
                        "with --flawless, or choose \"noise\" or \"fixed\"");
    }
    const double threshold =
        flawless_.empty() ? line_of(source, settings).threshold() : flawless_threshold(settings);
    thresholds_.emplace(key, threshold);
    return threshold;
  }

  double flawless_threshold(const InspectionSettings& settings) {
    std::vector<ImageF> responses;
    std::optional<Inspector> first;
    for (const PicturedPart& source : flawless_) {
      const PreparedPart part = prepare_part(source, masks_, pool_);
      Inspector inspector(settings, part.mask);
      responses.push_back(response_of(inspector, part, pool_));
      if (!first) {
        first.emplace(std::move(inspector));
      }
      if (responses.back().width() != responses.front().width() ||
          responses.back().height() != responses.front().height()) {
        throw ConfigError(source.name + ": flawless parts must have pictures of one size");
      }
    }
    return threshold_for(*first, responses, settings.false_alarms_per_picture, pool_);
  }

  /// The simulated line that a design's pictures come from, flawless parts included.
  const SimulatedLine& line_of(const PicturedPart& source, const InspectionSettings& settings) {
    if (line_name_ != source.name) {
      SceneSettings scene = load_scene(source.scene);
      scene.inspection = settings;
      line_name_.clear();
      line_.emplace(store_, scene);
      line_name_ = source.name;
    }
    return *line_;
  }

  /// Where a simulated part is looked at; nullptr: everywhere.
  const Mask* looked_at(const PicturedPart& source,
                        const InspectionSettings& settings,
                        PreparedPart& part) {
    if (source.scene.empty() || !options_.mask.empty() || !options_.reference_mask.empty()) {
      return nullptr;
    }
    try {
      const Mask& region = line_of(source, settings).region();
      if (region.width() != part.mask.width() || region.height() != part.mask.height()) {
        throw ConfigError("the pictures have another size than the scene");
      }
      return &region;
    } catch (const Error& error) {  // the part's file may have gone
      part.notes.push_back(fmt::format(
          "The flawless part could not be simulated, so nothing was left out: {}", error.what()));
      return nullptr;
    }
  }

  InspectedPart inspect_one(const PicturedPart& source) {
    const InspectionSettings& settings = rules_of(source).settings;
    PreparedPart part = prepare_part(source, masks_, pool_);
    const Mask* region = looked_at(source, settings, part);
    return inspect_part(
        source, std::move(part), settings, region, calibrated(source, settings), pool_);
  }

  void inspect_all(const fs::path& stage) {
    const auto count = static_cast<std::int64_t>(sources_.size());
    Progress bar("inspect", count, options_.progress);
    for (const PicturedPart& source : sources_) {
      if (options_.interrupt != nullptr && *options_.interrupt > 0) {
        throw Interrupted();
      }
      try {
        parts_.push_back(inspect_one(source));
      } catch (const ConfigError& error) {
        const Problem& problem = error.problems().front();
        const bool names_picture = problem.key.empty() || !problem.place.file.empty();
        throw names_picture ? error : in_context(error, source.name);
      }
      write_pictures(stage, parts_.back());
      bar.update(static_cast<std::int64_t>(parts_.size()), source.name);
    }
  }

  void write_pictures(const fs::path& stage, InspectedPart& part) {
    const fs::path folder = stage / part.source.name;
    make_folder(folder);
    const ImageF shown = shown_aspect(part.aspect, part.region);
    std::vector<DefectMark> marks = marks_of(part.inspection.defects);
    if (part.comparison) {
      const std::vector<DefectMark> missed = missed_marks(part.known, *part.comparison);
      marks.insert(marks.end(), missed.begin(), missed.end());
    }
    write_png(folder / "aspect.png", part.aspect, PixelDepth::k16Bit);
    write_exr(folder / "response.exr", part.response);
    if (part.phases) {
      write_exr(folder / "modulation.exr", part.phases->modulation);
      write_exr(folder / "phase_rad.exr", part.phases->phase_rad);
    }
    write_file(folder / "overlay.png", png_bytes(overlay(shown, marks)));
    if (pictures_.size() < kMaxPagePictures) {
      pictures_.push_back(page_picture(shown));
    }
    part.aspect = part.response = ImageF();
    if (part.phases) {
      part.phases.emplace();  // that there are some is still told
    }
    part.region = Mask();
  }

  /// Learns where that is wanted, and grades. @return result.json
  Json judge() {
    for (InspectedPart& part : parts_) {
      const auto label = labels_.find(part.source.name);
      if (label != labels_.end()) {
        part.label = label->second;
      }
    }
    Json learned;
    if (options_.is_learning) {
      learned = learn();
    }
    Json result = {{"schema", 1}, {"status", "done"}};
    result["unit"] = unit_of(rules_of(sources_.front()).settings.measure);
    Json parts = Json::array();
    Json counts = {{"Perfect", 0}, {"Acceptable", 0}, {"Rejected", 0}};
    bool has_limits = false;
    for (InspectedPart& part : parts_) {
      const InspectionRules& rules = rules_of(part.source);
      if (rules.has_limits) {
        part.grade = grade_of(part.inspection.defects, rules.settings);
        has_limits = true;
        Json& count = counts[std::string(grade_name(*part.grade))];
        count = count.get<int>() + 1;
      }
      parts.push_back(part_json(part, rules.settings));
    }
    result["has_limits"] = has_limits;
    result["grades"] = has_limits ? counts : Json(nullptr);
    if (!learned.is_null()) {
      result["learned"] = learned;
    }
    if (!labels_.empty()) {
      result["agreement"] = agreement();
    }
    if (const Json truth = truth_of_all(); !truth.is_null()) {
      result["truth"] = truth;
    }
    result["parts"] = parts;
    result["report"] = "report.html";
    return result;
  }

  Json learn() {
    std::vector<LabelledPart> labelled;
    for (const InspectedPart& part : parts_) {
      if (part.label) {
        labelled.push_back(
            {.holes = part.holes, .scratches = part.scratches, .grade = *part.label});
      }
    }
    const LearnedLimits limits = learn_limits(labelled);
    for (auto& [key, rules] : rules_) {
      rules.settings.holes = limits.holes;
      rules.settings.scratches = limits.scratches;
      rules.has_limits = true;
    }
    return {{"parts", labelled.size()},
            {"wrong", limits.wrong},
            {"is_proven", limits.is_proven},
            {"file", "grading.toml"}};
  }

  /// How often the grade is the label's.
  Json agreement() const {
    int labelled = 0;
    int equal = 0;
    for (const InspectedPart& part : parts_) {
      if (part.label && part.grade) {
        ++labelled;
        equal += *part.label == *part.grade ? 1 : 0;
      }
    }
    return {{"parts", labelled}, {"equal", equal}};
  }

  Json truth_of_all() const {
    int known = 0;
    int found = 0;
    int false_alarms = 0;
    bool is_told = false;
    for (const InspectedPart& part : parts_) {
      if (part.comparison) {
        is_told = true;
        known += static_cast<int>(part.known.size());
        found += part.comparison->found();
        false_alarms += part.comparison->false_alarms();
      }
    }
    return is_told ? Json{{"defects", known},
                          {"found", found},
                          {"missed", known - found},
                          {"false_alarms", false_alarms}}
                   : Json(nullptr);
  }

  void write_all(const fs::path& stage, const Json& result) {
    const InspectionSettings& settings = rules_of(sources_.front()).settings;
    const std::string toml = inspection_toml(settings);
    if (options_.is_learning) {
      write_file(stage / "grading.toml", toml);
    }
    write_file(stage / "defects.csv", defects_csv(parts_));
    write_file(stage / "report.html", inspect_page(result, parts_, pictures_, settings, toml));
    write_file(stage / "result.json", result.dump(2) + "\n");
    Json run = provenance();
    run["verb"] = command_of(ResultKind::kInspect);
    run["inspected"] = parts_.size();
    run["source"] = source_seen_from(options_.out, source_of_inspection(options_.inputs));
    run["threads"] = options_.threads;
    run["timings"] = {{"this_run_s", seconds_since(start_)}};
    run["configuration"] = toml;
    write_file(stage / "run.json", run.dump(2) + "\n");
  }

  const InspectOptions& options_;
  PartMasks masks_;
  ThreadPool pool_;
  SceneStore store_{pool_};
  std::string line_name_;              ///< whose line it is; empty: nobody's
  std::optional<SimulatedLine> line_;  ///< of the last design
  Clock::time_point start_ = Clock::now();
  std::vector<PicturedPart> sources_;
  std::vector<PicturedPart> flawless_;
  std::map<std::pair<fs::path, bool>, InspectionRules> rules_;  ///< by scene; of photographs
  std::map<std::string, double> thresholds_;                    ///< told by flawless parts
  std::map<std::string, Grade> labels_;
  std::vector<InspectedPart> parts_;
  std::vector<std::string> pictures_;  ///< of the first parts, for the page
};

}  // namespace

Json inspect_parts(const InspectOptions& options) {
  return InspectRun(options).execute();
}

}  // namespace glint
