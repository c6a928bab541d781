// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspection_line/visibility_trials.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "metrics/statistics/bisection.h"
#include "studies/inspection_line/visibility_windows.h"

namespace glint {
namespace {

/// What was found on a part, and what later steps need of the scan about its defects.
struct TriedPart {
  PartTrial trial;
  std::vector<DefectView> views;  ///< of its defects; both empty where they are not needed
  std::vector<ImageF> responses;  ///< in the views' windows
};

ImageF cut_out(const ImageF& image, const DefectView& view) {
  ImageF window(view.distance.width(), view.distance.height());
  for (int y = 0; y < window.height(); ++y) {
    std::copy_n(image.row(view.top_px + y) + view.left_px, window.width(), window.row(y));
  }
  return window;
}

/// Largest |value| within so many radii of the defect.
double largest_near(const ImageF& window, const DefectView& view, double radii) {
  float largest = 0.0F;
  const auto reach = static_cast<float>(radii);
  for (std::size_t i = 0; i < window.size(); ++i) {
    if (view.distance.values()[i] <= reach) {
      largest = std::max(largest, std::abs(window.values()[i]));
    }
  }
  return static_cast<double>(largest);
}

bool is_stain(const TrueDefect& truth) {
  return truth.defect.type == DefectType::kStain;
}

DefectTrial as_made(const TrueDefect& truth) {
  return {.group = truth.defect.group,
          .height_um = is_stain(truth) ? 0.0 : 1e3 * truth.defect.depth_mm,
          .rendering = truth.rendering};
}

TriedPart inspected(const SimulatedLine& line,
                    const ScannedPart& part,
                    double threshold,
                    const TrialNeeds& needs) {
  const std::vector<FoundDefect> found = line.inspect(part, threshold);
  const DetectionMatches matches =
      match_detections(found, part.defects, line.scene().inspection.trials);
  TriedPart result;
  for (std::size_t i = 0; i < part.defects.size(); ++i) {
    const TrueDefect& truth = part.defects[i];
    DefectTrial trial = as_made(truth);
    trial.is_found = matches.is_found(i);
    for (std::size_t k = 0; trial.is_found && k < found.size(); ++k) {
      if (matches.defect_of_blob[k] == static_cast<int>(i)) {
        trial.signature += found[k].area_px / truth.view.area_px;
      }
    }
    if (needs.largest || needs.dprime) {
      result.views.push_back(truth.view);
      result.responses.push_back(cut_out(part.response, truth.view));
      trial.largest = largest_near(
          result.responses.back(), truth.view, line.scene().inspection.trials.hit_radii);
    }
    result.trial.defects.push_back(std::move(trial));
  }
  return result;
}

/// Scans of the flawless part. Those that a threshold is calibrated on have the numbers from 0;
/// these have others.
struct FlawlessScans {
  std::int64_t blobs = 0;
  std::vector<ImageF> responses;  ///< empty pictures where they are not needed

  const ImageF& of(std::size_t number) const { return responses[number % responses.size()]; }
};

FlawlessScans scan_flawless(const SimulatedLine& line,
                            std::int64_t first,
                            double threshold,
                            const TrialNeeds& needs,
                            ThreadPool& pool) {
  struct Scan {
    ImageF response;
    std::int64_t blobs = 0;
  };

  const int count = line.scene().inspection.trials.flawless;
  const bool is_kept = needs.largest || needs.dprime;
  auto scans = pool.map<Scan>(count, [&](std::int64_t number) {
    ScannedPart part = line.flawless(first + count + number);
    const auto blobs =
        needs.flawless ? static_cast<std::int64_t>(line.inspect(part, threshold).size()) : 0;
    return Scan{is_kept ? std::move(part.response) : ImageF(), blobs};
  });
  FlawlessScans result;
  for (Scan& scan : scans) {
    result.blobs += scan.blobs;
    result.responses.push_back(std::move(scan.response));
  }
  return result;
}

ImageF sum_of(const std::vector<ImageF>& images) {
  ImageF sum(images.front().width(), images.front().height());
  for (const ImageF& image : images) {
    for (std::size_t i = 0; i < sum.size(); ++i) {
      sum.values()[i] += image.values()[i];
    }
  }
  return sum;
}

/// The mean of so many pictures but one: what that one and the scan of a part are compared with
/// alike.
ImageF mean_without(ImageF sum, const ImageF& one, std::size_t count) {
  const float share = 1.0F / static_cast<float>(count - 1);
  for (std::size_t i = 0; i < sum.size(); ++i) {
    sum.values()[i] = share * (sum.values()[i] - one.values()[i]);
  }
  return sum;
}

void look_without(const FlawlessScans& flawless, double radii, std::vector<TriedPart>& parts) {
  for (std::size_t k = 0; k < parts.size(); ++k) {
    for (std::size_t i = 0; i < parts[k].views.size(); ++i) {
      const DefectView& view = parts[k].views[i];
      parts[k].trial.defects[i].largest_without =
          largest_near(cut_out(flawless.of(k), view), view, radii);
    }
  }
}

/// A defect by part and number on it.
struct Address {
  std::size_t part = 0;
  std::size_t defect = 0;
};

WindowShape shape_for(const std::vector<TriedPart>& parts, const std::vector<Address>& group) {
  std::vector<double> areas;
  for (const Address& at : group) {
    areas.push_back(parts[at.part].views[at.defect].area_px);
  }
  const auto middle = areas.begin() + static_cast<std::ptrdiff_t>(areas.size() / 2);
  std::ranges::nth_element(areas, middle);
  return WindowShape::of_area(*middle);
}

/// Each group has a window of its own size.
void filter_groups(const SimulatedLine& line,
                   const FlawlessScans& flawless,
                   std::vector<TriedPart>& parts,
                   ThreadPool& pool) {
  std::map<std::string, std::vector<Address>> groups;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    for (std::size_t i = 0; i < parts[k].views.size(); ++i) {
      groups[parts[k].trial.defects[i].group].push_back({k, i});
    }
  }
  const ImageF sum = sum_of(flawless.responses);
  for (const auto& [name, group] : groups) {
    const WindowShape shape = shape_for(parts, group);
    std::vector<DefectWindow> windows;
    for (const Address& at : group) {
      const DefectView& view = parts[at.part].views[at.defect];
      const auto [x, y] = middle_of(view);
      const ImageF& response = parts[at.part].responses[at.defect];
      // Windows may reach beyond the view's; there all three are cut alike.
      const auto of = [&, u = x - view.left_px, v = y - view.top_px](const ImageF& cut) {
        return window_at(cut, u, v, shape);
      };
      const ImageF without = cut_out(flawless.of(at.part), view);
      const ImageF mean = mean_without(cut_out(sum, view), without, flawless.responses.size());
      windows.push_back({.with = of(response), .without = of(without), .mean = of(mean)});
    }
    const auto background = background_windows(flawless.responses, line.region(), shape);
    const std::vector<double> squares = squared_dprimes(windows, background, pool);
    for (std::size_t i = 0; i < group.size(); ++i) {
      parts[group[i].part].trial.defects[group[i].defect].squared_dprime = squares[i];
    }
  }
}

std::vector<NamedGroup> scaled(std::vector<NamedGroup> groups, double factor) {
  for (auto& [name, group] : groups) {
    group.height_mm = {factor * group.height_mm.min, factor * group.height_mm.max};
  }
  return groups;
}

/// Of its defects that have a height, with all heights times a factor.
double found_share(const SimulatedLine& line,
                   std::int64_t number,
                   double threshold,
                   double factor) {
  const ScannedPart part = line.part_with(scaled(line.scene().defects, factor), number);
  const DetectionMatches matches =
      match_detections(line.inspect(part, threshold), part.defects, line.scene().inspection.trials);
  int found = 0;
  int made = 0;
  for (std::size_t i = 0; i < part.defects.size(); ++i) {
    if (!is_stain(part.defects[i])) {
      ++made;
      found += matches.is_found(i) ? 1 : 0;
    }
  }
  return static_cast<double>(found) / std::max(1, made);
}

/// Bisection of one part: part and noise stay the same, so its own share is a clean step.
double factor_of(const SimulatedLine& line, std::int64_t number, double threshold) {
  const auto share = [&](double factor) { return found_share(line, number, threshold, factor); };
  const BisectionSettings settings = {.relative_step = 0.04, .max_calls = 12};
  const SmallestDetectable found =
      smallest_detectable(share, LineTrials::kMinFactor, LineTrials::kMaxFactor, 0.5, settings);
  return found.result == Detectable::kNever ? LineTrials::kMaxFactor : found.size;
}

/// Of the part's defects that have a height, all heights times a factor.
std::vector<double> slopes_mrad_at(const SimulatedLine& line, std::int64_t number, double factor) {
  std::vector<double> slopes = line.slopes_rad(scaled(line.scene().defects, factor), number);
  std::erase(slopes, 0.0);  // stains
  for (double& slope : slopes) {
    slope *= 1e3;
  }
  return slopes;
}

}  // namespace

LineTrials run_trials(const SimulatedLine& line,
                      const TrialNeeds& needs,
                      std::int64_t first,
                      ThreadPool& pool) {
  const TrialSettings& settings = line.scene().inspection.trials;
  LineTrials result;
  result.threshold = line.threshold();
  result.region_share = line.region_share();
  result.rendering_share = line.rendering_share();
  std::vector<TriedPart> parts;
  if (needs.parts || needs.largest || needs.dprime || needs.smallest) {
    parts = pool.map<TriedPart>(settings.parts, [&](std::int64_t k) {
      TriedPart part = inspected(line, line.part(first + k), result.threshold, needs);
      if (needs.smallest) {
        part.trial.factor = factor_of(line, first + k, result.threshold);
        part.trial.slopes_mrad = slopes_mrad_at(line, first + k, part.trial.factor);
      }
      return part;
    });
  }
  if (needs.flawless || needs.largest || needs.dprime) {
    const FlawlessScans flawless = scan_flawless(line, first, result.threshold, needs, pool);
    result.flawless = settings.flawless;
    result.false_alarms = flawless.blobs;
    if (needs.largest) {
      look_without(flawless, settings.hit_radii, parts);
    }
    if (needs.dprime) {
      filter_groups(line, flawless, parts, pool);
    }
  }
  for (TriedPart& part : parts) {
    result.parts.push_back(std::move(part.trial));
  }
  return result;
}

}  // namespace glint
