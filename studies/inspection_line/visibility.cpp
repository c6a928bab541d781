// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspection_line/visibility.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>

#include "core/median.h"
#include "metrics/statistics/pod.h"
#include "metrics/statistics/roc.h"
#include "studies/inspection_line/visibility_trials.h"

namespace glint {
namespace {

constexpr std::string_view kFamily = "inspection.";
constexpr int kResamples = 1000;
constexpr std::uint64_t kSeed = 1;

/// A score's value; the interval may be missing.
struct Statistic {
  double value = 0.0;
  std::optional<Estimate> estimate = {};

  Statistic(double only) : value(only) {}  // NOLINT(*-explicit-*): is one

  Statistic(const Estimate& whole)  // NOLINT(*-explicit-*): is one
      : value(whole.value), estimate(whole) {}
};

/// "inspection.dent.auc" is the auc of group dent, "inspection.auc" that of all ("").
struct LineScore {
  std::string group;
  std::string what;
};

LineScore parse(std::string_view name) {
  const std::string_view rest = without_bound(name).substr(kFamily.size());
  const std::size_t dot = rest.rfind('.');
  return dot == std::string_view::npos ? LineScore{.group = {}, .what = std::string(rest)}
                                       : LineScore{.group = std::string(rest.substr(0, dot)),
                                                   .what = std::string(rest.substr(dot + 1))};
}

/// The defects of one group, or of all, on the parts of a line.
class Sample {
 public:
  Sample(const LineTrials& line, std::string group, double confidence)
      : line_(line), group_(std::move(group)), confidence_(confidence) {}

  /// Of each defect on the parts at these indices.
  template <class Value, class Get>
  std::vector<Value> all(std::span<const std::size_t> parts, const Get& get) const {
    std::vector<Value> values;
    for (const std::size_t k : parts) {
      for (const DefectTrial& defect : line_.parts[k].defects) {
        if (group_.empty() || defect.group == group_) {
          values.push_back(get(defect));
        }
      }
    }
    return values;
  }

  template <class Value, class Get>
  std::vector<Value> all(const Get& get) const {
    return all<Value>(every_part(), get);
  }

  std::optional<Statistic> detection_rate() const {
    const auto found = all<int>([](const DefectTrial& one) { return one.is_found ? 1 : 0; });
    if (found.empty()) {
      return std::nullopt;
    }
    return wilson(std::accumulate(found.begin(), found.end(), std::int64_t{0}),
                  static_cast<std::int64_t>(found.size()),
                  confidence_);
  }

  std::optional<Statistic> auc() const {
    const auto with = all<double>([](const DefectTrial& one) { return one.largest; });
    const auto without = all<double>([](const DefectTrial& one) { return one.largest_without; });
    if (with.empty()) {
      return std::nullopt;
    }
    return area_under_roc(with, without, confidence_);
  }

  std::optional<Statistic> pod_a90_um() const {
    auto trials = all<SizedTrial>([](const DefectTrial& one) {
      return SizedTrial{.size = one.height_um, .is_hit = one.is_found};
    });
    std::erase_if(trials, [](const SizedTrial& trial) { return trial.size <= 0.0; });  // stains
    const std::optional<PodFit> fit = fit_pod(trials, confidence_);
    return fit ? std::optional<Statistic>(fit->a90) : std::nullopt;
  }

  /// Share of the rendering's noise in the squared changes of radiance.
  std::optional<Statistic> rendering_error() const {
    RenderedEnergy sum;
    for (const RenderedEnergy& one :
         all<RenderedEnergy>([](const DefectTrial& defect) { return defect.rendering; })) {
      sum.total += one.total;
      sum.noise += one.noise;
    }
    if (all<int>([](const DefectTrial&) { return 0; }).empty()) {
      return std::nullopt;
    }
    return Statistic(sum.total > 0.0 ? std::min(1.0, sum.noise / sum.total) : 0.0);
  }

  std::optional<Statistic> signature() const {
    return resampled([this](std::span<const std::size_t> parts) {
      const auto values = all<double>(parts, [](const DefectTrial& d) { return d.signature; });
      return std::accumulate(values.begin(), values.end(), 0.0) /
             std::max(1.0, static_cast<double>(values.size()));
    });
  }

  /// Median over the group's defects; of all: of the group where it is smallest.
  std::optional<Statistic> dprime() const {
    const std::set<std::string> groups = [this] {
      const auto names = all<std::string>([](const DefectTrial& one) { return one.group; });
      return std::set<std::string>(names.begin(), names.end());
    }();
    return resampled([this, groups](std::span<const std::size_t> parts) {
      double minimum = std::numeric_limits<double>::infinity();
      for (const std::string& group : groups) {
        const Sample one(line_, group, confidence_);
        const auto squares =
            one.all<double>(parts, [](const DefectTrial& d) { return d.squared_dprime; });
        if (!squares.empty()) {  // a resample may hold no part with this group
          minimum = std::min(minimum, std::sqrt(std::max(0.0, median(squares))));
        }
      }
      return std::isfinite(minimum) ? minimum : 0.0;
    });
  }

  /// Half of the defects are found at a part's factor: their median height there, median over the
  /// parts.
  std::optional<Statistic> smallest_height_um() const {
    return smallest([this](std::size_t k) {
      auto heights = all<double>({&k, 1}, [](const DefectTrial& one) { return one.height_um; });
      std::erase_if(heights, [](double value) { return value <= 0.0; });  // stains
      return heights.empty() ? 0.0 : line_.parts[k].factor * median(std::move(heights));
    });
  }

  std::optional<Statistic> smallest_slope_mrad() const {
    return smallest([this](std::size_t k) {
      const std::vector<double>& slopes = line_.parts[k].slopes_mrad;
      return slopes.empty() ? 0.0 : median(slopes);
    });
  }

 private:
  std::vector<std::size_t> every_part() const {
    std::vector<std::size_t> parts(line_.parts.size());
    std::iota(parts.begin(), parts.end(), std::size_t{0});
    return parts;
  }

  /// @param of_part  at the part's factor; 0: it has no defect with a height
  std::optional<Statistic> smallest(const std::function<double(std::size_t)>& of_part) const {
    std::vector<double> factors;
    std::vector<double> sizes;
    for (const std::size_t k : every_part()) {
      factors.push_back(line_.parts[k].factor);
      sizes.push_back(of_part(k));
    }
    const bool has_none = std::ranges::all_of(sizes, [](double size) { return size <= 0.0; });
    if (has_none || median(factors) >= LineTrials::kMaxFactor) {
      return std::nullopt;
    }
    return resampled([&sizes](std::span<const std::size_t> parts) {
      std::vector<double> drawn;
      for (const std::size_t k : parts) {
        if (sizes[k] > 0.0) {
          drawn.push_back(sizes[k]);
        }
      }
      return drawn.empty() ? 0.0 : median(std::move(drawn));
    });
  }

  /// Parts are drawn again, not defects: those of one part share its noise.
  std::optional<Statistic> resampled(
      const std::function<double(std::span<const std::size_t>)>& statistic) const {
    if (all<int>([](const DefectTrial&) { return 0; }).empty()) {
      return std::nullopt;
    }
    if (line_.parts.size() < 2) {
      return Statistic(statistic(every_part()));
    }
    return Statistic(bootstrap(line_.parts.size(), statistic, kResamples, kSeed, confidence_));
  }

  const LineTrials& line_;
  std::string group_;
  double confidence_;
};

std::optional<Statistic> statistic_of(const LineScore& score,
                                      const LineTrials& line,
                                      double confidence) {
  const Sample sample(line, score.group, confidence);
  if (score.what == "threshold") {
    return line.threshold;
  }
  if (score.what == "region_share") {
    return line.region_share;
  }
  if (score.what == "rendering_share") {
    return line.rendering_share;
  }
  if (score.what == "rendering_error") {
    return sample.rendering_error();
  }
  if (score.what == "false_alarms") {
    return poisson_rate(line.false_alarms, line.flawless, confidence);
  }
  if (score.what == "detection_rate") {
    return sample.detection_rate();
  }
  if (score.what == "auc") {
    return sample.auc();
  }
  if (score.what == "dprime") {
    return sample.dprime();
  }
  if (score.what == "pod_a90_um") {
    return sample.pod_a90_um();
  }
  if (score.what == "signature") {
    return sample.signature();
  }
  return score.what == "smallest_slope_mrad" ? sample.smallest_slope_mrad()
                                             : sample.smallest_height_um();
}

TrialNeeds needs_of(const std::set<std::string>& names) {
  TrialNeeds needs;
  for (const std::string& name : names) {
    const std::string what = parse(name).what;
    needs.flawless = needs.flawless || what == "false_alarms";
    needs.largest = needs.largest || what == "auc";
    needs.dprime = needs.dprime || what == "dprime";
    needs.smallest = needs.smallest || what.starts_with("smallest_");
    needs.parts = needs.parts || what == "detection_rate" || what == "pod_a90_um" ||
                  what == "signature" || what == "rendering_error";
  }
  return needs;
}

}  // namespace

bool is_of_line(std::string_view score) {
  return score.starts_with(kFamily);
}

Scores visibility_scores(SceneStore& store,
                         const SceneSettings& scene,
                         std::span<const std::string> wanted,
                         std::int64_t first) {
  std::set<std::string> names;
  for (const std::string& name : wanted) {
    if (is_of_line(name)) {
      names.emplace(without_bound(name));
    }
  }
  Scores scores;
  if (names.empty()) {
    return scores;
  }
  const SimulatedLine line(store, scene);
  const LineTrials trials = run_trials(line, needs_of(names), first, store.pool());
  for (const std::string& name : names) {
    const auto statistic = statistic_of(parse(name), trials, scene.inspection.trials.confidence);
    if (!statistic) {
      continue;
    }
    scores[name] = statistic->value;
    if (statistic->estimate && std::isfinite(statistic->estimate->low)) {
      scores[name + ".low"] = statistic->estimate->low;
    }
    if (statistic->estimate && std::isfinite(statistic->estimate->high)) {
      scores[name + ".high"] = statistic->estimate->high;
    }
  }
  return scores;
}

}  // namespace glint
