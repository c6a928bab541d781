// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/report/report_ranking.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "core/rng.h"
#include "metrics/statistics/estimate.h"
#include "studies/report/report_verdict.h"
#include "studies/report/report_wording.h"

namespace glint::report_detail {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kResamples = 4000;

struct Ranked {
  const Json* design = nullptr;
  double value = 0.0;
  std::vector<double> scans;  ///< empty: not repeated
  std::vector<std::string> missed;
  double probability_best = 0.0;

  /// A limit that the search's seeds miss is told by `feasible`, too.
  bool meets_all() const { return missed.empty() && member(*design, "feasible") != Json(false); }
};

std::vector<Ranked> valued_designs(const Json& data, const Wording& wording) {
  std::vector<Ranked> ranked;
  for (const Json& design : member(data, "designs")) {
    if (const auto value = wording.value(design)) {
      ranked.push_back({.design = &design,
                        .value = *value,
                        .scans = wording.repeated(design),
                        .missed = missed_limits(data, design)});
    }
  }
  return ranked;
}

/// Whether all designs were scanned with the same noise, so often that it can be told.
bool are_repeated(const std::vector<Ranked>& ranked) {
  return !ranked.empty() && ranked.front().scans.size() > 1 &&
         std::ranges::all_of(ranked, [&](const Ranked& one) {
           return one.scans.size() == ranked.front().scans.size();
         });
}

/// Gives the designs whose sample of the mean is best their share of one sample. @param width  of
/// the deviations from the mean of all scans
void count_best(std::vector<Ranked*>& candidates,
                const std::vector<std::size_t>& scans,
                double width,
                const Wording& wording) {
  std::vector<double> sums(candidates.size(), 0.0);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const std::vector<double>& all = candidates[i]->scans;
    const double whole = std::accumulate(all.begin(), all.end(), 0.0);
    for (const std::size_t scan : scans) {
      sums[i] += all[scan];
    }
    sums[i] = whole + width * (sums[i] - whole);
  }
  double best = sums.front();
  for (const double sum : sums) {
    best = wording.is_better(sum, best) ? sum : best;
  }
  const auto winners = static_cast<double>(std::ranges::count(sums, best));
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    candidates[i]->probability_best += sums[i] == best ? 1.0 / (winners * kResamples) : 0.0;
  }
}

/// What turns a bootstrap of few scans into Student's distribution: sqrt(n / chi-square(n - 1)).
double student_width(std::size_t count, Rng& rng) {
  double squares = 0.0;
  for (std::size_t k = 1; k < count; ++k) {
    const double normal = rng.normal();
    squares += normal * normal;
  }
  return std::sqrt(static_cast<double>(count) / std::max(squares, 1e-12));
}

/// The same samples of scans for all designs: what they share in noise cancels.
void find_probabilities(std::vector<Ranked>& ranked, const Wording& wording) {
  const bool has_feasible = std::ranges::any_of(ranked, &Ranked::meets_all);
  std::vector<Ranked*> candidates;
  for (Ranked& one : ranked) {
    if (!has_feasible || one.meets_all()) {
      candidates.push_back(&one);
    }
  }
  const std::size_t count = ranked.front().scans.size();
  Rng rng(1, Stream::kResampling, 0);
  std::vector<std::size_t> scans(count);
  for (int sample = 0; sample < kResamples; ++sample) {
    for (std::size_t& scan : scans) {
      scan =
          std::min(count - 1, static_cast<std::size_t>(rng.uniform() * static_cast<double>(count)));
    }
    count_best(candidates, scans, student_width(count, rng), wording);
  }
}

Json row_of(const Ranked& one, bool has_repeats) {
  Json row = {
      {"key", text_of(*one.design, "key")}, {"title", title_of(*one.design)}, {"value", one.value}};
  if (has_repeats) {
    const Estimate mean = mean_of(one.scans);
    row["value"] = mean.value;
    row["low"] = mean.low;
    row["high"] = mean.high;
    row["probability_best"] = one.probability_best;
  }
  row["missed"] = one.missed;
  return row;
}

}  // namespace

Json ranking_of(const Json& data) {
  Json rows = Json::array();
  const Wording wording(data);
  if (wording.score().empty()) {
    return rows;
  }
  std::vector<Ranked> ranked = valued_designs(data, wording);
  const bool has_repeats = are_repeated(ranked);
  if (has_repeats) {
    find_probabilities(ranked, wording);
    for (Ranked& one : ranked) {
      one.value = mean_of(one.scans).value;
    }
  }
  std::ranges::stable_sort(ranked, [&](const Ranked& a, const Ranked& b) {
    return a.meets_all() != b.meets_all() ? a.meets_all() : wording.is_better(a.value, b.value);
  });
  for (const Ranked& one : ranked) {
    rows.push_back(row_of(one, has_repeats));
  }
  return rows;
}

}  // namespace glint::report_detail
