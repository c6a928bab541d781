// SPDX-License-Identifier: GPL-3.0-or-later
//
// What both sides show of a blade's defects.
#include "studies/validate/compared_view.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/thread_pool.h"
#include "studies/validate/validate_result.h"
#include "tests/studies/compare/known_defects.h"

namespace glint::validate_detail {
namespace {

class TwoDentsTest : public KnownDefects {
 protected:
  /// A blade with dents 40 px left and right of the picture's middle, of radius 5 px.
  ComparedPair compared() const {
    return compared_with(
        R"({"id": 0, "label": "dent_1", "kind": "dent", "centre_mm": [-4, 0, 0], "area_px": 78.5},
           {"id": 1, "label": "dent_2", "kind": "dent", "centre_mm": [4, 0, 0], "area_px": 78.5})");
  }

  /// What both sides show where the photograph has the part so far to the left.
  SeenContrasts seen(ComparedPair& pair, double left_px) {
    pair.geometry.outlines.motion = OutlineMotion{.shift_px = {-left_px, 0.0}};
    pair.geometry.outlines.shown = 1.0;
    nlohmann::ordered_json row;
    return inspect_both(pair, 0.1, pool_, row);
  }

  ThreadPool pool_{1};
};

// Moved by 75 px one of both dents lies outside the photograph, by 150 px both do: what is not in
// it can neither be found nor missed there.
TEST_F(TwoDentsTest, AreCountedWhereTheyAreInThePicture) {
  ComparedPair pair = compared();
  SeenContrasts all = seen(pair, 0.0);
  EXPECT_EQ(all.defects_real, 2);
  const SeenContrasts one = seen(pair, 75.0);
  EXPECT_EQ(one.defects, 2);
  EXPECT_EQ(one.defects_simulated, 2);
  EXPECT_EQ(one.defects_real, 1);
  EXPECT_TRUE(seen_json(seen(pair, 150.0))["rate_real"].is_null());
  // Wilson's interval of 0 of 3: up to z^2 / (3 + z^2), z = 1.96; of 0 of 4 it would be 0.490.
  all.add(one);
  const nlohmann::ordered_json json = seen_json(all);
  EXPECT_EQ(json["defects"], 4);
  EXPECT_EQ(json["defects_real"], 3);
  ASSERT_EQ(json["found_real"], 0);
  EXPECT_NEAR(json["rate_real"]["high"].get<double>(), 0.5615, 5e-4);
}

}  // namespace
}  // namespace glint::validate_detail
