// SPDX-License-Identifier: GPL-3.0-or-later
//
// Directions are drawn from a piecewise constant density in t, where z = knee (exp(t scale) - 1)
// spreads the cells towards grazing as direction_table.h spreads its rows. The mass of a cell is
// the light lost in it, by four midpoints and eight azimuths, and a tenth of the samples keep to
// the cosine, so that no cell is empty. Cost: at most 32 steps a sample. docs/theory/materials.md
#include "simulator/material/compensation_sampler.h"

namespace glint {
namespace {

/// Share of the samples that keep to the cosine, so that no cell is empty.
constexpr double kCosineShare = 0.1;

/// The light lost from all azimuths at a cosine.
double loss_at(const DirectionTable& albedo, double z) {
  constexpr int kAzimuths = 8;  // midpoints of a quarter turn
  const double radius = std::sqrt((1.0 - z) * (1.0 + z));
  double sum = 0.0;
  for (int a = 0; a < kAzimuths; ++a) {
    const double phi_rad = 0.5 * kPi * (a + 0.5) / kAzimuths;
    sum += 1.0 - albedo.at({radius * std::cos(phi_rad), radius * std::sin(phi_rad), z});
  }
  return std::max(0.0, sum / kAzimuths);
}

}  // namespace

CompensationSampler::CompensationSampler(const DirectionTable& albedo, double width)
    : knee_(0.1 * std::min(width, 1.0 / width)), scale_(std::log1p(1.0 / knee_)) {
  constexpr int kSteps = 4;  // midpoints of a cell
  double sum = 0.0;
  for (int cell = 0; cell < kCells; ++cell) {
    double& mass = mass_[static_cast<std::size_t>(cell)];
    for (int step = 0; step < kSteps; ++step) {
      const double z = z_of((cell + (step + 0.5) / kSteps) / kCells);
      mass += loss_at(albedo, z) * z * (z + knee_);
    }
    sum += mass;
  }
  for (int cell = 0; cell < kCells; ++cell) {
    double& mass = mass_[static_cast<std::size_t>(cell)];
    const double low = z_of(static_cast<double>(cell) / kCells);
    const double high = z_of((cell + 1.0) / kCells);
    const double cosine = (high - low) * (high + low);
    mass = sum > 0.0 ? (1.0 - kCosineShare) * mass / sum + kCosineShare * cosine : cosine;
  }
}

double CompensationSampler::z_of(double t) const {
  return std::min(1.0, knee_ * std::expm1(t * scale_));
}

LocalDirection CompensationSampler::sample(double u, double v) const {
  std::size_t cell = 0;
  double rest = v;
  while (cell + 1 < mass_.size() && rest >= mass_[cell]) {
    rest -= mass_[cell];
    ++cell;
  }
  const double share = std::min(1.0, rest / mass_[cell]);
  const double z = z_of((static_cast<double>(cell) + share) / kCells);
  const double radius = std::sqrt((1.0 - z) * (1.0 + z));
  const double phi_rad = 2.0 * kPi * u;
  return {radius * std::cos(phi_rad), radius * std::sin(phi_rad), z};
}

double CompensationSampler::density(const LocalDirection& direction) const {
  if (!(direction.z > 0.0)) {
    return 0.0;
  }
  const double z = std::min(1.0, direction.z);
  const double t = std::log1p(z / knee_) / scale_;
  const auto cell = std::min(static_cast<std::size_t>(t * kCells), mass_.size() - 1);
  return mass_[cell] * kCells / ((z + knee_) * scale_ * 2.0 * kPi);
}

}  // namespace glint
