// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/shell/output_file.h"
#include "core/error.h"
#include "core/file.h"
#include "studies/analysis/run_analysis.h"
#include "studies/calibration_trial/trial_run.h"
#include "studies/export/optuna_journal.h"
#include "studies/report/report.h"
#include "studies/run/run_report.h"

namespace glint {

namespace {

/// A report may be written anew; every other file is the user's.
void check_page(const std::filesystem::path& file) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(file, ignored) &&
      read_file(file).find(R"(<meta name="generator" content="Glint">)") == std::string::npos) {
    throw ConfigError(file.string() +
                      ": exists and is no report of glint; give the report another name by --out");
  }
}

/// Writes the journal instead of a page.
int optuna_command(const ReportArguments& arguments, const CommonArguments& common) {
  if (arguments.runs.size() != 1) {
    throw ConfigError("--optuna: exports one run, give one directory");
  }
  const FolderOf folder(arguments.optuna);
  const OptunaExport counts = export_to_optuna(arguments.runs.front(), arguments.optuna);
  print_result(common,
               {{"schema", 1},
                {"status", "done"},
                {"optuna", arguments.optuna.string()},
                {"complete", counts.complete},
                {"failed", counts.failed},
                {"unfinished", counts.unfinished}},
               fmt::format("optuna: {} with {} trials, {} of them failed\n",
                           arguments.optuna.string(),
                           counts.complete + counts.failed,
                           counts.failed));
  return kExitDone;
}

/// Importance and responses of the objective over all branches, as they are asked for most.
void add_analysis(const nlohmann::ordered_json& analysis, nlohmann::ordered_json& result) {
  const auto& objective = analysis["scores"][0];
  result["q2"] = objective["q2"];
  for (const char* list : {"importance", "responses"}) {
    result[list] = nlohmann::ordered_json::array();
    for (const auto& branch : objective["branches"]) {
      for (auto entry : branch[list]) {
        if (!branch["name"].get<std::string>().empty()) {
          entry["branch"] = branch["name"];
        }
        result[list].push_back(entry);
      }
    }
  }
  result["analysis"] = analysis;
}

/// A line for each score and branch: how well it is modelled, and what matters most.
std::string analysis_text(const nlohmann::ordered_json& analysis) {
  std::string text;
  for (const auto& score : analysis["scores"]) {
    for (const auto& branch : score["branches"]) {
      const auto name = branch["name"].get<std::string>();
      text += fmt::format(
          "{}{}: ", score["score"].get<std::string>(), name.empty() ? name : " with " + name);
      if (!branch["is_enough"].get<bool>()) {
        const int wanted = branch["wanted"].get<int>();
        text += fmt::format("not enough evidence, {}{}\n",
                            branch["reason"].get<std::string>(),
                            wanted > 0 ? fmt::format("; designs wanted: {}", wanted) : "");
        continue;
      }
      text += fmt::format("Q2 = {:.2f}\n", branch["q2"].get<double>());
      for (const auto& one : branch["importance"]) {
        text += fmt::format("  {:<44} {:3.0f} % alone, {:3.0f} % in all ({:.0f} to {:.0f})\n",
                            one["variable"].get<std::string>(),
                            100.0 * one["first"].get<double>(),
                            100.0 * one["total"].get<double>(),
                            100.0 * one["total_low"].get<double>(),
                            100.0 * one["total_high"].get<double>());
      }
    }
    for (const auto& one : score["choices"]) {
      text += fmt::format("{}: the choice of {} explains {:.0f} % alone\n",
                          score["score"].get<std::string>(),
                          one["variable"].get<std::string>(),
                          100.0 * one["first"].get<double>());
    }
    if (score["wanted"].get<int>() > 0) {
      text += fmt::format(
          "{}: about {} designs spread over the space would be enough (--evaluate {})\n",
          score["score"].get<std::string>(),
          score["wanted"].get<int>(),
          score["wanted"].get<int>() + analysis["added"].get<int>());
    }
  }
  return text;
}

/// The page of one run with its analysis.
int analyse_command(const ReportArguments& arguments, const CommonArguments& common) {
  if (arguments.runs.size() != 1) {
    throw ConfigError("--analyse: takes one run apart, give one directory");
  }
  const std::filesystem::path& run = arguments.runs.front();
  const std::filesystem::path out = arguments.out.empty() ? run / "report.html" : arguments.out;
  check_page(out);
  if (arguments.evaluate > 0) {
    add_designs(
        run,
        {.count = arguments.evaluate, .threads = common.threads, .progress = common.progress()});
  }
  const nlohmann::ordered_json analysis = analyse_run(run);
  nlohmann::ordered_json data = report_data({run});
  data["analysis"] = analysis;
  const FolderOf folder(out);
  write_file(out, render_report(data));
  nlohmann::ordered_json result = {{"schema", 1}, {"status", "done"}, {"report", out.string()}};
  add_analysis(analysis, result);
  print_result(common, result, analysis_text(analysis) + "report: " + out.string() + "\n");
  return kExitDone;
}

}  // namespace

int report_command(const ReportArguments& arguments, const CommonArguments& common) {
  if (!arguments.optuna.empty()) {
    return optuna_command(arguments, common);
  }
  if (arguments.is_analysed) {
    return analyse_command(arguments, common);
  }
  std::filesystem::path out = arguments.out;
  if (out.empty()) {
    out = arguments.runs.size() == 1 ? arguments.runs.front() / "report.html"
                                     : std::filesystem::path("report.html");
  }
  check_page(out);
  const bool is_trial = arguments.runs.size() == 1 && is_calibration_trial(arguments.runs.front());
  const FolderOf folder(out);
  write_file(
      out,
      is_trial ? calibration_trial_report(arguments.runs.front()) : report_html(arguments.runs));
  print_result(common,
               {{"schema", 1}, {"status", "done"}, {"report", out.string()}},
               "report: " + out.string() + "\n");
  return kExitDone;
}

}  // namespace glint
