// SPDX-License-Identifier: GPL-3.0-or-later
//
// Gauss-Newton in gain and roughness: grey values at the scene's roughness and at a quarter more
// give a derivative, the third rendering is at the value that follows. Each rendering is two
// independent pictures of half the samples: products of one with the other have no noise of their
// own, which would make every derivative too small (two-sample instrumental variables).
#include "studies/compare/roughness_cause.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include <Eigen/Dense>

#include "core/image/image_io.h"
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
constexpr float kBright = 0.98F;  ///< at least: clipped
constexpr double kStep = 1.25;    ///< factor on the roughness
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

/// Mean grey of the scene's frames, without one of the two batches.
/// @param dark  grey of the sensor's dark signal, which the scene here has not
ImageF grey_of(const PathPicture& picture,
               const SceneSettings& scene,
               double dark,
               std::optional<std::size_t> without) {
  const Sensor sensor(scene.sensor, picture.sums.width_px, picture.sums.height_px);
  ScanSums sums(picture.sums.width_px, picture.sums.height_px);
  ImageF grey;
  for (const FrameFactors& factors : frame_factors(scene, picture.unit_power_w)) {
    sensor.expose(frame_radiance(picture, factors, without), sums.frames, grey);
    std::ranges::transform(
        grey.values(), sums.sum.values(), sums.sum.values().begin(), std::plus<>());
    ++sums.frames;
  }
  ImageF mean = sums.aspect();
  for (float& value : mean.values()) {
    value += static_cast<float>(dark);
  }
  return mean;
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
        dark_(dark_grey(scene.sensor)),
        real_(reduce(pair.real.grey, factor_)) {}

  std::optional<RoughnessFit> find() {
    const double first = scene_.material.roughness;
    const Halves base = at(first);
    if (!choose_pixels(base)) {
      return std::nullopt;
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
  Halves at(double roughness) {
    SceneSettings scene = scene_;
    scene.material.roughness = roughness;
    const std::shared_ptr<const PathPicture> picture = store_.picture(scene);
    ++renders_;
    if (part_.empty()) {
      part_ = sound_part(picture->sums, kRimPx);
    }
    if (picture->batches.empty()) {  // without noise
      const ImageF whole = grey_of(*picture, scene, dark_, std::nullopt);
      return {whole, whole};
    }
    return {grey_of(*picture, scene, dark_, 1), grey_of(*picture, scene, dark_, 0)};
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
    for (std::size_t i = 0; i < part_.size(); ++i) {
      const float brightest =
          std::max({real_.values()[i], base[0].values()[i], base[1].values()[i]});
      if (part_.values()[i] != 0 && brightest < kBright) {
        pixels_.push_back(i);
      }
    }
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
  double dark_;  ///< grey of the sensor's dark signal, under its gain
  ImageF real_;
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
