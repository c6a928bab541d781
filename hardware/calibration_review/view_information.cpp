// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration_review/view_information.h"

namespace glint {

SharedInformation view_information(const Bundle& bundle, const BundleView& view) {
  Bundle alone = without_views(bundle);
  alone.lens_prior.reset();
  alone.views = {view};
  return shared_information(alone, compress(alone), bundle.noise);
}

}  // namespace glint
