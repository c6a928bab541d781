// SPDX-License-Identifier: GPL-3.0-or-later
//
// A part one face of which is not where it should be: `glint compare` names the edges of that face
// and no others.
#include <array>
#include <memory>

#include "core/config/toml.h"
#include "core/file.h"
#include "simulator/camera/pinhole_camera.h"
#include "studies/definition/scene.h"
#include "tests/cli/program.h"

namespace glint::test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A box as facets of an ASCII STL.
std::string box_facets(const Vector3d& low, const Vector3d& high) {
  constexpr std::array<std::array<int, 4>, 6> kSides = {
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  const auto vertex = [&](int corner) {
    return fmt::format("vertex {} {} {}\n",
                       (corner & 1) != 0 ? high.x() : low.x(),
                       (corner & 2) != 0 ? high.y() : low.y(),
                       (corner & 4) != 0 ? high.z() : low.z());
  };
  std::string text;
  for (const auto& [a, b, c, d] : kSides) {
    for (const auto& [i, j, k] : {std::array{a, b, c}, std::array{a, c, d}}) {
      text += "facet normal 0 0 0\nouter loop\n" + vertex(i) + vertex(j) + vertex(k) +
              "endloop\nendfacet\n";
    }
  }
  return text;
}

/// A block of 40 x 30 x 10 mm with a pad of 6 mm on it, whose side to +x lies at face_mm.
std::string block_stl(double face_mm) {
  return "solid block\n" + box_facets({-20, -15, 0}, {20, 15, 10}) +
         box_facets({-10, -8, 10}, {face_mm, 8, 16}) + "endsolid block\n";
}

constexpr const char* kScene = R"(schema = 1
[part]
shape = "mesh"
file = "block.stl"
[material]
type = "conductor"
roughness = 0.5
[camera]
width_px = 400
height_px = 320
pixel_um = 10
focal_mm = 9
object_pixel_mm = 0
working_distance_mm = 150
[lens]
focus_mm = 150
[[viewpoint]]
position_mm = [70, -90, 95]
direction = [-70, 90, -88]
up = [0, 0, 1]
[sensor]
full_well_e = 10000
read_noise_e = 8
blur_px = 0.8
[lighting.dome]
position_mm = [30, -60, 60]
radius_mm = 250
radiance = [0.5]
[lighting.ring]
mount = "camera"
inner_radius_mm = 35
outer_radius_mm = 65
height_mm = 20
radiance = [4]
[render.paths]
samples = 64
max_reflections = 1
)";

/// All tests share a folder with the picture of the block, a.
class MovedFace : public ::testing::Test {
 protected:
  static constexpr double kMoved_mm = 0.3;

  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    write_file(*folder_ / "block.stl", block_stl(8.0));
    write_file(*folder_ / "moved.stl", block_stl(8.0 + kMoved_mm));
    write_file(*folder_ / "scene.toml", kScene);
    render("block.stl", "1", "a");
  }

  static void TearDownTestSuite() { folder_.reset(); }

  static void render(const std::string& part, const std::string& seed, const std::string& out) {
    const ProgramResult result = glint_in(*folder_,
                                          {"render",
                                           "scene.toml",
                                           "--quiet",
                                           "--set",
                                           "part.file=" + part,
                                           "--set",
                                           "sensor.seed=" + seed,
                                           "--set",
                                           "render.paths.seed=" + seed,
                                           "--out",
                                           out});
    ASSERT_EQ(result.code, 0) << result.err;
  }

  /// How far the picture of an edge along y moves across itself when it moves along x, in px: the
  /// mean over its 16 mm. Heights count from the middle of the part.
  double moved_px(double z_mm) const {
    std::vector<Problem> errors;
    const SceneSettings scene = read_scene(load_toml(*folder_ / "a/baseline/scene.toml"), errors);
    throw_if_any(errors);
    const PinholeCamera camera(intrinsics_of(scene));
    const RigidTransform pose = camera_from_world(scene.viewpoint());
    const auto pixel = [&](double x, double y) {
      return camera.project(pose * Vector3d(x, y, z_mm)).value();
    };
    double sum = 0.0;
    double y = -7.5;
    while (y < 8.0) {
      const Vector2d along = (pixel(8.0, y + 0.1) - pixel(8.0, y)).normalized();
      const Vector2d step = pixel(8.0 + kMoved_mm, y) - pixel(8.0, y);
      sum += std::abs(along.x() * step.y() - along.y() * step.x()) / 16.0;
      y += 1.0;
    }
    return sum;
  }

  inline static std::unique_ptr<TemporaryFolder> folder_;
};

TEST_F(MovedFace, IsNamedByItsEdges) {
  render("moved.stl", "2", "b");
  const nlohmann::json pair =
      json_of(*folder_, {"compare", "a", "b", "--quiet", "--out", "out"})["pairs"][0];
  int moved = 0;
  int still = 0;
  for (const nlohmann::json& edge : pair["edges"]) {
    const auto surface = edge["surface"].get<std::string>();
    const auto beyond = edge["beyond"].get<std::string>();
    const double offset = edge["offset_px"].get<double>();
    const double sigma = edge["sigma_px"].get<double>();
    std::printf("%s: %s | %s: %.3f +- %.3f px\n",
                edge["name"].get<std::string>().c_str(),
                surface.c_str(),
                beyond.c_str(),
                offset,
                sigma);
    if (beyond == "plane facing +x at x = 8.0 mm") {
      // The lower edge moves away from the larger plane, the upper one onto the face.
      const bool is_upper = surface == "plane facing +z at z = 8.0 mm";
      EXPECT_NEAR(offset, is_upper ? moved_px(8.0) : -moved_px(2.0), 0.15);
      EXPECT_NEAR(std::abs(edge["offset_mm"].get<double>()) / std::abs(offset), 0.148, 0.01);
      ++moved;
    } else {
      EXPECT_LE(std::abs(offset), std::max(4.0 * sigma, 0.05)) << edge;
      ++still;
    }
  }
  EXPECT_EQ(moved, 2);
  EXPECT_GE(still, 7);
  EXPECT_TRUE(pair["unlisted_edges"]["count"].is_number_unsigned());
  EXPECT_LT(pair["unlisted_edges"]["outline_share"].get<double>(), 0.15);
}

// The same picture twice: every edge is where it is.
TEST_F(MovedFace, IsNotThereInEqualPictures) {
  const nlohmann::json pair =
      json_of(*folder_, {"compare", "a", "a", "--quiet", "--out", "same"})["pairs"][0];
  EXPECT_GE(pair["edges"].size(), 9U);
  for (const nlohmann::json& edge : pair["edges"]) {
    EXPECT_EQ(edge["mean_px"].get<double>(), 0.0) << edge;
  }
}

}  // namespace
}  // namespace glint::test
