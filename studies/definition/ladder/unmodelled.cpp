// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/ladder/unmodelled.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include <fmt/format.h>

#include "core/units.h"
#include "simulator/light/tunnel/tunnel.h"
#include "studies/definition/render_methods.h"

namespace glint {
namespace {

double length_of(const std::vector<std::vector<Eigen::Vector2d>>& lines) {
  double length_mm = 0.0;
  for (const auto& line : lines) {
    for (std::size_t i = 1; i < line.size(); ++i) {
      length_mm += (line[i] - line[i - 1]).norm();
    }
  }
  return length_mm;
}

double mean_reflectance(const SceneSettings& scene) {
  const std::vector<double>& colour = scene.material.colour_srgb;
  if (!colour.empty()) {  // near enough for an estimate: a display's gamma of 2.2
    double sum = 0.0;
    for (const double value : colour) {
      sum += std::pow(value / 255.0, 2.2);
    }
    return sum / static_cast<double>(colour.size());
  }
  double sum = 0.0;
  for (const double value : scene.material.reflectance) {
    sum += value;
  }
  return sum / static_cast<double>(scene.material.reflectance.size());
}

/// What the part throws back to the wall makes it brighter by: the part's share of what the wall
/// sees, times both reflectances.
std::string wall_note(const SceneSettings& scene, const Eigen::Vector3d& size_mm) {
  constexpr double kWallReflectance = 0.5;  // of opal acrylic, about
  constexpr double kStep_mm = 1.0;
  if (!scene.has_tunnel) {
    return "Light that the part throws onto its surroundings and gets back from them is not "
           "modelled: all but part and lights is black. How much that is depends on what stands "
           "there; no estimate.";
  }
  const double wall_mm2 =
      length_of(Tunnel(scene.tunnel).outline(kStep_mm)) * scene.tunnel.length_mm;
  const double part_mm2 = size_mm.x() * size_mm.y();
  const double share = kWallReflectance * mean_reflectance(scene) * part_mm2 / wall_mm2;
  return fmt::format(
      "Light that goes from the part back to the wall and from there to the part again is not "
      "modelled: about {:.1g} % of the wall's light (part {:.0f} cm2, wall {:.0f} cm2 that "
      "reflects a half).",
      100.0 * share,
      part_mm2 / 100.0,
      wall_mm2 / 100.0);
}

std::string polarisation_note(const SceneSettings& scene) {
  constexpr double kAngle_rad = kPi / 3.0;
  const char* what = "Polarisation is not modelled";
  const bool is_once = needs_paths(scene) && scene.paths.max_reflections == 1;
  if (is_once || is_blurred(scene) || is_direct(scene)) {
    return fmt::format("{}: no error, as light is reflected once before it reaches the camera.",
                       what);
  }
  if (scene.material.type == MaterialSettings::Type::kDiffuse) {
    return fmt::format("{}: no error, as a diffuse surface does not polarise.", what);
  }
  const double degree = metal_polarisation(mean_reflectance(scene), kAngle_rad);
  if (degree == 0.0) {
    return fmt::format("{}: no error, as a surface that reflects everything does not polarise.",
                       what);
  }
  return fmt::format(
      "{}: light that is reflected twice by this metal, at 60 degrees, is wrong by up to {:.1g} %; "
      "what is reflected once is right.",
      what,
      100.0 * degree * degree);
}

/// Narrowest of a group's defects.
double width_mm(const DefectGroup& group) {
  return is_line(group.type) ? group.width_mm.min : group.diameter_mm.min;
}

std::string wave_note(const SceneSettings& scene) {
  constexpr double kMillimetresPerNanometre = 1e-6;
  double narrowest_mm = std::numeric_limits<double>::infinity();
  for (const auto& [name, group] : scene.defects) {
    narrowest_mm = std::min(narrowest_mm, width_mm(group));
  }
  if (!std::isfinite(narrowest_mm) || narrowest_mm <= 0.0) {
    return "Diffraction at features near the wavelength is not modelled; the scene has no defect "
           "that it could be estimated for.";
  }
  const double wave_nm = scene.sensor.wavelengths_nm.front();
  return fmt::format(
      "Diffraction at features near the wavelength is not modelled: it spreads what the narrowest "
      "defect ({:g} mm) reflects by about {:.2g} mrad.",
      narrowest_mm,
      1e3 * wave_nm * kMillimetresPerNanometre / narrowest_mm);
}

}  // namespace

double metal_polarisation(double reflectance, double angle_rad) {
  if (reflectance >= 1.0) {
    return 0.0;
  }
  // At normal incidence with n = 1: R = k^2 / (4 + k^2).
  const double k = 2.0 * std::sqrt(reflectance / (1.0 - reflectance));
  const std::complex<double> index(1.0, -k);
  const double cosine = std::cos(angle_rad);
  const std::complex<double> sine = std::sin(angle_rad) / index;
  const std::complex<double> inside = std::sqrt(1.0 - sine * sine);
  const double s = std::norm((cosine - index * inside) / (cosine + index * inside));
  const double p = std::norm((index * cosine - inside) / (index * cosine + inside));
  return s + p > 0.0 ? (s - p) / (s + p) : 0.0;
}

std::vector<std::string> unmodelled_notes(const SceneSettings& scene,
                                          const Eigen::Vector3d& size_mm) {
  return {wall_note(scene, size_mm), polarisation_note(scene), wave_note(scene)};
}

}  // namespace glint
