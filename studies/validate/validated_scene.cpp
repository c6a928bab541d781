// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/validated_scene.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "core/error.h"
#include "core/units.h"
#include "studies/compare/camera/scene_camera.h"
#include "studies/definition/scene_viewpoints.h"
#include "studies/imaging/scene_picture.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

// What is taken where nothing is told: a careful calibration by hand.
constexpr double kUnknownRotationRad = 0.02 * kPi / 180.0;
constexpr double kUnknownPositionMm = 0.05;
constexpr double kUnknownFocal = 5e-4;   ///< share of the focal length
constexpr double kUnknownCentre = 5e-4;  ///< share of the picture's width
constexpr double kUnknownRadial = 0.01;  ///< of k1
constexpr double kUnknownTangential = 1e-4;
constexpr double kUnseenTangential = 5e-4;  ///< of p1 and p2 that a calibration left at zero

/// The number at the end of a name: "view_03" and "03" give 3.
std::optional<std::size_t> number_of(const std::string& name) {
  const std::size_t last = name.find_last_not_of("0123456789");
  const std::size_t begin = last == std::string::npos ? 0 : last + 1;
  const std::string head = name.substr(0, begin);
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(name.data() + begin, name.data() + name.size(), number);
  if (error != std::errc() || number == 0 || !(head.empty() || head.ends_with("_"))) {
    return std::nullopt;
  }
  return number;
}

bool can_place(const SceneSettings& scene) {
  return scene.calibration && scene.cell &&
         ((scene.calibration->flange_from_camera && scene.cell->base_from_part) ||
          (scene.calibration->base_from_camera && scene.cell->flange_from_part));
}

Viewpoint placed(const SceneSettings& scene, const RigidTransform& base_from_flange) {
  const PoseSettings pose = pose_settings(base_from_flange);
  Viewpoint viewpoint = viewpoint_of_pose(inverse(scene_from_camera(scene, pose)));
  viewpoint.base_from_flange = pose;
  return viewpoint;
}

const MeasuredPoseSettings* placement_of(const SceneSettings& scene) {
  if (!scene.cell) {
    return nullptr;
  }
  return scene.cell->base_from_part     ? &*scene.cell->base_from_part
         : scene.cell->flange_from_part ? &*scene.cell->flange_from_part
                                        : nullptr;
}

/// How well a pose is known.
struct PoseSigma {
  Eigen::Matrix<double, 6, 1> sigma;  ///< rotation [rad] before position [mm]
  int guessed = 0;                    ///< so many of them are not told
};

/// A number that is 0 is not known: a guess takes its place. @param pose  nullptr: all are guessed
PoseSigma sigma_of(const MeasuredPoseSettings* pose) {
  PoseSigma known;
  for (Eigen::Index i = 0; i < 6; ++i) {
    const bool is_angle = i < 3;
    const auto axis = static_cast<std::size_t>(i % 3);
    const double told = pose == nullptr ? 0.0
                        : is_angle      ? pose->sigma_rad[axis]
                                        : pose->sigma_mm[axis];
    const double guess = is_angle ? kUnknownRotationRad : kUnknownPositionMm;
    known.sigma[i] = told > 0.0 ? told : guess;
    known.guessed += told > 0.0 ? 0 : 1;
  }
  return known;
}

/// Of the guesses, if there are any. @param what  "the part's place"
void note_guesses(const PoseSigma& known, const char* what, std::vector<std::string>& notes) {
  if (known.guessed > 0) {
    notes.push_back(
        fmt::format("How well {} is known is {}: {}0.05 mm and 0.02 degree are assumed.",
                    what,
                    known.guessed < 6 ? "stated in part" : "not stated",
                    known.guessed < 6 ? "of the rest " : ""));
  }
}

void guess_lens(const PinholeIntrinsics& in, GeometryBudget& budget) {
  const double focal = kUnknownFocal * in.focal_px.x();
  const double centre = kUnknownCentre * in.width_px;
  const Eigen::Matrix<double, 9, 1> sigma = (Eigen::Matrix<double, 9, 1>() << focal,
                                             focal,
                                             centre,
                                             centre,
                                             kUnknownRadial,
                                             0.0,
                                             0.0,
                                             kUnknownTangential,
                                             kUnknownTangential)
                                                .finished();
  budget.camera.topLeftCorner<9, 9>() = sigma.cwiseAbs2().asDiagonal();
}

const MeasuredPoseSettings* hand_eye_of(const SceneSettings& scene) {
  if (!scene.calibration) {
    return nullptr;
  }
  const CalibrationSettings& known = *scene.calibration;
  return known.flange_from_camera ? &*known.flange_from_camera
         : known.base_from_camera ? &*known.base_from_camera
                                  : nullptr;
}

/// What [calibration.covariance] says.
struct KnownTogether {
  bool has_lens = false;
  bool has_hand_eye = false;
};

/// Takes the place of the budget's guesses.
KnownTogether take_covariance(const SceneSettings& scene, GeometryBudget& budget) {
  if (!scene.calibration || !scene.calibration->covariance) {
    return {};
  }
  const CovarianceSettings& settings = *scene.calibration->covariance;
  const KnownTogether known = {.has_lens = !settings.intrinsics.empty(),
                               .has_hand_eye = !settings.hand_eye.empty()};
  const Eigen::MatrixXd covariance = covariance_of(settings);
  if (known.has_lens && known.has_hand_eye) {
    budget.camera = covariance;
  } else if (known.has_lens) {
    budget.camera.topLeftCorner<9, 9>() = covariance.topLeftCorner<9, 9>();
  } else if (known.has_hand_eye) {
    budget.camera.bottomRightCorner<6, 6>() = covariance.bottomRightCorner<6, 6>();
  }
  return known;
}

/// A lens has some p1 and p2. A calibration that leaves them at zero has seen them as a turn of the
/// camera by 2 p1 about x, -2 p2 about y and a centre off by f (r^2 - 2) (p2, p1), r^2 the mean
/// square of the distance from the axis: x^2 + y^2 - r^2 times f p is all that they differ by.
void add_unseen(const PinholeIntrinsics& in, GeometryBudget& budget) {
  constexpr std::array<Eigen::Index, 2> kNumbers = {7, 8};
  constexpr std::array<Eigen::Index, 2> kCentres = {3, 2};
  constexpr std::array<double, 2> kTurns = {-2.0, 2.0};  // about x, about y: back to the truth
  for (std::size_t i = 0; i < 2; ++i) {
    if (budget.camera(kNumbers[i], kNumbers[i]) > 0.0 || in.tangential[i] != 0.0) {
      continue;
    }
    const double focal_px = in.focal_px[1 - static_cast<Eigen::Index>(i)];
    const double square = (std::pow(in.width_px, 2) + std::pow(in.height_px, 2)) /
                          (12.0 * in.focal_px.x() * in.focal_px.y());
    const auto column = static_cast<Eigen::Index>(i);
    budget.unseen(kNumbers[i], column) = kUnseenTangential;
    budget.unseen(kCentres[i], column) = kUnseenTangential * focal_px * (2.0 - square);
    budget.unseen(9 + column, column) = kUnseenTangential * kTurns[i];
  }
}

}  // namespace

void take_calibration(const fs::path& file, SceneSettings& scene) {
  const SceneSettings calibrated = read_calibrated_scene(file);
  const PinholeIntrinsics now = intrinsics_of(scene);
  const PinholeIntrinsics in = intrinsics_of(calibrated);
  if (in.width_px != now.width_px || in.height_px != now.height_px) {
    throw ConfigError(fmt::format("{}: is of pictures of {} x {} pixels, the design's have {} x {}",
                                  file.string(),
                                  in.width_px,
                                  in.height_px,
                                  now.width_px,
                                  now.height_px));
  }
  put_intrinsics(in, scene);
  if (calibrated.calibration) {
    scene.calibration = calibrated.calibration;
  }
  if (calibrated.cell) {
    scene.cell = calibrated.cell;
  }
}

SceneSettings exposed_as_acquired(SceneStore& store,
                                  const SceneSettings& scene,
                                  const std::string& name,
                                  std::vector<std::string>& notes) {
  try {
    return with_equal_exposure(store, scene);
  } catch (const ConfigError& error) {
    notes.push_back(fmt::format("{}: compared at its sensor.exposure: {}", name, error.what()));
  }
  SceneSettings plain = scene;
  plain.expose_to = 0.0;
  return plain;
}

std::vector<Viewpoint> viewpoints_of_pictures(const RealDesign& design,
                                              const SceneSettings& scene,
                                              const std::vector<Viewpoint>& viewpoints) {
  std::vector<Viewpoint> result;
  for (const RealView& view : design.views) {
    if (view.base_from_flange && can_place(scene)) {
      result.push_back(placed(scene, *view.base_from_flange));
      continue;
    }
    const auto number = number_of(view.name);
    if (number && *number <= viewpoints.size()) {
      result.push_back(viewpoints[*number - 1]);
    } else if (viewpoints.size() == 1 && design.views.size() == 1) {
      result.push_back(viewpoints.front());
    } else {
      throw ConfigError(fmt::format(
          "{}: is of no view of the design {}, which has {}: name pictures view_01, view_02, ..., "
          "or give their poses in acquired.json",
          view.picture.string(),
          design.name,
          viewpoints.size()));
    }
  }
  return result;
}

GeometryBudget budget_of(const SceneSettings& scene, std::vector<std::string>& notes) {
  GeometryBudget budget;
  guess_lens(intrinsics_of(scene), budget);
  const PoseSigma hand_eye = sigma_of(hand_eye_of(scene));
  budget.camera.bottomRightCorner<6, 6>() = hand_eye.sigma.cwiseAbs2().asDiagonal();
  const KnownTogether together = take_covariance(scene, budget);
  if (!together.has_lens && !together.has_hand_eye) {
    notes.emplace_back(
        "The scene has no [calibration.covariance]: errors of lens and hand-eye are guessed "
        "(0.05 mm, 0.02 degree, focal length to 0.05 %).");
  } else {
    add_unseen(intrinsics_of(scene), budget);
  }
  if (together.has_lens && !together.has_hand_eye) {
    note_guesses(hand_eye, "the camera's place", notes);
  } else if (together.has_hand_eye && !together.has_lens) {
    notes.emplace_back(
        "How well the lens is known is not stated: a focal length known to 0.05 % is assumed.");
  }
  const PoseSigma placement = sigma_of(placement_of(scene));
  budget.part_sigma = placement.sigma;
  note_guesses(placement, "the part's place", notes);
  return budget;
}

void put_lens_change(const GeometryFit& fit, SceneSettings& scene) {
  PinholeIntrinsics in = intrinsics_of(scene);
  in.focal_px += fit.lens.head<2>();
  in.center_px += fit.lens.segment<2>(2);
  for (std::size_t i = 0; i < 3; ++i) {
    in.radial[i] += fit.lens[static_cast<Eigen::Index>(i) + 4];
  }
  in.tangential[0] += fit.lens[7];
  in.tangential[1] += fit.lens[8];
  put_intrinsics(in, scene);
}

}  // namespace glint
