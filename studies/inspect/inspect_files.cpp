// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspect/inspect_files.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/csv.h"
#include "core/units.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

Json grade_json(const std::optional<Grade>& grade) {
  return grade ? Json(std::string(grade_name(*grade))) : Json(nullptr);
}

Json sizes_json(const InspectedPart& part,
                DefectKind kind,
                const DefectSizes& sizes,
                const GradeLimits& limits) {
  const auto count = std::ranges::count_if(
      part.inspection.defects, [&](const FoundDefect& defect) { return defect.kind == kind; });
  return {
      {"count", count},
      {"biggest", sizes.biggest},
      {"sum", sizes.sum},
      {"grade", grade_json(part.grade ? std::optional(grade_by(sizes, limits)) : std::nullopt)}};
}

Json defect_json(const FoundDefect& defect, std::size_t index) {
  return {{"number", index + 1},
          {"kind", std::string(kind_name(defect.kind))},
          {"x_px", defect.x_px},
          {"y_px", defect.y_px},
          {"area_px", defect.area_px},
          {"weight", defect.weight},
          {"peak", defect.peak},
          {"is_bright", defect.is_bright},
          {"length_px", defect.length_px},
          {"width_px", defect.width_px},
          {"angle_deg", defect.angle_rad * kDegPerRad},
          {"elongation", defect.elongation},
          {"box_px", {defect.left_px, defect.top_px, defect.right_px, defect.bottom_px}}};
}

Json truth_json(const InspectedPart& part) {
  const DetectionMatches& comparison = *part.comparison;
  Json defects = Json::array();
  int other_kind = 0;
  for (std::size_t i = 0; i < part.known.size(); ++i) {
    const KnownDefect& known = part.known[i];
    const int blob = comparison.blob_of_defect[i];
    if (blob >= 0) {
      const FoundDefect& found = part.inspection.defects[static_cast<std::size_t>(blob)];
      other_kind += known.is_line() != (found.kind == DefectKind::kScratch) ? 1 : 0;
    }
    defects.push_back({{"id", known.id},
                       {"label", known.label},
                       {"kind", known.kind},
                       {"x_px", known.middle_px().x()},
                       {"y_px", known.middle_px().y()},
                       {"radius_px", known.radius_px},
                       {"found_as", blob < 0 ? Json(nullptr) : Json(blob + 1)}});
  }
  return {{"defects", part.known.size()},
          {"found", comparison.found()},
          {"missed", static_cast<int>(part.known.size()) - comparison.found()},
          {"other_kind", other_kind},
          {"false_alarms", comparison.false_alarms()},
          {"list", defects}};
}

}  // namespace

std::string unit_of(InspectionSettings::Measure measure) {
  return measure == InspectionSettings::Measure::kArea ? "px" : "weight";
}

Json part_json(const InspectedPart& part, const InspectionSettings& settings) {
  Json json = {
      {"name", part.source.name},
      {"grade", grade_json(part.grade)},
      {"holes", sizes_json(part, DefectKind::kHole, part.holes, settings.holes)},
      {"scratches", sizes_json(part, DefectKind::kScratch, part.scratches, settings.scratches)},
      {"threshold", part.inspection.threshold},
      {"noise", part.inspection.noise},
      {"pictures", part.source.pictures.size()},
      {"first_picture", part.source.pictures.front().string()},
      {"size_px", {part.width_px, part.height_px}},
      {"bits", part.bits},
      {"is_float", part.is_float},
      {"channels", part.channels},
      {"mask", part.mask_from},
      {"region_px", part.region_px},
      {"bright_share", part.bright_share}};
  if (part.label) {
    json["label"] = grade_json(part.label);
  }
  json["defects"] = Json::array();
  for (std::size_t i = 0; i < part.inspection.defects.size(); ++i) {
    json["defects"].push_back(defect_json(part.inspection.defects[i], i));
  }
  if (part.comparison) {
    json["truth"] = truth_json(part);
  }
  json["notes"] = part.notes;
  json["aspect"] = part.source.name + "/aspect.png";
  json["overlay"] = part.source.name + "/overlay.png";
  json["response"] = part.source.name + "/response.exr";
  if (part.phases) {
    json["modulation"] = part.source.name + "/modulation.exr";
    json["phase"] = part.source.name + "/phase_rad.exr";
  }
  return json;
}

std::string defects_csv(std::span<const InspectedPart> parts) {
  std::string text =
      "part,number,kind,x_px,y_px,area_px,weight,peak,is_bright,length_px,width_px,angle_deg,"
      "elongation,left_px,top_px,right_px,bottom_px,known_as\n";
  for (const InspectedPart& part : parts) {
    for (std::size_t i = 0; i < part.inspection.defects.size(); ++i) {
      const FoundDefect& defect = part.inspection.defects[i];
      const int known = part.comparison ? part.comparison->defect_of_blob[i] : -1;
      text += csv_row_of(part.source.name,
                         i + 1,
                         kind_name(defect.kind),
                         defect.x_px,
                         defect.y_px,
                         defect.area_px,
                         defect.weight,
                         defect.peak,
                         defect.is_bright ? 1 : 0,
                         defect.length_px,
                         defect.width_px,
                         defect.angle_rad * kDegPerRad,
                         defect.elongation,
                         defect.left_px,
                         defect.top_px,
                         defect.right_px,
                         defect.bottom_px,
                         known < 0 ? "" : part.known[static_cast<std::size_t>(known)].label);
    }
  }
  return text;
}

}  // namespace glint
