// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/opencv_methods.h"

#include <vector>

#include <opencv2/calib3d.hpp>

namespace glint {
namespace {

using Eigen::Isometry3d;

constexpr double kMetre = 1e-3;  // of a millimetre

constexpr std::array<std::string_view, 7> kNames = {
    "tsai", "park", "horaud", "andreff", "daniilidis", "shah", "li"};

/// Poses as OpenCV takes them: rotations and translations in metres.
struct CvPoses {
  void add(const Isometry3d& pose) {
    const cv::Matx33d turn(pose(0, 0),
                           pose(0, 1),
                           pose(0, 2),
                           pose(1, 0),
                           pose(1, 1),
                           pose(1, 2),
                           pose(2, 0),
                           pose(2, 1),
                           pose(2, 2));
    const Eigen::Vector3d at = kMetre * pose.translation();
    rotations.emplace_back(turn);
    translations.emplace_back(cv::Vec3d(at.x(), at.y(), at.z()));
  }

  std::vector<cv::Mat> rotations;
  std::vector<cv::Mat> translations;
};

Isometry3d from_opencv(const cv::Mat& rotation, const cv::Mat& translation) {
  Isometry3d pose = Isometry3d::Identity();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      pose.linear()(i, j) = rotation.at<double>(i, j);
    }
    pose.translation()[i] = translation.at<double>(i) / kMetre;
  }
  return pose;
}

cv::HandEyeCalibrationMethod opencv_method(HandEyeMethod method) {
  switch (method) {
    case HandEyeMethod::kPark:
      return cv::CALIB_HAND_EYE_PARK;
    case HandEyeMethod::kHoraud:
      return cv::CALIB_HAND_EYE_HORAUD;
    case HandEyeMethod::kAndreff:
      return cv::CALIB_HAND_EYE_ANDREFF;
    case HandEyeMethod::kDaniilidis:
      return cv::CALIB_HAND_EYE_DANIILIDIS;
    default:
      return cv::CALIB_HAND_EYE_TSAI;
  }
}

Isometry3d robot_world_hand_eye(HandEyeMethod method, const CvPoses& poses, const CvPoses& camera) {
  cv::Mat rotation;
  cv::Mat translation;
  cv::Mat ignored_rotation;
  cv::Mat ignored_translation;
  cv::calibrateRobotWorldHandEye(camera.rotations,
                                 camera.translations,
                                 poses.rotations,
                                 poses.translations,
                                 ignored_rotation,
                                 ignored_translation,
                                 rotation,
                                 translation,
                                 method == HandEyeMethod::kShah
                                     ? cv::CALIB_ROBOT_WORLD_HAND_EYE_SHAH
                                     : cv::CALIB_ROBOT_WORLD_HAND_EYE_LI);
  return from_opencv(rotation, translation).inverse();
}

/// @param robot  base_from_flange, or its inverse for a camera beside the robot
Isometry3d solve(HandEyeMethod method, std::span<const Isometry3d> robot, const CvPoses& camera) {
  const bool is_robot_world = method == HandEyeMethod::kShah || method == HandEyeMethod::kLi;
  CvPoses poses;
  for (const Isometry3d& pose : robot) {
    poses.add(is_robot_world ? pose.inverse() : pose);
  }
  cv::Mat rotation;
  cv::Mat translation;
  if (!is_robot_world) {
    cv::calibrateHandEye(poses.rotations,
                         poses.translations,
                         camera.rotations,
                         camera.translations,
                         rotation,
                         translation,
                         opencv_method(method));
    return from_opencv(rotation, translation);
  }
  return robot_world_hand_eye(method, poses, camera);
}

}  // namespace

std::string_view name_of(HandEyeMethod method) {
  return kNames[static_cast<std::size_t>(method)];
}

std::optional<HandEyeMethod> hand_eye_method(std::string_view name) {
  for (const HandEyeMethod method : kHandEyeMethods) {
    if (name_of(method) == name) {
      return method;
    }
  }
  return std::nullopt;
}

std::optional<HandEye> hand_eye_by(HandEyeMethod method,
                                   Mounting mounting,
                                   std::span<const PosePair> pairs) {
  std::vector<Isometry3d> robot;
  CvPoses camera;
  for (const PosePair& pair : pairs) {
    robot.push_back(mounting == Mounting::kEyeInHand ? pair.base_from_flange
                                                     : pair.base_from_flange.inverse());
    camera.add(pair.camera_from_board);
  }
  HandEye result;
  try {
    result.hand_eye = solve(method, robot, camera);
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
  if (!result.hand_eye.matrix().allFinite() || result.hand_eye.linear().determinant() < 0.5) {
    return std::nullopt;
  }
  result.hand_eye.linear() = nearest_rotation(result.hand_eye.linear());
  std::vector<Isometry3d> boards;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    boards.push_back(robot[i] * result.hand_eye * pairs[i].camera_from_board);
  }
  result.board = mean_pose(boards);
  return result;
}

}  // namespace glint
