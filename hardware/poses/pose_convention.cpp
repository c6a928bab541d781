// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/poses/pose_convention.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/text.h"
#include "core/units.h"
#include "hardware/poses/pose_reading.h"

namespace glint {
namespace {

constexpr std::array<std::string_view, 3> kUnits = {"auto", "mm", "m"};
constexpr std::array<std::string_view, 3> kDirections = {
    "auto", "base_from_flange", "flange_from_base"};
constexpr std::array<std::string_view, 6> kRotations = {
    "auto", "matrix", "quaternion_wxyz", "quaternion_xyzw", "rotation_vector", "euler"};
constexpr std::array<std::string_view, 3> kAngles = {"auto", "rad", "deg"};
constexpr double kMaxReachInMetres = 10.0;
constexpr double kMinReachInMm = 10.0;
constexpr double kLargestNumber = 1e6;  ///< of a pose: no robot reaches a kilometre
constexpr double kFullTurnRad = 2.0 * kPi;
constexpr double kLooksLikeRadians = 3.2;  ///< where no angle is larger

/// Of Euler angles, those of most robots first.
constexpr std::array<const char*, 12> kEulerOrders = {
    "zyx", "xyz", "zyz", "zxz", "xzy", "yxz", "yzx", "zxy", "xyx", "xzx", "yxy", "yzy"};
constexpr std::size_t kLikelyOrders = 3;

template <class Enum, std::size_t N>
std::string_view name_of(Enum value, const std::array<std::string_view, N>& names) {
  return names[static_cast<std::size_t>(value)];
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

/// Of all poses, in their unit.
double median_reach(std::span<const WrittenPose> poses) {
  std::vector<double> reaches;
  for (const WrittenPose& pose : poses) {
    reaches.push_back(written_position(pose).norm());
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
      "rotation = \"{}\": guessed from {} numbers a pose", name_of(rotation, kRotations), count));
}

bool is_order_said(const PoseConvention& convention) {
  return convention.written.contains("euler_order") ||
         convention.euler_order != PoseConvention{}.euler_order;
}

void tell_order(ResolvedConvention& resolved) {
  const PoseConvention& convention = resolved.convention;
  if (convention.rotation == PoseRotation::kEuler && !is_order_said(convention)) {
    resolved.told.push_back(fmt::format("euler_order = \"{}\": assumed", convention.euler_order));
  }
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
  if (angle == PoseAngle::kDegree && poses.size() > 2 && largest < kLooksLikeRadians &&
      !poses.front().has_angle_unit) {
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
    unit = reach < kMaxReachInMetres ? PoseUnit::kMetre : PoseUnit::kMillimetre;
    resolved.told.push_back(
        fmt::format("unit = \"{}\": guessed, the flange is {:.3g} from the base (median)",
                    name_of(unit, kUnits),
                    reach));
  } else if (unit == PoseUnit::kMillimetre && reach < kMinReachInMm) {
    refuse_key(
        poses.front().place,
        "unit",
        fmt::format("is \"mm\", but the flange is {:.3g} from the base (median): are they metres? "
                    "allowed is unit = \"m\"",
                    reach));
  } else if (unit == PoseUnit::kMetre && reach > kMaxReachInMetres) {
    refuse_key(
        poses.front().place,
        "unit",
        fmt::format("is \"m\", but the flange is {:.3g} from the base (median): are they mm? "
                    "allowed is unit = \"mm\"",
                    reach));
  }
}

/// The guess, and how else its rotations may be meant.
std::vector<PoseConvention> rotation_readings(const PoseConvention& guess,
                                              const PoseConvention& said) {
  const bool is_guessed = said.rotation == PoseRotation::kAuto;
  std::vector<PoseConvention> readings = {guess};
  const auto add = [&](PoseRotation rotation, const std::string& order) {
    readings.push_back(guess);
    readings.back().rotation = rotation;
    readings.back().euler_order = order;
  };
  if (is_guessed && guess.rotation == PoseRotation::kQuaternionXyzw) {
    add(PoseRotation::kQuaternionWxyz, guess.euler_order);
  }
  if (is_guessed && guess.rotation == PoseRotation::kEuler) {
    add(PoseRotation::kRotationVector, guess.euler_order);
  }
  const bool is_euler = guess.rotation == PoseRotation::kEuler;
  if (!is_euler && !(is_guessed && guess.rotation == PoseRotation::kRotationVector)) {
    return readings;
  }
  for (std::size_t i = 0; i < (is_euler ? kEulerOrders.size() : kLikelyOrders); ++i) {
    const bool is_guess = is_euler && kEulerOrders[i] == guess.euler_order;
    const bool is_allowed = !is_order_said(said) || kEulerOrders[i] == said.euler_order;
    if (!is_guess && is_allowed) {
      add(PoseRotation::kEuler, kEulerOrders[i]);
    }
  }
  return readings;
}

/// The reading, and the same with its angles in degrees where they were guessed to be radians.
std::vector<PoseConvention> angle_readings(const PoseConvention& reading,
                                           const PoseConvention& said,
                                           std::span<const WrittenPose> poses) {
  std::vector<PoseConvention> readings = {reading};
  if (has_angles(reading.rotation) && said.angle == PoseAngle::kAuto &&
      reading.angle == PoseAngle::kRadian && largest_angle(poses) >= kLooksLikeRadians) {
    readings.push_back(reading);
    readings.back().angle = PoseAngle::kDegree;
  }
  return readings;
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
  for (const char* key :
       {"unit", "direction", "rotation", "angle", "euler_order", "flange_from_tcp"}) {
    if (keys.is_given(key)) {
      convention.written.insert(key);
    }
  }
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
  tell_order(resolved);
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
  std::vector<PoseConvention> readings;
  for (const PoseConvention& rotation : rotation_readings(guess, convention)) {
    for (const PoseConvention& angle : angle_readings(rotation, convention, poses)) {
      readings.push_back(angle);
      if (convention.direction == PoseDirection::kAuto) {
        readings.push_back(angle);
        readings.back().direction = PoseDirection::kFlangeFromBase;
      }
    }
  }
  readings.erase(readings.begin());
  return readings;
}

}  // namespace glint
