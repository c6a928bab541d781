// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/output/unreplaced_files.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using testing::UnorderedElementsAre;

class Unreplaced : public testing::Test {
 protected:
  Unreplaced() {
    for (const char* file : {"out/ring/refit.toml",
                             "out/ring/simulated/views/image.png",
                             "out/ring/simulated/views/part.png",
                             "out/ring/notes.txt",
                             "stage/ring/simulated/views/image.png"}) {
      make_folder((folder_ / file).parent_path());
      write_file(folder_ / file, "");
    }
  }

  std::vector<fs::path> found(const std::vector<fs::path>& kept) {
    return unreplaced_files(folder_ / "out", folder_ / "stage", entries_, kept);
  }

  TemporaryFolder folder_;
  std::vector<fs::path> entries_ = {"ring/refit.toml", "ring/simulated", "dome/refit.toml"};
};

TEST_F(Unreplaced, AreThoseThatTheNewResultDoesNotHave) {
  EXPECT_THAT(found({}), UnorderedElementsAre("ring/refit.toml", "ring/simulated/views/part.png"));
  EXPECT_THAT(found({folder_ / "stage/../out/ring/refit.toml"}),
              UnorderedElementsAre("ring/simulated/views/part.png"))
      << "what is read stays";
}

TEST_F(Unreplaced, AreRemovedWithFoldersThatAreEmptyThen) {
  remove_unreplaced(folder_ / "out", found({}));
  EXPECT_FALSE(fs::exists(folder_ / "out/ring/refit.toml"));
  EXPECT_TRUE(fs::exists(folder_ / "out/ring/simulated/views/image.png"));
  EXPECT_TRUE(fs::exists(folder_ / "out/ring/notes.txt")) << "a person's own file";
  fs::remove_all(folder_ / "stage");
  fs::remove(folder_ / "out/ring/notes.txt");
  remove_unreplaced(folder_ / "out", found({}));
  EXPECT_FALSE(fs::exists(folder_ / "out/ring"));
  EXPECT_TRUE(fs::exists(folder_ / "out"));
}

}  // namespace
}  // namespace glint
