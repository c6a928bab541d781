// SPDX-License-Identifier: GPL-3.0-or-later
//
// What render.method = "blurred" takes and refuses, with the places of keys.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/toml.h"
#include "studies/definition/render_methods.h"

namespace glint {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

using Method = RenderSettings::Method;

const std::string kRender = "[render]\nmethod = \"blurred\"\n";
const std::string kMetal = "[material]\ntype = \"conductor\"\n";

std::vector<std::string> blurred_errors(const std::string& text) {
  std::vector<Problem> errors;
  read_scene(parse_toml(text, "s.toml"), errors);
  return messages_of(errors);
}

std::vector<std::string> errors_of_metal(const std::string& text) {
  return blurred_errors(kRender + kMetal + text);
}

SceneSettings satin_blurred() {
  SceneSettings scene;
  scene.material.type = MaterialSettings::Type::kConductor;
  scene.material.alpha = {0.05};
  scene.render.method = Method::kBlurred;
  return scene;
}

TEST(BlurredRange, IsReachedFromAFile) {
  EXPECT_THAT(errors_of_metal("alpha = [0.05]\n"), IsEmpty());
  for (const char* width : {"alpha = [0.02]", "alpha = [0.1]", "alpha = [0.1, 0.1]"}) {
    EXPECT_THAT(errors_of_metal(width), IsEmpty()) << width;
  }
  EXPECT_THAT(errors_of_metal("roughness = 0.25\n"), IsEmpty()) << "a width of 0.0625";
}

TEST(BlurredRange, RefusesOtherWidthsAtTheirPlaces) {
  EXPECT_THAT(errors_of_metal("alpha = [0.019]\n"),
              ElementsAre(AllOf(StartsWith("s.toml:5:"),
                                HasSubstr("material.alpha: is 0.019"),
                                HasSubstr("allowed are 0.02 to 0.1"))));
  EXPECT_THAT(errors_of_metal("alpha = [0.1001]\n"), ElementsAre(HasSubstr("is 0.1001")));
  EXPECT_THAT(errors_of_metal("alpha = [0.05, 0.06]\n"),
              ElementsAre(HasSubstr("material.alpha: makes widths along and across differ")));
  EXPECT_THAT(errors_of_metal("roughness = 0.4\n"),
              ElementsAre(AllOf(StartsWith("s.toml:5:"), HasSubstr("a width of 0.16"))));
  EXPECT_THAT(errors_of_metal("roughness = 0\n"), ElementsAre(HasSubstr("a width of 0,")));
  EXPECT_THAT(errors_of_metal("anisotropy = 0.2\n"),
              ElementsAre(AllOf(StartsWith("s.toml:5:"), HasSubstr("material.anisotropy"))));
}

TEST(BlurredRange, RefusesOtherMaterials) {
  EXPECT_THAT(blurred_errors(kRender), ElementsAre(HasSubstr("material.type: is \"mirror\"")));
  EXPECT_THAT(blurred_errors(kRender + "[material]\ntype = \"diffuse\"\n"),
              ElementsAre(AllOf(StartsWith("s.toml:4:"), HasSubstr("allowed is \"conductor\""))));
  EXPECT_THAT(errors_of_metal("[material.coat]\nindex = 1.5\n"),
              ElementsAre(AllOf(StartsWith("s.toml:6:"), HasSubstr("material.coat.index"))));
  EXPECT_THAT(errors_of_metal("[defects.stain]\n"),
              ElementsAre(AllOf(StartsWith("s.toml:5:"), HasSubstr("defects.stain.type"))));
}

TEST(BlurredRange, RefusesOtherLight) {
  EXPECT_THAT(errors_of_metal("[lighting.tunnel]\nled_ripple = 0.1\n"),
              ElementsAre(AllOf(StartsWith("s.toml:6:"),
                                HasSubstr("lighting.tunnel.led_ripple: is 0.1"),
                                HasSubstr("allowed is 0, or render.method = \"paths\""))));
  EXPECT_THAT(errors_of_metal("[lighting.tunnel]\nend_falloff = 0.1\n"),
              ElementsAre(HasSubstr("lighting.tunnel.end_falloff")));
  EXPECT_THAT(
      errors_of_metal("[lighting.ring]\n[lighting.tunnel]\n"),
      ElementsAre(AllOf(StartsWith("s.toml:5:"), HasSubstr("lighting.ring: is switched on, too"))));
  EXPECT_THAT(errors_of_metal("[lighting.ring]\n"),
              ::testing::Contains(HasSubstr("render.method: is used where no tunnel is")));
  EXPECT_THAT(errors_of_metal("[lighting.one]\ntype = \"tunnel\"\n[lighting.two]\ntype = "
                              "\"tunnel\"\n"),
              ::testing::SizeIs(1));
}

TEST(BlurredRange, RefusesOtherCameras) {
  EXPECT_THAT(errors_of_metal("[sensor]\nwavelengths_nm = [630, 532, 465]\n"),
              ElementsAre(AllOf(StartsWith("s.toml:6:"), HasSubstr("a grey camera"))));
  EXPECT_THAT(errors_of_metal("[lens]\nfocus_mm = 300\nf_number = 4\n[camera]\nfocal_mm = "
                              "12\nobject_pixel_mm = 0\n"),
              ElementsAre(AllOf(StartsWith("s.toml:7:"), HasSubstr("lens.f_number: is 4"))));
  EXPECT_THAT(errors_of_metal("[[viewpoint]]\n[[viewpoint]]\n"),
              ElementsAre(HasSubstr("a scan has exactly one [[viewpoint]]")));
}

TEST(BlurredRange, IsAskedForAndNotChosen) {
  SceneSettings scene = satin_blurred();
  EXPECT_FALSE(needs_paths(scene));
  scene.render.method = Method::kAuto;
  EXPECT_TRUE(needs_paths(scene));
  EXPECT_THAT(blurred_problems(scene), IsEmpty());
}

TEST(BlurredRange, HasItsOwnFramesAndItsFinerOnesHaveMoreRays) {
  const SceneSettings scene = satin_blurred();
  EXPECT_EQ(frame_method(scene).name, "blurred");
  EXPECT_FALSE(frame_method(scene).has_closed_mean);
  EXPECT_EQ(rescoring_settings(scene).render.method, Method::kBlurred);
  EXPECT_EQ(rescoring_settings(scene).render.rays_per_axis, 2 * scene.render.rays_per_axis);
  EXPECT_EQ(coarse_settings(scene).render.method, Method::kBlurred);
  EXPECT_EQ(coarse_settings(scene).render.rays_per_axis, 1);
}

}  // namespace
}  // namespace glint
