// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/search_page.h"

#include <algorithm>
#include <chrono>
#include <functional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "studies/definition/study_text.h"
#include "studies/frontier/frontier_folder.h"
#include "studies/output/output_folder.h"
#include "studies/output/result_folder.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

Json run_json(const SearchRun& run) {
  Json steps = Json::array();
  for (const SearchStep& step : run.steps) {
    steps.push_back({{"evaluations", step.evaluations},
                     {"score", optional_json(step.score)},
                     {"top", optional_json(step.top)},
                     {"is_feasible", step.is_feasible}});
  }
  return {{"seed", run.seed},
          {"evaluations", run.evaluations},
          {"is_whole", run.is_whole},
          {"steps", steps}};
}

Json method_json(const SearchedMethod& method) {
  Json json = {{"method", method.name}, {"summary", Json::array()}, {"runs", Json::array()}};
  for (const SearchSummary& summary : method.summary) {
    json["summary"].push_back({{"evaluations", summary.evaluations},
                               {"runs", summary.runs},
                               {"feasible", summary.feasible},
                               {"median", optional_json(summary.median)},
                               {"low", optional_json(summary.low)},
                               {"high", optional_json(summary.high)}});
  }
  for (const SearchRun& run : method.runs) {
    json["runs"].push_back(run_json(run));
  }
  if (!method.problem.empty()) {
    json["problem"] = method.problem;
  }
  return json;
}

std::string sentence_of(const Study& study, const SearchFrontier& frontier) {
  std::string text;
  for (const SearchedMethod& method : frontier.methods) {
    if (!method.summary.empty() && method.summary.back().median) {
      const SearchSummary& last = method.summary.back();
      text += fmt::format(
          "{}After {} evaluations {} has {} = {:.4g} in the median of {} feasible "
          "winners of {} ({:.4g} to {:.4g}).",
          text.empty() ? "" : " ",
          last.evaluations,
          method.name,
          study.goal.objective.name,
          *last.median,
          last.feasible,
          last.runs,
          *last.low,
          *last.high);
    }
  }
  return text.empty() ? "No search has a feasible winner yet." : text;
}

std::vector<std::string> notes_of(const SearchFrontier& frontier) {
  std::vector<std::string> notes = {
      "Each thin line is a search with a seed of its own, the thick one the median of those that "
      "have a feasible winner by then.",
      "The best design after 1, 2, 5, 10, ... evaluations is scored again as finalists are: finer "
      "sampling, fresh random numbers, the same for all. A search that ended by itself keeps its "
      "winner.",
      "A search counts its evaluations, not the repeated questions that its algorithm asks."};
  if (!frontier.is_whole) {
    notes.emplace_back("The budget of time cut some of it: the same call resumes from there.");
  }
  return notes;
}

SearchFrontier measure(const Study& study,
                       const FrontierRun& run,
                       const std::vector<std::string>& methods,
                       int seeds,
                       const std::function<void()>& keep) {
  Progress bar(study.name, kProgressSteps, run.progress);
  const auto show = [&](double done, const std::string& next) {
    keep();  // what is evaluated is not thrown away
    bar.update(static_cast<std::int64_t>(done * kProgressSteps), next);
  };
  const std::vector<std::string> own = {study.search.algorithm};
  try {
    return measure_searches(study,
                            {.folder = run.out / "searches",
                             .methods = methods.empty() ? own : methods,
                             .seeds = seeds,
                             .threads = run.threads,
                             .budget_s = run.budget_s,
                             .on_progress = show});
  } catch (const ConfigError& error) {
    throw with_place(study.root, error);
  }
}

std::string page_of(const Study& study, const SearchFrontier& frontier, const Json& json) {
  return frontier_page_html(study,
                            "Evaluations against the winner's quality",
                            json["sentence"],
                            "searches",
                            json,
                            notes_of(frontier));
}

}  // namespace

Json searches_json(const Study& study, const SearchFrontier& frontier) {
  Json methods = Json::array();
  for (const SearchedMethod& method : frontier.methods) {
    methods.push_back(method_json(method));
  }
  return {{"schema", 1},
          {"status", frontier.is_whole ? "done" : "budget"},
          {"study", study.name},
          {"title", study.title},
          {"score", study.goal.objective.name},
          {"direction", study.goal.objective.is_maximised ? "maximise" : "minimise"},
          {"evaluations", study.budget.evaluations},
          {"sentence", sentence_of(study, frontier)},
          {"methods", methods},
          {"report", "search.html"}};
}

Json searches_study(const Study& study,
                    const FrontierRun& run,
                    const std::vector<std::string>& methods,
                    int seeds) {
  const auto start = Clock::now();
  check_frontier_folder(study, run.out);
  OutputFolder folder(run.out);
  OutputFolder databases(run.out / "searches");
  mark_result_folder(
      run.out, ResultKind::kFrontier, study.name, source_seen_from(run.out, study.root.place.file));
  const auto keep = [&] {
    folder.keep();
    databases.keep();
  };
  const SearchFrontier frontier = measure(study, run, methods, seeds, keep);
  Json json = searches_json(study, frontier);
  const double taken_s = std::chrono::duration<double>(Clock::now() - start).count();
  write_frontier_folder(
      study,
      run.out,
      {{"search.json", json.dump(2) + "\n"}, {"search.html", page_of(study, frontier, json)}},
      {{"threads", run.threads}, {"timings", {{"this_run_s", taken_s}}}});
  keep();
  json["report"] = (run.out / "search.html").string();
  return json;
}

}  // namespace glint
