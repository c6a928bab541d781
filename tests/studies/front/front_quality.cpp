// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: glint_front_quality --list
//        glint_front_quality STUDY FOLDER [--evaluations N] [PART ...]
//        glint_front_quality STUDY FOLDER --front FILE
//        glint_front_quality STUDY FOLDER --table FILE
//
// Compares searches of a study with several objectives with the best front that is known of it. A
// part is nsga2, the long search that the front comes from (20,000 evaluations, or N), or gp/SEED,
// 300 evaluations; without parts all of --list. Each is a database in FOLDER, so that an
// interrupted part goes on. --front writes what no design of all parts beats, and of the FILE that
// is there;
// --table prints which share of its hypervolume each gp/SEED has.
// Exit: 0 done, with --table the bar is met; 1 it is missed or not shown; 2 wrong usage.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "core/thread_pool.h"
#include "optimizer/algorithm/merit.h"
#include "optimizer/front/front.h"
#include "optimizer/search/search.h"
#include "studies/definition/study_text.h"
#include "studies/output/provenance.h"
#include "studies/run/study_search.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using Row = std::vector<double>;

constexpr int kSeeds = 10;
constexpr int kEvaluations = 300;
constexpr int kLongEvaluations = 20000;
constexpr double kShareWanted = 0.95;
constexpr const char* kLongPart = "nsga2";

std::vector<std::string> all_parts() {
  std::vector<std::string> parts = {kLongPart};
  for (int seed = 1; seed <= kSeeds; ++seed) {
    parts.push_back(fmt::format("gp/{}", seed));
  }
  return parts;
}

Study study_of(const fs::path& file, const std::string& part, int evaluations) {
  const bool is_long = part == kLongPart;
  std::vector<KeyValue> sets = {{"search.algorithm", is_long ? "nsga2" : "gp"},
                                {"search.seed", is_long ? "1" : part.substr(part.find('/') + 1)},
                                {"budget.evaluations", std::to_string(evaluations)}};
  return load_study(file, sets);
}

fs::path database_of(const fs::path& folder, std::string part) {
  std::ranges::replace(part, '/', '_');
  return folder / (part + ".sqlite");
}

void run_part(const fs::path& file, const fs::path& folder, const std::string& part, int longest) {
  const Study study =
      study_of(file, part, part == kLongPart ? longest : std::min(longest, kEvaluations));
  fs::create_directories(folder);
  Storage storage = Storage::open(database_of(folder, part),
                                  {.config_hash = config_hash(study),
                                   .config_text = resolved_text(study),
                                   .code_version = program_version(),
                                   .seed = study.search.seed});
  ThreadPool pool(1);
  SceneStore store(pool);
  const auto evaluate = [&](const Point& point, int /*trial*/) {
    return evaluate_candidate(store, study, point);
  };
  const SearchResult result = run_search(search_task(study, study.search.batch), storage, evaluate);
  std::cout << fmt::format("{}: {} evaluations\n", part, result.evaluations) << std::flush;
}

/// A front as a table: objectives in the scores' units, then where they come from.
struct KnownFront {
  std::vector<Row> rows;  ///< objectives, minimised
  std::vector<std::string> lines;
};

/// The rows of a file that --front wrote; none without it.
KnownFront read_front(const Goal& goal, const fs::path& file) {
  KnownFront front;
  std::istringstream text(fs::exists(file) ? read_file(file) : "");
  const std::vector<Objective> objectives = objectives_of(goal);
  bool is_head = true;
  for (std::string line; std::getline(text, line);) {
    if (line.empty() || line.front() == '#') {
      continue;
    }
    if (!std::exchange(is_head, false)) {
      std::istringstream fields(line);
      Row row;
      for (const Objective& objective : objectives) {
        std::string field;
        std::getline(fields, field, ',');
        row.push_back((objective.is_maximised ? -1.0 : 1.0) * std::stod(field));
      }
      front.rows.push_back(std::move(row));
      front.lines.push_back(line);
    }
  }
  return front;
}

std::vector<Trial> trials_of(const fs::path& folder, const std::string& part) {
  const fs::path file = database_of(folder, part);
  std::vector<Trial> trials =
      fs::exists(file) ? Storage::read(file).trials(TrialKind::kSearch) : std::vector<Trial>{};
  std::erase_if(trials, [](const Trial& trial) { return !trial.outcome; });
  return trials;
}

void add_part(const Study& study,
              const fs::path& folder,
              const std::string& part,
              KnownFront& known) {
  const std::vector<Trial> trials = trials_of(folder, part);
  const TradeOff found = trade_off(study.goal, trials, {});
  for (std::size_t k = 0; k < found.trials.size(); ++k) {
    const auto trial = std::ranges::find(trials, found.trials[k], &Trial::number);
    std::vector<std::string> fields;
    for (const double value : in_score_units(study.goal, found.front[k])) {
      fields.push_back(fmt::format("{:.6g}", value));
    }
    for (const double value : trial->point) {
      fields.push_back(fmt::format("{:.6g}", value));
    }
    fields.push_back(fmt::format("{} {}", part, found.trials[k]));
    known.rows.push_back(found.front[k]);
    known.lines.push_back(join(fields, ","));
  }
}

std::string head_of(const Study& study) {
  std::vector<std::string> names;
  for (const Objective& objective : objectives_of(study.goal)) {
    names.push_back(objective.name);
  }
  for (const Variable& variable : study.space.variables) {
    names.push_back(variable.name);
  }
  names.emplace_back("from");
  return join(names, ",");
}

int write_front(const fs::path& study_file, const fs::path& folder, const fs::path& file) {
  const Study study = study_of(study_file, kLongPart, kLongEvaluations);
  KnownFront known;
  std::vector<std::string> counts;
  for (const std::string& part : all_parts()) {
    add_part(study, folder, part, known);
    if (const std::size_t count = trials_of(folder, part).size(); count > 0) {
      counts.push_back(fmt::format("{} {}", part, count));
    }
  }
  const KnownFront before = read_front(study.goal, file);
  const std::set<std::string> found(known.lines.begin(), known.lines.end());
  for (std::size_t k = 0; k < before.rows.size(); ++k) {
    if (!found.contains(before.lines[k])) {
      known.rows.push_back(before.rows[k]);
      known.lines.push_back(before.lines[k]);
    }
  }
  const std::vector<std::size_t> unbeaten = front_of(known.rows);
  std::vector<Row> rows;
  std::string text;
  for (const std::size_t k : unbeaten) {
    rows.push_back(known.rows[k]);
    text += known.lines[k] + "\n";
  }
  const double volume = hypervolume(rows, reference_of(study.goal, {}));
  write_file(file,
             fmt::format("# The best front that is known of {}, by script/bench search front.\n"
                         "# Evaluations: {}. Hypervolume: {:.2f}.\n{}\n{}",
                         study.name,
                         join(counts, ", "),
                         volume,
                         head_of(study),
                         text));
  std::cout << fmt::format("{} designs, hypervolume {:.2f}\n", unbeaten.size(), volume);
  return 0;
}

int print_table(const fs::path& study_file, const fs::path& folder, const fs::path& file) {
  const Study study = study_of(study_file, kLongPart, kLongEvaluations);
  const std::vector<double> reference = reference_of(study.goal, {});
  const std::vector<Row> known = read_front(study.goal, file).rows;
  if (known.empty()) {
    std::cout << fmt::format("not shown: no best front is known, {} is missing\n", file.string());
    return 1;
  }
  const double best = hypervolume(known, reference);
  std::cout << fmt::format("best known: {:.2f}\n{:<8} {:>8} {:>8}\n", best, "part", "100", "300");
  std::vector<double> shares;
  for (const std::string& part : all_parts()) {
    if (part == kLongPart) {
      continue;
    }
    const std::vector<double> history =
        hypervolume_history(study.goal, trials_of(folder, part), reference);
    if (history.size() < kEvaluations) {
      continue;
    }
    shares.push_back(history[kEvaluations - 1] / best);
    std::cout << fmt::format(
        "{:<8} {:>7.1f}% {:>7.1f}%\n", part, 100.0 * history[99] / best, 100.0 * shares.back());
  }
  const bool is_shown = std::ssize(shares) == kSeeds;
  const double least = shares.empty() ? 0.0 : *std::ranges::min_element(shares);
  const bool is_met = is_shown && least >= kShareWanted;
  std::cout << fmt::format("{}: least of {} seeds {:.1f} %, wanted {:.0f} % of {} seeds\n",
                           is_met     ? "met"
                           : is_shown ? "missed"
                                      : "not shown",
                           shares.size(),
                           100.0 * least,
                           100.0 * kShareWanted,
                           kSeeds);
  return is_met ? 0 : 1;
}

int run(std::vector<std::string> arguments) {
  if (arguments == std::vector<std::string>{"--list"}) {
    std::cout << join(all_parts(), "\n") << "\n";
    return 0;
  }
  GLINT_CHECK(arguments.size() >= 2, "STUDY and FOLDER");
  const fs::path study = arguments[0];
  const fs::path folder = arguments[1];
  arguments.erase(arguments.begin(), arguments.begin() + 2);
  if (arguments.size() == 2 && (arguments[0] == "--front" || arguments[0] == "--table")) {
    return arguments[0] == "--front" ? write_front(study, folder, arguments[1])
                                     : print_table(study, folder, arguments[1]);
  }
  int longest = kLongEvaluations;
  if (arguments.size() >= 2 && arguments[0] == "--evaluations") {
    longest = std::stoi(arguments[1]);
    arguments.erase(arguments.begin(), arguments.begin() + 2);
  }
  const std::vector<std::string> known = all_parts();
  for (const std::string& part : arguments) {
    GLINT_CHECK(std::ranges::count(known, part) > 0, "a part of --list");
  }
  for (const std::string& part : arguments.empty() ? known : arguments) {
    run_part(study, folder, part, longest);
  }
  return 0;
}

}  // namespace
}  // namespace glint

int main(int argc, char** argv) {
  try {
    return glint::run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::cerr << "front_quality: " << error.what() << "\n";
    return 2;
  }
}
