// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/aspect_image/settings.h"

namespace glint {

void visit_keys(KeyVisitor& keys, MetricsSettings& settings) {
  keys.integer("erosion_px",
               settings.erosion_px,
               Range::between(0, 100),
               "rim of the part excluded from the region of interest");
  keys.number("exclusion_radii",
              settings.exclusion_radii,
              Range::at_least(1.0),
              "radii around each defect excluded from homogeneity");
  keys.number("ring_inner_radii",
              settings.ring_inner_radii,
              Range::at_least(1.0),
              "radii at which a defect's background begins");
  keys.number("ring_outer_radii",
              settings.ring_outer_radii,
              Range::at_least(1.0),
              "radii at which a defect's background ends");
  keys.number("lit_threshold",
              settings.lit_threshold,
              Range::between(0.0, 1.0),
              "value of the mean image above which a pixel counts as lit, share of full scale");
  keys.number("signature_sigmas",
              settings.signature_sigmas,
              Range::positive(),
              "deviation that counts as signature, in standard deviations of the background");
  keys.number("signature_floor",
              settings.signature_floor,
              Range::between(0.0, 1.0),
              "smallest deviation that counts as signature, share of full scale");
  keys.number("defect_diameter_px",
              settings.defect_diameter_px,
              Range::between(0.0, 1e4),
              "diameter that parts fine from coarse in homogeneity.residual and .low_share; 0: of "
              "the scene's largest defect, 20 without one");
  keys.number("shading_diameters",
              settings.shading_diameters,
              Range::between(3.0, 100.0),
              "width (sigma) of the shading that homogeneity.residual removes, in diameters");
  keys.integer("regions",
               settings.regions,
               Range::between(1, 100),
               "tiles along each side of the region for homogeneity.worst_region");
  keys.require(settings.ring_outer_radii > settings.ring_inner_radii,
               "ring_outer_radii",
               "must be greater than ring_inner_radii");
}

}  // namespace glint
