// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/run.h"

#include <chrono>
#include <map>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/cpu_clock.h"
#include "core/file.h"
#include "core/log.h"
#include "core/wall_clock.h"
#include "studies/accuracy/accurate_search.h"
#include "studies/accuracy/outcome_labels.h"
#include "studies/definition/manufacture.h"
#include "studies/definition/study_text.h"
#include "studies/front/front_files.h"
#include "studies/front/front_run.h"
#include "studies/output/output_folder.h"
#include "studies/output/provenance.h"
#include "studies/output/result_folder.h"
#include "studies/population/pod_study.h"
#include "studies/population/sorting.h"
#include "studies/run/begun_study.h"
#include "studies/run/check_study.h"
#include "studies/run/design_files.h"
#include "studies/run/results/judged_limits.h"
#include "studies/run/results/run_record.h"
#include "studies/run/results/scene_facts.h"
#include "studies/run/run_report.h"
#include "studies/run/run_texts.h"
#include "studies/run/search_race.h"
#include "studies/run/study_search.h"
#include "studies/run/warm_start.h"
#include "studies/run/written_designs.h"
#include "studies/tolerance/tolerance_spread.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

/// A run directory that is being worked on.
class Run {
 public:
  Run(const Study& study, const RunOptions& options)
      : study_(study), options_(options), pool_(options.threads), store_(pool_) {}

  Json execute() {
    const std::vector<std::string> names = names_in_run(study_);
    check_result_folder(options_.out, ResultKind::kRun, names);
    check_inputs_kept(input_files(study_), options_.out, names);
    check_everything(store_, study_);
    if (!fs::exists(options_.out / "study.sqlite")) {
      check_has_tolerances(study_);
    }
    const TakenTrials taken = trials_to_take(study_, options_.from, options_.out);
    check_accuracy_choice(study_, !options_.from.empty());
    OutputFolder folder(options_.out);
    Storage storage = open_storage();
    fresh_.emplace(storage);
    write_file(options_.out / "study.resolved.toml", resolved_text(study_));
    remove_unfinished_files(options_.out);
    configure_run_log();
    keep_taken(study_, taken, options_.out, storage);
    SearchResult search;
    const double search_start = process_cpu_s();
    if (study_.has_search()) {
      search = search_with_accuracy(storage, folder);
      cpu_.search_s = process_cpu_s() - search_start;
      if (search.termination == Termination::kInterrupted) {
        is_interrupted_ = true;
        log(LogLevel::kWarning,
            "interrupted after {} evaluations, which are kept; writing what there is (a second "
            "interrupt stops at once)",
            search.evaluations);
      } else {
        race_for_winner(storage, search);
      }
    }
    Json result = finish(storage, search, folder);
    cpu_.finish_s = process_cpu_s() - search_start - cpu_.search_s;
    write_run_json(search, storage);
    if (study_.has_search()) {
      result["ended_by"] = ended_by(search.termination);
    }
    result = with_report(std::move(result), options_.out);
    folder.keep();
    return result;
  }

 private:
  void configure_run_log() {
    LogSettings settings = {.to_stderr = options_.progress != Progress::Style::kNone,
                            .files = {options_.out / "log.txt"}};
    if (!options_.log_file.empty()) {
      settings.files.push_back(options_.log_file);
    }
    configure_log(settings);
    log(LogLevel::kInfo,
        "study {} with {} threads, {} jobs",
        study_.name,
        options_.threads,
        options_.jobs);
    if (study_.has_search()) {
      log(LogLevel::kInfo, "the search ends {}", limits_text(study_.budget));
    }
    if (!widened_.empty()) {
      log(LogLevel::kInfo, "it goes on in a wider space: {}", widened_);
    }
  }

  Storage open_storage() {
    const fs::path database = options_.out / "study.sqlite";
    identity_ = {.config_hash = config_hash(study_),
                 .config_text = resolved_text(study_),
                 .code_version = program_version(),
                 .seed = study_.search.seed};
    if (std::error_code ignored; fs::exists(database, ignored)) {
      widened_ = adopt_begun_study(study_, identity_, options_.out);
    }
    return Storage::open(database, identity_);
  }

  /// Where the study says how exactly scores must be known, the search is rendered so.
  SearchResult search_with_accuracy(Storage& storage, OutputFolder& folder) {
    if (!study_.accuracy) {
      return search_designs(storage, folder);
    }
    Storage record = Storage::open(options_.out / kAccuracyTrials, identity_);
    const auto search = [&](const ChosenAccuracy& chosen, const Review& review) {
      return search_designs(storage, folder, &chosen, review);
    };
    return search_accurately({.study = study_,
                              .store = store_,
                              .record = &record,
                              .jobs = options_.jobs,
                              .interrupt = options_.interrupt,
                              .progress = options_.progress,
                              .on_evaluation = [&] { folder.keep(); }},
                             storage,
                             search,
                             accurate_);
  }

  SearchResult search_designs(Storage& storage,
                              OutputFolder& folder,
                              const ChosenAccuracy* chosen = nullptr,
                              const Review& review = {}) {
    SearchTask task = search_task(study_, options_.jobs);
    task.verify_replay = options_.verify_replay;
    task.review = review;
    task.label = [&](const Point& point) {
      return searched_label(study_, chosen != nullptr ? chosen->of(point).rung().name : kOwnRung);
    };
    const std::map<Point, Outcome> taken = begin_with_taken(options_.out, task);
    const auto evaluate_point = [&](const Point& point, int /*trial*/) {
      const ChosenAccuracy* part = chosen != nullptr ? &chosen->of(point) : nullptr;
      const auto& known = part != nullptr ? part->known : taken;  // nothing is taken beside it
      const auto found = known.find(point);
      const RenderRung* rung = part != nullptr ? &part->rung() : nullptr;
      return found != known.end() ? found->second : evaluate_candidate(store_, study_, point, rung);
    };
    Progress bar(study_.name, std::max(1, study_.budget.evaluations), options_.progress);
    const auto show = [&](const SearchProgress& progress) {
      folder.keep();  // what is evaluated is not thrown away
      bar.update(progress.evaluations, progress_note(study_.goal, progress));
    };
    return run_search(task, storage, evaluate_point, options_.interrupt, show);
  }

  /// Under noise the search's best design is the one that its finalists' race leaves.
  void race_for_winner(Storage& storage, SearchResult& search) {
    if (!has_race(study_, search)) {
      return;
    }
    const double start = process_cpu_s();
    race_ = race_finalists(store_, study_, storage, search, options_.interrupt);
    cpu_.rescoring_s += process_cpu_s() - start;
    is_interrupted_ = race_.is_null();
    if (is_interrupted_) {
      search.termination = Termination::kInterrupted;
    } else if (accurate_.check) {
      accurate_.check->raced = search.best->number;
    }
  }

  Json head(const std::string& title, const char* role, const Json& variables) const {
    return {{"title", title}, {"study", study_.title}, {"role", role}, {"variables", variables}};
  }

  Json baseline_head() const {
    return head(baseline_title(study_), "baseline", baseline_variables_json(study_));
  }

  /// Adds what the study's populations give. @return false when interrupted
  bool inspect_populations(Storage& storage, OutputFolder& folder, Json& result) {
    const PopulationTask task = {.study = study_,
                                 .store = store_,
                                 .storage = storage,
                                 .folder = folder,
                                 .out = options_.out,
                                 .progress = options_.progress,
                                 .interrupt = options_.interrupt};
    const auto add = [&](const char* name, const std::optional<Json>& found) {
      if (found) {
        result[name] = *found;
      }
      return found.has_value();
    };
    return (!study_.sorting || add("sorting", run_sorting(task))) &&
           (!study_.pod || add("pod", run_pod(task)));
  }

  /// Pictures and fresh scores of the front's designs.
  void add_front(const Storage& storage, const Json& winner, Json& result) {
    const double start = process_cpu_s();
    write_front({.study = study_,
                 .store = store_,
                 .storage = storage,
                 .out = options_.out,
                 .wanted = wanted_in_search(study_),
                 .write = [this](const auto&... design) { return writer_->write(design...); },
                 .drawing = drawing_svg,
                 .interrupt = options_.interrupt},
                winner,
                front_,
                result);
    cpu_.front_s = process_cpu_s() - start;
  }

  /// The spread of the winner, and the robust optimum.
  void add_manufacture(const Storage& storage, const SearchResult& search, Json& result) {
    if (study_.root.find("manufacture") == nullptr || is_interrupted_) {
      return;
    }
    const double start = process_cpu_s();
    const auto rungs = accurate_.chosen ? std::optional(accurate_.chosen->rungs()) : std::nullopt;
    BuiltDesigns built(
        store_, study_, identity_, options_.out, rungs, options_.jobs, options_.interrupt);
    const auto variables = [this](const Point& point) { return variables_json(study_, point); };
    const auto trials = storage.trials(TrialKind::kSearch);
    auto found = tolerance_spread(built, study_, trials, search.best->point, variables, search);
    found ? result["manufacture"] = std::move(*found) : result["status"] = "interrupted";
    cpu_.manufacture_s = process_cpu_s() - start;
  }

  /// @return its scores with fresh seeds
  Json add_winner(const Storage& storage, const SearchResult& search, Json& result) {
    const Json variables = variables_json(study_, search.best->point);
    const char* title = search.is_feasible ? "Winner of the search" : "Closest to the limits";
    Json winner_head = head(title, "winner", variables);
    winner_head["trial"] = search.best->number;
    add_judged_limits(study_.goal, search, winner_head);
    const Json winner = writer_->write(
        "winner", scene_with(study_, overrides_of(study_, search.best->point)), winner_head);
    result["best"] = {
        {"trial", search.best->number}, {"variables", variables}, {"scores", winner["scores"]}};
    add_judged_limits(study_.goal, search, result["best"]);
    if (!front_.is_null() && !is_interrupted_) {
      add_front(storage, winner, result);
    }
    add_manufacture(storage, search, result);
    add_race_to_result(study_, search, winner, race_, result);
    if (is_interrupted_) {
      return winner["rescored"];
    }
    if (Json kinds = kinds_of_search(store_, study_, storage, search, &*fresh_); !kinds.is_null()) {
      result["kinds"] = std::move(kinds);
    }
    return winner["rescored"];
  }

  Json finish(Storage& storage, const SearchResult& search, OutputFolder& folder) {
    front_ = search.trade_off ? front_json(study_, storage, search) : Json();
    const int front_designs = front_.is_null() ? 0 : full_designs_of_front(front_);
    writer_.emplace(WritingTask{.store = store_,
                                .study = study_,
                                .out = options_.out,
                                .fresh = *fresh_,
                                .race = race_,
                                .front_designs = front_designs,
                                .is_repeated = !is_interrupted_},
                    options_.progress);
    const Json baseline = writer_->write("baseline", study_.scene, baseline_head());
    write_part_picture(
        store_, first_view(store_, study_.scene), options_.out / "baseline" / "part.png");
    Json prototypes = Json::object();
    for (const Prototype& prototype : study_.prototypes) {
      const Json written = writer_->write(prototype.name,
                                          scene_with(study_, prototype.overrides),
                                          head(prototype.title, "prototype", Json::object()));
      prototypes[prototype.name] = {{"scores", written["scores"]},
                                    {"rescored", written["rescored"]}};
    }
    Json result = {{"schema", 1},
                   {"status", run_status(search, study_.has_search())},
                   {"evaluations", search.evaluations},
                   {"failed", search.failed},
                   {"study", study_file(study_)},
                   {"part", part_json(store_.build(study_.scene)->part)}};
    if (study_.has_objective) {
      result["objective"] = study_.goal.objective.name;
    }
    add_front_to_result(front_, result);
    if (accurate_.chosen) {
      result["accuracy"] = accurate_search_json(store_, study_, accurate_, search.evaluations);
    }
    Json rescored = Json::object();
    result["best"] = nullptr;
    if (search.best) {
      rescored["best"] = add_winner(storage, search, result);
    }
    result["baseline"] = {{"variables", baseline["variables"]}, {"scores", baseline["scores"]}};
    rescored["baseline"] = baseline["rescored"];
    result["rescored"] = rescored;
    result["prototypes"] = prototypes;
    cpu_.rescoring_s += writer_->rescoring_cpu_s();
    writer_.reset();
    const double populations_start = process_cpu_s();
    const bool is_inspected = inspect_populations(storage, folder, result);
    cpu_.populations_s = process_cpu_s() - populations_start;
    if (!is_inspected) {
      log(LogLevel::kWarning,
          "interrupted; the inspected parts are kept, the same command resumes");
      result["status"] = "interrupted";
    }
    write_file(options_.out / "trials.csv", trials_csv(study_, storage));
    result["report"] = "report.html";
    write_file(options_.out / "result.json", result.dump(2) + "\n");
    return result;
  }

  void write_run_json(const SearchResult& search, const Storage& storage) const {
    const RunRecord record = {
        .study = study_,
        .out = options_.out,
        .search = search,
        .store = store_,
        .threads = options_.threads,
        .jobs = options_.jobs,
        .started = started_,
        .seconds = seconds_since(start_),
        .cpu = cpu_,
        .has_front = !front_.is_null(),
        .accuracy_cpu_s = accurate_.chosen ? std::optional(accurate_.cpu_s) : std::nullopt,
        .derivatives = derivative_remarks(storage)};
    write_file(options_.out / "run.json", run_record_json(record).dump(2) + "\n");
  }

  const Study& study_;
  const RunOptions& options_;
  ThreadPool pool_;
  SceneStore store_;
  StudyIdentity identity_;
  std::string widened_;  ///< by what, if this run widened the space
  Clock::time_point start_ = Clock::now();
  std::chrono::system_clock::time_point started_ = std::chrono::system_clock::now();
  AccurateSearch accurate_;
  std::optional<FreshOutcomes> fresh_;  ///< of its database
  RunCpu cpu_;
  Json front_;  ///< of several objectives
  Json race_;   ///< race_finalists(); null: there was none
  std::optional<DesignWriter> writer_;
  bool is_interrupted_ = false;  ///< in the search: what can be had without is left out
};

}  // namespace

Json run_study(const Study& study, const RunOptions& options) {
  return Run(study, options).execute();
}

}  // namespace glint
