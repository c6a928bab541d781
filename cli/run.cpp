// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run.h"

#include <atomic>
#include <csignal>

#include <fmt/format.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include "cli/commands.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

/// Read by the search; a signal handler can reach nothing but a global.
std::atomic<int> interrupts = 0;

/// The first interrupt lets running evaluations finish; at the second the program ends at once.
/// Nothing is lost: every finished evaluation is already recorded.
void on_interrupt(int /*signal*/) {
  if (interrupts.fetch_add(1) >= 1) {
    ::_exit(kExitInterrupted);
  }
}

std::string score_text(const Json& scores, const char* name) {
  return scores.contains(name) ? fmt::format("{:.2f} %", 100.0 * scores[name].get<double>()) : "-";
}

std::string row(const std::string& name, const Json& scores) {
  return fmt::format("  {:<24} {:>10} {:>10}\n",
                     name,
                     score_text(scores, "homogeneity.h_rms"),
                     score_text(scores, "homogeneity.h_abs"));
}

std::string summary(const Json& result) {
  std::string text = fmt::format("{}: {} evaluations, {} failed\n",
                                 result["status"].get<std::string>(),
                                 result["evaluations"].get<int>(),
                                 result["failed"].get<int>());
  text += fmt::format("  {:<24} {:>10} {:>10}\n", "", "h_rms", "h_abs");
  text += row("baseline", result["baseline"]["scores"]);
  for (const auto& [name, prototype] : result["prototypes"].items()) {
    text += row(name, prototype["scores"]);
  }
  if (!result["best"].is_null()) {
    text += row(fmt::format("winner (trial {})", result["best"]["trial"].get<int>()),
                result["best"]["scores"]);
    text += row("winner, re-scored", result["rescored"]["best"]);
    for (const auto& [name, value] : result["best"]["variables"].items()) {
      text += fmt::format("  {} = {}\n", name, value.dump());
    }
  }
  return text + fmt::format("report: {}\n", result["report"].get<std::string>());
}

int jobs_of(const StudyArguments& arguments, const CommonArguments& common) {
  return arguments.jobs > 0 ? arguments.jobs : common.threads;
}

}  // namespace

int run_command(const StudyArguments& arguments, const CommonArguments& common) {
  const Study study = load_study(arguments);
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
  const Json result = run_study(
      study,
      {.out = arguments.out.empty() ? std::filesystem::path("out") / study.name : arguments.out,
       .threads = common.threads,
       .jobs = jobs_of(arguments, common),
       .progress = common.progress(),
       .log_file = common.log_file,
       .interrupt = &interrupts});
  print_result(common, result, summary(result));
  if (result["status"] == "interrupted") {
    return kExitInterrupted;
  }
  return result["status"] == "no_feasible" ? kExitNegative : kExitDone;
}

int check_command(const StudyArguments& arguments, const CommonArguments& common) {
  const Study study = load_study(arguments);
  const Json result = check_study(study, common.threads, jobs_of(arguments, common));
  std::string text = fmt::format(
      "{}: the study is sound, {} variables\n", study.name, result["variables"].get<std::size_t>());
  text += fmt::format("  {:<24} {:>10} {:>10}\n", "", "h_rms", "h_abs");
  text += row("baseline", result["baseline"]["scores"]);
  for (const auto& [name, prototype] : result["prototypes"].items()) {
    text += row(name, prototype["scores"]);
  }
  for (const Json& note : result["baseline"]["notes"]) {
    text += "  note: " + note.get<std::string>() + "\n";
  }
  for (const Json& name : result["idle_variables"]) {
    text += fmt::format("  warning: {} changes nothing in this scene\n", name.get<std::string>());
  }
  text += fmt::format("{:.3f} s an evaluation, about {} for {} evaluations\n",
                      result["seconds_per_evaluation"].get<double>(),
                      duration_text(result["predicted_s"].get<double>()),
                      result["evaluations"].get<int>());
  print_result(common, result, text);
  return kExitDone;
}

int render_command(const StudyArguments& arguments, const CommonArguments& common) {
  const Study study = load_study(arguments);
  const Json result = render_study(study, arguments.out, common.threads);
  std::string text;
  for (const auto& [name, value] : result["scores"].items()) {
    text += fmt::format("  {:<32} {:.6g}\n", name, value.get<double>());
  }
  text += fmt::format("pictures: {}\nreport: {}\n",
                      result["folder"].get<std::string>(),
                      result["report"].get<std::string>());
  print_result(common, result, text);
  return kExitDone;
}

}  // namespace glint
