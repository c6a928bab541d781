// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/optimizer/quality/bars.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>
#include <utility>

#include "tests/optimizer/quality/resampling.h"

namespace glint::quality {
namespace {

using Score = double Result::*;

constexpr const char* kMixedPeer = "optuna:tpe";
constexpr const char* kDerivativeMethod = "derivatives:gp";

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
                    .is_lower_bound = true});
  }
  return bars;
}

/// The peer of the least mean gap; empty, and why is added, where one is not shown.
std::optional<std::string> best_peer(const Results& results,
                                     const std::string& noise,
                                     Score score,
                                     std::string& why) {
  std::optional<double> best;
  std::string best_name;
  for (const std::string& peer : peers_of_one()) {
    const std::string method = fmt::format("{}/{}", noise, peer);
    const std::optional<double> gap =
        mean_over(results, tasks_of_one_objective(), kSeedsOfOne, method, score, why);
    if (!gap) {
      return std::nullopt;
    }
    if (!best || *gap < *best) {
      best = gap;
      best_name = peer;
    }
  }
  return best_name;
}

/// Of seeds that both have; empty, and why is added, where there are too few of them.
std::optional<Pairs> pairs_of_task(const Results& results,
                                   const std::string& own_part,
                                   const std::string& peer_part,
                                   Score score,
                                   std::string& why) {
  for (const std::string& part : {own_part, peer_part}) {
    if (!mean_of_part(results, part, kSeedsOfOne, score, why)) {
      return std::nullopt;
    }
  }
  const Row& peer_row = results.at(peer_part);
  Pairs pairs;
  for (const auto& [seed, own] : results.at(own_part)) {
    const auto peer = peer_row.find(seed);
    if (peer != peer_row.end()) {
      pairs.own.push_back(own.*score);
      pairs.peer.push_back(peer->second.*score);
    }
  }
  if (pairs.own.size() < static_cast<std::size_t>(kSeedsOfOne)) {
    why = fmt::format(" ({} seeds are those of {})", pairs.own.size(), peer_part);
    return std::nullopt;
  }
  return pairs;
}

std::optional<std::vector<Pairs>> pairs_over(const Results& results,
                                             const std::vector<std::string_view>& tasks,
                                             const std::string& noise,
                                             const std::string& peer,
                                             Score score,
                                             std::string& why) {
  std::vector<Pairs> all;
  for (const std::string_view task : tasks) {
    const std::string begin = fmt::format("{}/{}/", task, noise);
    auto pairs = pairs_of_task(results, begin + "glint:auto", begin + peer, score, why);
    if (!pairs) {
      return std::nullopt;
    }
    all.push_back(std::move(*pairs));
  }
  return all;
}

struct RatioWanted {
  std::string noise;
  Score score = nullptr;
  const char* after = "";
  double bound = 0.0;
  double upper_bound = 0.0;
};

/// The ratio of mean gaps to the best peer's, and the upper end of its interval.
std::vector<Bar> ratio_bars(const Results& results,
                            const Results& development,
                            const RatioWanted& wanted) {
  const std::string what =
      fmt::format("gap over best peer's, noise {}, after {}", wanted.noise, wanted.after);
  Bar ratio{.what = what, .bound = wanted.bound};
  Bar upper{.what = "upper 95 % end of " + what, .bound = wanted.upper_bound};
  std::string why;
  if (const auto peer = best_peer(development, wanted.noise, wanted.score, why)) {
    const auto pairs =
        pairs_over(results, tasks_of_one_objective(), wanted.noise, *peer, wanted.score, why);
    if (pairs) {
      const Means means = means_of(*pairs);
      ratio.value = means.own / means.peer;
      upper.value = upper_ends(*pairs).ratio;
      ratio.what += fmt::format(" ({} {:.1f} %)", *peer, means.peer);
    }
  }
  ratio.what += why;
  upper.what += why;
  return {ratio, upper};
}

/// Own time of the slowest of all tasks with noise.
Bar time_bar(const Results& results, const std::string& method, double bound) {
  Bar bar{.what = fmt::format("own time of {} on the slowest task, ms an evaluation", method),
          .bound = bound};
  std::string why;
  double longest = 0.0;
  for (const std::string& part : all_parts()) {
    if (!part.ends_with("/" + method) || part.find("/0/") != std::string::npos) {
      continue;
    }
    const bool is_several = is_of_several(part.substr(0, part.find('/')));
    const int needed = is_several ? kSeedsOfSeveral : kSeedsOfOne;
    const auto mean = mean_of_part(results, part, needed, &Result::own_ms, why);
    if (!mean) {
      bar.what += why;
      return bar;
    }
    longest = std::max(longest, *mean);
  }
  bar.value = longest;
  return bar;
}

/// On spaces with choices and conditions: own gap minus the peer's, of each task.
std::vector<Bar> mixed_bars(const Results& results) {
  std::vector<Bar> bars;
  for (const std::string_view task : mixed_tasks()) {
    for (const std::string& noise : noises_of_several()) {
      for (const auto& [after, score] : {std::pair{50, &Result::after_50},
                                         std::pair{100, &Result::after_100},
                                         std::pair{300, &Result::after_300}}) {
        std::string why;
        Bar bar{.bound = 0.0};
        if (const auto pairs = pairs_over(results, {task}, noise, kMixedPeer, score, why)) {
          bar.value = upper_ends(*pairs).difference;
        }
        bar.what = fmt::format("upper 95 % end of {}'s gap minus {}'s, noise {}, after {}{}",
                               task,
                               kMixedPeer,
                               noise,
                               after,
                               why);
        bars.push_back(std::move(bar));
      }
    }
  }
  return bars;
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

Bar memory_bar(const Results& results) {
  std::string why;
  const auto peak = mean_of_part(results, kLongPart, 1, &Result::peak_mb, why);
  if (!peak && results.contains(kFormerLongPart)) {
    why += fmt::format("; {} may be the memory of a whole process", kFormerLongPart);
  }
  return {.what = "memory that 10,000 evaluations take, MB" + why, .value = peak, .bound = 100.0};
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
  add(mixed_tasks(), noises_of_several(), {kMixedPeer});
  for (const std::string_view task : tasks_of_one_objective()) {
    parts.push_back(fmt::format("{}/0.05/{}", task, kDerivativeMethod));
  }
  parts.emplace_back(kLongPart);
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
  return bar.value && (bar.is_lower_bound ? *bar.value >= bar.bound : *bar.value <= bar.bound);
}

std::vector<Bar> bars_of(const Results& results, const Results& development) {
  std::vector<Bar> bars = hypervolume_bars(results);
  const auto add_ratio = [&](const RatioWanted& wanted) {
    std::ranges::copy(ratio_bars(results, development, wanted), std::back_inserter(bars));
  };
  for (const std::string& noise : noises_of_one()) {
    const bool is_noisy = noise != "0";
    if (is_noisy) {
      add_ratio({noise, &Result::after_100, "100", 0.9, 1.0});
    }
    add_ratio({noise, &Result::after_300, "300", is_noisy ? 0.9 : 1.1, is_noisy ? 1.0 : 1.2});
    bars.push_back(random_bar(results, noise));
  }
  std::ranges::copy(mixed_bars(results), std::back_inserter(bars));
  bars.push_back(time_bar(results, "glint:auto", 10.0));
  bars.push_back(time_bar(results, kDerivativeMethod, 50.0));
  bars.push_back(memory_bar(results));
  return bars;
}

}  // namespace glint::quality
