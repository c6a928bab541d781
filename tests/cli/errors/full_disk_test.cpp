// SPDX-License-Identifier: GPL-3.0-or-later
//
// Disks that are full before, while and after a run writes, and under every other verb. Skipped
// where mounting is not permitted; the tests with limits on files run everywhere.
#include <sys/mount.h>

#include <algorithm>
#include <cstdint>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "core/image/image_io.h"
#include "tests/cli/imprint_fixture.h"
#include "tests/cli/program.h"

namespace glint::test {
namespace {
namespace fs = std::filesystem;

using ::testing::MatchesRegex;

/// A file system of so many bytes, mounted where that is permitted.
class SmallDisk {
 public:
  SmallDisk(const fs::path& folder, std::uintmax_t bytes) : folder_(folder) {
    fs::create_directories(folder);
    is_mounted_ = mount_with(bytes, 0);
  }

  ~SmallDisk() {
    if (is_mounted_) {
      ::umount2(folder_.c_str(), MNT_DETACH);
    }
  }

  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  bool is_mounted() const { return is_mounted_; }

  bool grow(std::uintmax_t bytes) const { return mount_with(bytes, MS_REMOUNT); }

 private:
  bool mount_with(std::uintmax_t bytes, unsigned long flags) const {
    const std::string size = "size=" + std::to_string(bytes);
    return ::mount("glint_test", folder_.c_str(), "tmpfs", flags, size.c_str()) == 0;
  }

  fs::path folder_;
  bool is_mounted_ = false;
};

/// What the files below a folder take, in whole pages.
std::uintmax_t bytes_of(const fs::path& folder) {
  constexpr std::uintmax_t kPage = 4096;
  std::uintmax_t bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    bytes += entry.is_regular_file() ? (entry.file_size() / kPage + 1) * kPage : 0;
  }
  return bytes;
}

/// study.toml to run, render and chart, shaft.toml to imprint, a photograph to inspect.
class FullDisk : public ImprintVerb {
 protected:
  void SetUp() override {
    write_file(folder_ / "study.toml", small_study());
    write_file(folder_ / "shaft.toml", kShaft);
    write_png(folder_ / "photo.png", ImageF(200, 150, 0.5F), PixelDepth::k8Bit);
    const SmallDisk disk(folder_ / "disk", 4096);
    if (!disk.is_mounted()) {
      GTEST_SKIP() << "mounting is not permitted";
    }
  }

  ProgramResult glint(Arguments arguments) const {
    arguments.emplace_back("--quiet");
    return glint_in(folder_, arguments);
  }

  /// One line that names a file on the disk and says that it is full.
  static void expect_full(const ProgramResult& result, const std::string& verb) {
    EXPECT_EQ(result.code, 3) << verb;
    EXPECT_THAT(result.err, MatchesRegex("disk/[^ ]*: .*(No space left on device|disk.* full).*\n"))
        << verb;
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
  }
};

TEST_F(FullDisk, LeavesNothingOfWhatHasNotBegun) {
  for (const std::uintmax_t bytes : {4096U, 40960U}) {
    const SmallDisk disk(folder_ / "disk", bytes);
    expect_full(glint({"run", "study.toml", "--out", "disk/a/b"}), "run");
    EXPECT_TRUE(fs::is_empty(folder_ / "disk")) << bytes;
    expect_full(glint({"render", "study.toml", "--out", "disk/pictures"}), "render");
    EXPECT_TRUE(fs::is_empty(folder_ / "disk")) << bytes;
  }
}

// The same command goes on when there is room, and ends with the same bytes.
TEST_F(FullDisk, EndsARunThatGoesOnLater) {
  ASSERT_EQ(glint({"run", "study.toml", "--out", "whole"}).code, 0);
  const auto whole = static_cast<double>(bytes_of(folder_ / "whole"));
  for (const double share : {0.15, 0.4, 0.7, 0.95}) {
    const SmallDisk disk(folder_ / "disk", static_cast<std::uintmax_t>(share * whole));
    expect_full(glint({"run", "study.toml", "--out", "disk/run"}), "run");
    ASSERT_TRUE(disk.grow(std::uintmax_t{64} << 20U));
    EXPECT_EQ(glint({"run", "study.toml", "--out", "disk/run"}).code, 0);
    expect_same_files(folder_ / "disk/run", folder_ / "whole");
  }
}

TEST_F(FullDisk, OfAnyVerbIsToldWithTheFileAndKeepsNoPieces) {
  ASSERT_EQ(glint({"run", "study.toml", "--out", "run"}).code, 0);
  const std::vector<Arguments> verbs = {{"imprint", "shaft.toml", "--out", "disk/part"},
                                        {"inspect", "photo.png", "--out", "disk/inspected"},
                                        {"report", "run", "--out", "disk/page.html"},
                                        {"part", "shaft.toml", "--out", "disk/part.stl"},
                                        {"frontier", "study.toml", "--out", "disk/chart"}};
  for (const Arguments& verb : verbs) {
    const SmallDisk disk(folder_ / "disk", 4096);
    expect_full(glint(verb), verb.front());
    EXPECT_TRUE(fs::is_empty(folder_ / "disk")) << verb.front();
  }
}

}  // namespace
}  // namespace glint::test
