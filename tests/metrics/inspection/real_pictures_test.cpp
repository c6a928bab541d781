// SPDX-License-Identifier: GPL-3.0-or-later
//
// Photographs of worn ball screws by others, with pitting outlined by hand (2Obe/BSData, arXiv
// 2103.13003, CC BY-SA 4.0). The filters of a scan's inspection are not tuned to them, they are as
// their defaults are; the width of filter structure is judged on pictures that did not choose it.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/image/image_io.h"
#include "metrics/inspection/inspector.h"

namespace glint {
namespace {

using Filter = InspectionSettings::Filter;
using Polygon = std::vector<std::pair<double, double>>;

std::filesystem::path picture_folder() {
  return std::filesystem::path(GLINT_SHARED_DIR) / "data" / "field" / "bsdata";
}

std::vector<std::filesystem::path> labels_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> labels;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".json") {
      labels.push_back(entry.path());
    }
  }
  std::ranges::sort(labels);
  return labels;
}

bool holds(const Polygon& polygon, double x, double y) {
  bool is_inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const auto& [ax, ay] = polygon[i];
    const auto& [bx, by] = polygon[(i + 1) % polygon.size()];
    if ((ay > y) != (by > y) && x < ax + (bx - ax) * (y - ay) / (by - ay)) {
      is_inside = !is_inside;
    }
  }
  return is_inside;
}

/// Marks the pixels whose centres are inside, looking no further than the outline's box.
void mark(const Polygon& polygon, Mask& mask) {
  double left = mask.width();
  double top = mask.height();
  double right = 0.0;
  double bottom = 0.0;
  for (const auto& [x, y] : polygon) {
    left = std::min(left, x);
    right = std::max(right, x);
    top = std::min(top, y);
    bottom = std::max(bottom, y);
  }
  const int last_x = std::min(static_cast<int>(right) + 1, mask.width());
  const int last_y = std::min(static_cast<int>(bottom) + 1, mask.height());
  for (int y = std::max(static_cast<int>(top), 0); y < last_y; ++y) {
    for (int x = std::max(static_cast<int>(left), 0); x < last_x; ++x) {
      mask(x, y) = mask(x, y) != 0 || holds(polygon, x + 0.5, y + 0.5) ? 1 : 0;
    }
  }
}

/// A photograph and the pixels that somebody called pitted.
struct Photograph {
  ImageF picture;
  Mask labels;
};

std::vector<Photograph> photographs() {
  std::vector<Photograph> all;
  for (const std::filesystem::path& label : labels_in(picture_folder())) {
    const std::filesystem::path file = std::filesystem::path(label).replace_extension(".jpg");
    Photograph photograph{.picture = linear_values(read_picture(file).pixels)};
    photograph.labels = Mask(photograph.picture.width(), photograph.picture.height());
    std::ifstream in(label);
    const auto outlines = nlohmann::json::parse(in);
    for (const auto& shape : outlines.at("shapes")) {
      mark(shape.at("points").get<Polygon>(), photograph.labels);
    }
    all.push_back(std::move(photograph));
  }
  return all;
}

/// P(a labelled pixel has the larger response) + P(equal) / 2, over the region.
double area_under_curve(const ImageF& response, const Mask& labels, const Mask& region) {
  std::vector<float> with;
  std::vector<float> without;
  for (std::size_t i = 0; i < region.size(); ++i) {
    if (region.values()[i] != 0) {
      (labels.values()[i] != 0 ? with : without).push_back(std::abs(response.values()[i]));
    }
  }
  std::ranges::sort(with);
  double above = 0.0;
  for (const float value : without) {
    const auto [first, last] = std::equal_range(with.begin(), with.end(), value);
    above += static_cast<double>(with.end() - last) + 0.5 * static_cast<double>(last - first);
  }
  return above / (static_cast<double>(with.size()) * static_cast<double>(without.size()));
}

struct Summary {
  double mean = 0.0;
  double low = 0.0;  ///< of the mean over pictures like these, 95 %, by Student's t
  double minimum = 1.0;
};

/// Pictures are the sample: pixels of one picture are no independent trials.
Summary summary_of(const std::vector<double>& areas) {
  const auto count = static_cast<double>(areas.size());
  Summary summary;
  for (const double area : areas) {
    summary.mean += area / count;
    summary.minimum = std::min(summary.minimum, area);
  }
  double squares = 0.0;
  for (const double area : areas) {
    squares += (area - summary.mean) * (area - summary.mean);
  }
  constexpr double kStudent = 2.262;  // 97.5 % for 9 degrees of freedom
  summary.low = summary.mean - kStudent * std::sqrt(squares / (count - 1.0) / count);
  return summary;
}

Summary inspected(const std::vector<Photograph>& photographs,
                  const InspectionSettings& settings,
                  const std::string& name) {
  ThreadPool pool(hardware_threads());
  std::vector<double> areas;
  std::string list;
  for (const Photograph& photograph : photographs) {
    const ImageF& picture = photograph.picture;
    const Inspector inspector(settings, Mask(picture.width(), picture.height(), 1));
    const ImageF response = inspector.response(picture, pool);
    areas.push_back(area_under_curve(response, photograph.labels, inspector.region()));
    list += fmt::format(" {:.3f}", areas.back());
  }
  Summary summary = summary_of(areas);
  std::cout << fmt::format("{}: AUC mean {:.3f}, at least {:.3f}, worst {:.3f}; of each:{}\n",
                           name,
                           summary.mean,
                           summary.low,
                           summary.minimum,
                           list);
  return summary;
}

TEST(RealPictures, AreaUnderCurveOfAHandWorkedExample) {
  ImageF response(5, 1);
  Mask labels(5, 1);
  for (int x = 0; x < 5; ++x) {
    response(x, 0) = static_cast<float>(x == 4 ? -2 : x);  // sizes 0 1 2 3 2
  }
  labels(3, 0) = 1;
  labels(4, 0) = 1;  // 3 and 2 against 0, 1, 2: (3 + 2.5) / 6
  EXPECT_NEAR(area_under_curve(response, labels, Mask(5, 1, 1)), 5.5 / 6.0, 1e-12);
}

TEST(RealPictures, PittingIsFoundBetterThanByChance) {
  if (!std::filesystem::exists(picture_folder())) {
    GTEST_SKIP() << "the folder of shared photographs is absent";
  }
  const std::vector<Photograph> all = photographs();
  ASSERT_EQ(all.size(), 10U);
  InspectionSettings settings;
  const Summary gaussian = inspected(all, settings, "gaussian");
  settings.filter = Filter::kDifferenceOfGaussians;
  const Summary differences = inspected(all, settings, "difference_of_gaussians");
  settings.filter = Filter::kMatched;
  const Summary matched = inspected(all, settings, "matched");
  settings.filter = Filter::kGaussian;
  settings.kernel_px = 63;  // wider than most of the pits
  const Summary wide = inspected(all, settings, "gaussian, 63 px");
  for (const Summary& summary : {gaussian, differences, matched, wide}) {
    EXPECT_GT(summary.mean, 0.6);
    EXPECT_GT(summary.low, 0.55);
  }
}

/// What the inspector makes of one photograph.
struct Inspected {
  double area = 0.0;  ///< under the curve of the response, the larger the more suspicious
  int reports = 0;
  bool is_hit = false;  ///< the middle of a report lies on the labelled pixels or within 3 px
  double chance = 0.0;  ///< of a hit when all reports are moved together by a random shift
};

Mask grown(const Mask& labels, int by_px) {
  Mask result(labels.width(), labels.height());
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      for (int v = y - by_px; labels(x, y) != 0 && v <= y + by_px; ++v) {
        for (int u = x - by_px; u <= x + by_px; ++u) {
          if (u >= 0 && v >= 0 && u < labels.width() && v < labels.height()) {
            result(u, v) = 1;
          }
        }
      }
    }
  }
  return result;
}

/// The share of all shifts, around the picture's ends, that bring one of the middles onto the goal.
double chance_of_hit(const std::vector<FoundDefect>& reports, const Mask& goal) {
  const int width = goal.width();
  const int height = goal.height();
  Mask hits(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (std::size_t i = 0; goal(x, y) != 0 && i < reports.size(); ++i) {
        const int at_x = static_cast<int>(reports[i].x_px);
        const int at_y = static_cast<int>(reports[i].y_px);
        hits((x - at_x + width) % width, (y - at_y + height) % height) = 1;
      }
    }
  }
  return static_cast<double>(std::ranges::count(hits.values(), 1)) /
         static_cast<double>(hits.size());
}

Inspected inspect_one(const Photograph& photograph, const InspectionSettings& settings) {
  ThreadPool pool(hardware_threads());
  const ImageF& picture = photograph.picture;
  const Inspector inspector(settings, Mask(picture.width(), picture.height(), 1));
  const Inspection found = inspector.inspect(picture, pool);
  const ImageF response = inspector.response(picture, pool);
  const Mask goal = grown(photograph.labels, 3);
  return {.area = area_under_curve(response, photograph.labels, inspector.region()),
          .reports = static_cast<int>(found.defects.size()),
          .is_hit = std::ranges::any_of(found.defects,
                                        [&](const FoundDefect& report) {
                                          return goal(static_cast<int>(report.x_px),
                                                      static_cast<int>(report.y_px)) != 0;
                                        }),
          .chance = chance_of_hit(found.defects, goal)};
}

struct Totals {
  Summary areas;
  int median_reports = 0;
  int hits = 0;
  double chance = 0.0;  ///< hits to be expected by chance
};

Totals totals_of(const std::string& name, const std::vector<Inspected>& all) {
  Totals totals;
  std::vector<double> areas;
  std::vector<int> reports;
  std::string list;
  for (const Inspected& one : all) {
    areas.push_back(one.area);
    reports.push_back(one.reports);
    totals.hits += one.is_hit ? 1 : 0;
    totals.chance += one.chance;
    list += fmt::format(" {:.3f}/{}{}", one.area, one.reports, one.is_hit ? "+" : "-");
  }
  totals.areas = summary_of(areas);
  std::ranges::sort(reports);
  totals.median_reports = reports[reports.size() / 2];
  std::cout << fmt::format(
      "{}: AUC mean {:.3f}, worst {:.3f}; reports {} to {}, median {}; hits {}, by chance {:.2f}; "
      "of each:{}\n",
      name,
      totals.areas.mean,
      totals.areas.minimum,
      reports.front(),
      reports.back(),
      totals.median_reports,
      totals.hits,
      totals.chance,
      list);
  return totals;
}

constexpr std::array kWidths_px = {8.0, 12.0, 16.0, 24.0, 32.0};

/// Of each width, of each photograph.
std::vector<std::vector<Inspected>> inspected_by_width(const std::vector<Photograph>& all) {
  std::vector<std::vector<Inspected>> by_width;
  for (const double width_px : kWidths_px) {
    InspectionSettings settings = photograph_settings();
    settings.structure_px = width_px;
    by_width.emplace_back();
    for (const Photograph& photograph : all) {
      by_width.back().push_back(inspect_one(photograph, settings));
    }
    totals_of(fmt::format("structure, {} px", width_px), by_width.back());
  }
  return by_width;
}

/// The width with the largest sum of areas over all photographs but one.
std::size_t best_width(const std::vector<std::vector<Inspected>>& by_width, std::size_t without) {
  std::size_t best = 0;
  double largest = 0.0;
  for (std::size_t w = 0; w < by_width.size(); ++w) {
    double sum = 0.0;
    for (std::size_t i = 0; i < by_width[w].size(); ++i) {
      sum += i == without ? 0.0 : by_width[w][i].area;
    }
    best = sum > largest ? w : best;
    largest = std::max(largest, sum);
  }
  return best;
}

TEST(RealPictures, ChanceOfAHandWorkedExample) {
  Mask goal(10, 10);
  goal(4, 4) = goal(5, 4) = 1;
  const std::vector<FoundDefect> reports = {{.x_px = 2.5, .y_px = 3.5}, {.x_px = 3.5, .y_px = 3.5}};
  // Shifts (2, 1), (3, 1) of the first and (1, 1), (2, 1) of the second: three of a hundred.
  EXPECT_NEAR(chance_of_hit(reports, goal), 0.03, 1e-12);
}

// Each photograph is inspected with the width that the nine others choose.
TEST(RealPictures, SettingsOfPhotographsFindPitsAmongFewReports) {
  if (!std::filesystem::exists(picture_folder())) {
    GTEST_SKIP() << "the folder of shared photographs is absent";
  }
  const std::vector<Photograph> all = photographs();
  ASSERT_EQ(all.size(), 10U);
  std::vector<Inspected> of_scan;
  for (const Photograph& photograph : all) {
    of_scan.push_back(inspect_one(photograph, {}));
  }
  const Totals scan = totals_of("settings of a scan", of_scan);
  const auto by_width = inspected_by_width(all);
  std::vector<Inspected> left_out;
  for (std::size_t i = 0; i < all.size(); ++i) {
    left_out.push_back(by_width[best_width(by_width, i)][i]);
  }
  const Totals photograph = totals_of("structure, width by the others", left_out);
  EXPECT_GT(scan.median_reports, 1000) << "what photographs gave without settings of their own";
  EXPECT_LE(photograph.median_reports, 30);
  EXPECT_GE(photograph.hits, 2.0 * photograph.chance);
  EXPECT_GE(photograph.hits, 8);
  EXPECT_GE(photograph.areas.mean, scan.areas.mean);
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_GT(left_out[i].area, of_scan[i].area) << i;
  }
  EXPECT_EQ(photograph_settings().structure_px, kWidths_px[best_width(by_width, all.size())])
      << "the width that all of them choose";
}

}  // namespace
}  // namespace glint
