// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/aspect_image/defect_scores.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace glint {
namespace {

/// Calls visit(pixel index, distance in radii) over a defect's window.
template <class Visit>
void visit_window(const DefectView& defect, int width_px, const Visit& visit) {
  for (int y = 0; y < defect.distance.height(); ++y) {
    for (int x = 0; x < defect.distance.width(); ++x) {
      const int index = (defect.top_px + y) * width_px + defect.left_px + x;
      visit(static_cast<std::size_t>(index), static_cast<double>(defect.distance(x, y)));
    }
  }
}

/// Radius of a defect as the picture shows it, in pixels: of a disc, or half the width of a line.
/// Away from its middle the distance grows by 1 over it a pixel; the median passes over edges of
/// the part. Infinite where no two neighbours are seen.
double radius_in_pixels(const ImageF& distance) {
  std::vector<double> slopes;
  for (int y = 0; y + 1 < distance.height(); ++y) {
    for (int x = 0; x + 1 < distance.width(); ++x) {
      const float right = distance(x + 1, y) - distance(x, y);
      const float down = distance(x, y + 1) - distance(x, y);
      const auto slope = static_cast<double>(std::hypot(right, down));
      if (std::isfinite(slope)) {
        slopes.push_back(slope);
      }
    }
  }
  if (slopes.empty()) {
    return DefectView::kFar;
  }
  const auto middle = slopes.begin() + static_cast<std::ptrdiff_t>(slopes.size() / 2);
  std::ranges::nth_element(slopes, middle);
  return 1.0 / *middle;
}

/// A defect so small that it lies between the middles of pixels gets the nearest pixel on the part,
/// at most one pixel from its middle: the one that holds it, or a neighbour. Nothing is changed
/// where that is none, as of a defect outside the picture.
void take_pixel_around(const DefectView& defect, const Mask& on_part, DefectPixels& pixels) {
  std::size_t nearest = on_part.size();
  double nearest_distance = DefectView::kFar;
  visit_window(defect, on_part.width(), [&](std::size_t index, double distance) {
    if (on_part.values()[index] != 0 && distance < nearest_distance) {
      nearest = index;
      nearest_distance = distance;
    }
  });
  if (nearest < on_part.size() && nearest_distance * radius_in_pixels(defect.distance) <= 1.0) {
    pixels.inside.push_back(nearest);
    pixels.window.push_back(nearest);
    std::erase(pixels.ring, nearest);
  }
}

DefectPixels sort_pixels(const DefectView& defect,
                         const Mask& on_part,
                         const Mask& background,
                         const MetricsSettings& settings) {
  DefectPixels pixels{.label = defect.label, .area_px = defect.area_px};
  std::size_t nearest = on_part.size();
  double nearest_distance = settings.ring_inner_radii;
  visit_window(defect, on_part.width(), [&](std::size_t index, double distance) {
    if (on_part.values()[index] == 0) {
      return;
    }
    if (distance <= 1.0) {
      pixels.inside.push_back(index);
    }
    if (distance <= settings.ring_inner_radii) {
      pixels.window.push_back(index);
    } else if (distance <= settings.ring_outer_radii && background.values()[index] != 0) {
      pixels.ring.push_back(index);
    }
    if (distance <= nearest_distance) {
      nearest = distance < nearest_distance || nearest == on_part.size() ? index : nearest;
      nearest_distance = distance;
    }
  });
  if (pixels.inside.empty() && nearest < on_part.size()) {
    pixels.inside.push_back(nearest);  // smaller than a pixel: the one that sees most of it
  } else if (pixels.inside.empty()) {
    take_pixel_around(defect, on_part, pixels);
  }
  return pixels;
}

double variance_of(const ImageF& image, const std::vector<std::size_t>& pixels, double mean) {
  double sum = 0.0;
  for (const std::size_t pixel : pixels) {
    const double deviation = static_cast<double>(image.values()[pixel]) - mean;
    sum += deviation * deviation;
  }
  return sum / static_cast<double>(pixels.size());
}

double mean_change(const ImageF& image,
                   const std::vector<std::size_t>& pixels,
                   const std::vector<float>& flawless) {
  GLINT_CHECK(flawless.size() == pixels.size(), "one flawless value for each pixel of the defect");
  double sum = 0.0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    sum +=
        std::abs(static_cast<double>(image.values()[pixels[i]]) - static_cast<double>(flawless[i]));
  }
  return sum / static_cast<double>(pixels.size());
}

/// Of two sets of pixels together: standard deviation / mean.
double rms_contrast(const ImageF& image, const DefectPixels& defect, double floor) {
  const auto inside = static_cast<double>(defect.inside.size());
  const auto ring = static_cast<double>(defect.ring.size());
  const double share = inside / (inside + ring);
  const double mean =
      share * mean_of(image, defect.inside) + (1.0 - share) * mean_of(image, defect.ring);
  const double variance = share * variance_of(image, defect.inside, mean) +
                          (1.0 - share) * variance_of(image, defect.ring, mean);
  return std::sqrt(variance) / std::max(mean, floor);
}

/// Marks the pixels that differ by as much and gives the number of all marked yet.
double mark_changed(const ImageF& image,
                    const std::vector<std::size_t>& pixels,
                    const std::vector<float>& flawless,
                    double change_threshold,
                    std::vector<bool>& has_changed) {
  double marked = 0.0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const auto value = static_cast<double>(image.values()[pixels[i]]);
    if (std::abs(value - static_cast<double>(flawless[i])) >= change_threshold) {
      has_changed[i] = true;
    }
    marked += has_changed[i] ? 1.0 : 0.0;
  }
  return marked;
}

struct Window {
  double lowest = 0.0;
  double highest = 0.0;
  double energy = 0.0;      ///< sum of squared deviations from the background
  double far_pixels = 0.0;  ///< deviating more than the threshold
};

Window look_at_window(const ImageF& image,
                      const std::vector<std::size_t>& pixels,
                      double background,
                      double threshold) {
  Window window{.lowest = background, .highest = background};
  for (const std::size_t pixel : pixels) {
    const auto value = static_cast<double>(image.values()[pixel]);
    const double deviation = value - background;
    window.lowest = std::min(window.lowest, value);
    window.highest = std::max(window.highest, value);
    window.energy += deviation * deviation;
    window.far_pixels += std::abs(deviation) > threshold ? 1.0 : 0.0;
  }
  return window;
}

double peak_deviation(const ImageF& image,
                      const std::vector<std::size_t>& pixels,
                      double background) {
  double peak = 0.0;
  for (const std::size_t pixel : pixels) {
    const double deviation = static_cast<double>(image.values()[pixel]) - background;
    peak = std::abs(deviation) > std::abs(peak) ? deviation : peak;
  }
  return peak;
}

DefectScores score(const ImageF& image,
                   const DefectPixels& defect,
                   double sigma_floor,
                   const MetricsSettings& settings) {
  const double background = mean_of(image, defect.ring);
  const double variance = variance_of(image, defect.ring, background);
  const double sigma = std::max(std::sqrt(variance), sigma_floor);
  const double denominator = std::max(background, sigma_floor);
  const double difference = mean_of(image, defect.inside) - background;
  const double threshold = std::max(settings.signature_sigmas * sigma, settings.signature_floor);
  const Window window = look_at_window(image, defect.window, background, threshold);
  const double noise_energy = static_cast<double>(defect.window.size()) * variance;
  const double span = window.highest + window.lowest;
  return {.label = defect.label,
          .weber = difference / denominator,
          .michelson = span > 0.0 ? (window.highest - window.lowest) / span : 0.0,
          .cnr = std::abs(difference) / sigma,
          .peak = peak_deviation(image, defect.inside, background) / denominator,
          .dprime = std::sqrt(std::max(window.energy - noise_energy, 0.0)) / sigma,
          .signature = window.far_pixels / defect.area_px,
          .rms_contrast = rms_contrast(image, defect, sigma_floor)};
}

}  // namespace

double mean_of(const ImageF& image, const std::vector<std::size_t>& pixels) {
  double sum = 0.0;
  for (const std::size_t pixel : pixels) {
    sum += static_cast<double>(image.values()[pixel]);
  }
  return pixels.empty() ? 0.0 : sum / static_cast<double>(pixels.size());
}

std::string defect_table(const std::string& label) {
  const std::size_t end = label.rfind('_');
  const bool is_numbered = end != std::string::npos && end > 0 && end + 1 < label.size() &&
                           label.find_first_not_of("0123456789", end + 1) == std::string::npos;
  return "defects." + (is_numbered ? label.substr(0, end) : label);
}

ConfigError unseen_defect(const std::string& label, const std::string& why) {
  return {defect_table(label),
          fmt::format("{} {}; give it a place that the camera sees (x_mm and y_mm, or at_mm), or "
                      "keep random places in sight (facing_deg, or a region)",
                      label,
                      why)};
}

std::vector<DefectPixels> defect_pixels(std::span<const DefectView> defects,
                                        const Mask& on_part,
                                        const MetricsSettings& settings) {
  Mask background = on_part;
  exclude_defects(background, defects, settings.ring_inner_radii);
  std::vector<DefectPixels> result;
  for (const DefectView& defect : defects) {
    DefectPixels pixels = sort_pixels(defect, on_part, background, settings);
    if (pixels.inside.empty()) {
      throw unseen_defect(defect.label,
                          "is not in the picture, its middle must lie on the visible part");
    }
    if (pixels.ring.empty()) {
      throw ConfigError(defect_table(defect.label),
                        fmt::format("{}{} has no background between {} and {} radii on the visible "
                                    "part away from other defects, at least one pixel must be left",
                                    defect.label,
                                    defect.area_px < 1.0 ? " is smaller than a pixel and" : "",
                                    settings.ring_inner_radii,
                                    settings.ring_outer_radii));
    }
    result.push_back(std::move(pixels));
  }
  return result;
}

std::vector<DefectScores> defect_scores(const ImageF& image,
                                        std::span<const DefectPixels> defects,
                                        double sigma_floor,
                                        const MetricsSettings& settings) {
  GLINT_CHECK(sigma_floor > 0.0, "a noise floor of zero divides by zero");
  std::vector<DefectScores> scores;
  for (const DefectPixels& defect : defects) {
    scores.push_back(score(image, defect, sigma_floor, settings));
  }
  return scores;
}

DefectSummary summarise(std::span<const DefectScores> scores) {
  if (scores.empty()) {
    return {};
  }
  DefectSummary result{.min_cnr = scores[0].cnr,
                       .min_weber = std::abs(scores[0].weber),
                       .min_dprime = scores[0].dprime,
                       .min_signature = scores[0].signature,
                       .min_change = scores[0].change,
                       .min_rms_contrast = scores[0].rms_contrast,
                       .min_best_frame = scores[0].best_frame,
                       .min_union = scores[0].union_area};
  for (const DefectScores& defect : scores) {
    result.min_cnr = std::min(result.min_cnr, defect.cnr);
    result.min_weber = std::min(result.min_weber, std::abs(defect.weber));
    result.mean_weber += std::abs(defect.weber) / static_cast<double>(scores.size());
    result.min_dprime = std::min(result.min_dprime, defect.dprime);
    result.min_signature = std::min(result.min_signature, defect.signature);
    result.min_change = std::min(result.min_change, defect.change);
    result.mean_change += defect.change / static_cast<double>(scores.size());
    result.min_rms_contrast = std::min(result.min_rms_contrast, defect.rms_contrast);
    result.min_best_frame = std::min(result.min_best_frame, defect.best_frame);
    result.min_union = std::min(result.min_union, defect.union_area);
  }
  return result;
}

BestFrames::BestFrames(std::span<const DefectPixels> defects,
                       double mean_floor,
                       double change_threshold)
    : defects_(defects),
      mean_floor_(mean_floor),
      change_threshold_(change_threshold),
      best_(defects.size()) {
  GLINT_CHECK(mean_floor > 0.0, "a floor of zero divides by zero");
  GLINT_CHECK(change_threshold > 0.0, "no change at all is no change");
  for (const DefectPixels& defect : defects) {
    has_changed_.emplace_back(defect.inside.size());
  }
}

void BestFrames::add(const ImageF& frame, std::span<const std::vector<float>> flawless) {
  GLINT_CHECK(flawless.empty() || flawless.size() == defects_.size(),
              "flawless values of all defects or of none");
  for (std::size_t k = 0; k < defects_.size(); ++k) {
    const double background = mean_of(frame, defects_[k].ring);
    const double difference = std::abs(mean_of(frame, defects_[k].inside) - background);
    Best& best = best_[k];
    best.weber = std::max(best.weber, difference / std::max(background, mean_floor_));
    if (best.frame < 0 || difference > best.difference) {
      best.difference = difference;
      best.frame = frames_;
    }
    if (!flawless.empty()) {
      const std::vector<std::size_t>& inside = defects_[k].inside;
      if (const double change = mean_change(frame, inside, flawless[k]); change > best.change) {
        best.change = change;
        best.change_frame = frames_;
      }
      best.union_area =
          mark_changed(frame, inside, flawless[k], change_threshold_, has_changed_[k]) /
          defects_[k].area_px;
    }
  }
  ++frames_;
}

}  // namespace glint
