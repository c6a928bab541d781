// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/poses/pose_convention.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/SVD>

#include "core/text.h"
#include "core/units.h"

namespace glint {
namespace {

constexpr std::array<std::string_view, 3> kUnits = {"auto", "mm", "m"};
constexpr std::array<std::string_view, 3> kDirections = {
    "auto", "base_from_flange", "flange_from_base"};
constexpr std::array<std::string_view, 6> kRotations = {
    "auto", "matrix", "quaternion_wxyz", "quaternion_xyzw", "rotation_vector", "euler"};
constexpr std::array<std::string_view, 3> kAngles = {"auto", "rad", "deg"};
constexpr double kMostFromRotation = 0.01;  ///< of an element of R R^T - 1; rounding leaves 1e-3
constexpr double kMostReachInMetres = 10.0;
constexpr double kLeastReachInMm = 10.0;
constexpr double kLargestNumber = 1e6;  ///< of a pose: no robot reaches a kilometre
constexpr double kFullTurnRad = 2.0 * kPi;

template <class Enum, std::size_t N>
std::string_view name_of(Enum value, const std::array<std::string_view, N>& names) {
  return names[static_cast<std::size_t>(value)];
}

bool is_matrix(const WrittenPose& pose) {
  return pose.numbers.size() == 12 || pose.numbers.size() == 16;
}

std::size_t count_for(PoseRotation rotation) {
  switch (rotation) {
    case PoseRotation::kQuaternionWxyz:
    case PoseRotation::kQuaternionXyzw:
      return 7;
    case PoseRotation::kRotationVector:
    case PoseRotation::kEuler:
      return 6;
    default:
      return 16;
  }
}

bool has_angles(PoseRotation rotation) {
  return rotation == PoseRotation::kRotationVector || rotation == PoseRotation::kEuler;
}

Eigen::Vector3d position_of(const WrittenPose& pose) {
  const auto& n = pose.numbers;
  return is_matrix(pose) ? Eigen::Vector3d(n[3], n[7], n[11]) : Eigen::Vector3d(n[0], n[1], n[2]);
}

/// Of all poses, in their unit.
double median_reach(std::span<const WrittenPose> poses) {
  std::vector<double> reaches;
  for (const WrittenPose& pose : poses) {
    reaches.push_back(position_of(pose).norm());
  }
  const auto middle = reaches.begin() + static_cast<std::ptrdiff_t>(reaches.size() / 2);
  std::ranges::nth_element(reaches, middle);
  return *middle;
}

/// The largest of the three last numbers.
double largest_angle(std::span<const WrittenPose> poses) {
  double largest = 0.0;
  for (const WrittenPose& pose : poses) {
    for (std::size_t k = 3; k < 6; ++k) {
      largest = std::max(largest, std::abs(pose.numbers[k]));
    }
  }
  return largest;
}

/// The place of the first pose that a test holds for.
template <class Test>
Place place_where(std::span<const WrittenPose> poses, const Test& test) {
  const auto found = std::ranges::find_if(poses, test);
  return found == poses.end() ? Place{} : found->place;
}

void check_count(const WrittenPose& pose) {
  const std::size_t count = pose.numbers.size();
  if (count != 6 && count != 7 && count != 12 && count != 16) {
    refuse_key(
        pose.place,
        "pose",
        fmt::format("has {} numbers, must be 6 (position and rotation vector or Euler angles), 7 "
                    "(position and quaternion), 12 or 16 (matrix, row by row)",
                    count));
  }
}

void check_numbers(std::span<const WrittenPose> poses) {
  std::vector<Problem> errors;
  const std::size_t count = poses.front().numbers.size();
  for (const WrittenPose& pose : poses) {
    const auto bad = std::ranges::find_if_not(
        pose.numbers, [](double v) { return std::abs(v) <= kLargestNumber; });
    if (bad != pose.numbers.end()) {
      errors.push_back({.place = pose.place,
                        .key = "pose",
                        .text = fmt::format("number {} is {}, all must lie between -{} and {}",
                                            bad - pose.numbers.begin() + 1,
                                            shortest(*bad),
                                            kLargestNumber,
                                            kLargestNumber)});
    } else if (pose.numbers.size() != count) {
      errors.push_back({.place = pose.place,
                        .key = "pose",
                        .text = fmt::format(
                            "has {} numbers, the first pose has {}", pose.numbers.size(), count)});
    }
  }
  throw_if_any(errors);
  check_count(poses.front());
}

void check_rotation(PoseRotation rotation, const WrittenPose& pose) {
  const std::size_t count = pose.numbers.size();
  const std::size_t wanted = count_for(rotation);
  if (wanted != count && !(wanted == 16 && count == 12)) {
    refuse_key(pose.place,
               "rotation",
               fmt::format("is \"{}\", which needs {} numbers a pose, but there are {}",
                           name_of(rotation, kRotations),
                           wanted == 16 ? "12 or 16" : fmt::format("{}", wanted),
                           count));
  }
}

void resolve_rotation(std::span<const WrittenPose> poses, ResolvedConvention& resolved) {
  PoseRotation& rotation = resolved.convention.rotation;
  const std::size_t count = poses.front().numbers.size();
  if (rotation != PoseRotation::kAuto) {
    check_rotation(rotation, poses.front());
    return;
  }
  if (count >= 12) {
    rotation = PoseRotation::kMatrix;
    return;  // nothing else has so many numbers
  }
  rotation = count == 7 ? PoseRotation::kQuaternionXyzw : PoseRotation::kRotationVector;
  const bool is_far = count == 6 && resolved.convention.angle != PoseAngle::kRadian &&
                      largest_angle(poses) > kFullTurnRad;
  if (is_far) {
    rotation = PoseRotation::kEuler;
  }
  resolved.told.push_back(fmt::format(
      "rotation = \"{}\"{}: guessed from {} numbers a pose",
      name_of(rotation, kRotations),
      is_far ? fmt::format(" in the order \"{}\"", resolved.convention.euler_order) : "",
      count));
}

/// Radians that are too large, degrees that are too small. @param largest  of all angles
void check_angle(std::span<const WrittenPose> poses, PoseAngle angle, double largest) {
  if (angle == PoseAngle::kRadian && largest > kFullTurnRad) {
    const auto is_largest = [&](const WrittenPose& pose) {
      return largest_angle({&pose, 1}) == largest;
    };
    refuse_key(
        place_where(poses, is_largest),
        "angle",
        fmt::format("is \"rad\", but an angle is {}, more than a whole turn: are they degrees? "
                    "allowed is angle = \"deg\"",
                    shortest(largest)));
  }
  constexpr double kLooksLikeRadians = 3.2;
  if (angle == PoseAngle::kDegree && poses.size() > 2 && largest < kLooksLikeRadians) {
    refuse_key(
        poses.front().place,
        "angle",
        fmt::format("is \"deg\", but no angle is above {}: are they radians? allowed is angle = "
                    "\"rad\"",
                    shortest(largest)));
  }
}

void resolve_angle(std::span<const WrittenPose> poses, ResolvedConvention& resolved) {
  PoseAngle& angle = resolved.convention.angle;
  if (!has_angles(resolved.convention.rotation)) {
    angle = PoseAngle::kRadian;  // there are none
    return;
  }
  const double largest = largest_angle(poses);
  if (angle == PoseAngle::kAuto) {
    angle = largest > kFullTurnRad ? PoseAngle::kDegree : PoseAngle::kRadian;
    resolved.told.push_back(fmt::format("angle = \"{}\": guessed, the largest angle is {}",
                                        name_of(angle, kAngles),
                                        shortest(largest)));
    return;
  }
  check_angle(poses, angle, largest);
}

void resolve_unit(std::span<const WrittenPose> poses, ResolvedConvention& resolved) {
  PoseUnit& unit = resolved.convention.unit;
  const double reach = median_reach(poses);
  if (unit == PoseUnit::kAuto) {
    unit = reach < kMostReachInMetres ? PoseUnit::kMetre : PoseUnit::kMillimetre;
    resolved.told.push_back(
        fmt::format("unit = \"{}\": guessed, the flange is {:.3g} from the base (median)",
                    name_of(unit, kUnits),
                    reach));
  } else if (unit == PoseUnit::kMillimetre && reach < kLeastReachInMm) {
    refuse_key(
        poses.front().place,
        "unit",
        fmt::format("is \"mm\", but the flange is {:.3g} from the base (median): are they metres? "
                    "allowed is unit = \"m\"",
                    reach));
  } else if (unit == PoseUnit::kMetre && reach > kMostReachInMetres) {
    refuse_key(
        poses.front().place,
        "unit",
        fmt::format("is \"m\", but the flange is {:.3g} from the base (median): are they mm? "
                    "allowed is unit = \"mm\"",
                    reach));
  }
}

/// The rotation nearest to a matrix, where it is one to rounding.
Eigen::Matrix3d checked_rotation(const Eigen::Matrix3d& matrix, const Place& place) {
  const double off =
      (matrix * matrix.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= kMostFromRotation)) {
    refuse_key(
        place,
        "pose",
        fmt::format("its matrix is no rotation: rows times rows differ from 1 by {:.3g}, at most "
                    "{} is allowed",
                    off,
                    kMostFromRotation));
  }
  if (matrix.determinant() < 0.0) {
    refuse_key(
        place, "pose", "its matrix is no rotation but a mirror: the determinant is -1, must be 1");
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

Eigen::Matrix3d matrix_rotation(const WrittenPose& pose) {
  const auto& n = pose.numbers;
  if (n.size() == 16) {
    const double off = std::abs(n[12]) + std::abs(n[13]) + std::abs(n[14]) + std::abs(n[15] - 1.0);
    if (off > 1e-9) {
      refuse_key(pose.place, "pose", "the last row of its matrix must be 0, 0, 0, 1");
    }
  }
  Eigen::Matrix3d matrix;
  matrix << n[0], n[1], n[2], n[4], n[5], n[6], n[8], n[9], n[10];
  return checked_rotation(matrix, pose.place);
}

Eigen::Matrix3d quaternion_rotation(const WrittenPose& pose, bool is_w_first) {
  const auto& n = pose.numbers;
  const Eigen::Quaterniond quaternion = is_w_first ? Eigen::Quaterniond(n[3], n[4], n[5], n[6])
                                                   : Eigen::Quaterniond(n[6], n[3], n[4], n[5]);
  if (!(std::abs(quaternion.norm() - 1.0) <= kMostFromRotation)) {
    refuse_key(pose.place,
               "pose",
               fmt::format("its quaternion has the length {:.4g}, must be 1", quaternion.norm()));
  }
  return quaternion.normalized().toRotationMatrix();
}

Eigen::Matrix3d vector_rotation(const Eigen::Vector3d& vector_rad) {
  const double angle = vector_rad.norm();
  if (angle < 1e-300) {
    return Eigen::Matrix3d::Identity();
  }
  return Eigen::AngleAxisd(angle, vector_rad / angle).toRotationMatrix();
}

Eigen::Matrix3d euler_rotation(const Eigen::Vector3d& angles_rad, const std::string& order) {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(order[static_cast<std::size_t>(k)] - 'x');
    rotation = rotation * Eigen::AngleAxisd(angles_rad[k], axis).toRotationMatrix();
  }
  return rotation;
}

Eigen::Matrix3d rotation_of(const WrittenPose& pose, const PoseConvention& convention) {
  switch (convention.rotation) {
    case PoseRotation::kQuaternionWxyz:
      return quaternion_rotation(pose, true);
    case PoseRotation::kQuaternionXyzw:
      return quaternion_rotation(pose, false);
    case PoseRotation::kRotationVector:
    case PoseRotation::kEuler: {
      const double scale = convention.angle == PoseAngle::kDegree ? kRadPerDeg : 1.0;
      const Eigen::Vector3d angles =
          scale * Eigen::Vector3d(pose.numbers[3], pose.numbers[4], pose.numbers[5]);
      return convention.rotation == PoseRotation::kEuler
                 ? euler_rotation(angles, convention.euler_order)
                 : vector_rotation(angles);
    }
    default:
      return matrix_rotation(pose);
  }
}

Eigen::Isometry3d tcp_of(const std::vector<double>& numbers) {
  Eigen::Isometry3d flange_from_tcp = Eigen::Isometry3d::Identity();
  if (!numbers.empty()) {
    flange_from_tcp.translation() = Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
    flange_from_tcp.linear() = vector_rotation(Eigen::Vector3d(numbers[3], numbers[4], numbers[5]));
  }
  return flange_from_tcp;
}

bool is_euler_order(const std::string& order) {
  return order.size() == 3 && order.find_first_not_of("xyz") == order.npos &&
         order[0] != order[1] && order[1] != order[2];
}

}  // namespace

void refuse_key(const Place& place, std::string_view key, const std::string& text) {
  throw ConfigError(Problem{.place = place, .key = std::string(key), .text = text});
}

void visit_keys(KeyVisitor& keys, PoseConvention& convention) {
  keys.choice("unit", convention.unit, kUnits, "of positions");
  keys.choice("direction", convention.direction, kDirections, "what the poses take to what");
  keys.choice("rotation", convention.rotation, kRotations, "how rotations are written");
  keys.choice("angle", convention.angle, kAngles, "unit of rotation vectors and Euler angles");
  keys.text("euler_order",
            convention.euler_order,
            "axes of Euler angles, each as the ones before have turned it");
  keys.numbers(
      "flange_from_tcp",
      convention.flange_from_tcp,
      {.min = 0, .max = 6},
      {},
      "tool's tip the poses are of: x y z in mm, rotation vector in rad; empty: the flange");
  const std::size_t size = convention.flange_from_tcp.size();
  keys.require(size == 0 || size == 6,
               "flange_from_tcp",
               fmt::format("has {} numbers, must be empty or have 6", size));
  keys.require(is_euler_order(convention.euler_order),
               "euler_order",
               fmt::format("is \"{}\", must be three of x, y, z, no two neighbours alike",
                           convention.euler_order));
}

ResolvedConvention resolved_convention(std::span<const WrittenPose> poses,
                                       const PoseConvention& convention) {
  GLINT_CHECK(!poses.empty(), "at least one pose");
  check_numbers(poses);
  ResolvedConvention resolved = {.convention = convention, .told = {}};
  resolve_rotation(poses, resolved);
  resolve_angle(poses, resolved);
  resolve_unit(poses, resolved);
  if (convention.direction == PoseDirection::kAuto) {
    resolved.convention.direction = PoseDirection::kBaseFromFlange;
    resolved.told.emplace_back("direction = \"base_from_flange\": assumed");
  }
  if (!convention.flange_from_tcp.empty()) {
    resolved.told.push_back(fmt::format("flange_from_tcp = [{}]: removed from every pose",
                                        fmt::join(convention.flange_from_tcp, ", ")));
  }
  return resolved;
}

std::vector<PoseConvention> other_conventions(std::span<const WrittenPose> poses,
                                              const PoseConvention& convention) {
  const PoseConvention guess = resolved_convention(poses, convention).convention;
  std::vector<PoseConvention> readings = {guess};
  const auto add = [&](auto change) {
    for (std::size_t i = 0, size = readings.size(); i < size; ++i) {
      PoseConvention other = readings[i];
      change(other);
      readings.push_back(other);
    }
  };
  if (convention.direction == PoseDirection::kAuto) {
    add([](PoseConvention& other) { other.direction = PoseDirection::kFlangeFromBase; });
  }
  if (convention.rotation == PoseRotation::kAuto &&
      guess.rotation == PoseRotation::kQuaternionXyzw) {
    add([](PoseConvention& other) { other.rotation = PoseRotation::kQuaternionWxyz; });
  } else if (convention.rotation == PoseRotation::kAuto && has_angles(guess.rotation)) {
    const std::vector<PoseConvention> before = readings;
    if (guess.rotation == PoseRotation::kEuler) {
      add([](PoseConvention& other) { other.rotation = PoseRotation::kRotationVector; });
    }
    for (const char* order : {"zyx", "xyz", "zyz"}) {
      for (PoseConvention other : before) {
        other.rotation = PoseRotation::kEuler;
        other.euler_order = order;
        if (guess.rotation != PoseRotation::kEuler || other.euler_order != guess.euler_order) {
          readings.push_back(other);
        }
      }
    }
  }
  readings.erase(readings.begin());
  return readings;
}

Eigen::Isometry3d base_from_flange(const WrittenPose& pose, const PoseConvention& convention) {
  Eigen::Isometry3d written = Eigen::Isometry3d::Identity();
  written.linear() = rotation_of(pose, convention);
  written.translation() = position_of(pose) * (convention.unit == PoseUnit::kMetre ? 1e3 : 1.0);
  const Eigen::Isometry3d base_from_tcp =
      convention.direction == PoseDirection::kFlangeFromBase ? written.inverse() : written;
  return base_from_tcp * tcp_of(convention.flange_from_tcp).inverse();
}

}  // namespace glint
