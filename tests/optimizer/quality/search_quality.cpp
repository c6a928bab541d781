// SPDX-License-Identifier: GPL-3.0-or-later
//
// usage: glint_search_quality --list
//        glint_search_quality RESULTS [--fresh] [--seeds N] [--evaluations N] [PART ...]
//        glint_search_quality RESULTS [--fresh] --table
//
// Compares searches on noisy tasks whose optima are known. A part is TASK/NOISE/METHOD, like
// zdt1/0.05/glint:auto; without parts all of --list. Each search adds one line to the file RESULTS;
// searches that it holds already are not run again, so an interrupted run goes on. Development
// seeds are 1, 2, ..; --fresh takes 1001, 1002, ... --table prints means and bars.
// Exit: 0 all bars met, 1 one is missed or not shown, 2 wrong usage.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "core/error.h"
#include "tests/optimizer/quality/judge.h"

namespace glint::quality {
namespace {

constexpr int kFirstFreshSeed = 1001;
const std::vector<std::string> kNoises = {"0", "0.05", "0.2"};
const std::vector<std::string> kNoisesOfSeveral = {"0.05", "0.2"};
const std::vector<std::string> kPeers = {
    "nlopt:cobyla", "nlopt:bobyqa", "nlopt:direct_l", "nlopt:direct_l_rand", "glint:cmaes"};
const std::vector<std::string> kPeersOfSeveral = {"glint:nsga2", "glint:nspso"};

struct Options {
  std::string results;
  bool is_fresh = false;
  bool is_table = false;
  int num_seeds = 0;  ///< 0: 30, of several objectives 20
  int evaluations = 300;
  std::vector<std::string> parts;
};

bool is_of_several(const std::string& task) {
  const std::vector<std::string_view> several = tasks_of_several_objectives();
  return std::ranges::find(several, task) != several.end();
}

std::vector<std::string> all_parts() {
  std::vector<std::string> parts;
  const auto add = [&](auto tasks, const auto& noises, std::vector<std::string> methods) {
    methods.insert(methods.begin(), {"glint:auto", "glint:random"});
    for (const std::string_view task : tasks) {
      for (const std::string& noise : noises) {
        for (const std::string& method : methods) {
          parts.push_back(fmt::format("{}/{}/{}", task, noise, method));
        }
      }
    }
  };
  add(tasks_of_several_objectives(), kNoisesOfSeveral, kPeersOfSeveral);
  add(tasks_of_one_objective(), kNoises, kPeers);
  return parts;
}

using Row = std::map<int, Result>;  ///< by seed

/// Part -> results; lines that a kill cut short do not count.
std::map<std::string, Row> read_results(const std::string& path) {
  std::map<std::string, Row> results;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream fields(line);
    std::string part;
    std::string end;
    int seed = 0;
    Result result;
    if (fields >> part >> seed >> result.after_100 >> result.after_300 >> result.own_ms >> end &&
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
  const int num_seeds = options.num_seeds > 0 ? options.num_seeds : (is_of_several(name) ? 20 : 30);
  std::ofstream file(options.results, std::ios::app);
  for (int i = 0; i < num_seeds; ++i) {
    const int seed = (options.is_fresh ? kFirstFreshSeed : 1) + i;
    if (known.contains(seed)) {
      continue;
    }
    const Task task = make_task(name, seed);
    const Result result =
        run_method(part.substr(second + 1), task, noise, seed, options.evaluations);
    file << fmt::format("{} {} {:.4f} {:.4f} {:.4f} .\n",
                        part,
                        seed,
                        result.after_100,
                        result.after_300,
                        result.own_ms)
         << std::flush;
  }
}

double mean_of(const Row& row, double Result::*score) {
  double sum = 0.0;
  for (const auto& [seed, result] : row) {
    sum += result.*score;
  }
  return row.empty() ? std::nan("") : sum / static_cast<double>(row.size());
}

/// Mean over tasks of the means over seeds; empty where a task is missing.
std::optional<double> mean_over(const std::map<std::string, Row>& results,
                                const std::vector<std::string_view>& tasks,
                                const std::string& noise,
                                const std::string& method,
                                double Result::*score) {
  double sum = 0.0;
  for (const std::string_view task : tasks) {
    const auto found = results.find(fmt::format("{}/{}/{}", task, noise, method));
    if (found == results.end()) {
      return std::nullopt;
    }
    sum += mean_of(found->second, score);
  }
  return sum / static_cast<double>(tasks.size());
}

struct Bar {
  std::string what;
  std::optional<double> value;
  double bound = 0.0;
  bool is_least = false;  ///< the value must not be below the bound, else not above it
};

bool is_met(const Bar& bar) {
  return bar.value && (bar.is_least ? *bar.value >= bar.bound : *bar.value <= bar.bound);
}

std::vector<Bar> hypervolume_bars(const std::map<std::string, Row>& results) {
  struct Wanted {
    const char* noise;
    double Result::*score;
    const char* after;
    double bound;
  };

  std::vector<Bar> bars;
  for (const Wanted& wanted : {Wanted{"0.05", &Result::after_100, "100", 91.0},
                               Wanted{"0.05", &Result::after_300, "300", 94.5},
                               Wanted{"0.2", &Result::after_100, "100", 88.0},
                               Wanted{"0.2", &Result::after_300, "300", 92.0}}) {
    bars.push_back(
        {.what = fmt::format("hypervolume, noise {}, after {}, %", wanted.noise, wanted.after),
         .value = mean_over(
             results, tasks_of_several_objectives(), wanted.noise, "glint:auto", wanted.score),
         .bound = wanted.bound,
         .is_least = true});
  }
  return bars;
}

/// The ratio of mean gaps to the best peer's, as far as all peers were run.
Bar ratio_bar(const std::map<std::string, Row>& results,
              const std::string& noise,
              double Result::*score,
              const std::string& after,
              double bound) {
  const std::vector<std::string_view> tasks = tasks_of_one_objective();
  Bar bar{.what = fmt::format("gap over best peer's, noise {}, after {}", noise, after),
          .bound = bound};
  std::optional<double> best;
  std::string best_name;
  for (const std::string& peer : kPeers) {
    const std::optional<double> gap = mean_over(results, tasks, noise, peer, score);
    if (!gap) {
      bar.what += " (" + peer + " is missing)";
      return bar;
    }
    if (!best || *gap < *best) {
      best = gap;
      best_name = peer;
    }
  }
  bar.what += fmt::format(" ({} {:.1f} %)", best_name, *best);
  if (const auto own = mean_over(results, tasks, noise, "glint:auto", score)) {
    bar.value = *own / *best;
  }
  return bar;
}

int print_table(const Options& options) {
  const std::map<std::string, Row> results = read_results(options.results);
  fmt::print("{:<36} {:>5} {:>8} {:>8} {:>8}\n", "part", "seeds", "100", "300", "ms/eval");
  for (const std::string& part : all_parts()) {
    const auto found = results.find(part);
    if (found != results.end()) {
      const Row& row = found->second;
      fmt::print("{:<36} {:>5} {:>8.1f} {:>8.1f} {:>8.2f}\n",
                 part,
                 row.size(),
                 mean_of(row, &Result::after_100),
                 mean_of(row, &Result::after_300),
                 mean_of(row, &Result::own_ms));
    }
  }
  std::vector<Bar> bars = hypervolume_bars(results);
  for (const std::string& noise : kNoises) {
    const bool is_noisy = noise != "0";
    if (is_noisy) {
      bars.push_back(ratio_bar(results, noise, &Result::after_100, "100", 0.9));
    }
    bars.push_back(ratio_bar(results, noise, &Result::after_300, "300", is_noisy ? 0.9 : 1.1));
  }
  bars.push_back(
      {.what = "gap over Optuna's TPE and CMA-ES: they are not run by this program", .bound = 0.9});
  for (const Bar& bar : bars) {
    const std::string value = bar.value ? fmt::format("{:.3g}", *bar.value) : "-";
    fmt::print("{:<10} {:>6} {} {:<5} {}\n",
               !bar.value    ? "not shown"
               : is_met(bar) ? "met"
                             : "missed",
               value,
               bar.is_least ? ">=" : "<=",
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
                 "[--evaluations N] [--table] [PART ...]\n";
    return 2;
  }
  if (options.is_table) {
    return print_table(options);
  }
  const std::map<std::string, Row> known = read_results(options.results);
  for (const std::string& part : options.parts.empty() ? all_parts() : options.parts) {
    const auto found = known.find(part);
    run_part(part, options, found == known.end() ? Row{} : found->second);
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
