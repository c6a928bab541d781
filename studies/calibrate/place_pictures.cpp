// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/place_pictures.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "core/error.h"
#include "hardware/calibration/camera_bundle.h"
#include "hardware/placement/first_placement.h"
#include "studies/calibrate/known_calibration.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

/// Rows of a calibration's covariance: intrinsics and hand-eye, and with the board.
constexpr Index kWithHandEye = 15;
constexpr Index kWithBoard = 21;

/// A calibration with what places a part.
struct PlacingRig {
  KnownCalibration known;
  PlacingCamera camera;
};

PlacingRig rig_of(const CalibrateOptions& options) {
  if (options.camera.empty()) {
    throw ConfigError("--camera: is missing; give a calibration.json or its folder");
  }
  PlacingRig rig{.known = read_calibration(options.camera)};
  const KnownCalibration& known = rig.known;
  if (!known.mounting) {
    throw ConfigError(
        fmt::format("{}: was made without poses: where the camera is in the cell is not known",
                    known.file.string()));
  }
  rig.camera = {.mounting = *known.mounting,
                .lens = lens_vector(known.intrinsics),
                .hand_eye = known.poses.hand_eye,
                .robot_rad = known.noise.robot_rad,
                .robot_mm = known.noise.robot_mm};
  const Index told = std::min<Index>(known.covariance.rows(), kWithHandEye);
  rig.camera.covariance.topLeftCorner(told, told) = known.covariance.topLeftCorner(told, told);
  return rig;
}

/// Closed forms do not say how well they know the hand-eye, nor does a covariance with a number
/// missing. With a hand-eye taken for exact the place would get sigmas far too small: it gets none.
/// @param rows  of the covariance that the placement needs
void state_no_sigma(const PlacingRig& rig, Index rows, Placement& placement) {
  if (rig.known.covariance.rows() >= rows) {
    return;
  }
  placement.placed.covariance.setZero();
  const std::string& closed_form = rig.known.closed_form;
  placement.why_unknown =
      fmt::format("the calibration{} does not say how well its hand-eye is known",
                  closed_form.empty() ? "" : " by " + closed_form);
}

bool is_in_hand(const PlacingRig& rig) {
  return rig.camera.mounting == Mounting::kEyeInHand;
}

/// base_from_flange of pictures; where the camera is in the cell they do not matter.
std::vector<Isometry3d> flanges_of(const PlacingRig& rig, const CalibrateOptions& options) {
  if (!is_in_hand(rig)) {
    std::vector<Isometry3d> unused(options.pictures.size(), Isometry3d::Identity());
    return unused;
  }
  if (options.poses.empty()) {
    throw ConfigError(
        "--poses: is missing; the camera is on the flange, so what it sees depends on them");
  }
  return poses_of_pictures(options);
}

/// Points of a picture beside edges are two edges.
void add_point(const SeenPoint& point, bool has_edges, PartPicture& picture) {
  const auto add = [&](const Eigen::Vector2d* normal) {
    picture.part_mm.push_back(point.part_mm);
    picture.picture_px.push_back(point.pixel_px);
    if (normal != nullptr) {
      picture.normals.push_back(*normal);
    }
  };
  if (!has_edges) {
    add(nullptr);
  } else if (point.normal.has_value()) {
    add(&*point.normal);
  } else {
    const Eigen::Vector2d x = Eigen::Vector2d::UnitX();
    const Eigen::Vector2d y = Eigen::Vector2d::UnitY();
    add(&x);
    add(&y);
  }
}

/// The points by picture, in the order of the options' pictures.
std::vector<PartPicture> part_pictures(const std::vector<SeenPoint>& points,
                                       const std::vector<fs::path>& pictures,
                                       const std::vector<Isometry3d>& flanges) {
  std::vector<PartPicture> result(pictures.size());
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    result[i].base_from_flange = flanges[i];
    const auto is_here = [&](const SeenPoint& point) { return point.picture == pictures[i]; };
    const bool has_edges = std::ranges::any_of(
        points, [&](const SeenPoint& point) { return is_here(point) && point.normal.has_value(); });
    for (const SeenPoint& point : points) {
      if (is_here(point)) {
        add_point(point, has_edges, result[i]);
      }
    }
  }
  return result;
}

std::vector<PartRay> rays_of(const PlacingRig& rig, const std::vector<PartPicture>& pictures) {
  const PinholeCamera camera(rig.known.intrinsics);
  std::vector<PartRay> rays;
  for (const PartPicture& picture : pictures) {
    const Isometry3d base_from_camera =
        (is_in_hand(rig) ? picture.base_from_flange : Isometry3d::Identity()) * rig.camera.hand_eye;
    for (std::size_t i = 0; i < picture.part_mm.size(); ++i) {
      if (const auto direction = camera.ray_through(picture.picture_px[i])) {
        rays.push_back({.part_mm = picture.part_mm[i],
                        .origin_mm = base_from_camera.translation(),
                        .direction = base_from_camera.linear() * *direction});
      }
    }
  }
  return rays;
}

/// The best of the refined solutions.
std::optional<PlacedPart> refined(const PlacingRig& rig,
                                  const std::vector<PartPicture>& pictures,
                                  const std::vector<Isometry3d>& starts,
                                  double sigma_px) {
  std::optional<PlacedPart> best;
  for (const Isometry3d& start : starts) {
    const auto placed = place_by_pictures(rig.camera, pictures, start, sigma_px);
    if (placed.has_value() && (!best.has_value() || placed->rms < best->rms)) {
      best = placed;
    }
  }
  return best;
}

/// What is measured beyond what is looked for: rows less the part's six numbers and, where the
/// robot errs, six a picture.
double surplus_of(const PlacingRig& rig, const std::vector<PartPicture>& pictures) {
  const bool errs = is_in_hand(rig) && (rig.camera.robot_mm > 0.0 || rig.camera.robot_rad > 0.0);
  double surplus = -6.0;
  for (const PartPicture& picture : pictures) {
    const double rows =
        (picture.normals.empty() ? 2.0 : 1.0) * static_cast<double>(picture.part_mm.size());
    surplus += errs ? std::max(rows - 6.0, 0.0) : rows;
  }
  return surplus;
}

struct PlacedBySigma {
  std::optional<PlacedPart> placed;
  double sigma_px = 0.0;
  bool is_assumed = false;  ///< neither told nor measured
};

/// Where sigma is not told it is taken from what remains, with which the weights change.
PlacedBySigma placed_by_pictures(const PlacingRig& rig,
                                 const std::vector<PartPicture>& pictures,
                                 double told_px) {
  constexpr double kAssumedPx = 0.5;
  constexpr double kEnough = 4.0;
  constexpr double kFinestPx = 0.01;
  const std::vector<Isometry3d> starts = first_placements(rays_of(rig, pictures));
  const double surplus = surplus_of(rig, pictures);
  PlacedBySigma result{.sigma_px = told_px > 0.0 ? told_px : kAssumedPx,
                       .is_assumed = !(told_px > 0.0) && surplus < kEnough};
  result.placed = refined(rig, pictures, starts, result.sigma_px);
  double count = 0.0;
  for (const PartPicture& picture : pictures) {
    count += static_cast<double>(picture.part_mm.size());
  }
  for (int round = 0; round < 4 && result.placed && told_px <= 0.0 && !result.is_assumed; ++round) {
    result.sigma_px = std::max(kFinestPx, result.placed->rms * std::sqrt(count / surplus));
    result.placed = refined(rig, pictures, {result.placed->base_from_part}, result.sigma_px);
  }
  return result;
}

/// Distances with the robot's poses as they were told.
Json distances_json(const PlacingRig& rig,
                    const std::vector<SeenPoint>& points,
                    const std::vector<fs::path>& pictures,
                    const std::vector<Isometry3d>& flanges,
                    const Isometry3d& base_from_part) {
  Json list = Json::array();
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const Isometry3d camera_from_part =
        (flanges[i] * rig.camera.hand_eye).inverse() * base_from_part;
    for (const SeenPoint& point : points) {
      if (point.picture != pictures[i]) {
        continue;
      }
      const auto pixel =
          project_by_lens(rig.camera.lens, camera_from_part * point.part_mm, nullptr);
      Json distance = nullptr;
      if (pixel.has_value()) {
        const Eigen::Vector2d off = point.pixel_px - *pixel;
        distance = point.normal ? std::abs(point.normal->dot(off)) : off.norm();
      }
      list.push_back({{"name", point.name}, {"picture", point.picture}, {"distance_px", distance}});
    }
  }
  return list;
}

// --- A board on the part -------------------------------------------------------------------------

/// As the calibration saw it.
Placement board_of_calibration(const PlacingRig& rig) {
  Placement board{.placed = {.base_from_part = rig.known.poses.board},
                  .is_on_flange = !is_in_hand(rig),
                  .told = {{"by", "board"}, {"rms_px", nullptr}}};
  if (rig.known.covariance.rows() == kWithBoard) {
    board.placed.covariance = rig.known.covariance.bottomRightCorner<6, 6>();
  }
  return board;
}

/// The corners of each accepted picture as points of a part that is the board. A board that looks
/// the same when it is turned lies as it was detected in the first picture.
std::vector<PartPicture> board_pictures(const PlacingRig& rig,
                                        const CalibrateInput& input,
                                        const std::vector<Isometry3d>& flanges) {
  BoardSymmetry symmetry{.turns = num_symmetries(input.board)};
  symmetry.center_mm.head<2>() =
      0.5 * input.board.square_mm * Eigen::Vector2d(input.board.cols - 1, input.board.rows - 1);
  std::vector<PartPicture> pictures;
  std::optional<Isometry3d> first;
  for (std::size_t i = 0; i < input.corners.size(); ++i) {
    const auto fitted = input.corners[i].board_mm.empty()
                            ? std::nullopt
                            : fit_view(input.corners[i], rig.camera.lens);
    if (!fitted.has_value()) {
      continue;
    }
    const Isometry3d seen = flanges[i] * rig.camera.hand_eye *
                            pose_of(camera_bundle(rig.camera.lens, {}), fitted->view);
    first = first.value_or(seen);
    const auto off = [&](int turn) {
      return angle_rad((seen * board_turn(symmetry, turn)).linear().transpose() * first->linear());
    };
    int best = 0;
    for (int turn = 1; turn < symmetry.turns; ++turn) {
      best = off(turn) < off(best) ? turn : best;
    }
    PartPicture& picture = pictures.emplace_back();
    picture.base_from_flange = flanges[i];
    picture.picture_px = input.corners[i].picture_px;
    for (const Vector3d& corner : input.corners[i].board_mm) {
      picture.part_mm.push_back(board_turn(symmetry, best).inverse() * corner);
    }
  }
  return pictures;
}

/// As new pictures see it.
Placement board_in_pictures(const PlacingRig& rig, const CalibrateOptions& options) {
  CalibrateOptions reading = options;
  reading.camera.clear();
  reading.known_board = rig.known.board;
  reading.known_given = rig.known.given_board;
  const std::vector<Isometry3d> flanges = flanges_of(rig, options);
  if (!is_in_hand(rig) && !reading.poses.empty()) {
    reading.poses.clear();
    reading.sets.clear();  // place_run.cpp leaves those of poses alone
  }
  ThreadPool pool(options.threads);
  const CalibrateInput input = read_calibrate_input(reading, pool);
  const std::vector<PartPicture> pictures = board_pictures(rig, input, flanges);
  // Errors that neighbouring corners share are those that a pose cannot tell from a movement.
  const PlacedBySigma found = placed_by_pictures(rig, pictures, rig.known.noise.whole_pattern_px());
  if (!found.placed.has_value()) {
    throw ConfigError("PICTURES: the board's place cannot be found in them");
  }
  Placement board{
      .placed = *found.placed,
      .told = {{"by", "board"}, {"pictures", pictures.size()}, {"rms_px", found.placed->rms}}};
  if (num_symmetries(input.board) > 1) {
    board.told["note"] =
        "the board looks the same when it is turned: it lies as in the first picture";
  }
  return board;
}

}  // namespace

Placement place_by_seen_points(const std::vector<SeenPoint>& points,
                               const fs::path& file,
                               const CalibrateOptions& options,
                               double sigma_px) {
  const PlacingRig rig = rig_of(options);
  CalibrateOptions reading = options;
  reading.pictures.clear();
  for (const SeenPoint& point : points) {
    if (std::ranges::count(reading.pictures, fs::path(point.picture)) == 0) {
      reading.pictures.emplace_back(point.picture);
    }
  }
  const std::vector<Isometry3d> flanges = flanges_of(rig, reading);
  const std::vector<PartPicture> pictures = part_pictures(points, reading.pictures, flanges);
  const PlacedBySigma found = placed_by_pictures(rig, pictures, sigma_px);
  if (!found.placed.has_value()) {
    throw ConfigError(
        fmt::format("{}: its points leave the part's place open: it needs 4 that are not in one "
                    "plane, or 3 in two pictures from different sides",
                    file.string()));
  }
  Placement placement{.placed = *found.placed};
  placement.told = {
      {"by", "pictures"},
      {"pictures", reading.pictures.size()},
      {"rms_px", found.placed->rms},
      {"point_sigma_px", found.sigma_px},
      {"point_sigma",
       found.is_assumed ? "assumed"
       : sigma_px > 0.0 ? "told"
                        : "measured"},
      {"points",
       distances_json(rig, points, reading.pictures, flanges, found.placed->base_from_part)}};
  state_no_sigma(rig, kWithHandEye, placement);
  return placement;
}

Placement place_by_seen_board(const BoardOffset& offset, const CalibrateOptions& options) {
  const PlacingRig rig = rig_of(options);
  Placement board =
      options.pictures.empty() ? board_of_calibration(rig) : board_in_pictures(rig, options);
  const double rms = board.placed.rms;
  board.placed = place_by_board(board.placed.base_from_part,
                                board.placed.covariance + offset.board_covariance,
                                offset.board_from_part,
                                offset.part_covariance);
  board.placed.rms = rms;
  state_no_sigma(rig, options.pictures.empty() ? kWithBoard : kWithHandEye, board);
  return board;
}

}  // namespace glint
