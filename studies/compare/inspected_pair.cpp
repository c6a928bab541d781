// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/inspected_pair.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "core/units.h"
#include "metrics/overlap/outline_motion.h"
#include "metrics/overlap/region_overlap.h"
#include "studies/compare/guided_outline.h"
#include "studies/inspect/defect_contrast.h"
#include "studies/inspect/inspect_rules.h"
#include "studies/inspect/inspected_part.h"
#include "studies/inspect/picture_sequence.h"

namespace glint {
namespace {

using Eigen::Affine2d;

constexpr double kBesidePx = 2.0;  ///< edges farther apart are not of one place

double edge_reach_px(const ComparedPair& pair) {
  return kMaxDistanceShare * pair.simulated.width();
}

/// Offsets of edges that a motion takes near their counterparts, from where they lie without it.
std::vector<EdgeOffset> offsets_after(const OutlineMotion& motion,
                                      const std::vector<Boundary>& edges,
                                      const std::vector<Boundary>& real,
                                      double reach_px) {
  std::vector<EdgeOffset> offsets;
  for (const BoundaryGap& gap : gaps_between(moved_outlines(edges, motion), real, reach_px)) {
    const BoundaryPoint& before = edges[gap.boundary].points[gap.point];
    offsets.push_back(
        {.at_px = before.at_px,
         .normal = before.normal,
         .offset_px = gap.offset_px + before.normal.dot(gap.from.at_px - before.at_px)});
  }
  return offsets;
}

/// By nearest edges, from the shift between both regions on. Edges inside the pictures alone may
/// all lie in one corner: they tell a shift.
OutlineMotion motion_by_nearest(const OutlinePair& outlines, double reach_px) {
  constexpr int kShiftRounds = 3;
  constexpr int kAllRounds = 9;
  constexpr double kAlike_px = 0.5;
  const bool is_inner = outlines.real.method == OutlineMethod::kInner;
  OutlineMotion motion = {.shift_px = middle_shift_px(outlines)};
  for (int round = 0; round < kAllRounds; ++round) {
    motion = fit_outline_motion(
        offsets_after(motion, outlines.simulated.located, outlines.real.located, reach_px),
        kAlike_px,
        is_inner || round < kShiftRounds);
  }
  return motion;
}

/// Of the simulated edges, those that a motion takes onto a real one.
double share_laid_over(const OutlinePair& outlines, const OutlineMotion& motion) {
  constexpr double kMinPoints = 40.0;
  double points = 0.0;
  for (const Boundary& line : outlines.simulated.located) {
    points += static_cast<double>(line.points.size());
  }
  const auto laid = gaps_between(
      moved_outlines(outlines.simulated.located, motion), outlines.real.located, kBesidePx);
  return points < kMinPoints ? 0.0 : static_cast<double>(laid.size()) / points;
}

/// From the simulated part's place in the picture to the real one's; nothing where too few edges
/// tell, or where the real picture is mirrored or turned.
std::optional<OutlineMotion> part_motion(const ComparedPair& pair) {
  const OutlinePair& outlines = pair.geometry.outlines;
  const OutlineMotion motion =
      outlines.motion ? *outlines.motion : motion_by_nearest(outlines, edge_reach_px(pair));
  const double shown = outlines.motion ? outlines.shown : share_laid_over(outlines, motion);
  return shown >= kMostlyShown && !pair.better_turn ? std::optional(motion) : std::nullopt;
}

Affine2d affine_of(const OutlineMotion& motion) {
  Affine2d affine = Affine2d::Identity();
  affine.linear() += motion.linear;
  affine.translation() = motion.shift_px - motion.linear * motion.middle_px;
  return affine;
}

/// Of areas, as a length.
double length_scale(const Affine2d& affine) {
  return std::sqrt(std::abs(affine.linear().determinant()));
}

MovedPlace moved_place(const ComparedPair& pair, const OutlineMotion& motion) {
  const OutlinePair& outlines = pair.geometry.outlines;
  const Affine2d affine = affine_of(motion);
  const Eigen::Matrix2d& linear = affine.linear();
  return {.shift_px = motion.shift_px,
          .turn_rad = std::atan2(linear(1, 0) - linear(0, 1), linear(0, 0) + linear(1, 1)),
          .scale = length_scale(affine),
          .rest_px = boundary_distance(moved_outlines(outlines.simulated.located, motion),
                                       outlines.real.located,
                                       edge_reach_px(pair))
                         .mean_px,
          .untold = motion.untold};
}

/// What is inspected of a side, in its own pixels.
struct InspectedPlace {
  Mask mask;    ///< where the part is
  Mask region;  ///< where contrasts are measured; empty: everywhere
  std::vector<KnownDefect> known;
};

InspectedPlace simulated_place(const ComparedPair& pair, const Affine2d& to_real) {
  const CompareSource& source = pair.simulated.source;
  const OutlinePair& outlines = pair.geometry.outlines;
  return {.mask = read_mask(source.mask, pair.simulated.width(), pair.simulated.height()),
          .region = pixels_on_both(outlines.simulated.coverage, outlines.real.coverage, to_real),
          .known = read_known_defects(source.truth, source.scene)};
}

InspectedPlace real_place(const ComparedPair& pair,
                          const InspectedPlace& simulated,
                          const Affine2d& to_real) {
  const OutlinePair& outlines = pair.geometry.outlines;
  const Affine2d back = to_real.inverse();
  InspectedPlace place = {
      .mask = Mask(pair.real.width(), pair.real.height()),
      .region = pixels_on_both(outlines.real.coverage, outlines.simulated.coverage, back),
      .known = simulated.known};
  for (int y = 0; y < place.mask.height(); ++y) {
    for (int x = 0; x < place.mask.width(); ++x) {
      place.mask(x, y) = value_under(simulated.mask, back, x, y) > 0.0 ? 1 : 0;
    }
  }
  for (KnownDefect& defect : place.known) {
    defect.from_px = to_real * defect.from_px;
    defect.to_px = to_real * defect.to_px;
    defect.radius_px *= length_scale(to_real);
  }
  return place;
}

bool is_in_picture(const ComparedPicture& picture, const Eigen::Vector2d& at) {
  return at.x() >= 0.0 && at.y() >= 0.0 && at.x() < picture.width() && at.y() < picture.height();
}

InspectedSide side_of(const ComparedPicture& picture,
                      const CompareSource& simulated,
                      const InspectedPlace& place,
                      const InspectionSettings& settings,
                      ThreadPool& pool) {
  const PicturedPart source = {
      .name = picture.source.name, .pictures = {picture.source.picture}, .scene = simulated.scene};
  PreparedPart prepared = prepare_part(source, {.placed = &place.mask}, pool);
  const InspectedPart part =
      inspect_part(source, std::move(prepared), settings, nullptr, std::nullopt, pool);
  const std::vector<FoundDefect>& blobs = part.inspection.defects;
  const DetectionMatches matches = match_detections(blobs, place.known, settings.trials);
  InspectedSide side = {.found = matches.found(), .false_alarms = matches.false_alarms()};
  for (std::size_t i = 0; i < place.known.size(); ++i) {
    const int blob = matches.blob_of_defect[i];
    SeenDefect seen = {
        .is_found = blob >= 0,
        .is_beyond_picture = blob < 0 && !is_in_picture(picture, place.known[i].middle_px())};
    side.missed += seen.is_found || seen.is_beyond_picture ? 0 : 1;
    if (blob >= 0) {
      seen.found_as = kind_name(blobs[static_cast<std::size_t>(blob)].kind);
    }
    seen.contrast = defect_contrast(picture.grey, place.region, place.known[i]);
    side.defects.push_back(std::move(seen));
  }
  return side;
}

/// How far the part lies from where the simulated picture has it.
double aside_px(const PairGeometry& geometry) {
  return std::max(middle_shift_px(geometry.outlines).norm(), geometry.distance.mean_px);
}

/// How far edges may lie from where the part is inspected.
double most_aside_px(const std::vector<KnownDefect>& known) {
  const double smallest_px =
      std::ranges::min_element(known, {}, &KnownDefect::radius_px)->radius_px;
  return std::min(kBesidePx, 0.5 * smallest_px);
}

void note_unmoved(const ComparedPair& pair, InspectedPair& result) {
  const double off_px = aside_px(pair.geometry);
  if (off_px > most_aside_px(result.known)) {
    result.notes.push_back(fmt::format(
        "In the photograph the part lies {:.1f} px elsewhere, and is inspected where the simulated "
        "picture has it, as its edges do not show how it was moved: its found, missed and "
        "contrasts may be of other places.",
        off_px));
  }
}

void note_moved(const MovedPlace& moved, const Affine2d& to_real, InspectedPair& result) {
  constexpr double kTold_px = 0.5;
  double farthest_px = 0.0;
  for (const KnownDefect& defect : result.known) {
    const Eigen::Vector2d at = defect.middle_px();
    farthest_px = std::max(farthest_px, (to_real * at - at).norm());
  }
  if (farthest_px > kTold_px) {
    result.notes.push_back(fmt::format(
        "The photograph is inspected where its edges have the part: its defects lie up to {:.1f} "
        "px from where the simulated picture has them (moved by {:.1f}, {:.1f} px, turned by "
        "{:.2f} degrees, {:.4f} times as large).",
        farthest_px,
        moved.shift_px.x(),
        moved.shift_px.y(),
        moved.turn_rad * kDegPerRad,
        moved.scale));
  }
  if (moved.rest_px > most_aside_px(result.known)) {
    result.notes.push_back(fmt::format(
        "So moved, edges of the part still lie {:.1f} px from those of the photograph: its found, "
        "missed and contrasts may be of other places.",
        moved.rest_px));
  }
}

void note_untold(const OutlineMotion& motion, InspectedPair& result) {
  if (const std::string note = compare_detail::untold_shift_note(motion); !note.empty()) {
    result.notes.push_back(note +
                           " The photograph's found, missed and contrasts may be of other places.");
  }
}

void note_beyond_picture(InspectedPair& result) {
  const auto count = std::ranges::count_if(result.real.defects, &SeenDefect::is_beyond_picture);
  if (count > 0) {
    result.notes.push_back(fmt::format(
        "So moved, {} of {} defects lie outside the photograph: they do not count as missed there.",
        count,
        result.known.size()));
  }
}

InspectionSettings rules_of_scene(const std::filesystem::path& scene,
                                  std::vector<std::string>& notes) {
  InspectionSettings settings = read_inspection_rules(InspectionSettings{}, scene, {}, {}).settings;
  if (settings.threshold == InspectionSettings::Threshold::kFalseAlarms) {
    settings.threshold = InspectionSettings::Threshold::kNoise;
    notes.emplace_back("Inspected with threshold = \"noise\": there are no flawless parts.");
  }
  return settings;
}

}  // namespace

std::optional<InspectedPair> inspect_pair(const ComparedPair& pair, ThreadPool& pool) {
  const CompareSource& simulated = pair.simulated.source;
  if (simulated.truth.empty() || simulated.scene.empty() || simulated.mask.empty()) {
    return std::nullopt;
  }
  const std::optional<OutlineMotion> motion = part_motion(pair);
  const Affine2d to_real = motion ? affine_of(*motion) : Affine2d::Identity();
  const InspectedPlace place = simulated_place(pair, to_real);
  if (place.known.empty()) {
    return std::nullopt;
  }
  InspectedPair result;
  result.known = place.known;
  const InspectionSettings settings = rules_of_scene(simulated.scene, result.notes);
  result.simulated = side_of(pair.simulated, simulated, place, settings, pool);
  result.real = side_of(pair.real, simulated, real_place(pair, place, to_real), settings, pool);
  if (motion) {
    result.moved = moved_place(pair, *motion);
    note_moved(*result.moved, to_real, result);
    note_untold(*motion, result);
    note_beyond_picture(result);
  } else {
    note_unmoved(pair, result);
  }
  return result;
}

}  // namespace glint
