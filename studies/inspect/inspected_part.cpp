// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspect/inspected_part.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "metrics/aspect_image/roi.h"
#include "metrics/shape/equivalent_ellipse.h"
#include "metrics/shape/shape_match.h"
#include "metrics/shape/silhouette.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Filter = InspectionSettings::Filter;

constexpr int kBins = 121;
constexpr double kGoodOverlap = 0.9;
constexpr double kLittle = 0.75;
constexpr double kFullShareToTell = 0.001;

/// The outline of a mask without its holes, which a silhouette has not either.
Mask filled(const Mask& mask) {
  const Silhouette outline = find_silhouette(coverage_of(mask), PartPieces::kAll);
  return outline.mask ? *outline.mask : mask;
}

/// Onto all pieces of the silhouette, or onto the largest where that fits better: what else is
/// bright may lie beside the part.
ShapeMatch best_match(const Mask& reference, const ImageF& aspect, const Silhouette& silhouette) {
  const auto match = match_shapes(reference, *silhouette.mask);
  GLINT_CHECK(match.has_value(), "neither a mask that was read nor a silhouette is empty");
  if (silhouette.pieces > 1) {
    const auto of_largest = match_shapes(reference, *find_silhouette(aspect).mask);
    return of_largest->overlap > match->overlap ? *of_largest : *match;
  }
  return *match;
}

/// @throws ConfigError  a reference needs a silhouette to lie on
void lay_reference(const fs::path& file,
                   const PicturedPart& source,
                   const Silhouette& silhouette,
                   PreparedPart& part) {
  const Mask reference = read_mask(file);
  if (!silhouette.mask) {
    throw ConfigError(fmt::format("{}: no silhouette to lay the reference mask on: {}",
                                  source.name,
                                  sentence(*silhouette.fault)));
  }
  const ShapeMatch match = best_match(filled(reference), part.aspect, silhouette);
  part.mask = warped(reference, match.to_part, part.aspect.width(), part.aspect.height());
  part.mask_from = "reference";
  if (const std::string_view text = warning(match.rule); !text.empty()) {
    part.notes.emplace_back(text);
  }
  if (silhouette.touches_border) {
    part.notes.emplace_back(
        "The part leaves the picture: the reference mask cannot lie on it truly.");
  }
  if (match.overlap < kGoodOverlap) {
    part.notes.push_back(fmt::format(
        "The reference mask and the part overlap by {:.1f} % only: is it the mask of this part?",
        100.0 * match.overlap));
  }
}

void find_part(const PicturedPart& source, Silhouette silhouette, PreparedPart& part) {
  part.mask = Mask(part.aspect.width(), part.aspect.height(), 1);
  part.mask_from = "picture";
  if (source.pictures.size() == 1) {
    part.notes.emplace_back("No mask was given: the whole picture was taken for the part.");
    return;
  }
  if (!silhouette.mask) {
    part.notes.push_back(
        fmt::format("The whole picture was taken for the part: {}", sentence(*silhouette.fault)));
    return;
  }
  part.mask = std::move(*silhouette.mask);
  part.mask_from = "silhouette";
  if (silhouette.pieces > 1) {
    part.notes.push_back(
        fmt::format("The part was found in {} pieces; the dark between them was not inspected. A "
                    "mask (--mask) has it inspected.",
                    silhouette.pieces));
  }
}

/// What no defect can change: pixels of the part that are black, or at full scale in all pictures.
void check_part_light(const std::string& name, PreparedPart& part) {
  std::size_t inside = 0;
  std::size_t black = 0;
  std::size_t full = 0;
  for (std::size_t i = 0; i < part.mask.size(); ++i) {
    if (part.mask.values()[i] != 0) {
      ++inside;
      black += part.aspect.values()[i] <= 0.0F ? 1U : 0U;
      full += !part.sequence.is_float && part.aspect.values()[i] > 0.999999F ? 1U : 0U;
    }
  }
  if (inside > 0 && black == inside) {
    throw ConfigError(name + ": the part is black in all pictures, there is nothing to inspect");
  }
  if (inside > 0 && full == inside) {
    throw ConfigError(name + ": the part is at full scale in all pictures, no defect can show");
  }
  const auto tell = [&](std::size_t count, const char* what) {
    const double share = static_cast<double>(count) / static_cast<double>(inside);
    if (share >= kFullShareToTell) {
      part.notes.push_back(
          fmt::format("{:.1f} % of the part is {} in all pictures: no defect can be found there.",
                      100.0 * share,
                      what));
    }
  };
  if (inside > 0) {
    tell(full, "at full scale");
    tell(black, "black");
  }
}

/// The share of the pixels from a grey value on that is inspected.
double bright_share(const ImageF& aspect, const Mask& region, double threshold) {
  std::size_t bright = 0;
  std::size_t inspected = 0;
  for (std::size_t i = 0; i < region.size(); ++i) {
    if (static_cast<double>(aspect.values()[i]) >= threshold) {
      ++bright;
      inspected += region.values()[i] != 0 ? 1U : 0U;
    }
  }
  return bright == 0 ? 0.0 : static_cast<double>(inspected) / static_cast<double>(bright);
}

ResponseHistogram histogram_of(const ImageF& response, const Mask& region, double threshold) {
  double largest = 0.0;
  for (const float value : response.values()) {
    largest = std::max(largest, static_cast<double>(std::abs(value)));
  }
  ResponseHistogram histogram{.reach = std::clamp(largest, 1.5 * threshold, 4.0 * threshold),
                              .counts = std::vector<double>(kBins, 0.0)};
  for (std::size_t i = 0; i < response.size(); ++i) {
    if (region.values()[i] != 0) {
      const double share =
          0.5 * (static_cast<double>(response.values()[i]) / histogram.reach + 1.0);
      const int bin = std::clamp(static_cast<int>(std::floor(share * kBins)), 0, kBins - 1);
      histogram.counts[static_cast<std::size_t>(bin)] += 1.0;
    }
  }
  return histogram;
}

/// What stands behind the number of reports.
std::string limits_note(const PicturedPart& source,
                        const InspectionSettings& settings,
                        bool is_capped) {
  std::string text;
  if (source.is_photograph()) {
    text =
        "No scan was given but a single picture: where no setting says otherwise, it was "
        "inspected as a photograph. (Is it the mean image of a scan? Then set "
        "inspection.filter = \"gaussian\", inspection.threshold_sigmas = 6 and "
        "inspection.max_reports = 0.)";
  }
  if (is_capped) {
    text += fmt::format(
        "{}The {} places that stand out most are reported (inspection.max_reports); none of them "
        "need be a defect.",
        text.empty() ? "" : " ",
        settings.max_reports);
  }
  return text;
}

/// Takes what is not looked at out of the region. @throws ConfigError when nothing is left
void leave_out(const std::string& name,
               const Mask& looked_at,
               Mask& region,
               ImageF& response,
               std::vector<std::string>& notes) {
  const std::size_t before = count_inside(region);
  for (std::size_t i = 0; i < region.size(); ++i) {
    if (looked_at.values()[i] == 0) {
      region.values()[i] = 0;
      response.values()[i] = 0.0F;
    }
  }
  const std::size_t after = count_inside(region);
  if (after == 0) {
    throw ConfigError(name +
                      ": inspection.trials.mask_grey: the flawless part responds everywhere");
  }
  if (after < before) {
    notes.push_back(fmt::format(
        "{:.1f} % of the part was left out: there the flawless part is dark or responds itself "
        "(inspection.trials.mask_grey); defects there count as missed.",
        100.0 * static_cast<double>(before - after) / static_cast<double>(before)));
  }
}

/// What is known before anything is looked for; a note where little of the part is inspected.
InspectedPart looked_at_part(const PicturedPart& source, PreparedPart& part, const Mask& region) {
  InspectedPart result{.source = source,
                       .width_px = part.aspect.width(),
                       .height_px = part.aspect.height(),
                       .bits = part.sequence.bits,
                       .is_float = part.sequence.is_float,
                       .channels = part.sequence.channels,
                       .mask_from = part.mask_from,
                       .region_px = count_inside(region),
                       .bright_share = bright_share(part.aspect, region, part.bright_from)};
  if (result.bright_share < kLittle) {
    part.notes.push_back(
        fmt::format("Only {:.1f} % of what is bright in the picture was inspected.",
                    100.0 * result.bright_share));
  }
  return result;
}

/// Of the defects that were found.
void add_sizes_and_matches(const InspectionSettings& settings, InspectedPart& result) {
  const std::vector<FoundDefect>& defects = result.inspection.defects;
  result.holes = sizes_of(defects, DefectKind::kHole, settings.measure);
  result.scratches = sizes_of(defects, DefectKind::kScratch, settings.measure);
  const PicturedPart& source = result.source;
  if (!source.truth.empty() && !source.scene.empty()) {
    result.known = read_known_defects(source.truth, source.scene);
    result.comparison = match_detections(defects, result.known, settings.trials);
  }
}

}  // namespace

PreparedPart prepare_part(const PicturedPart& source, const PartMasks& masks, ThreadPool& pool) {
  PreparedPart part{.sequence = read_sequence(source.pictures, pool)};
  part.aspect = aspect_of(part.sequence, pool);
  part.notes = part.sequence.notes;
  Silhouette silhouette = find_silhouette(part.aspect, PartPieces::kAll);
  part.bright_from = silhouette.fault ? 0.0 : silhouette.threshold;
  if (masks.placed != nullptr) {
    part.mask = *masks.placed;
    part.mask_from = "design";
  } else if (!masks.mask.empty()) {
    part.mask = read_mask(masks.mask, part.aspect.width(), part.aspect.height());
    part.mask_from = "file";
  } else if (!masks.reference.empty()) {
    lay_reference(masks.reference, source, silhouette, part);
  } else if (!source.mask.empty()) {
    part.mask = read_mask(source.mask, part.aspect.width(), part.aspect.height());
    part.mask_from = "design";
  } else {
    find_part(source, std::move(silhouette), part);
  }
  check_part_light(source.name, part);
  return part;
}

ImageF response_of(const Inspector& inspector, const PreparedPart& part, ThreadPool& pool) {
  if (inspector.settings().filter != Filter::kPhase) {
    return inspector.response(part.aspect, pool);
  }
  return inspector.response(linear_frames(part.sequence), pool);
}

InspectedPart inspect_part(const PicturedPart& source,
                           PreparedPart part,
                           const InspectionSettings& settings,
                           const Mask* looked_at,
                           std::optional<double> calibrated,
                           ThreadPool& pool) {
  const Inspector inspector(settings, part.mask);
  ImageF response = response_of(inspector, part, pool);
  Mask region = inspector.region();
  if (looked_at != nullptr) {
    leave_out(source.name, *looked_at, region, response, part.notes);
  }
  InspectedPart result = looked_at_part(source, part, region);
  const double threshold = inspector.threshold(response, calibrated);
  result.inspection.threshold = inspector.capped_threshold(response, threshold, pool);
  if (source.is_photograph() || result.inspection.threshold > threshold) {
    part.notes.push_back(limits_note(source, settings, result.inspection.threshold > threshold));
  }
  result.inspection.noise = inspector.noise(response, pool);
  result.inspection.defects = inspector.blobs(response, result.inspection.threshold, pool);
  add_sizes_and_matches(settings, result);
  result.histogram = histogram_of(response, region, result.inspection.threshold);
  if (settings.filter == Filter::kPhase) {
    result.phases = phase_maps(linear_frames(part.sequence), settings.periods, pool);
  }
  result.response = std::move(response);
  result.source.pictures = std::move(part.sequence.files);  // in the order they were taken
  result.notes = std::move(part.notes);
  result.aspect = std::move(part.aspect);
  result.region = std::move(region);
  return result;
}

}  // namespace glint
