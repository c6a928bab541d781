// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/yardstick.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/median.h"
#include "metrics/appearance/grey_match.h"
#include "metrics/statistics/estimate.h"
#include "studies/compare/compared_pair.h"

namespace glint {
namespace {

constexpr int kResamples = 400;
constexpr double kMinDistance = 1e-6;  ///< equal photographs would make every multiple infinite

/// Distances of all pairs, found once: [first][second].
using DistanceTable = std::vector<std::vector<SampleDistances>>;

DistanceTable table_of(std::span<const TextureSample> first,
                       std::span<const TextureSample> second) {
  DistanceTable table(first.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    for (const TextureSample& other : second) {
      table[i].push_back(distances_between(first[i], other));
    }
  }
  return table;
}

double quantile_of(std::vector<double> values, double share) {
  std::ranges::sort(values);
  const double at = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const double above = values[std::min(below + 1, values.size() - 1)];
  return values[below] + (at - static_cast<double>(below)) * (above - values[below]);
}

class Measure {
 public:
  Measure(std::span<const TextureSample> reals, std::span<const TextureSample> simulated)
      : among_(table_of(reals, reals)), across_(table_of(simulated, reals)) {}

  /// Of the real pictures at these indices, which may repeat.
  Yardstick of(std::span<const std::size_t> reals) const {
    Yardstick result = {.reals = reals.size()};
    double logarithm = 0.0;
    for (std::size_t k = 0; k < kYardstickNames.size(); ++k) {
      const std::vector<double> among = among_at(reals, k);
      const std::vector<double> across = across_at(reals, k);
      YardstickRow row = {.name = kYardstickNames[k]};
      if (!among.empty()) {
        row.real = median(among);
        row.real_low = quantile_of(among, 0.25);
        row.real_high = quantile_of(among, 0.75);
      }
      if (!across.empty()) {
        row.simulated = median(across);
        row.multiple = row.simulated / std::max(row.real, kMinDistance);
        logarithm += std::log(std::max(row.multiple, 1e-9));
      }
      result.pairs = among.size();
      result.rows.push_back(row);
    }
    result.multiple = across_.empty() ? 0.0 : std::exp(logarithm / kYardstickNames.size());
    return result;
  }

 private:
  std::vector<double> among_at(std::span<const std::size_t> reals, std::size_t k) const {
    std::vector<double> values;
    for (std::size_t i = 0; i < reals.size(); ++i) {
      for (std::size_t j = i + 1; j < reals.size(); ++j) {
        if (reals[i] != reals[j]) {
          values.push_back(among_[reals[i]][reals[j]][k]);
        }
      }
    }
    return values;
  }

  std::vector<double> across_at(std::span<const std::size_t> reals, std::size_t k) const {
    std::vector<double> values;
    for (const std::vector<SampleDistances>& row : across_) {
      for (const std::size_t j : reals) {
        values.push_back(row[j][k]);
      }
    }
    return values;
  }

  DistanceTable among_;
  DistanceTable across_;
};

/// The smallest window; 0: one sample has none.
int common_window_px(std::span<const TextureSample> reals,
                     std::span<const TextureSample> simulated) {
  int least = std::numeric_limits<int>::max();
  for (const std::span<const TextureSample> samples : {reals, simulated}) {
    for (const TextureSample& sample : samples) {
      least = std::min(least, sample.texture.windows > 0 ? sample.texture.window_px : 0);
    }
  }
  return least;
}

void bring_to(int window_px, std::span<TextureSample> samples) {
  for (TextureSample& sample : samples) {
    if (sample.texture.window_px != window_px) {
      sample.texture = texture_in(sample.grey, sample.region, window_px);
    }
  }
}

}  // namespace

TextureSample texture_sample(std::string name,
                             const ImageF& picture,
                             const Mask& region,
                             SurfaceTexture texture) {
  TextureSample sample = {
      .name = std::move(name), .grey = picture, .region = region, .texture = std::move(texture)};
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < picture.size(); ++i) {
    if (region.empty() || region.values()[i] != 0) {
      sum += static_cast<double>(picture.values()[i]);
      count += 1.0;
    }
  }
  const auto mean = static_cast<float>(std::max(sum / std::max(count, 1.0), 1e-9));
  for (float& grey : sample.grey.values()) {
    grey /= mean;
  }
  return sample;
}

SampleDistances distances_between(const TextureSample& first, const TextureSample& second) {
  const TextureDistance texture = distance_between(first.texture, second.texture);
  return {histogram_distance(first.grey, second.grey, first.region, second.region),
          texture.radial,
          texture.contrast,
          texture.length};
}

std::optional<Yardstick> measure_yardstick(std::vector<TextureSample> reals,
                                           std::vector<TextureSample> simulated) {
  const int window_px = common_window_px(reals, simulated);
  if (reals.size() < 2 || window_px == 0) {
    return std::nullopt;
  }
  bring_to(window_px, reals);
  bring_to(window_px, simulated);
  const Measure measure(reals, simulated);
  std::vector<std::size_t> all(reals.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i] = i;
  }
  Yardstick result = measure.of(all);
  result.window_px = window_px;
  result.low = result.high = result.multiple;
  if (!simulated.empty() && reals.size() >= 3) {
    const auto multiple = [&](std::span<const std::size_t> chosen) {
      const bool is_one = std::ranges::all_of(chosen, [&](auto i) { return i == chosen[0]; });
      return is_one ? result.multiple : measure.of(chosen).multiple;
    };
    const Estimate interval = bootstrap(reals.size(), multiple, kResamples, 1);
    result.low = interval.low;
    result.high = interval.high;
  }
  return result;
}

void YardstickPictures::add(const ComparedPair& pair) {
  const auto add_to = [&](std::map<std::string, TextureSample>& samples,
                          const ComparedPicture& picture,
                          const SurfaceTexture& texture) {
    const std::string key = picture.source.picture.string();
    if (!samples.contains(key)) {
      samples.emplace(key, texture_sample(picture.source.name, picture.grey, pair.region, texture));
    }
  };
  add_to(simulated_, pair.simulated, pair.appearance.simulated);
  add_to(reals_, pair.real, pair.appearance.real);
}

std::vector<const TextureSample*> YardstickPictures::photographs(bool is_copy) const {
  std::vector<const TextureSample*> all;
  std::vector<const TextureSample*> list;
  for (const auto& [key, sample] : reals_) {
    const auto& values = sample.grey.values();
    const bool is_repeated = std::ranges::any_of(
        all, [&values](const TextureSample* earlier) { return earlier->grey.values() == values; });
    all.push_back(&sample);
    if (is_repeated == is_copy) {
      list.push_back(&sample);
    }
  }
  return list;
}

std::optional<Yardstick> YardstickPictures::measure() const {
  if (!has_yardstick()) {
    return std::nullopt;
  }
  std::vector<TextureSample> reals;
  for (const TextureSample* photograph : photographs(false)) {
    reals.push_back(*photograph);
  }
  return measure_yardstick(std::move(reals), {simulated_.begin()->second});
}

std::string YardstickPictures::without_windows() const {
  std::string names;
  for (const auto* samples : {&simulated_, &reals_}) {
    for (const auto& [key, sample] : *samples) {
      if (sample.texture.windows == 0) {
        names += (names.empty() ? "" : ", ") + sample.name;
      }
    }
  }
  return names;
}

std::vector<std::string> YardstickPictures::notes() const {
  std::vector<std::string> notes;
  if (simulated_.size() > 1 && reals_.size() >= 2) {
    notes.emplace_back(
        "No yardstick of photographs: compare one simulated picture with all photographs of a "
        "kind to see how many times as far it is from them as they are from each other.");
  }
  if (!has_yardstick()) {
    return notes;
  }
  const std::string missing = without_windows();
  if (!missing.empty()) {
    notes.push_back("No yardstick of photographs: the part has no window of 16 px in " + missing +
                    ".");
  }
  std::string copies;
  for (const TextureSample* copy : photographs(true)) {
    copies += (copies.empty() ? "" : ", ") + copy->name;
  }
  if (photographs(false).size() < 2) {
    notes.emplace_back("No yardstick of photographs: all of them are one and the same picture.");
  } else if (!copies.empty()) {
    notes.push_back(
        "Photographs that are equal to another one in every pixel do not count for the "
        "yardstick: " +
        copies + ".");
  }
  return notes;
}

}  // namespace glint
