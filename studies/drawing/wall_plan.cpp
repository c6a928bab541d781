// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/drawing/wall_plan.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/csv.h"
#include "core/text.h"
#include "core/units.h"
#include "studies/drawing/dxf_file.h"

namespace glint {
namespace {

using Eigen::Vector2d;

constexpr double kTitleHeight_mm = 5.0;
constexpr double kNoteHeight_mm = 3.0;

/// A length to a hundredth of a mm.
std::string rounded(double value) {
  const double number = std::round(value * 100.0) / 100.0;
  return shortest(number == 0.0 ? 0.0 : number);
}

std::string point_text(const Vector2d& point) {
  return fmt::format("({}, {})", rounded(point.x()), rounded(point.y()));
}

/// From its rim, the lower end, on.
std::vector<Vector2d> from_rim(std::vector<Vector2d> panel) {
  if (panel.front().y() > panel.back().y()) {
    std::ranges::reverse(panel);
  }
  return panel;
}

/// Lines are sampled: the last point may lie a step before the slot.
void reach_slot(std::vector<Vector2d>& panel, double half_slot_mm) {
  const Vector2d step = panel.back() - panel[panel.size() - 2];
  const double missing = std::abs(panel.back().x()) - half_slot_mm;
  if (half_slot_mm > 0.0 && std::abs(step.x()) > 1e-9 && missing > 0.0 &&
      missing <= 2.0 * std::abs(step.x())) {
    panel.back() += missing / std::abs(step.x()) * step;
  }
}

/// Whether both walls run from and to mirrored points, as those of every tunnel do.
bool is_mirror_image(const std::vector<Arc>& left, const std::vector<Arc>& right) {
  constexpr double kMirrored_mm = 1e-6;
  return (mirrored(left.front()).from_mm - right.front().from_mm).norm() < kMirrored_mm &&
         std::abs(mirrored(left.back()).to_mm.x() - right.back().to_mm.x()) < kMirrored_mm;
}

}  // namespace

std::vector<std::vector<Arc>> wall_arcs(const CrossSection& section) {
  std::vector<std::vector<Arc>> arcs;
  for (const std::vector<Vector2d>& whole : section.panels_yz_mm) {
    if (whole.size() < 2) {
      continue;
    }
    std::vector<Vector2d> panel = section.panels_yz_mm.size() == 1 ? whole : from_rim(whole);
    reach_slot(panel, 0.5 * section.slot_mm);
    arcs.push_back(arcs_through(panel));
  }
  if (arcs.size() == 2 && is_mirror_image(arcs[0], arcs[1])) {
    arcs[0] = arcs[1];  // sampled in one direction, the two are divided in different places
    std::ranges::transform(arcs[0], arcs[0].begin(), &mirrored);
  }
  return arcs;
}

std::vector<std::string> wall_lines(const CrossSection& section, std::size_t max_lines) {
  const std::vector<std::vector<Arc>> panels = wall_arcs(section);
  if (panels.empty()) {
    return {};
  }
  const std::vector<Arc>& arcs = panels.back();  // at y > 0 where there are two
  if (arcs.size() > max_lines) {
    return {fmt::format("wall: {} arcs, see the table in cross_section.csv", arcs.size())};
  }
  std::vector<std::string> lines = {
      fmt::format("Wall{}, (y, z) in mm within {} mm:",
                  panels.size() == 2 ? " at y > 0, the other is its mirror image" : "",
                  kArcTolerance_mm),
      "from " + point_text(arcs.front().from_mm)};
  for (const Arc& arc : arcs) {
    lines.push_back("to " + point_text(arc.to_mm) +
                    (arc.bulge == 0.0 ? std::string(", straight")
                                      : fmt::format(", radius {}, centre {}",
                                                    rounded(arc.radius_mm()),
                                                    point_text(arc.centre()))));
  }
  return lines;
}

std::string wall_csv(const CrossSection& section) {
  std::string csv = csv_row_of("panel",
                               "from_y_mm",
                               "from_z_mm",
                               "to_y_mm",
                               "to_z_mm",
                               "radius_mm",
                               "centre_y_mm",
                               "centre_z_mm",
                               "angle_deg");
  int panel = 0;
  for (const std::vector<Arc>& arcs : wall_arcs(section)) {
    ++panel;
    for (const Arc& arc : arcs) {
      const bool is_straight = arc.bulge == 0.0;
      const auto text = [&](double value) { return is_straight ? std::string() : rounded(value); };
      const Vector2d centre = is_straight ? Vector2d::Zero() : arc.centre();
      // Written as they are: csv_row_of() would take the minus of a text for a formula.
      csv += csv_row(std::vector<std::string>{std::to_string(panel),
                                              rounded(arc.from_mm.x()),
                                              rounded(arc.from_mm.y()),
                                              rounded(arc.to_mm.x()),
                                              rounded(arc.to_mm.y()),
                                              text(arc.radius_mm()),
                                              text(centre.x()),
                                              text(centre.y()),
                                              text(arc.angle_rad() * kDegPerRad)});
    }
  }
  return csv;
}

std::string wall_dxf(const CrossSection& section) {
  DxfFile dxf;
  double lowest = 0.0;
  double left = 0.0;
  for (const std::vector<Arc>& arcs : wall_arcs(section)) {
    dxf.chain("LIGHT", arcs);
    for (const Arc& arc : arcs) {
      lowest = std::min({lowest, arc.from_mm.y(), arc.to_mm.y()});
      left = std::min({left, arc.from_mm.x(), arc.to_mm.x()});
    }
  }
  dxf.polyline("PART", section.part_yz_mm, true);
  const Vector2d camera = section.camera_mm.tail<2>();
  if (camera.norm() > 0.0) {
    dxf.line("CAMERA", Vector2d::Zero(), camera);
  }
  const Vector2d notes(left, lowest - 4.0 * kTitleHeight_mm);
  dxf.text("NOTES", notes, kTitleHeight_mm, section.title.empty() ? "Lighting" : section.title);
  dxf.text(
      "NOTES",
      notes - Vector2d(0.0, 2.0 * kNoteHeight_mm),
      kNoteHeight_mm,
      fmt::format("mm, 1 : 1, y to the right, z upwards; arcs within {} mm; along x {}, slot {}",
                  kArcTolerance_mm,
                  length_text(section.length_mm),
                  length_text(section.slot_mm)));
  return dxf.document();
}

}  // namespace glint
