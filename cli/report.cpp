// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "core/error.h"
#include "core/file.h"
#include "studies/calibration_trial/trial_run.h"
#include "studies/export/optuna_journal.h"
#include "studies/run/run_report.h"

namespace glint {

namespace {

/// A report may be written anew; every other file is the user's.
void check_page(const std::filesystem::path& file) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(file, ignored) &&
      read_file(file).find("<meta name=\"generator\" content=\"Glint\">") == std::string::npos) {
    throw ConfigError(file.string() +
                      ": exists and is no report of glint; give the report another name by --out");
  }
}

/// Writes the journal instead of a page.
int optuna_command(const ReportArguments& arguments, const CommonArguments& common) {
  if (arguments.runs.size() != 1) {
    throw ConfigError("--optuna: exports one run, give one directory");
  }
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

}  // namespace

int report_command(const ReportArguments& arguments, const CommonArguments& common) {
  if (!arguments.optuna.empty()) {
    return optuna_command(arguments, common);
  }
  std::filesystem::path out = arguments.out;
  if (out.empty()) {
    out = arguments.runs.size() == 1 ? arguments.runs.front() / "report.html"
                                     : std::filesystem::path("report.html");
  }
  check_page(out);
  const bool is_trial = arguments.runs.size() == 1 && is_calibration_trial(arguments.runs.front());
  write_file(
      out,
      is_trial ? calibration_trial_report(arguments.runs.front()) : report_html(arguments.runs));
  print_result(common,
               {{"schema", 1}, {"status", "done"}, {"report", out.string()}},
               "report: " + out.string() + "\n");
  return kExitDone;
}

}  // namespace glint
