// SPDX-License-Identifier: GPL-3.0-or-later
//
// Gauss-Newton in gain and roughness: grey values at the scene's roughness and at a quarter more
// give a derivative, the third rendering is at the value that follows. Each rendering is two
// independent pictures of half the samples: products of one with the other have no noise of their
// own, which would make every derivative too small (two-sample instrumental variables). Grey values
// are those that light makes: the dark signal stays what it is under any light.
#include "studies/compare/roughness_cause.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include "core/image/image_io.h"
#include "metrics/appearance/unclipped_pixels.h"
#include "simulator/sensor/sensor.h"
#include "studies/compare/camera/reduced_scene.h"
#include "studies/compare/rendered_halves.h"
#include "studies/definition/render_methods.h"
#include "studies/imaging/path_picture.h"
#include "studies/imaging/scene_picture.h"

namespace glint::compare_detail {
namespace {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr int kWidthPx = 612;
constexpr int kHeightPx = 512;
constexpr int kMinSamples = 32;
constexpr std::size_t kMinPixels = 1000;
/// So many times full scale a rendered frame may have: more than the noise of paths adds, little
/// enough for single bright paths to be told. A power of two: grey values are not rounded.
constexpr double kHeadroom = 2.0;
constexpr double kStep = 1.25;  ///< factor on the roughness
constexpr double kMinRoughness = 0.02;
constexpr double kReach = 1.7;  ///< factor on the roughness within which three renderings tell it
constexpr double kSurelyCurved = 2.0;  ///< sigmas
constexpr double kMaxGainStep = 1.5;   ///< a gain that moves more between two fits is not settled
constexpr int kBlockPx = 12;  ///< whose misfit is taken together: it is alike for neighbours
constexpr int kRimPx = 2;     ///< from the part's edge

int factor_of(const SceneSettings& scene) {
  const int factor = std::max((scene.camera.width_px + kWidthPx - 1) / kWidthPx,
                              (scene.camera.height_px + kHeightPx - 1) / kHeightPx);
  return std::max(factor, 1);
}

/// Mean grey that light makes in the scene's frames, without one of the two batches. One frame may
/// be up to twice as bright as full scale; of several each is clipped, as only their mean is
/// compared.
ImageF grey_of(const PathPicture& picture,
               const SceneSettings& scene,
               std::optional<std::size_t> without) {
  const auto frames = frame_factors(scene, picture.unit_power_w);
  const double headroom = frames.size() == 1 ? kHeadroom : 1.0;
  SensorSettings settings = scene.sensor;
  settings.exposure /= headroom;
  const Sensor sensor(settings, picture.sums.width_px, picture.sums.height_px);
  ScanSums sums(picture.sums.width_px, picture.sums.height_px);
  ImageF grey;
  for (const FrameFactors& factors : frames) {
    sensor.expose(frame_radiance(picture, factors, without), sums.frames, grey);
    std::ranges::transform(
        grey.values(), sums.sum.values(), sums.sum.values().begin(), std::plus<>());
    ++sums.frames;
  }
  ImageF mean = sums.aspect();
  for (float& value : mean.values()) {
    value *= static_cast<float>(headroom);
  }
  return mean;
}

/// Of the photograph what light made. Floats beyond full scale are radiances, without a dark
/// signal.
ImageF light_of(const ComparedPicture& real, double dark, int factor) {
  ImageF light = reduce(real.grey, factor);
  for (float& value : light.values()) {
    value -= static_cast<float>(dark);
  }
  return light;
}

/// Reduced pixels of which a part is at full scale.
Mask clipped_in(const ImageF& grey, int factor) {
  Mask clipped(grey.width() / factor, grey.height() / factor);
  for (int y = 0; y < clipped.height() * factor; ++y) {
    for (int x = 0; x < clipped.width() * factor; ++x) {
      if (grey(x, y) >= 1.0F) {
        clipped(x / factor, y / factor) = 1;
      }
    }
  }
  return clipped;
}

class RoughnessSearch {
 public:
  RoughnessSearch(const ComparedPair& pair, const SceneSettings& scene, SceneStore& store)
      : store_(store),
        factor_(factor_of(scene)),
        scene_(reduced_scene(with_equal_exposure(store, scene), factor_, kMinSamples)),
        dark_(pair.real.is_scaled ? 0.0 : dark_grey(scene.sensor)),
        has_offset_(pair.appearance.exposure.offset != 0.0),
        real_(light_of(pair.real, dark_, factor_)),
        clipped_(clipped_in(pair.real.grey, factor_)) {}

  std::optional<RoughnessFit> find() {
    const double first = scene_.material.roughness;
    Halves base = rendered(first);
    if (!choose_pixels(base)) {
      return std::nullopt;
    }
    base = without_offset(std::move(base));
    if (has_offset_) {
      subtract_mean(real_, pixels_);
    }
    const double stepped = first * kStep <= 1.0 ? first * kStep : first / kStep;
    std::vector<Rendering> renderings = {{first, std::move(base)}, {stepped, at(stepped)}};
    const auto fit = fitted(renderings[0].grey, derivative_between(renderings[0], renderings[1]));
    if (!fit) {
      return std::nullopt;
    }
    const double nearer = bounded(first + fit->change());
    if (std::abs(fit->change()) <= fit->change_sigma() || nearer == first) {
      return told(renderings[0].grey, *fit, nearer - first);
    }
    renderings.push_back({nearer, at(nearer)});
    return told_by_third(renderings, *fit);
  }

 private:
  Halves at(double roughness) { return without_offset(rendered(roughness)); }

  /// Where exposures may differ by an offset too: about the means over the chosen pixels.
  Halves without_offset(Halves halves) const {
    if (has_offset_) {
      std::ranges::for_each(halves, [&](ImageF& half) { subtract_mean(half, pixels_); });
    }
    return halves;
  }

  Halves rendered(double roughness) {
    SceneSettings scene = scene_;
    scene.material.roughness = roughness;
    const std::shared_ptr<const PathPicture> picture = store_.picture(scene);
    ++renders_;
    if (part_.empty()) {
      part_ = sound_part(picture->sums, kRimPx);
    }
    if (picture->batches.empty()) {  // without noise
      const ImageF whole = grey_of(*picture, scene, std::nullopt);
      return {whole, whole};
    }
    return {grey_of(*picture, scene, 1), grey_of(*picture, scene, 0)};
  }

  /// Roughness that metal may have, within reach of the scene's.
  double bounded(double roughness) const {
    const double own = scene_.material.roughness;
    return std::clamp(
        roughness, std::max(own / kReach, kMinRoughness), std::min(kReach * own, 1.0));
  }

  /// From the third rendering along the straight line to it from the first; where the parabola
  /// through all three leads on from there by more than its noise, that far, and half of it is
  /// open.
  /// @param first_fit  along the straight line to the second one
  std::optional<RoughnessFit> told_by_third(std::span<const Rendering> renderings,
                                            const GreyFit& first_fit) const {
    const Rendering& first = renderings[0];
    const Rendering& third = renderings[2];
    const auto straight = fitted(third.grey, derivative_between(first, third));
    if (!straight) {
      return std::nullopt;
    }
    const double found = third.roughness + straight->change();
    const Interpolated parabola = interpolated(renderings, found);
    const auto curved = fitted(parabola.grey, parabola.derivative);
    if (!curved || std::abs(curved->change()) <= kSurelyCurved * curved->change_sigma()) {
      return told_within(renderings, first_fit, *straight, found);
    }
    const double further = found + curved->change();
    RoughnessFit result = told_within(renderings, first_fit, *curved, further);
    result.sigma = std::hypot(result.sigma, 0.5 * curved->change());
    result.gain_sigma = std::hypot(result.gain_sigma, 0.5 * (curved->gain() - straight->gain()));
    result.is_within_reach = result.is_within_reach &&
                             (is_between(renderings, found) || !is_between(renderings, further));
    return result;
  }

  static bool is_between(std::span<const Rendering> renderings, double roughness) {
    const auto [least, most] = std::ranges::minmax(renderings, {}, &Rendering::roughness);
    return roughness >= least.roughness && roughness <= most.roughness;
  }

  /// Told where the first step stayed within reach, and the gain has not moved far since.
  RoughnessFit told_within(std::span<const Rendering> renderings,
                           const GreyFit& first_fit,
                           const GreyFit& fit,
                           double found) const {
    const double first = renderings[0].roughness;
    RoughnessFit result = told(renderings[0].grey, fit, bounded(found) - first);
    const double stepped = first + first_fit.change();
    result.is_within_reach = found == bounded(found) && stepped == bounded(stepped) &&
                             std::max(fit.gain(), first_fit.gain()) <=
                                 kMaxGainStep * std::min(fit.gain(), first_fit.gain());
    return result;
  }

  /// @return whether there are enough
  bool choose_pixels(const Halves& base) {
    if (part_.width() != real_.width() || part_.height() != real_.height()) {
      return false;  // the picture is not of this scene
    }
    Mask shown = part_;
    for (std::size_t i = 0; i < shown.size(); ++i) {
      const double brightest =
          static_cast<double>(std::max(base[0].values()[i], base[1].values()[i]));
      if (clipped_.values()[i] != 0 || brightest >= 0.98 * kHeadroom) {
        shown.values()[i] = 0;
      }
    }
    pixels_ = unclipped_pixels(
        mean_of(base), real_, shown, {.full_scale = 1.0 - dark_, .noise_over_rest = 1.0 * factor_});
    return pixels_.size() >= kMinPixels;
  }

  static Vector2d row_of(const Halves& base,
                         const Halves& derivatives,
                         std::size_t half,
                         std::size_t pixel) {
    return {static_cast<double>(base[half].values()[pixel]),
            static_cast<double>(derivatives[half].values()[pixel])};
  }

  /// Nothing where these pixels do not tell both.
  std::optional<GreyFit> fitted(const Halves& base, const Halves& derivatives) const {
    Matrix2d products = Matrix2d::Zero();
    Vector2d right = Vector2d::Zero();
    for (const std::size_t pixel : pixels_) {
      const Vector2d one = row_of(base, derivatives, 0, pixel);
      const Vector2d other = row_of(base, derivatives, 1, pixel);
      products += 0.5 * (one * other.transpose() + other * one.transpose());
      right += 0.5 * (one + other) * static_cast<double>(real_.values()[pixel]);
    }
    constexpr double kSingular = 1e-9;  ///< determinant over the product of the diagonal
    if (!(products.determinant() > kSingular * products(0, 0) * products(1, 1)) ||
        !(products(0, 0) > 0.0)) {
      return std::nullopt;
    }
    const Matrix2d inverse = products.inverse();
    GreyFit fit = {.values = inverse * right};
    fit.covariance = inverse * scatter_of(base, derivatives, fit) * inverse;
    fit.bound = photograph_variance(base, derivatives, fit) * inverse;
    return fit.values[0] > 0.0 && std::isfinite(fit.change()) ? std::optional(fit) : std::nullopt;
  }

  /// Sum over blocks of the squares of their parts of the gradient. @param fit  receives its rest
  Matrix2d scatter_of(const Halves& base, const Halves& derivatives, GreyFit& fit) const {
    const int width = real_.width();
    const int across = width / kBlockPx + 1;
    std::vector<Vector2d> blocks(static_cast<std::size_t>(across * (real_.height() / kBlockPx + 1)),
                                 Vector2d::Zero());
    for (const std::size_t pixel : pixels_) {
      const Vector2d row =
          0.5 * (row_of(base, derivatives, 0, pixel) + row_of(base, derivatives, 1, pixel));
      const double rest = static_cast<double>(real_.values()[pixel]) - row.dot(fit.values);
      const int x = static_cast<int>(pixel) % width / kBlockPx;
      const int y = static_cast<int>(pixel) / width / kBlockPx;
      blocks[static_cast<std::size_t>(y * across + x)] += row * rest;
      fit.rest += rest * rest;
    }
    Matrix2d scatter = Matrix2d::Zero();
    for (const Vector2d& block : blocks) {
      scatter += block * block.transpose();
    }
    return scatter;
  }

  /// Of a pixel of the photograph: what the fit leaves without the noise of the renderings.
  double photograph_variance(const Halves& base,
                             const Halves& derivatives,
                             const GreyFit& fit) const {
    double rendered = 0.0;
    for (const std::size_t pixel : pixels_) {
      const Vector2d apart =
          row_of(base, derivatives, 0, pixel) - row_of(base, derivatives, 1, pixel);
      const double noise = 0.5 * apart.dot(fit.values);
      rendered += noise * noise;
    }
    return std::max(fit.rest - rendered, 0.0) / static_cast<double>(pixels_.size());
  }

  RoughnessFit told(const Halves& base, const GreyFit& fit, double change) const {
    double misfit = 0.0;
    double squares = 0.0;
    double product = 0.0;
    for (const std::size_t pixel : pixels_) {
      const double simulated =
          0.5 * static_cast<double>(base[0].values()[pixel] + base[1].values()[pixel]);
      const auto real = static_cast<double>(real_.values()[pixel]);
      misfit += (real - simulated) * (real - simulated);
      squares += simulated * simulated;
      product += simulated * real;
    }
    const double gain = product / squares;
    const double by_gain = squares * (gain - 1.0) * (gain - 1.0);
    return {.change = change,
            .sigma = fit.change_sigma(),
            .noise_sigma = fit.change_sigma(),
            .bound = fit.change_bound(),
            .gain = fit.gain(),
            .gain_sigma = std::sqrt(fit.covariance(0, 0)),
            .share = misfit > 0.0 ? std::max(misfit - by_gain - fit.rest, 0.0) / misfit : 0.0,
            .gain_share = misfit > 0.0 ? by_gain / misfit : 0.0,
            .renders = renders_};
  }

  SceneStore& store_;
  int factor_;
  SceneSettings scene_;
  double dark_;      ///< grey of the sensor's dark signal, which light leaves as it is
  bool has_offset_;  ///< exposures may differ by one
  ImageF real_;      ///< what light made
  Mask clipped_;
  Mask part_;
  std::vector<std::size_t> pixels_;
  int renders_ = 0;
};

}  // namespace

bool tells_roughness(const SceneSettings& scene) {
  const MaterialSettings& material = scene.material;
  return material.type == MaterialSettings::Type::kConductor && material.alpha.empty() &&
         material.roughness >= kMinRoughness && scene.sensor.wavelengths_nm.size() == 1 &&
         shows_roughness(scene);
}

std::optional<RoughnessFit> fit_roughness(const ComparedPair& pair,
                                          const SceneSettings& scene,
                                          SceneStore& store) {
  if (!tells_roughness(scene)) {
    return std::nullopt;
  }
  return RoughnessSearch(pair, scene, store).find();
}

}  // namespace glint::compare_detail
