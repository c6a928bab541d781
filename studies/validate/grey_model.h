// SPDX-License-Identifier: GPL-3.0-or-later
//
// Small pictures of all views of all designs for changed lights: what a fit of grey values
// compares. Private to the room.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/cache.h"
#include "studies/validate/grey_fit.h"

namespace glint::validate_detail {

/// Of two independent pictures of one scene, each of half the samples: products of one with the
/// other have no noise of their own. Equal where pictures have no noise.
template <class Values>
using Halves = std::array<Values, 2>;

template <class Values>
Values mean_of(const Halves<Values>& halves) {
  return 0.5 * (halves[0] + halves[1]);
}

/// Pixels of all views that take part, one after the other, in shares of the mean real grey of
/// their design, or of a hundred times what rounding may do to it, whichever is more: designs that
/// are dark count less where their pictures tell less.
struct GreyColumns {
  Eigen::VectorXd sum;       ///< grey of all lights together
  Eigen::MatrixXd segments;  ///< grey of each segment of each light that has several
};

/// Pixels of one design.
struct GreyRows {
  Eigen::Index first = 0;
  Eigen::Index count = 0;
};

/// Rows of one view, and which one it is: GreyView::pose.
struct ViewRows {
  GreyRows rows;
  int pose = -1;
};

/// A small change of the camera: of fx fy cx cy k1 k2 k3 p1 p2 in whole pictures, and a motion in
/// its own frame, rotation [rad] before position [mm].
struct CameraChange {
  Eigen::Matrix<double, 9, 1> lens = Eigen::Matrix<double, 9, 1>::Zero();
  Eigen::Matrix<double, 6, 1> motion = Eigen::Matrix<double, 6, 1>::Zero();
};

class GreyModel {
 public:
  using ColumnsPointer = std::shared_ptr<const Halves<GreyColumns>>;

  GreyModel(SceneStore& store, std::span<const GreyDesign> designs);

  /// Of all designs: those that shine, and those whose bodies shade others.
  const std::vector<LitLight>& lights() const { return lights_; }

  /// Index of the first column of segments of a light. @param light  that has several
  Eigen::Index first_segment(std::size_t light) const;

  const std::vector<std::string>& designs() const { return designs_; }

  const GreyRows& rows(std::size_t design) const { return rows_[design]; }

  /// Real grey values.
  const Eigen::VectorXd& real() const { return real_; }

  bool can_change_roughness() const;

  /// Simulated ones with lights moved, as lights and as bodies, and roughness changed; powers and
  /// exposure stay.
  /// @param places_mm  of each light
  /// @param is_fine    with several times the samples, and other random numbers
  ColumnsPointer columns(const std::vector<Eigen::Vector3d>& places_mm,
                         double roughness,
                         bool is_fine = false);

  /// The same with the cameras of all views changed; lights that are fixed to them go along. Pixels
  /// stay those of the unchanged pictures.
  Halves<GreyColumns> columns_by(const CameraChange& camera,
                                 const std::vector<Eigen::Vector3d>& places_mm,
                                 double roughness);

  std::vector<ViewRows> view_rows() const;

  /// Root mean square of the even part of a design's difference: of means over 3 x 3 of these
  /// pixels, less what noise that differs from pixel to pixel makes of it and two standard errors
  /// of that. Also less what rounding to the steps of the recorded pictures makes of the grey
  /// values that the real ones are compared with: real() - difference. Where that may be more than
  /// half of what a design shines, less half a step.
  double even_rms(const Eigen::VectorXd& difference, std::size_t design) const;

  /// The share of a design's pixels whose even part even_rms() sees.
  double even_cover(std::size_t design) const;

  /// The largest share by which that rounding may change the exposure of a design that is as bright
  /// as designed: what is found in its pictures has no part in it, or a dead light would be allowed
  /// whatever it lacks. Infinite for a design that is black.
  double rounding_share(std::size_t design) const { return rounding_[design]; }

  int renders() const { return renders_; }

 private:
  struct SmallView {
    std::size_t design = 0;
    SceneSettings scene;
    ImageF real;
    Mask used = {};
    std::vector<std::string> groups = {};  ///< of lights, as they are rendered
    SensorSettings sensor = {};            ///< of a whole picture
    double step = 0.0;                     ///< of its grey values
    int factor = 1;                        ///< of whole pixels to these
    int pose = -1;
  };

  void add_views(std::size_t design, const GreyDesign& views);
  void take_shared_pose(SmallView& view) const;
  void choose_pixels();
  void use_shares();
  double largest_rounding(std::size_t design, double grey) const;
  void keep_rounding();
  double hidden_share(std::size_t design) const;
  double rounding_of(std::size_t design, const Eigen::VectorXd& expected) const;
  SceneChange change_of(const std::vector<Eigen::Vector3d>& places_mm, double roughness) const;
  Halves<GreyColumns> render(const SceneChange& change,
                             bool is_fine,
                             const CameraChange& camera = {});
  void put_columns(const SmallView& view,
                   const std::vector<ImageF>& pictures,
                   Eigen::Index first,
                   GreyColumns& columns) const;
  std::vector<ImageF> group_pictures(const SmallView& view,
                                     const SceneSettings& scene,
                                     const std::vector<std::string>& names,
                                     std::size_t half);
  std::vector<std::string> column_names() const;

  SceneStore& store_;
  std::vector<std::string> designs_;
  std::vector<SmallView> views_;  ///< design by design
  std::vector<GreyRows> rows_;    ///< of each design
  std::vector<double> means_;     ///< real grey of each design
  std::vector<double> units_;     ///< of each design's rows; its mean, more where it is rounded
  std::vector<double> rounding_;  ///< rounding_share() of each design
  std::vector<LitLight> lights_;
  Eigen::VectorXd real_;
  Cache<std::string, Halves<GreyColumns>> kept_{{.max_values = 8}};
  int renders_ = 0;
};

}  // namespace glint::validate_detail
