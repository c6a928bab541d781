// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/stability/stability_page.h"

#include <chrono>
#include <functional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/config/toml.h"
#include "core/file.h"
#include "studies/definition/study_text.h"
#include "studies/output/provenance.h"
#include "studies/output/result_writer.h"
#include "studies/report/report.h"
#include "studies/stability/run_winner.h"

namespace glint::stability {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Refuses before any work is done.
/// @param earlier  what earlier versions called the study
void check_folder(const Study* study,
                  const std::filesystem::path& out,
                  const std::string& earlier = "") {
  const std::vector<std::string> names = {"stability.json", "stability.html", "run.json"};
  if (study != nullptr) {
    check_inputs_kept(input_files(*study), out, names);
  }
  check_result_folder(out, ResultKind::kStability, names);
  if (study != nullptr && (earlier.empty() || study_of_folder(out) != earlier)) {
    check_study_of_folder(out, study->name);
  }
}

std::function<bool(int, const std::string&)> progress_of(Progress& bar,
                                                         const StabilityRun& run,
                                                         Clock::time_point start) {
  return [&bar, &run, start](int done, const std::string& next) {
    bar.update(done, next);
    return !run.budget_s || seconds_since(start) < *run.budget_s;
  };
}

Stability measure(const Study* study, const std::vector<Sweep>& sweeps, const StabilityRun& run) {
  const auto start = Clock::now();
  Progress bar("stability", count_cells(sweeps), run.progress);
  StabilityOptions options{.threads = run.threads, .bounds = run.bounds};
  if (study != nullptr) {
    options.base = study->resolved;
  }
  options.on_progress = progress_of(bar, run, start);
  try {
    Stability stability = measure_stability(sweeps, options);
    bar.update(count_cells(sweeps));
    return stability;
  } catch (const ConfigError& error) {
    throw study != nullptr ? with_place(study->root, error) : error;
  }
}

std::vector<std::string> method_lines(const Bounds& bounds) {
  return {
      fmt::format("Stated bounds: {:g} points of h, {:g} % of a dent's contrast (of at least "
                  "{:g} of full scale), {:g} of full scale for the mean image.",
                  bounds.h_points,
                  bounds.contrast_percent,
                  kMinContrast,
                  bounds.picture),
      "Scenes under a tunnel are compared with a tracer of their own in double precision, 144 or "
      "576 rays a pixel, that uses nothing of the renderer; the light beside a matt plate with "
      "Lambert's formula. Winners and switches compare the program with itself.",
      "Where a reference's own uncertainty covers the excess, a cell is right."};
}

/// Of winner_study().
std::vector<std::string> winner_lines(const RunnersUp& found) {
  return {
      fmt::format("Winner (trial {}) and runner-up (trial {}, the best design that differs by "
                  "at least {:g} % of a range) are rendered by the study's own settings, as "
                  "they are and disturbed. A cell is wrong where their order turns round by "
                  "more than its bound.",
                  found.winner_trial,
                  found.second_trial,
                  100.0 * kApart)};
}

std::string page_html(const Study* study,
                      const Stability& stability,
                      const std::vector<std::string>& methods,
                      const Json& json) {
  Json source = provenance();
  source.erase("cores");
  return render_report(
      {{"title", study != nullptr ? study->title : "Where methods fail"},
       {"subtitle", "Sweeps from harmless to hopeless"},
       {"verdict",
        {{"sentence", stability_sentence(stability)},
         {"tone", stability.totals().wrong > 0 ? "bad" : "good"},
         {"details", Json::array()}}},
       {"stability", json},
       {"methods", methods},
       {"config_toml", study != nullptr ? shown_text(*study) : std::string(base_scene_text())},
       {"provenance", source}});
}

Json written(const Study* study,
             const Stability& stability,
             const std::vector<std::string>& methods,
             const StabilityRun& run,
             Clock::time_point start) {
  Json json = stability_json(stability);
  ResultWriter writer(run.out, ResultKind::kStability);
  write_file(writer.path() / "stability.json", json.dump(2) + "\n");
  write_file(writer.path() / "stability.html", page_html(study, stability, methods, json));
  Json told = {{"study", nullptr}, {"threads", run.threads}};
  if (study != nullptr) {
    told["study"] = study->name;
    told["source"] = source_seen_from(run.out, study->root.place.file);
  }
  writer.finish(told, start);
  json["report"] = (run.out / "stability.html").string();
  return json;
}

}  // namespace

std::string stability_sentence(const Stability& stability) {
  const StabilityTotals totals = stability.totals();
  const std::string rest =
      totals.left_out > 0 ? fmt::format(" {} were left out by the budget.", totals.left_out) : "";
  return fmt::format(
      "{} of {} cells are silently wrong; {} are right, {} wrong and told, {} refused.{}",
      totals.wrong == 0 ? "None" : std::to_string(totals.wrong),
      totals.right + totals.told + totals.refused + totals.wrong,
      totals.right,
      totals.told,
      totals.refused,
      rest);
}

Json stability_study(const Study* study,
                     const std::vector<Sweep>& sweeps,
                     const StabilityRun& run) {
  const auto start = Clock::now();
  check_folder(study, run.out);
  { const OutputFolder probe(run.out); }  // refused now rather than after all the work
  const Stability stability = measure(study, sweeps, run);
  return written(study, stability, method_lines(run.bounds), run, start);
}

Json winner_study(const std::filesystem::path& folder, const StabilityRun& run) {
  const auto start = Clock::now();
  RunnersUp found = runners_up(folder);
  const std::string of_its_file = found.study.name;
  if (const std::string name = study_of_folder(folder); !name.empty()) {
    found.study.name = name;  // the run's own study has that of its file in the folder
  }
  check_folder(&found.study, run.out, of_its_file);
  { const OutputFolder probe(run.out); }  // as above
  Progress bar("stability of the winner", count_winner_cells(found), run.progress);
  const Stability stability = measure_winner(
      found,
      {.threads = run.threads, .bounds = run.bounds, .on_progress = progress_of(bar, run, start)});
  bar.update(count_winner_cells(found));
  return written(&found.study, stability, winner_lines(found), run, start);
}

}  // namespace glint::stability
