// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/geometry_passes.h"

#include <vector>

#include "core/file.h"
#include "core/thread_pool.h"
#include "tests/studies/compare/compare_fixture.h"

namespace glint {
namespace {

class Passes : public CompareFiles {
 protected:
  /// A pair of a design whose light has that height, with edges in both pictures.
  ComparedPair pair_of(int light_mm) const {
    const auto scene = folder() / fmt::format("light_{}.toml", light_mm);
    write_file(scene,
               fmt::format("schema = 1\n"
                           "[part]\nshape = \"plate\"\nlength_mm = 16\nwidth_mm = 12\n"
                           "[material]\ntype = \"conductor\"\nroughness = 0.3\n"
                           "[camera]\nwidth_px = 40\nheight_px = 30\nobject_pixel_mm = 0.6\n"
                           "working_distance_mm = 100\n"
                           "[lighting.ring]\nmount = \"camera\"\nheight_mm = {}\n",
                           light_mm));
    ComparedPair pair;
    pair.simulated.source.scene = scene;
    pair.simulated.grey = ImageF(40, 30, 0.5F);
    pair.geometry.outlines.simulated.located.resize(1);
    pair.geometry.outlines.real.located.resize(1);
    return pair;
  }

  static std::vector<ComparePair> plan_of(const std::vector<ComparedPair>& pairs) {
    std::vector<ComparePair> plan;
    for (const ComparedPair& pair : pairs) {
      plan.push_back({.simulated = pair.simulated.source});
    }
    return plan;
  }

  ThreadPool pool_{2};
  SceneStore store_{pool_};
};

TEST_F(Passes, OfTwoDesignsMakeTheirPartOnce) {
  std::vector<ComparedPair> pairs = {pair_of(40), pair_of(60)};
  GeometryPasses passes(store_, plan_of(pairs));
  for (ComparedPair& pair : pairs) {
    EXPECT_EQ(passes.complete(pair), "");
    EXPECT_TRUE(std::filesystem::exists(pair.simulated.source.geometry));
  }
  EXPECT_NE(pairs[0].simulated.source.geometry, pairs[1].simulated.source.geometry);
  EXPECT_EQ(store_.num_defects_made(), 1);
}

TEST_F(Passes, AreNotRenderedWhereNoEdgesWereLocated) {
  std::vector<ComparedPair> pairs = {pair_of(40), pair_of(40)};
  pairs[0].geometry.outlines.simulated.located.clear();
  pairs[1].geometry.outlines.real.located.clear();
  GeometryPasses passes(store_, plan_of(pairs));
  for (ComparedPair& pair : pairs) {
    EXPECT_EQ(passes.complete(pair), "");
    EXPECT_TRUE(pair.simulated.source.geometry.empty());
  }
  EXPECT_EQ(passes.render_s(), 0.0);
}

// Two pairs of one design, one of another.
TEST_F(Passes, AreRemovedAfterTheLastPairOfTheirView) {
  std::vector<ComparedPair> pairs = {pair_of(40), pair_of(60), pair_of(40)};
  GeometryPasses passes(store_, plan_of(pairs));
  std::vector<std::filesystem::path> files;
  for (ComparedPair& pair : pairs) {
    passes.complete(pair);
    files.push_back(pair.simulated.source.geometry);
  }
  EXPECT_EQ(files[0], files[2]);
  passes.release(pairs[0]);
  EXPECT_TRUE(std::filesystem::exists(files[0]));
  EXPECT_TRUE(pairs[0].simulated.source.geometry.empty());
  passes.release(pairs[2]);
  EXPECT_FALSE(std::filesystem::exists(files[0]));
  EXPECT_TRUE(std::filesystem::exists(files[1]));
}

// What is in a view's own folder stays there.
TEST_F(Passes, LeaveTheGeometryOfARenderedViewAlone) {
  ComparedPair pair = pair_of(40);
  pair.simulated.source.geometry = folder() / "geometry.exr";
  write_file(pair.simulated.source.geometry, "");
  GeometryPasses passes(store_, plan_of({pair}));
  EXPECT_EQ(passes.complete(pair), "");
  passes.release(pair);
  EXPECT_EQ(pair.simulated.source.geometry, folder() / "geometry.exr");
  EXPECT_TRUE(std::filesystem::exists(folder() / "geometry.exr"));
  EXPECT_EQ(store_.num_defects_made(), 0);
}

}  // namespace
}  // namespace glint
