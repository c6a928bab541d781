// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/ladder/unmodelled.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include <fmt/format.h>

#include "core/units.h"
#include "simulator/material/fresnel.h"
#include "simulator/material/nk_table.h"
#include "studies/definition/ladder/lamp_share.h"
#include "studies/definition/ladder/render_ladder.h"
#include "studies/definition/ladder/wall_share.h"
#include "studies/definition/render_methods.h"

namespace glint {
namespace {

/// Of metal with a table of n and k; none for other materials.
std::vector<std::complex<double>> indices_of(const SceneSettings& scene) {
  std::vector<std::complex<double>> indices;
  if (!scene.material.nk_file.empty()) {
    const NkTable table = read_nk(scene.material.nk_file);
    for (const double wavelength_nm : scene.sensor.wavelengths_nm) {
      const RefractiveIndex index = table.at(wavelength_nm);
      indices.emplace_back(index.n, -index.k);
    }
  }
  return indices;
}

double mean_reflectance(const SceneSettings& scene) {
  const std::vector<std::complex<double>> indices = indices_of(scene);
  if (!indices.empty()) {
    double sum = 0.0;
    for (const std::complex<double>& index : indices) {
      sum += normal_reflectance(index.real(), -index.imag());
    }
    return sum / static_cast<double>(indices.size());
  }
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

/// What comes back to the part from lamps that it shines on.
std::string lamp_note(const SceneSettings& scene,
                      const Eigen::Vector3d& size_mm,
                      const MeshLoader& load_mesh) {
  constexpr double kLampReflectance = 0.5;  // a guess: no file tells it
  const LampShare share = lamp_share(scene, size_mm, load_mesh);
  if (share.seen <= 0.0) {
    return "Light that the part throws onto its surroundings and gets back from them is not "
           "modelled: all but part and lights is black. How much that is depends on what stands "
           "there; no estimate.";
  }
  return fmt::format(
      "Light that goes from the part to the lamps and from there to the part again is not "
      "modelled: about {:.1g} % of the part's light, if lamps, which fill {:.2g} % of what it "
      "sees, reflect a half (a guess). All but part and lamps is taken as black.",
      100.0 * kLampReflectance * mean_reflectance(scene) * share.returned,
      100.0 * share.seen);
}

/// Of the light that the part throws back to the wall what the wall returns to the part, times both
/// reflectances.
std::string wall_note(const SceneSettings& scene,
                      const Eigen::Vector3d& size_mm,
                      const MeshLoader& load_mesh) {
  constexpr double kWallReflectance = 0.5;  // of opal acrylic, about
  constexpr double kMm2PerCm2 = 100.0;
  if (!scene.has_tunnel) {
    return lamp_note(scene, size_mm, load_mesh);
  }
  const WallShare share = wall_share(scene, size_mm);
  return fmt::format(
      "Light that goes from the part back to the wall and from there to the part again is not "
      "modelled: about {:.1g} % of the wall's light (part {:.0f} cm2, wall {:.0f} cm2 that "
      "reflects a half).",
      100.0 * kWallReflectance * mean_reflectance(scene) * share.returned,
      size_mm.x() * size_mm.y() / kMm2PerCm2,
      share.wall_mm2 / kMm2PerCm2);
}

double polarisation(const std::complex<double>& index, double angle_rad) {
  const double cosine = std::cos(angle_rad);
  const std::complex<double> sine = std::sin(angle_rad) / index;
  const std::complex<double> inside = std::sqrt(1.0 - sine * sine);
  const double s = std::norm((cosine - index * inside) / (cosine + index * inside));
  const double p = std::norm((index * cosine - inside) / (index * cosine + inside));
  return s + p > 0.0 ? (s - p) / (s + p) : 0.0;
}

/// The largest over the wavelengths.
double metal_polarisation_of(const SceneSettings& scene, double angle_rad) {
  double most = 0.0;
  const std::vector<std::complex<double>> indices = indices_of(scene);
  for (const std::complex<double>& index : indices) {
    most = std::max(most, std::abs(polarisation(index, angle_rad)));
  }
  return indices.empty() ? metal_polarisation(mean_reflectance(scene), angle_rad) : most;
}

std::string polarisation_note(const SceneSettings& scene) {
  constexpr double kAngle_rad = kPi / 3.0;
  const char* what = "Polarisation is not modelled";
  const bool is_once = needs_paths(scene) && scene.paths.max_reflections == 1;
  if (is_once || is_blurred(scene) || is_direct(scene)) {
    return fmt::format("{}: no error, as light is reflected once before it reaches the camera.",
                       what);
  }
  const bool has_coat = scene.material.coat.index > 1.0;
  if (scene.material.type == MaterialSettings::Type::kDiffuse && !has_coat) {
    return fmt::format("{}: no error, as a diffuse surface does not polarise.", what);
  }
  const double degree = has_coat ? std::abs(polarisation(scene.material.coat.index, kAngle_rad))
                                 : metal_polarisation_of(scene, kAngle_rad);
  if (degree == 0.0) {
    return fmt::format(
        "{}: no error for a surface that reflects everything, as this one is asked to "
        "do. How a real metal polarises is known by its material.nk_file or "
        "reflectance alone.",
        what);
  }
  return fmt::format(
      "{}: light that is reflected twice by this {}, at 60 degrees, is wrong by up to {:.1g} %; "
      "what is reflected once is right.",
      what,
      has_coat ? "coat" : "metal",
      100.0 * degree * degree);
}

/// Arc of a parabola over its chord; 1 where it bulges or is straight.
double arc_over_chord(double radius_mm, double chord_mm) {
  const double slope = radius_mm < 0.0 ? -0.5 * chord_mm / radius_mm : 0.0;
  return slope > 0.0 ? 0.5 * (std::hypot(1.0, slope) + std::asinh(slope) / slope) : 1.0;
}

/// The share of what the part reflects that falls on it again. A hollow strip that scatters evenly
/// sends through its opening as much as the opening's share of its surface; of gears and meshes a
/// guess.
double return_share(const PartSettings& part) {
  constexpr double kOfOthers = 0.5;
  return part.shape == PartSettings::Shape::kStrip
             ? 1.0 - 1.0 / (arc_over_chord(part.radius_along_mm, part.length_mm) *
                            arc_over_chord(part.radius_across_mm, part.width_mm))
             : kOfOthers;
}

/// What no path is long enough for, as a geometric series.
std::string reflections_note(const SceneSettings& scene) {
  if (!may_see_itself(scene)) {
    return "Reflections from part to part: none, its shape does not see itself.";
  }
  const int most = is_blurred(scene) || is_direct(scene) ? 1
                   : needs_paths(scene)                  ? scene.paths.max_reflections
                                                         : scene.render.max_bounces;
  const double share = return_share(scene.part);
  return fmt::format(
      "Light that the part reflects more than {} is not modelled: about {:.1g} % of its light, if "
      "{:.2g} % of what it reflects falls on the part again.",
      most == 1 ? std::string("once") : fmt::format("{} times", most),
      100.0 * std::pow(share * mean_reflectance(scene), most),
      100.0 * share);
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
  const double wave_nm = std::ranges::max(scene.sensor.wavelengths_nm);  // it spreads the most
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
  return polarisation({1.0, -k}, angle_rad);
}

std::vector<std::string> unmodelled_notes(const SceneSettings& scene,
                                          const Eigen::Vector3d& size_mm,
                                          const MeshLoader& load_mesh) {
  return {wall_note(scene, size_mm, load_mesh),
          polarisation_note(scene),
          wave_note(scene),
          reflections_note(scene)};
}

}  // namespace glint
