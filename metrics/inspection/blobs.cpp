// SPDX-License-Identifier: GPL-3.0-or-later
//
// Connected regions beyond a threshold and their moments. Runs of pixels are found row by row, in
// bands for the threads, and joined with the runs of the row above (union-find, 8-connected, bright
// and dark apart). The sums of a run are closed formulas in integers, so moments are exact until
// the last division. docs/theory/inspection.md, "Blobs". Cost: one pass over the picture, then
// linear in the runs; memory linear in the runs.
#include "metrics/inspection/blobs.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/units.h"
#include "metrics/inspection/filter_kernels.h"
#include "metrics/inspection/inspection_settings.h"

namespace glint {
namespace {

using Polarity = InspectionSettings::Polarity;

constexpr double kPixelVariance = 1.0 / 12.0;  // of a square pixel about its middle

/// Pixels of one sign beside each other in a row.
struct Run {
  int y = 0;
  int begin = 0;
  int end = 0;
  bool is_bright = true;
  float peak = 0.0F;
  double weight = 0.0;
};

/// Responses from `high` on and down to `low` are beyond the threshold.
struct Limits {
  float low = 0.0F;
  float high = 0.0F;
};

Limits limits_of(double threshold, Polarity polarity) {
  GLINT_CHECK(threshold > 0.0, "a threshold must be positive");
  constexpr float kNever = std::numeric_limits<float>::infinity();
  auto minimum = static_cast<float>(threshold);
  if (static_cast<double>(minimum) < threshold) {
    minimum = std::nextafter(minimum, kNever);
  }
  Limits limits = {.low = -minimum, .high = minimum};
  if (polarity == Polarity::kBright) {
    limits.low = -kNever;
  } else if (polarity == Polarity::kDark) {
    limits.high = kNever;
  }
  return limits;
}

void add_runs(const float* row, int y, int width, Limits limits, std::vector<Run>& runs) {
  for (int x = 0;;) {
    x = inspection_kernels::find_beyond(row, x, width, limits.low, limits.high);
    if (x == width) {
      return;
    }
    Run run{.y = y, .begin = x, .is_bright = row[x] >= limits.high};
    while (x < width && (run.is_bright ? row[x] >= limits.high : row[x] <= limits.low)) {
      const float size = std::abs(row[x]);
      run.peak = std::max(run.peak, size);
      run.weight += static_cast<double>(size);
      ++x;
    }
    run.end = x;
    runs.push_back(run);
  }
}

std::vector<Run> runs_of(const ImageF& response, Limits limits, ThreadPool& pool) {
  const int height = response.height();
  const int bands = (height + kRowsPerBand - 1) / kRowsPerBand;
  const auto parts = pool.map<std::vector<Run>>(bands, [&](std::int64_t band) {
    std::vector<Run> runs;
    const int first = static_cast<int>(band) * kRowsPerBand;
    for (int y = first; y < std::min(first + kRowsPerBand, height); ++y) {
      add_runs(response.row(y), y, response.width(), limits, runs);
    }
    return runs;
  });
  std::vector<Run> all;
  for (const std::vector<Run>& part : parts) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

/// Union-find whose roots are the smallest members.
class Groups {
 public:
  explicit Groups(std::size_t count) : parents_(count) {
    for (std::size_t i = 0; i < count; ++i) {
      parents_[i] = i;
    }
  }

  std::size_t root(std::size_t i) {
    while (parents_[i] != i) {
      parents_[i] = parents_[parents_[i]];
      i = parents_[i];
    }
    return i;
  }

  void join(std::size_t a, std::size_t b) {
    a = root(a);
    b = root(b);
    parents_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parents_;
};

/// Joins the runs of one row, [row, end), with those of the row above, [above, row).
void join_rows(const std::vector<Run>& runs,
               std::size_t above,
               std::size_t row,
               std::size_t end,
               Groups& groups) {
  std::size_t first = above;
  for (std::size_t i = row; i < end; ++i) {
    // Ends are one beyond: runs that meet corner to corner have end == begin.
    while (first < row && runs[first].end < runs[i].begin) {
      ++first;
    }
    for (std::size_t j = first; j < row && runs[j].begin <= runs[i].end; ++j) {
      if (runs[j].is_bright == runs[i].is_bright) {
        groups.join(i, j);
      }
    }
  }
}

Groups connected(const std::vector<Run>& runs) {
  Groups groups(runs.size());
  std::size_t above = 0;
  for (std::size_t row = 0; row < runs.size();) {
    std::size_t end = row;
    while (end < runs.size() && runs[end].y == runs[row].y) {
      ++end;
    }
    if (row > 0 && runs[above].y + 1 == runs[row].y) {
      join_rows(runs, above, row, end, groups);
    }
    above = row;
    row = end;
  }
  return groups;
}

struct Blob {
  PixelSums sums;
  FoundDefect found;
};

void add_run(const Run& run, Blob& blob) {
  FoundDefect& found = blob.found;
  if (blob.sums.count == 0) {
    found.is_bright = run.is_bright;
    found.left_px = run.begin;
    found.top_px = run.y;
  }
  blob.sums.add(sums_of_run(run.y, run.begin, run.end));
  found.weight += run.weight;
  found.peak = std::max(found.peak, static_cast<double>(run.peak));
  found.left_px = std::min(found.left_px, run.begin);
  found.right_px = std::max(found.right_px, run.end);
  found.bottom_px = run.y + 1;
}

/// Fills in what follows from the moments.
void measure(Blob& blob, const InspectionSettings& settings) {
  FoundDefect& found = blob.found;
  const auto count = static_cast<double>(blob.sums.count);
  const BlobMoments moments = moments_of(blob.sums);
  const double half_sum = 0.5 * (moments.mu20 + moments.mu02);
  const double half_gap = std::hypot(0.5 * (moments.mu20 - moments.mu02), moments.mu11);
  found.area_px = static_cast<int>(blob.sums.count);
  found.x_px = static_cast<double>(blob.sums.x) / count + 0.5;
  found.y_px = static_cast<double>(blob.sums.y) / count + 0.5;
  found.length_px = 4.0 * std::sqrt(half_sum + half_gap);
  found.width_px = 4.0 * std::sqrt(std::max(0.0, half_sum - half_gap));
  found.angle_rad = 0.5 * std::atan2(2.0 * moments.mu11, moments.mu20 - moments.mu02);
  if (found.angle_rad <= -0.5 * kPi) {
    found.angle_rad = 0.5 * kPi;
  }
  found.elongation = half_gap / half_sum;
  found.kind = kind_of(moments, found.area_px, settings);
}

/// The sum of i^2 for i in [0, n).
std::int64_t squares_below(std::int64_t n) {
  return (n - 1) * n * (2 * n - 1) / 6;
}

}  // namespace

void PixelSums::add(const PixelSums& other) {
  count += other.count;
  x += other.x;
  y += other.y;
  xx += other.xx;
  xy += other.xy;
  yy += other.yy;
}

PixelSums sums_of_run(int y, int begin, int end) {
  const std::int64_t first = begin;
  const std::int64_t count = static_cast<std::int64_t>(end) - begin;
  const std::int64_t row = y;
  const std::int64_t x = count * (2 * first + count - 1) / 2;
  return {.count = count,
          .x = x,
          .y = count * row,
          .xx = squares_below(first + count) - squares_below(first),
          .xy = x * row,
          .yy = count * row * row};
}

/// About the whole pixel next to the middle first, exactly: nothing cancels far from the origin.
BlobMoments moments_of(const PixelSums& sums) {
  const std::int64_t n = sums.count;
  const std::int64_t cx = sums.x / n;
  const std::int64_t cy = sums.y / n;
  const auto count = static_cast<double>(n);
  const double dx = static_cast<double>(sums.x - n * cx) / count;
  const double dy = static_cast<double>(sums.y - n * cy) / count;
  const std::int64_t xx = sums.xx - 2 * cx * sums.x + n * cx * cx;
  const std::int64_t xy = sums.xy - cx * sums.y - cy * sums.x + n * cx * cy;
  const std::int64_t yy = sums.yy - 2 * cy * sums.y + n * cy * cy;
  return {.mu20 = static_cast<double>(xx) / count - dx * dx + kPixelVariance,
          .mu11 = static_cast<double>(xy) / count - dx * dy,
          .mu02 = static_cast<double>(yy) / count - dy * dy + kPixelVariance};
}

DefectKind kind_of(const BlobMoments& moments, int area_px, const InspectionSettings& settings) {
  if (area_px < settings.hole_below_px) {
    return DefectKind::kHole;
  }
  const double difference = moments.mu02 - moments.mu20;
  bool is_hole = false;
  if (settings.kind_rule == InspectionSettings::KindRule::kPrinted) {
    // A round blob gives 0 / 0 in both and passes neither.
    is_hole = difference / moments.mu11 >= settings.printed_k ||
              moments.mu11 / difference >= settings.printed_k;
  } else {
    const double elongation =
        std::hypot(difference, 2.0 * moments.mu11) / (moments.mu20 + moments.mu02);
    is_hole = 1.0 - elongation >= settings.hole_compactness;
  }
  return is_hole ? DefectKind::kHole : DefectKind::kScratch;
}

std::vector<FoundDefect> find_blobs(const ImageF& response,
                                    double threshold,
                                    const InspectionSettings& settings,
                                    ThreadPool& pool) {
  const std::vector<Run> runs = runs_of(response, limits_of(threshold, settings.polarity), pool);
  Groups groups = connected(runs);
  std::vector<Blob> blobs;
  std::vector<std::size_t> blob_of_run(runs.size());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const std::size_t root = groups.root(i);
    if (root == i) {
      blob_of_run[i] = blobs.size();
      blobs.emplace_back();
    }
    blob_of_run[i] = blob_of_run[root];
    add_run(runs[i], blobs[blob_of_run[i]]);
  }
  std::vector<FoundDefect> defects;
  for (Blob& blob : blobs) {
    if (blob.sums.count >= settings.min_area_px) {
      measure(blob, settings);
      defects.push_back(blob.found);
    }
  }
  return defects;
}

}  // namespace glint
