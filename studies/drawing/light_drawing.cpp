// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/drawing/light_drawing.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/text.h"
#include "studies/definition/scene_notes.h"
#include "studies/drawing/light_section.h"
#include "studies/drawing/svg_page.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPageWidth = 440.0;
constexpr double kMargin = 12.0;
constexpr double kViewLeft = 40.0;
constexpr double kViewWidth = 360.0;
constexpr double kViewHeight = 330.0;
constexpr double kCameraRoom = 84.0;  ///< above the view, for a camera that is far away
constexpr double kFarCamera = 1.6;    ///< times the size of the rest: drawn behind a break

constexpr std::string_view kLight = "#e69f00";
constexpr std::string_view kPart = "#9db4c6";
constexpr std::string_view kRay = "#0072b2";

/// Page position of a place of the plane.
struct View {
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

std::string stroke(std::string_view colour, double width, std::string_view more = "") {
  return fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\" {}",
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

void draw_camera(SvgPage& page, const Vector2d& at, const Vector2d& away) {
  const Vector2d side(-away.y(), away.x());
  const auto block = [&](double near, double far, double half) {
    page.shape("polygon",
               {at + near * away + half * side,
                at + near * away - half * side,
                at + far * away - half * side,
                at + far * away + half * side},
               fmt::format("fill=\"#ffffff\" stroke=\"{}\" stroke-width=\"1.3\"", kDrawingInk));
  };
  block(0.0, 6.0, 6.0);
  block(6.0, 20.0, 9.0);
}

/// The camera with its field of view down to the depth of the scene's origin.
void draw_camera_view(SvgPage& page,
                      const PhysicalScene& scene,
                      const DrawingPlane& section,
                      const View& view,
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
    page.line(edge, edge + shown * (camera - edge), stroke(kRay, 0.8, "stroke-dasharray=\"5 3\""));
  }
  page.line(foot, place, stroke(kDrawingSoft, 0.7, "stroke-dasharray=\"9 3 2 3\""));
  if (is_far) {
    page.break_mark(
        place - 26.0 * away, away, std::clamp(spread * (1.0 - shown) + 8.0, 12.0, 60.0));
  }
  draw_camera(page, place, away);
  const bool is_right = place.x() > 0.75 * kPageWidth;
  page.text(place + Vector2d(is_right ? 22.0 : 0.0, away.y() < -0.5 ? -27.0 : -16.0),
            fmt::format("camera {} away", length_text(pose.translation_mm.norm())),
            is_right ? "end" : "middle");
}

void draw_lights(SvgPage& page, const LightLines& lines, const View& view) {
  for (const PlaneLine& outline : lines.seen) {
    page.shape("polygon",
               view(outline),
               fmt::format("fill=\"{0}\" fill-opacity=\"0.5\" stroke=\"{0}\" stroke-width=\"3.4\" "
                           "stroke-linejoin=\"round\"",
                           kLight));
  }
  for (const PlaneLine& cut : lines.cut) {
    page.shape("polyline", view(cut), stroke(kLight, 5.0));
    page.shape("polyline", view(cut), stroke(kDrawingInk, 0.8));
  }
}

}  // namespace

std::string area_lights_svg(const SceneSettings& scene,
                            const PhysicalScene& physical,
                            const std::string& title) {
  const DrawingPlane section = drawing_plane(physical);
  const LightLines lines = light_lines_in(physical, section);
  const PlaneLine part = part_outline(physical.part.mesh, section);
  Extent extent;
  extent.add(part);
  for (const std::vector<PlaneLine>* list : {&lines.cut, &lines.seen}) {
    for (const PlaneLine& line : *list) {
      extent.add(line);
    }
  }
  const Vector2d camera = section(section.origin_mm);
  const Vector2d middle = 0.5 * (extent.low + extent.high);
  const bool is_far = (camera - middle).norm() > kFarCamera * std::max(1e-9, extent.size().norm());
  if (!is_far) {
    extent.add({camera});
  }
  const Vector2d size = extent.size().cwiseMax(1e-3);
  const double scale = std::min(kViewWidth / size.x(), kViewHeight / size.y());
  const double top = (title.empty() ? 34.0 : 58.0) + (is_far ? kCameraRoom : 44.0);
  const View view = {
      .scale = scale,
      .origin = {kViewLeft + 0.5 * (kViewWidth - scale * size.x()) - scale * extent.low.x(),
                 top + scale * extent.high.y()}};
  SvgPage page;
  if (!title.empty()) {
    page.text({kMargin, 20.0}, title, "start", 0.0, "font-size=\"14\" font-weight=\"bold\"");
  }
  const double head = title.empty() ? 20.0 : 44.0;
  page.text({kMargin, head},
            "Lights, part and camera from the side",
            "start",
            0.0,
            "font-weight=\"bold\"");
  const Vector2d origin = view(Vector2d::Zero());
  draw_camera_view(page, physical, section, view, is_far ? origin.y() - head - 46.0 : 1e9);
  page.shape("polygon",
             view(part),
             fmt::format("fill=\"{}\" stroke=\"{}\" stroke-width=\"1\" stroke-linejoin=\"round\"",
                         kPart,
                         kDrawingInk));
  draw_lights(page, lines, view);
  double bottom = view(extent.low).y();
  page.axes({kMargin + 2.0, bottom + 40.0}, section.across_name, "z");
  page.scale_bar({kViewLeft + 30.0, bottom + 36.0}, scale);
  bottom += 54.0;
  for (const std::string& line : light_lines(scene)) {
    bottom += 16.0;
    page.text({kMargin, bottom - 4.0}, line, "start");
  }
  return page.document(kPageWidth, bottom + 6.0, title.empty() ? "Lighting, to scale" : title);
}

}  // namespace glint
