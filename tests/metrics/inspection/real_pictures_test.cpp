// SPDX-License-Identifier: GPL-3.0-or-later
//
// Photographs of worn ball screws by others, with pitting outlined by hand (2Obe/BSData, arXiv
// 2103.13003, CC BY-SA 4.0). Nothing is tuned to them: filters as their defaults are.
#include <algorithm>
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
  const Summary summary = summary_of(areas);
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

}  // namespace
}  // namespace glint
