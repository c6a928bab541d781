// SPDX-License-Identifier: GPL-3.0-or-later
//
// What errors of lens and camera pose make of a fit of grey values: the camera is where the edges
// have it, as well as calibration, robot and edges tell, and a light that is fixed to it goes along
// with its error. Private to the room.
#pragma once

#include <span>

#include <Eigen/Core>

#include "studies/validate/grey_terms.h"

namespace glint::validate_detail {

/// Adds to the standard deviation of each number of a fit what they make of it: the root of the
/// diagonal of J C J^T, J by finite differences of the fit's step, through renderings with the
/// camera changed.
/// @param state       where the fit stands
/// @param system      its derivatives there
/// @param left        what it leaves of the real grey values, for the weights of pixels
/// @param covariance  GeometryFit::covariance; GreyView::pose tells a view's numbers. Empty: there
///                    are none
void add_camera_errors(GreyProblem& problem,
                       const GreyState& state,
                       const GreySystem& system,
                       const GreyHalves& left,
                       const Eigen::MatrixXd& covariance,
                       Eigen::VectorXd& sigma);

/// The variance that they add, from derivatives that are known. @param by  of each number of the
/// covariance the derivatives of all grey values
Eigen::VectorXd added_variance(const GreySystem& system,
                               const GreyHalves& left,
                               std::span<const GreyHalves> by,
                               const Eigen::MatrixXd& covariance);

}  // namespace glint::validate_detail
