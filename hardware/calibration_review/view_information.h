// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "hardware/calibration/variance_components.h"

namespace glint {

/// What a single picture says of the shared unknowns of a solved bundle, without what is known
/// beforehand.
SharedInformation view_information(const Bundle& bundle, const BundleView& view);

}  // namespace glint
