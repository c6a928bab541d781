// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/points_run.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/csv.h"
#include "core/error.h"
#include "core/file.h"
#include "core/image/image_io.h"
#include "studies/calibrate/known_calibration.h"
#include "studies/calibrate/point_table.h"
#include "studies/output/result_folder.h"
#include "studies/output/result_writer.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;
using Pixel = std::array<std::uint8_t, 3>;

constexpr Pixel kOrange = {255, 149, 0};
constexpr Pixel kBlack = {0, 0, 0};

/// A grey picture to draw on.
class Canvas {
 public:
  explicit Canvas(const ImageF& grey) : image_(grey.width(), grey.height()) {
    const float brightest = std::max(std::ranges::max(grey.values()), 1e-6F);
    for (std::size_t i = 0; i < grey.size(); ++i) {
      const auto code = static_cast<std::uint8_t>(
          std::lround(255.0F * std::clamp(grey.values()[i] / brightest, 0.0F, 1.0F)));
      image_.values()[i] = {code, code, code};
    }
  }

  /// Two crossed lines with a black rim, the middle left open.
  void cross(const Eigen::Vector2d& pixel_px) {
    const int reach = std::max(6, image_.width() / 80);
    const int thick = std::max(1, image_.width() / 1200);
    for (const int wide : {thick + 1, thick}) {
      for (int step = 2; step <= reach; ++step) {
        for (int side = -wide + 1; side < wide; ++side) {
          for (const int way : {-step, step}) {
            const Pixel colour = wide > thick ? kBlack : kOrange;
            put(pixel_px + Eigen::Vector2d(way, side), colour);
            put(pixel_px + Eigen::Vector2d(side, way), colour);
          }
        }
      }
    }
  }

  const ImageRgb& image() const { return image_; }

 private:
  void put(const Eigen::Vector2d& at, const Pixel& colour) {
    const double x = std::floor(at.x());
    const double y = std::floor(at.y());
    if (x >= 0.0 && y >= 0.0 && x < image_.width() && y < image_.height()) {
      image_(static_cast<int>(x), static_cast<int>(y)) = colour;
    }
  }

  ImageRgb image_;
};

/// base_from_camera of each picture.
std::vector<Eigen::Isometry3d> cameras_of(const KnownCalibration& known,
                                          const CalibrateOptions& options) {
  if (!known.mounting) {
    throw ConfigError(
        fmt::format("{}: was made without poses: where the camera is in the cell is not known",
                    known.file.string()));
  }
  if (*known.mounting == Mounting::kEyeToHand) {
    std::vector<Eigen::Isometry3d> all(options.pictures.size(), known.poses.hand_eye);
    return all;
  }
  if (options.poses.empty()) {
    throw ConfigError(
        "--poses: is missing; the camera is on the flange, so its place depends on them");
  }
  std::vector<Eigen::Isometry3d> cameras;
  for (const Eigen::Isometry3d& flange : poses_of_pictures(options)) {
    cameras.push_back(flange * known.poses.hand_eye);
  }
  return cameras;
}

std::vector<std::string> written_names(const std::vector<fs::path>& pictures) {
  std::vector<std::string> names = {"points.csv", "run.json"};
  std::set<std::string> seen;
  for (const fs::path& picture : pictures) {
    names.push_back(picture.stem().string() + ".png");
    if (!seen.insert(names.back()).second) {
      throw ConfigError(fmt::format(
          "{}: another picture of that name would be written to the same file", picture.string()));
    }
  }
  return names;
}

/// Draws the points of one picture. @return what result.json says of it
Json drawn(const std::vector<NamedPoint>& points,
           const PinholeCamera& camera,
           const Eigen::Isometry3d& base_from_camera,
           Canvas& canvas) {
  Json list = Json::array();
  for (const NamedPoint& point : points) {
    const auto pixel = camera.project(base_from_camera.inverse() * point.base_mm);
    const bool is_inside = pixel && pixel->x() >= 0.0 && pixel->y() >= 0.0 &&
                           pixel->x() <= camera.intrinsics().width_px &&
                           pixel->y() <= camera.intrinsics().height_px;
    if (is_inside) {
      canvas.cross(*pixel);
    }
    list.push_back({{"name", point.name},
                    {"pixel_px", pixel ? Json({pixel->x(), pixel->y()}) : Json(nullptr)},
                    {"is_in_picture", is_inside}});
  }
  return list;
}

std::string points_csv(const Json& pictures) {
  std::string text = csv_row_of("picture", "point", "x_px", "y_px", "in_picture");
  for (const Json& picture : pictures) {
    for (const Json& point : picture["points"]) {
      const Json& pixel = point["pixel_px"];
      const auto number = [&](std::size_t i) {
        return pixel.is_null() ? std::string() : shortest(pixel[i].get<double>());
      };
      // Not csv_row_of(), which would take the text of a number below 0 for a formula.
      text += csv_row(std::vector<std::string>{csv_plain_text(picture["file"].get<std::string>()),
                                               csv_plain_text(point["name"].get<std::string>()),
                                               number(0),
                                               number(1),
                                               point["is_in_picture"].get<bool>() ? "yes" : "no"});
    }
  }
  return text;
}

void check_size(const Picture& picture, const KnownCalibration& known, const fs::path& file) {
  if (picture.width() != known.intrinsics.width_px ||
      picture.height() != known.intrinsics.height_px) {
    throw ConfigError(fmt::format("{}: has {} x {} pixels, the camera of {} has {} x {}",
                                  file.string(),
                                  picture.width(),
                                  picture.height(),
                                  known.file.string(),
                                  known.intrinsics.width_px,
                                  known.intrinsics.height_px));
  }
}

}  // namespace

std::vector<NamedPoint> parse_points(std::string_view text, const std::string& file) {
  const PointTable table(text, file, "a table of points has name, x_mm, y_mm, z_mm");
  const std::size_t name = table.column("name");
  const std::array<std::size_t, 3> axes = {
      table.column("x_mm"), table.column("y_mm"), table.column("z_mm")};
  std::vector<NamedPoint> points;
  for (std::size_t i = 0; i < table.size(); ++i) {
    points.push_back({.name = table.field(i, name).text, .base_mm = table.point(i, axes)});
  }
  return points;
}

Json draw_points(const fs::path& points_file, const CalibrateOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  if (options.pictures.empty()) {
    throw ConfigError("PICTURES: there are none; give the pictures to draw into");
  }
  if (options.camera.empty()) {
    throw ConfigError("--camera: is missing; give a calibration.json or its folder");
  }
  check_sets_are_of_poses(options.sets);  // also where a camera beside the arm needs no poses
  const fs::path out =
      options.out.empty() ? folder_of_pictures(options.pictures, ResultKind::kPoints) : options.out;
  const std::vector<std::string> names = written_names(options.pictures);
  check_result_folder(out, ResultKind::kPoints, names);
  std::vector<fs::path> inputs = options.pictures;
  inputs.insert(inputs.end(), options.poses.begin(), options.poses.end());
  inputs.push_back(points_file);
  check_inputs_kept(inputs, out, names);
  const std::vector<fs::path> sources = {fs::absolute(options.pictures.front()).parent_path(),
                                         points_file};
  if (options.out.empty()) {
    check_source_of_folder(out, sources);
  }
  const std::vector<NamedPoint> points = parse_points(read_file(points_file), points_file.string());
  const KnownCalibration known = read_calibration(options.camera);
  const std::vector<Eigen::Isometry3d> cameras = cameras_of(known, options);
  const PinholeCamera camera(known.intrinsics);
  ResultWriter writer(out, ResultKind::kPoints);
  Json pictures = Json::array();
  for (std::size_t i = 0; i < options.pictures.size(); ++i) {
    const Picture picture = read_picture(options.pictures[i]);
    check_size(picture, known, options.pictures[i]);
    Canvas canvas(linear_values(picture.pixels));
    const Json list = drawn(points, camera, cameras[i], canvas);
    const std::string written = options.pictures[i].stem().string() + ".png";
    write_file(writer.path() / written, png_bytes(canvas.image()));
    pictures.push_back(
        {{"file", options.pictures[i].string()}, {"written", written}, {"points", list}});
  }
  write_file(writer.path() / "points.csv", points_csv(pictures));
  writer.finish({{"pictures", pictures.size()}, {"source", sources_seen_from(out, sources)}},
                start);
  return {{"schema", 1}, {"status", "done"}, {"pictures", pictures}, {"folder", out.string()}};
}

}  // namespace glint
