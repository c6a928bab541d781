// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where normals alone stop being enough, over depth, size and viewing angle. Prints the table of
// docs/theory/imprint.md.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "studies/imaging/realisation.h"
#include "tests/studies/imaging/realisation_support.h"

namespace glint {
namespace {

TEST(Realisation, TheEstimateOfItsErrorIsOnTheSafeSide) {
  ThreadPool pool(2);
  SceneStore store(pool);
  int cases = 0;
  int within = 0;
  fmt::print("view_deg diameter_mm depth_um slope_mrad contrast rms_share max_share estimate\n");
  for (const double view_deg : {0.0, 15.0, 30.0, 45.0, 60.0}) {
    for (const double diameter_mm : {0.4, 0.8, 1.6}) {
      for (const double depth_um : {1.0, 4.0, 16.0, 64.0}) {
        const realisation::Dent dent = {
            .depth_um = depth_um, .diameter_mm = diameter_mm, .view_rad = view_deg * kRadPerDeg};
        const realisation::Difference seen = realisation::difference(store, dent);
        const Defect defect = {
            .type = DefectType::kDent, .depth_mm = depth_um * 1e-3, .diameter_mm = diameter_mm};
        const double estimate = normal_error(defect, dent.view_rad, 150.0);
        fmt::print("{:8g} {:11g} {:8g} {:10.4g} {:8.3f} {:9.4f} {:9.4f} {:8.4f}\n",
                   view_deg,
                   diameter_mm,
                   depth_um,
                   height_feature(defect, {}).max_slope_rad() * 1e3,
                   seen.contrast,
                   seen.rms_share,
                   seen.max_share,
                   estimate);
        const double allowed = std::max(0.01, estimate);
        ++cases;
        within += seen.max_share <= allowed ? 1 : 0;
        EXPECT_GT(seen.contrast, 0.005);
        EXPECT_LE(seen.max_share, 2.0 * allowed);
      }
    }
  }
  fmt::print("{} of {} within the estimate or 1 %\n", within, cases);
  EXPECT_GE(within, cases * 9 / 10);
}

}  // namespace
}  // namespace glint
