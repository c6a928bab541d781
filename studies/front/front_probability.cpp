// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/front/front_probability.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/rng.h"
#include "optimizer/algorithm/merit.h"
#include "optimizer/front/choice_cost.h"
#include "optimizer/front/front.h"
#include "optimizer/search/trade_off.h"
#include "studies/front/front_designs.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using Row = std::vector<double>;

constexpr int kDraws = 4000;  // 1 % of probability is at most 2 standard errors

/// One objective of one finalist.
struct Noisy {
  double value = 0.0;
  std::optional<double> error;
  std::vector<double> scans;
};

struct Candidate {
  std::size_t finalist = 0;
  std::vector<Noisy> objectives;  ///< smaller is better
  bool keeps_limits = true;
};

std::vector<double> scans_of(const Json& written, const Objective& objective, double sign) {
  std::vector<double> scans;
  const Json repeated = written.value("repeated", Json::object());
  for (const Json& value : repeated.value(objective.name, Json::array())) {
    scans.push_back(sign * value.get<double>());
  }
  return scans;
}

/// Without objectives where one is missing.
Candidate candidate_of(const Goal& goal, const Finalist& finalist, std::size_t index) {
  Candidate candidate{.finalist = index};
  const Json fresh = finalist.written.value("rescored", Json());
  const Scores scores = fresh.is_object() ? scores_from_json(fresh) : Scores{};
  if (!problem_with(goal, scores).empty()) {
    return candidate;
  }
  candidate.keeps_limits = is_feasible(goal, scores);
  for (const Objective& objective : objectives_of(goal)) {
    const double sign = objective.is_maximised ? -1.0 : 1.0;
    candidate.objectives.push_back({.value = sign * scores.at(objective.name),
                                    .error = fresh_error(finalist.written, objective.name),
                                    .scans = scans_of(finalist.written, objective, sign)});
  }
  return candidate;
}

std::vector<Candidate> candidates_of(const Goal& goal, const std::vector<Finalist>& finalists) {
  std::vector<Candidate> all;
  for (std::size_t k = 0; k < finalists.size(); ++k) {
    all.push_back(candidate_of(goal, finalists[k], k));
  }
  std::erase_if(all, [](const Candidate& one) { return one.objectives.empty(); });
  if (std::ranges::any_of(all, &Candidate::keeps_limits)) {
    std::erase_if(all, [](const Candidate& one) { return !one.keeps_limits; });
  }
  return all;
}

/// Scans of an objective count where all have the same number of them; 0: they do not.
std::size_t common_scans(const std::vector<Candidate>& candidates, std::size_t objective) {
  const std::size_t count = candidates.front().objectives[objective].scans.size();
  const bool is_common = std::ranges::all_of(candidates, [&](const Candidate& one) {
    return one.objectives[objective].scans.size() == count;
  });
  return is_common && count > 1 ? count : 0;
}

/// Of each objective; 0: it moves by its errors. Scans count where they are as many as of any
/// objective, as all share the same draw of them.
std::vector<std::size_t> scans_drawn(const std::vector<Candidate>& candidates) {
  std::vector<std::size_t> counts;
  for (std::size_t i = 0; i < candidates.front().objectives.size(); ++i) {
    counts.push_back(common_scans(candidates, i));
  }
  const std::size_t most = *std::ranges::max_element(counts);
  std::ranges::transform(
      counts, counts.begin(), [most](std::size_t count) { return count == most ? most : 0; });
  return counts;
}

double mean_of(const std::vector<double>& scans) {
  return std::accumulate(scans.begin(), scans.end(), 0.0) / static_cast<double>(scans.size());
}

/// Which scans are drawn, and what turns a bootstrap of few scans into Student's distribution:
/// sqrt(n / chi-square(n - 1)).
struct Draw {
  std::vector<std::size_t> scans;
  double width = 1.0;
};

Draw draw_scans(std::size_t count, Rng& rng) {
  Draw draw{.scans = std::vector<std::size_t>(count)};
  for (std::size_t& scan : draw.scans) {
    scan =
        std::min(count - 1, static_cast<std::size_t>(rng.uniform() * static_cast<double>(count)));
  }
  double squares = 0.0;
  for (std::size_t k = 1; k < count; ++k) {
    const double normal = rng.normal();
    squares += normal * normal;
  }
  draw.width = count > 1 ? std::sqrt(static_cast<double>(count) / std::max(squares, 1e-12)) : 1.0;
  return draw;
}

double drawn_value(const Noisy& noisy, std::size_t num_scans, const Draw& draw, Rng& rng) {
  if (num_scans == 0) {
    const double error = noisy.error.value_or(0.0);
    return error > 0.0 ? noisy.value + error * rng.normal() : noisy.value;
  }
  const double mean = mean_of(noisy.scans);
  double drawn = 0.0;
  for (const std::size_t scan : draw.scans) {
    drawn += noisy.scans[scan] / static_cast<double>(draw.scans.size());
  }
  return mean + draw.width * (drawn - mean);
}

/// One sample of all: the index of the one that is taken.
class Sampler {
 public:
  Sampler(const Goal& goal, const Json& front, const std::vector<Candidate>& candidates)
      : choice_(front_choice_of(goal)),
        candidates_(candidates),
        num_scans_(scans_drawn(candidates)) {
    std::vector<Row> searched;
    for (const Json& design : front["designs"]) {
      searched.push_back(minimised_objectives(goal, scores_from_json(design["scores"])));
    }
    ranges_ = objective_ranges(searched);
  }

  std::size_t chosen(int sample) const {
    Rng rng(1, Stream::kResampling, static_cast<std::uint64_t>(sample));
    const std::size_t most = *std::ranges::max_element(num_scans_);
    const Draw draw = draw_scans(most, rng);
    std::vector<Row> rows;
    for (const Candidate& candidate : candidates_) {
      Row row;
      for (std::size_t i = 0; i < ranges_.size(); ++i) {
        row.push_back(drawn_value(candidate.objectives[i], num_scans_[i], draw, rng));
      }
      rows.push_back(std::move(row));
    }
    const std::vector<std::size_t> unbeaten = front_of(rows);
    std::vector<Row> on_front;
    for (const std::size_t row : unbeaten) {
      on_front.push_back(rows[row]);
    }
    return unbeaten[compromise_of(on_front, ranges_, choice_)];
  }

 private:
  FrontChoice choice_;
  const std::vector<Candidate>& candidates_;
  std::vector<std::size_t> num_scans_;  ///< scans_drawn()
  std::vector<ObjectiveRange> ranges_;
};

}  // namespace

std::string unknown_noise(const Goal& goal, const std::vector<Finalist>& finalists) {
  const std::vector<Candidate> candidates = candidates_of(goal, finalists);
  if (candidates.size() < 2) {
    return "";
  }
  const std::vector<std::size_t> num_scans = scans_drawn(candidates);
  for (const Candidate& candidate : candidates) {
    for (std::size_t i = 0; i < num_scans.size(); ++i) {
      if (num_scans[i] == 0 && !candidate.objectives[i].error) {
        return "how far noise moves " + objectives_of(goal)[i].name + " of " +
               finalists[candidate.finalist].title + " is not known";
      }
    }
  }
  return "";
}

std::vector<double> probabilities_of_choice(const Goal& goal,
                                            const Json& front,
                                            const std::vector<Finalist>& finalists) {
  const std::vector<Candidate> candidates = candidates_of(goal, finalists);
  if (finalists.size() < 2 || candidates.empty() || front["designs"].empty() ||
      !unknown_noise(goal, finalists).empty()) {
    return {};
  }
  const Sampler sampler(goal, front, candidates);
  std::vector<double> probabilities(finalists.size(), 0.0);
  for (int sample = 0; sample < kDraws; ++sample) {
    probabilities[candidates[sampler.chosen(sample)].finalist] += 1.0 / kDraws;
  }
  return probabilities;
}

void add_probability_best(const Goal& goal,
                          const std::vector<Finalist>& finalists,
                          Json& front,
                          Json& result) {
  const std::vector<double> probabilities = probabilities_of_choice(goal, front, finalists);
  Json list = Json::array();
  for (std::size_t k = 0; k < probabilities.size(); ++k) {
    list.push_back({{"key", finalists[k].key},
                    {"title", finalists[k].title},
                    {"probability", probabilities[k]}});
    for (Json& design : front["designs"]) {
      if (design.value("folder", std::string()) == finalists[k].key) {
        design["probability_best"] = probabilities[k];
      }
    }
  }
  std::stable_sort(list.begin(), list.end(), [](const Json& a, const Json& b) {
    return a["probability"].get<double>() > b["probability"].get<double>();
  });
  if (!list.empty()) {
    result["probability_best"] = std::move(list);
  } else if (std::string why = unknown_noise(goal, finalists); !why.empty()) {
    result["probability_best_unknown"] = std::move(why);
  }
}

}  // namespace glint
