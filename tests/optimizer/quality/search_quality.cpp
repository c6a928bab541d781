// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: glint_search_quality --list
//        glint_search_quality RESULTS [--fresh] [--seeds N] [--evaluations N] [--alone] [PART ...]
//        glint_search_quality RESULTS [--chosen_by FILE] --table
//
// Compares searches on noisy tasks whose optima are known. A part is TASK/NOISE/METHOD, like
// zdt1/0.05/glint:auto; without parts all of --list. Each search adds one line to the file RESULTS;
// searches that it holds already are not run again, so an interrupted run goes on. Development
// seeds are 1, 2, ..; --fresh takes 1001, 1002, ... --table prints means and bars;
// the peer to compare with is the best of the results in FILE (default: RESULTS). Parts whose peer
// is not installed (Optuna) are left out with a word, and their bars are not shown. The part whose
// memory is judged is run by a process of its own, which --alone marks.
// Exit: 0 all bars met, 1 one is missed or not shown, 2 wrong usage.
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>
#include <optional>
#include <sstream>

#include "core/error.h"
#include "tests/optimizer/quality/bars.h"
#include "tests/optimizer/quality/judge.h"
#include "tests/optimizer/quality/optuna_peer.h"

namespace glint::quality {
namespace {

constexpr int kFirstFreshSeed = 1001;

struct Options {
  std::string results;
  std::string chosen_by;
  bool is_fresh = false;
  bool is_table = false;
  bool is_alone = false;
  int num_seeds = 0;  ///< 0: 30, of several objectives 20
  int evaluations = 300;
  std::vector<std::string> parts;
};

/// Lines that a kill cut short do not count.
Results read_results(const std::string& path) {
  Results results;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream fields(line);
    std::string part;
    std::string end;
    int seed = 0;
    Result result;
    if (fields >> part >> seed >> result.after_50 >> result.after_100 >> result.after_300 >>
            result.own_ms >> result.peak_mb >> end &&
        end == ".") {
      results[part][seed] = result;
    }
  }
  return results;
}

void run_part(const std::string& part, const Options& options, const Row& known) {
  const std::size_t first = part.find('/');
  const std::size_t second = part.find('/', first + 1);
  GLINT_CHECK(second != std::string::npos, "a part is TASK/NOISE/METHOD");
  const std::string name = part.substr(0, first);
  const double noise = std::stod(part.substr(first + 1, second - first - 1));
  const int needed = part == kLongPart ? 1 : is_of_several(name) ? kSeedsOfSeveral : kSeedsOfOne;
  const int num_seeds = options.num_seeds > 0 ? options.num_seeds : needed;
  std::ofstream file(options.results, std::ios::app);
  for (int i = 0; i < num_seeds; ++i) {
    const int seed = (options.is_fresh ? kFirstFreshSeed : 1) + i;
    if (known.contains(seed)) {
      continue;
    }
    const Task task = make_task(name, seed);
    const Result result =
        run_method(part.substr(second + 1), task, noise, seed, options.evaluations);
    file << fmt::format("{} {} {:.4f} {:.4f} {:.4f} {:.4f} {:.1f} .\n",
                        part,
                        seed,
                        result.after_50,
                        result.after_100,
                        result.after_300,
                        result.own_ms,
                        result.peak_mb)
         << std::flush;
  }
}

/// By this program anew, which has no memory of other parts.
void run_part_alone(const std::string& part, const Options& options) {
  std::vector<std::string> arguments = {"glint_search_quality", options.results, "--alone", part};
  if (options.is_fresh) {
    arguments.emplace_back("--fresh");
  }
  if (options.num_seeds > 0) {
    arguments.insert(arguments.end(), {"--seeds", std::to_string(options.num_seeds)});
  }
  std::vector<char*> raw;
  for (std::string& argument : arguments) {
    raw.push_back(argument.data());
  }
  raw.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    ::execv("/proc/self/exe", raw.data());
    ::_exit(127);
  }
  int status = 0;
  GLINT_CHECK(::waitpid(child, &status, 0) == child && status == 0, "a search that ends");
}

int print_table(const Options& options) {
  const Results results = read_results(options.results);
  fmt::print(
      "{:<36} {:>5} {:>8} {:>8} {:>8} {:>8}\n", "part", "seeds", "50", "100", "300", "ms/eval");
  for (const std::string& part : all_parts()) {
    const auto found = results.find(part);
    if (found != results.end()) {
      const Row& row = found->second;
      fmt::print("{:<36} {:>5} {:>8.1f} {:>8.1f} {:>8.1f} {:>8.2f}\n",
                 part,
                 row.size(),
                 mean_of(row, &Result::after_50),
                 mean_of(row, &Result::after_100),
                 mean_of(row, &Result::after_300),
                 mean_of(row, &Result::own_ms));
    }
  }
  const std::vector<Bar> bars =
      bars_of(results, options.chosen_by.empty() ? results : read_results(options.chosen_by));
  for (const Bar& bar : bars) {
    const std::string value = bar.value ? fmt::format("{:.3g}", *bar.value) : "-";
    fmt::print("{:<10} {:>6} {} {:<5} {}\n",
               !bar.value    ? "not shown"
               : is_met(bar) ? "met"
                             : "missed",
               value,
               bar.is_lower_bound ? ">=" : "<=",
               bar.bound,
               bar.what);
  }
  return std::ranges::all_of(bars, is_met) ? 0 : 1;
}

Options parse(const std::vector<std::string>& arguments) {
  Options options;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    const auto number = [&] {
      GLINT_CHECK(i + 1 < arguments.size(), "an option with a number");
      return std::stoi(arguments[++i]);
    };
    if (argument == "--fresh") {
      options.is_fresh = true;
    } else if (argument == "--table") {
      options.is_table = true;
    } else if (argument == "--alone") {
      options.is_alone = true;
    } else if (argument == "--chosen_by") {
      GLINT_CHECK(i + 1 < arguments.size(), "an option with a file");
      options.chosen_by = arguments[++i];
    } else if (argument == "--seeds") {
      options.num_seeds = number();
    } else if (argument == "--evaluations") {
      options.evaluations = number();
    } else if (options.results.empty()) {
      options.results = argument;
    } else {
      options.parts.push_back(argument);
    }
  }
  return options;
}

int run(const std::vector<std::string>& arguments) {
  if (arguments.size() == 1 && arguments[0] == "--list") {
    for (const std::string& part : all_parts()) {
      fmt::print("{}\n", part);
    }
    return 0;
  }
  const Options options = parse(arguments);
  if (options.results.empty()) {
    std::cerr << "usage: glint_search_quality --list | RESULTS [--fresh] [--seeds N] "
                 "[--evaluations N] [--alone] [--table] [PART ...]\n";
    return 2;
  }
  if (options.is_table) {
    return print_table(options);
  }
  const Results known = read_results(options.results);
  for (const std::string& part : options.parts.empty() ? all_parts() : options.parts) {
    const auto found = known.find(part);
    try {
      if (part == kLongPart && !options.is_alone) {
        run_part_alone(part, options);
      } else {
        run_part(part, options, found == known.end() ? Row{} : found->second);
      }
    } catch (const PeerMissing& missing) {
      std::cerr << part << " left out: " << missing.what() << "\n";
    }
  }
  return 0;
}

}  // namespace
}  // namespace glint::quality

int main(int argc, char** argv) {
  try {
    return glint::quality::run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::cerr << "search_quality: " << error.what() << "\n";
    return 2;
  }
}
