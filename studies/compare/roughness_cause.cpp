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
constexpr int kBlockPx = 12;  ///< whose misfit is taken together: it is alike for neighbours
constexpr int kRimPx = 2;     ///< from the part's edge

int factor_of(const SceneSettings& scene) {
  const int factor = std::max((scene.camera.width_px + kWidthPx - 1) / kWidthPx,
                              (scene.camera.height_px + kHeightPx - 1) / kHeightPx);
  return std::max(factor, 1);
}

/// Two independent pictures of one scene.
using Halves = std::array<ImageF, 2>;

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

ImageF mean_of(const Halves& halves) {
  ImageF mean = halves[0];
  std::ranges::transform(
      mean.values(), halves[1].values(), mean.values().begin(), [](float one, float other) {
        return 0.5F * (one + other);
      });
  return mean;
}

void subtract_mean(ImageF& picture, std::span<const std::size_t> pixels) {
  double sum = 0.0;
  for (const std::size_t pixel : pixels) {
    sum += static_cast<double>(picture.values()[pixel]);
  }
  const auto mean = static_cast<float>(sum / static_cast<double>(pixels.size()));
  for (float& value : picture.values()) {
    value -= mean;
  }
}

/// real = gain base + product derivative, product = gain times the change.
struct GreyFit {
  Vector2d values = Vector2d::Zero();
  Matrix2d covariance = Matrix2d::Zero();
  Matrix2d bound = Matrix2d::Zero();  ///< of the covariance, by the photograph's noise alone
  double rest = 0.0;                  ///< sum of squares

  double change() const { return values[1] / values[0]; }

  double change_sigma() const { return change_sigma(covariance); }

  double change_bound() const { return change_sigma(bound); }

 private:
  double change_sigma(const Matrix2d& of_values) const {
    const Vector2d derivative(-change() / values[0], 1.0 / values[0]);
    return std::sqrt(derivative.dot(of_values * derivative));
  }
};

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
    auto fit = fitted(base, derivatives_between(base, at(stepped), stepped - first));
    if (!fit) {
      return std::nullopt;
    }
    double found = bounded(first + fit->change());
    if (std::abs(found - first) > fit->change_sigma()) {
      const Halves nearer = at(found);
      fit = fitted(nearer, derivatives_between(base, nearer, found - first));
      found = fit ? bounded(found + fit->change()) : first;
    }
    return fit ? std::optional(told(base, *fit, found - first)) : std::nullopt;
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

  /// Roughness that metal may have.
  double bounded(double roughness) const {
    return std::clamp(roughness, std::max(0.4 * scene_.material.roughness, kMinRoughness), 1.0);
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

  static Halves derivatives_between(const Halves& base, const Halves& changed, double step) {
    Halves derivatives = changed;
    for (std::size_t half = 0; half < 2; ++half) {
      std::ranges::transform(
          changed[half].values(),
          base[half].values(),
          derivatives[half].values().begin(),
          [&](float after, float before) {
            return static_cast<float>(static_cast<double>(after - before) / step);
          });
    }
    return derivatives;
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
            .bound = fit.change_bound(),
            .gain = fit.values[0],
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
