// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/optimizer/quality/bars.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace glint::quality {
namespace {

using Score = double Result::*;

/// Mean over seeds; empty, and why is added, where there are too few of them.
std::optional<double> mean_of_part(
    const Results& results, const std::string& part, int needed, Score score, std::string& why) {
  const auto found = results.find(part);
  const std::size_t count = found == results.end() ? 0 : found->second.size();
  if (count < static_cast<std::size_t>(needed)) {
    why = fmt::format(" ({} has {} of {} seeds)", part, count, needed);
    return std::nullopt;
  }
  return mean_of(found->second, score);
}

/// Mean over tasks of the means over seeds.
std::optional<double> mean_over(const Results& results,
                                const std::vector<std::string_view>& tasks,
                                int needed,
                                const std::string& noise_and_method,
                                Score score,
                                std::string& why) {
  double sum = 0.0;
  for (const std::string_view task : tasks) {
    const std::string part = fmt::format("{}/{}", task, noise_and_method);
    const std::optional<double> mean = mean_of_part(results, part, needed, score, why);
    if (!mean) {
      return std::nullopt;
    }
    sum += *mean;
  }
  return sum / static_cast<double>(tasks.size());
}

std::vector<Bar> hypervolume_bars(const Results& results) {
  struct Wanted {
    const char* noise;
    Score score;
    const char* after;
    double bound;
  };

  std::vector<Bar> bars;
  for (const Wanted& wanted : {Wanted{"0.05", &Result::after_100, "100", 91.0},
                               Wanted{"0.05", &Result::after_300, "300", 94.5},
                               Wanted{"0.2", &Result::after_100, "100", 88.0},
                               Wanted{"0.2", &Result::after_300, "300", 92.0}}) {
    std::string why;
    const auto value = mean_over(results,
                                 tasks_of_several_objectives(),
                                 kSeedsOfSeveral,
                                 std::string(wanted.noise) + "/glint:auto",
                                 wanted.score,
                                 why);
    bars.push_back({.what = fmt::format(
                        "hypervolume, noise {}, after {}, %{}", wanted.noise, wanted.after, why),
                    .value = value,
                    .bound = wanted.bound,
                    .is_least = true});
  }
  return bars;
}

/// The ratio of mean gaps to the best peer's.
Bar ratio_bar(const Results& results,
              const std::string& noise,
              Score score,
              const std::string& after,
              double bound) {
  Bar bar{.what = fmt::format("gap over best peer's, noise {}, after {}", noise, after),
          .bound = bound};
  const auto gap_of = [&](const std::string& method, std::string& why) {
    return mean_over(
        results, tasks_of_one_objective(), kSeedsOfOne, noise + "/" + method, score, why);
  };
  std::string why;
  std::optional<double> best;
  std::string best_name;
  for (const std::string& peer : peers_of_one()) {
    const std::optional<double> gap = gap_of(peer, why);
    if (!gap) {
      bar.what += why;
      return bar;
    }
    if (!best || *gap < *best) {
      best = gap;
      best_name = peer;
    }
  }
  bar.what += fmt::format(" ({} {:.1f} %)", best_name, *best);
  if (const auto own = gap_of("glint:auto", why)) {
    bar.value = *own / *best;
  }
  bar.what += why;
  return bar;
}

/// On its worst task.
Bar random_bar(const Results& results, const std::string& noise) {
  Bar bar{.what = fmt::format("gap over random's on the worst task, noise {}, after 100", noise),
          .bound = 1.0};
  std::string why;
  double worst = 0.0;
  std::string_view worst_task;
  for (const std::string_view task : tasks_of_one_objective()) {
    const auto gap_of = [&](const char* method) {
      const std::string part = fmt::format("{}/{}/{}", task, noise, method);
      return mean_of_part(results, part, kSeedsOfOne, &Result::after_100, why);
    };
    const auto own = gap_of("glint:auto");
    const auto random = gap_of("glint:random");
    if (!own || !random) {
      bar.what += why;
      return bar;
    }
    if (worst_task.empty() || *own / *random > worst) {
      worst = *own / *random;
      worst_task = task;
    }
  }
  bar.what += fmt::format(" ({})", worst_task);
  bar.value = worst;
  return bar;
}

}  // namespace

std::vector<std::string> noises_of_one() {
  return {"0", "0.05", "0.2"};
}

std::vector<std::string> noises_of_several() {
  return {"0.05", "0.2"};
}

std::vector<std::string> peers_of_one() {
  return {"nlopt:cobyla",
          "nlopt:bobyqa",
          "nlopt:direct_l",
          "nlopt:direct_l_rand",
          "glint:cmaes",
          "optuna:tpe",
          "optuna:cmaes"};
}

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
  add(tasks_of_several_objectives(), noises_of_several(), {"glint:nsga2", "glint:nspso"});
  add(tasks_of_one_objective(), noises_of_one(), peers_of_one());
  return parts;
}

double mean_of(const Row& row, double Result::*score) {
  double sum = 0.0;
  for (const auto& [seed, result] : row) {
    sum += result.*score;
  }
  return row.empty() ? std::nan("") : sum / static_cast<double>(row.size());
}

bool is_met(const Bar& bar) {
  return bar.value && (bar.is_least ? *bar.value >= bar.bound : *bar.value <= bar.bound);
}

std::vector<Bar> bars_of(const Results& results) {
  std::vector<Bar> bars = hypervolume_bars(results);
  for (const std::string& noise : noises_of_one()) {
    const bool is_noisy = noise != "0";
    if (is_noisy) {
      bars.push_back(ratio_bar(results, noise, &Result::after_100, "100", 0.9));
    }
    bars.push_back(ratio_bar(results, noise, &Result::after_300, "300", is_noisy ? 0.9 : 1.1));
    bars.push_back(random_bar(results, noise));
  }
  return bars;
}

}  // namespace glint::quality
