// SPDX-License-Identifier: GPL-3.0-or-later
//
// The kernels of metal against the functions in double they stand for, lane by lane.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/simulator/render/path_tracing/packet_bench.h"

namespace glint::path_test {
namespace {

using Eigen::Vector3d;

/// Every fourth one grazes: cosines down to 1e-4.
Eigen::Vector3f direction_above(Rng& rng) {
  const double turns = rng.uniform();
  const double share = rng.uniform();
  const double z = rng.uniform() < 0.25 ? 1e-4 + 0.05 * share * share : 1e-4 + 0.9999 * share;
  const double radius = std::sqrt(std::max(0.0, 1.0 - z * z));
  return Vector3d(radius * std::cos(2.0 * kPi * turns), radius * std::sin(2.0 * kPi * turns), z)
      .cast<float>();
}

VectorLanes directions_above(Rng& rng) {
  VectorLanes lanes;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const Eigen::Vector3f d = direction_above(rng);
    lanes.x[i] = d.x();
    lanes.y[i] = d.y();
    lanes.z[i] = d.z();
  }
  return lanes;
}

LocalDirection local_of(const VectorLanes& lanes, std::size_t i) {
  return {static_cast<double>(lanes.x[i]),
          static_cast<double>(lanes.y[i]),
          static_cast<double>(lanes.z[i])};
}

double relative(double found, double expected) {
  return std::abs(found - expected) / std::max(std::abs(expected), 1e-30);
}

/// Largest relative deviations of the metal kernels.
struct MetalErrors {
  double value = 0.0;
  double density = 0.0;
  double direction = 0.0;  ///< absolute
  double weight = 0.0;
};

void compare_evaluation(const Material& metal,
                        const ConductorNumbers& numbers,
                        Rng& rng,
                        MetalErrors& errors) {
  const VectorLanes viewer = directions_above(rng);
  const VectorLanes light = directions_above(rng);
  LobeLanes lobes;
  ReflectionLanes found;
  choose_lobes16(numbers, viewer, lobes);
  evaluate16(numbers, lobes, viewer, light, found);
  for (std::size_t i = 0; i < kLanes; ++i) {
    const Reflection expected = evaluate(metal, local_of(viewer, i), local_of(light, i));
    for (std::size_t c = 0; c < 3; ++c) {
      const double value = expected.value[static_cast<Eigen::Index>(c)];
      errors.value =
          std::max(errors.value, relative(static_cast<double>(found.value.c[c][i]), value));
    }
    errors.density =
        std::max(errors.density, relative(static_cast<double>(found.density[i]), expected.density));
  }
}

void compare_samples(const Material& metal,
                     const ConductorNumbers& numbers,
                     Rng& rng,
                     MetalErrors& errors) {
  const VectorLanes viewer = directions_above(rng);
  const RandomLanes random = random_lanes(rng);
  LobeLanes lobes;
  LeavingLanes found;
  choose_lobes16(numbers, viewer, lobes);
  sample16(numbers, lobes, viewer, random, found);
  for (std::size_t i = 0; i < kLanes; ++i) {
    const auto expected = sample(metal,
                                 local_of(viewer, i),
                                 {static_cast<double>(random.lobe_u[i]),
                                  static_cast<double>(random.lobe_v[i]),
                                  static_cast<double>(random.choice[i])});
    const LocalDirection to = local_of(found.to_light, i);
    if (!expected || std::abs(expected->to_light.z) < 1e-4) {  // below, or too near to tell
      EXPECT_LT(to.z, 2e-4);
      continue;
    }
    const LocalDirection& e = expected->to_light;
    errors.direction = std::max(errors.direction,
                                Vector3d(to.x - e.x, to.y - e.y, to.z - e.z).cwiseAbs().maxCoeff());
    const Reflection there = evaluate(metal, local_of(viewer, i), to);
    errors.weight = std::max(
        errors.weight,
        relative(static_cast<double>(found.weight.c[0][i]), there.value[0] / there.density));
    errors.density =
        std::max(errors.density, relative(static_cast<double>(found.density[i]), there.density));
  }
}

MetalErrors errors_of(const MaterialSettings& settings) {
  const SurfaceMaterial material(settings, kGreen_nm);
  const auto numbers = conductor_numbers(material.plain());
  EXPECT_TRUE(numbers.has_value());
  MetalErrors errors;
  Rng rng(7, Stream::kTest, 0);
  for (int i = 0; i < kPackets; ++i) {
    compare_evaluation(material.plain(), *numbers, rng, errors);
    compare_samples(material.plain(), *numbers, rng, errors);
  }
  return errors;
}

TEST(PacketStages, MetalOfOneReflectionIsThatOfTheScalarCode) {
  for (const auto& alpha : {std::vector{0.1027, 0.038}, std::vector{0.4}, std::vector{0.01}}) {
    for (const bool schlick : {true, false}) {
      const MetalErrors errors = errors_of(metal_of(alpha, schlick, false));
      EXPECT_LT(errors.value, 1e-5) << alpha[0];
      EXPECT_LT(errors.density, 1e-5) << alpha[0];
      EXPECT_LT(errors.weight, 1e-5) << alpha[0];
      EXPECT_LT(errors.direction, 1e-4) << alpha[0];  // facets seen at grazing
    }
  }
}

/// What several reflections return is 1 - albedo, which is good to some 1e-7 of 1, not of itself;
/// their directions are looked up in cells that hold as little as 1e-4 of the random numbers.
TEST(PacketStages, MetalOfSeveralReflectionsIsThatOfTheScalarCode) {
  for (const auto& alpha : {std::vector{0.1027, 0.038}, std::vector{0.4}, std::vector{0.6, 0.2}}) {
    const MetalErrors errors = errors_of(metal_of(alpha, true, true));
    EXPECT_LT(errors.value, 1e-3) << alpha[0];
    EXPECT_LT(errors.weight, 1e-3) << alpha[0];
    EXPECT_LT(errors.direction, 1e-3) << alpha[0];
  }
}

}  // namespace
}  // namespace glint::path_test
