// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/drawing/light_drawing.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/text.h"
#include "studies/definition/scene_notes.h"
#include "studies/drawing/arc_chain.h"
#include "studies/drawing/dxf_file.h"
#include "studies/drawing/light_dimensions.h"
#include "studies/drawing/light_section.h"
#include "studies/drawing/svg_page.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kLightViewLeft = 40.0;
constexpr double kLightViewWidth = 320.0;
constexpr double kLightTitleWidth =
    0.82 * (kDrawingWidth - 2.0 * kDrawingMargin);  ///< of larger, bold letters
constexpr double kLightDimensionGap = 22.0;         ///< between dimension lines
constexpr double kLightNote_mm = 3.0;
constexpr double kDxfTolerance_mm = 1e-3;
constexpr double kLightViewHeight = 330.0;
constexpr double kCameraRoom = 84.0;  ///< above the view, for a camera that is far away
constexpr double kFarCamera = 1.6;    ///< times the size of the rest: drawn behind a break

/// Page position of a place of the plane.
struct LightView {
  double scale = 1.0;
  Vector2d origin = Vector2d::Zero();

  Vector2d operator()(const Vector2d& point_mm) const {
    return origin + scale * Vector2d(point_mm.x(), -point_mm.y());
  }

  PlaneLine operator()(const PlaneLine& points_mm) const {
    PlaneLine points;
    std::ranges::transform(
        points_mm, std::back_inserter(points), [&](const Vector2d& p) { return (*this)(p); });
    return points;
  }
};

struct Extent {
  Vector2d low = Vector2d::Constant(1e300);
  Vector2d high = Vector2d::Constant(-1e300);

  void add(const PlaneLine& points) {
    for (const Vector2d& point : points) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
  }

  Vector2d size() const { return high - low; }
};

std::string light_stroke(std::string_view colour, double width, std::string_view more = "") {
  return fmt::format(R"(fill="none" stroke="{}" stroke-width="{}" stroke-linejoin="round" {})",
                     colour,
                     width,
                     more);
}

/// Half the angle of view across the image's axis that lies nearer to the plane.
double half_angle_rad(const PhysicalScene& scene, const DrawingPlane& section) {
  const PinholeIntrinsics& in = scene.camera.intrinsics();
  const Vector3d in_camera = scene.camera_from_world.rotation * section.across;
  const Vector3d upwards = scene.camera_from_world.rotation * Vector3d::UnitZ();
  const double along_x = std::abs(in_camera.x()) + std::abs(upwards.x());
  const double along_y = std::abs(in_camera.y()) + std::abs(upwards.y());
  return along_x > along_y ? std::atan(0.5 * in.width_px / in.focal_px.x())
                           : std::atan(0.5 * in.height_px / in.focal_px.y());
}

void draw_camera_of_lights(SvgPage& page, const Vector2d& at, const Vector2d& away) {
  const Vector2d side(-away.y(), away.x());
  const auto block = [&](double near, double far, double half) {
    page.shape("polygon",
               {at + near * away + half * side,
                at + near * away - half * side,
                at + far * away - half * side,
                at + far * away + half * side},
               fmt::format(R"(fill="#ffffff" stroke="{}" stroke-width="1.3")", kDrawingInk));
  };
  block(0.0, 6.0, 6.0);
  block(6.0, 20.0, 9.0);
}

/// The camera with its field of view down to the depth of the scene's origin.
void draw_camera_view(SvgPage& page,
                      const PhysicalScene& scene,
                      const DrawingPlane& section,
                      const LightView& view,
                      double max_units) {
  const RigidTransform pose = inverse(scene.camera_from_world);
  const Vector2d camera = view(section(pose.translation_mm));
  const Vector3d axis = pose.rotation.col(2);
  const double depth_mm = std::max(1e-3, -axis.dot(pose.translation_mm));
  const Vector2d foot = view(section(pose.translation_mm + depth_mm * axis));
  const double length = (camera - foot).norm();
  if (length < 1e-6) {
    return;
  }
  const Vector2d away = (camera - foot) / length;
  const Vector2d side(-away.y(), away.x());
  const bool is_far = length > max_units;
  const Vector2d place = is_far ? Vector2d(foot + max_units * away) : camera;
  const double spread = length * std::tan(half_angle_rad(scene, section));
  const double shown = is_far ? (max_units - 32.0) / length : 1.0;
  for (const double sign : {-1.0, 1.0}) {
    const Vector2d edge = foot + sign * spread * side;
    page.line(edge,
              edge + shown * (camera - edge),
              light_stroke(kDrawingRay, 0.8, "stroke-dasharray=\"5 3\""));
  }
  page.line(foot, place, light_stroke(kDrawingSoft, 0.7, "stroke-dasharray=\"9 3 2 3\""));
  if (is_far) {
    page.break_mark(
        place - 26.0 * away, away, std::clamp(spread * (1.0 - shown) + 8.0, 12.0, 60.0));
  }
  draw_camera_of_lights(page, place, away);
  const bool is_right = place.x() > 0.75 * kDrawingWidth;
  page.text(place + Vector2d(is_right ? 22.0 : 0.0, away.y() < -0.5 ? -27.0 : -16.0),
            fmt::format("camera {} away", length_text(pose.translation_mm.norm())),
            is_right ? "end" : "middle");
}

void draw_lights(SvgPage& page, const LightLines& lines, const LightView& view) {
  for (const PlaneLine& outline : lines.seen) {
    page.shape("polygon",
               view(outline),
               fmt::format("fill=\"{0}\" fill-opacity=\"0.5\" stroke=\"{0}\" stroke-width=\"3.4\" "
                           "stroke-linejoin=\"round\"",
                           kDrawingLight));
  }
  for (const PlaneLine& cut : lines.cut) {
    page.shape("polyline", view(cut), light_stroke(kDrawingLight, 5.0));
    page.shape("polyline", view(cut), light_stroke(kDrawingInk, 0.8));
  }
}

/// Dimension lines: level ones stacked below the drawing, upright ones to the right of it, others
/// beside what they measure. @return the height below the last of them
double draw_dimensions(SvgPage& page,
                       const std::vector<PlaneDimension>& dimensions,
                       const LightView& view,
                       const Vector2d& right_bottom) {
  double bottom = right_bottom.y();
  double right = right_bottom.x();
  double beside = 0.0;
  for (const PlaneDimension& one : dimensions) {
    const Vector2d a = view(one.a_mm);
    const Vector2d b = view(one.b_mm);
    if (std::abs(a.y() - b.y()) < 0.01) {
      bottom += kLightDimensionGap;
      page.dimension(a, b, a.y() - bottom, one.words);
    } else if (std::abs(a.x() - b.x()) < 0.01) {
      right += kLightDimensionGap;
      page.dimension(a, b, a.x() - right, one.words);
    } else {
      beside += kLightDimensionGap;
      page.dimension(a, b, beside, one.words);
    }
  }
  return bottom;
}

/// All that is drawn, in the plane.
struct Sheet {
  DrawingPlane plane;
  LightLines lines;
  PlaneLine part;
  std::vector<PlaneDimension> dimensions;
  Extent extent;  ///< of lights and part, and of a camera that is near
  bool is_camera_far = false;

  explicit Sheet(const PhysicalScene& physical)
      : plane(drawing_plane(physical)),
        lines(light_lines_in(physical, plane)),
        part(part_outline(physical.part.mesh, plane)),
        dimensions(light_dimensions(physical, plane)) {
    extent.add(part);
    for (const std::vector<PlaneLine>* list : {&lines.cut, &lines.seen}) {
      for (const PlaneLine& line : *list) {
        extent.add(line);
      }
    }
    const Vector2d camera = plane(plane.origin_mm);
    const Vector2d middle = 0.5 * (extent.low + extent.high);
    is_camera_far = (camera - middle).norm() > kFarCamera * std::max(1e-9, extent.size().norm());
    if (!is_camera_far) {
      extent.add({camera});
    }
  }
};

void draw_part(SvgPage& page, const PlaneLine& part, const LightView& view) {
  page.shape("polygon",
             view(part),
             fmt::format(R"(fill="{}" stroke="{}" stroke-width="1" stroke-linejoin="round")",
                         kDrawingPart,
                         kDrawingInk));
}

}  // namespace

std::string area_lights_svg(const SceneSettings& scene,
                            const PhysicalScene& physical,
                            const std::string& title) {
  const Sheet sheet(physical);
  SvgPage page;
  double head = 20.0;
  if (!title.empty()) {
    head = page.lines({kDrawingMargin, 20.0},
                      {title},
                      kLightTitleWidth,
                      R"(font-size="14" font-weight="bold")") +
           8.0;
  }
  page.text({kDrawingMargin, head},
            "Lights, part and camera from the side",
            "start",
            0.0,
            "font-weight=\"bold\"");
  const Vector2d size = sheet.extent.size().cwiseMax(1e-3);
  const double scale = std::min(kLightViewWidth / size.x(), kLightViewHeight / size.y());
  const double top = head + 14.0 + (sheet.is_camera_far ? kCameraRoom : 44.0);
  const double left = kLightViewLeft + 0.5 * (kLightViewWidth - scale * size.x());
  const LightView view = {
      .scale = scale,
      .origin = {left - scale * sheet.extent.low.x(), top + scale * sheet.extent.high.y()}};
  const Vector2d origin = view(Vector2d::Zero());
  const double reach = sheet.is_camera_far ? origin.y() - head - 46.0 : 1e9;
  draw_camera_view(page, physical, sheet.plane, view, reach);
  draw_part(page, sheet.part, view);
  draw_lights(page, sheet.lines, view);
  const Vector2d corner = view(Vector2d(sheet.extent.high.x(), sheet.extent.low.y()));
  double bottom = draw_dimensions(page, sheet.dimensions, view, corner);
  page.axes({kDrawingMargin + 2.0, bottom + 48.0}, sheet.plane.across_name, "z");
  page.scale_bar({kLightViewLeft + 90.0, bottom + 44.0}, scale);
  bottom = page.lines(
      {kDrawingMargin, bottom + 74.0}, light_lines(scene), kDrawingWidth - 2.0 * kDrawingMargin);
  const PaperScale paper = paper_scale(scale, kDrawingWidth, bottom + 8.0);
  page.text({kDrawingMargin, bottom},
            fmt::format("{} printed at 100 %, lengths in mm", paper.words),
            "start");
  return page.document(
      kDrawingWidth, bottom + 8.0, title.empty() ? "Lighting, to scale" : title, paper.unit_mm);
}

std::string area_lights_dxf(const SceneSettings& scene,
                            const PhysicalScene& physical,
                            const std::string& title) {
  const Sheet sheet(physical);
  DxfFile dxf;
  for (const PlaneLine& cut : sheet.lines.cut) {
    dxf.chain("LIGHT", arcs_through(cut, kDxfTolerance_mm));
  }
  for (const PlaneLine& outline : sheet.lines.seen) {
    dxf.polyline("LIGHT", outline, true);
  }
  dxf.polyline("PART", sheet.part, true);
  const Vector2d camera = sheet.plane(sheet.plane.origin_mm);
  if (camera.norm() > 0.0) {
    dxf.line("CAMERA", Vector2d::Zero(), camera);
  }
  Vector2d at = sheet.extent.low - Vector2d(0.0, 20.0);
  std::vector<std::string> notes = {
      title.empty() ? std::string("Lighting") : title,
      fmt::format("mm, 1 : 1, {} to the right, z upwards", sheet.plane.across_name)};
  for (const std::string& line : light_lines(scene)) {
    notes.push_back(line);
  }
  for (const std::string& note : notes) {
    dxf.text("NOTES", at, kLightNote_mm, note);
    at.y() -= 2.0 * kLightNote_mm;
  }
  return dxf.document();
}

}  // namespace glint
