// SPDX-License-Identifier: GPL-3.0-or-later
//
// Regularity of the stripes in one frame, row by row. In each run of pixels of the region an edge
// is where the values cross the middle between darkest and brightest, interpolated linearly, and
// counts once they leave a band around that level (hysteresis, so that noise makes no edges).
// Spacings run between edges of the same direction, which keeps the duty out of them.
// docs/theory/homogeneity.md, "Fringe regularity". Cost: one pass over the region.
#include "metrics/aspect_image/fringe.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace glint {
namespace {

struct Edge {
  double at_px = 0.0;
  bool rising = false;
};

struct Totals {
  std::vector<double> periods_px;
  double bright_px = 0.0;       ///< bright lengths inside the periods
  double modulation_sum = 0.0;  ///< weighted by the runs' pixels
  double modulation_pixels = 0.0;
};

/// Crossings of the middle level; a crossing counts when the value then leaves the band around it.
std::vector<Edge> edges_of(std::span<const float> run, double middle, double band) {
  std::vector<Edge> edges;
  int state = 0;          // -1 dark, +1 bright, 0 not yet known
  double crossing = 0.0;  // the last one seen
  for (std::size_t x = 0; x < run.size(); ++x) {
    const double value = static_cast<double>(run[x]) - middle;
    const double before = x > 0 ? static_cast<double>(run[x - 1]) - middle : value;
    if ((before < 0.0) != (value < 0.0)) {
      crossing = static_cast<double>(x - 1) + before / (before - value);
    }
    const int now = value > band ? 1 : value < -band ? -1 : state;
    if (now != state && state != 0) {
      edges.push_back({crossing, now > 0});
    }
    state = now;
  }
  return edges;
}

void add_run(std::span<const float> run, const FringeSettings& settings, Totals& totals) {
  if (run.size() < 3) {
    return;
  }
  const auto [low, high] = std::minmax_element(run.begin(), run.end());
  const double darkest = static_cast<double>(*low);
  const double brightest = static_cast<double>(*high);
  const double sum = brightest + darkest;
  const double modulation = sum > 0.0 ? (brightest - darkest) / sum : 0.0;
  if (modulation < settings.min_modulation) {
    return;
  }
  const double band = 0.5 * settings.hysteresis * (brightest - darkest);
  const std::vector<Edge> edges = edges_of(run, 0.5 * sum, band);
  if (edges.size() < 3) {
    return;
  }
  for (std::size_t i = 0; i + 2 < edges.size(); ++i) {
    totals.periods_px.push_back(edges[i + 2].at_px - edges[i].at_px);
    const std::size_t bright_from = edges[i].rising ? i : i + 1;
    totals.bright_px += edges[bright_from + 1].at_px - edges[bright_from].at_px;
  }
  const auto pixels = static_cast<double>(run.size());
  totals.modulation_sum += modulation * pixels;
  totals.modulation_pixels += pixels;
}

/// Standard deviation over mean.
double variation_of(const std::vector<double>& values, double mean) {
  double squares = 0.0;
  for (const double value : values) {
    squares += (value - mean) * (value - mean);
  }
  return std::sqrt(squares / static_cast<double>(values.size())) / mean;
}

/// @param totals  of one period or more
FringeScores scores_of(const Totals& totals, const FringeSettings& settings) {
  double length_px = 0.0;
  for (const double period_px : totals.periods_px) {
    length_px += period_px;
  }
  FringeScores scores;
  scores.periods = static_cast<int>(totals.periods_px.size());
  scores.period_px = length_px / scores.periods;
  scores.regularity = variation_of(totals.periods_px, scores.period_px);
  scores.duty = totals.bright_px / length_px;
  scores.duty_error = scores.duty - settings.nominal_duty;
  scores.modulation = totals.modulation_sum / totals.modulation_pixels;
  return scores;
}

}  // namespace

std::optional<FringeScores> fringe_scores(const ImageF& frame,
                                          const Mask& region,
                                          const FringeSettings& settings) {
  GLINT_CHECK(frame.width() == region.width() && frame.height() == region.height(),
              "frame and region differ in size");
  Totals totals;
  for (int y = 0; y < frame.height(); ++y) {
    for (int x = 0; x < frame.width(); ++x) {
      const int begin = x;
      while (x < frame.width() && region(x, y) != 0) {
        ++x;
      }
      add_run({frame.row(y) + begin, static_cast<std::size_t>(x - begin)}, settings, totals);
    }
  }
  if (totals.periods_px.empty()) {
    return std::nullopt;
  }
  return scores_of(totals, settings);
}

}  // namespace glint
