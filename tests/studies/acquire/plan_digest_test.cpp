// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/plan_digest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/text.h"
#include "studies/acquire/acquire_run.h"
#include "studies/acquire/journal.h"
#include "studies/cell/pose_numbers.h"
#include "studies/cell/typed_permit.h"
#include "studies/cell_camera/cell_camera.h"
#include "studies/output/result_folder.h"
#include "tests/studies/acquire/run_of_prototypes.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;

/// A folder as a whole acquisition of the lonely cell's only view leaves it.
/// @param digest  of an earlier program; empty: this one's
void write_pictures(const AcquireOptions& options, const std::string& digest = "") {
  const Cell cell = read_cell(options.cell);
  const AcquireWork work = work_of(read_source(options.source), cell, options.speed_share);
  make_folder(options.out);
  AcquireJournal journal(options.out, digest.empty() ? work.digest : digest, "", work.grounds);
  journal.keep({.view = work.plan.tasks.front().name, .file = "views/view_1/frame_000.png"},
               "bytes of a picture");
  write_file(options.out / "acquired.json",
             R"({"kind": "acquired", "status": "complete", "pictures": []})");
  mark_result_folder(options.out, ResultKind::kAcquire);
}

TEST_F(PrototypesOfARun, AreNotAskedForWhenAllPicturesAreThere) {
  write_file(folder_ / "cell.toml", kLonelyCell);
  AcquireOptions options = {.source = scene("wide"), .cell = folder_ / "cell.toml"};
  options.out = folder_ / "out";
  write_pictures(options);
  const MotionPermit permit = typed_permit(true, "acquire");
  EXPECT_THROW(acquire_pictures(options, permit), IoError) << "nobody listens, nobody is asked";
  EXPECT_TRUE(describe_acquisition(options)["next"].is_null());
  write_file(scene("wide"), scene_text(65));
  EXPECT_THAT([&] { acquire_pictures(options, permit); },
              testing::ThrowsMessage<ConfigError>(HasSubstr("another plan, cell, scene or")))
      << "pictures of another prototype";
  write_file(scene("wide"), scene_text(60));
  write_file(options.out / "views/view_1/frame_000.png", "other bytes");
  EXPECT_EQ(acquire_pictures(options, permit)["status"], "waiting");
  std::filesystem::remove(options.out / "views/view_1/frame_000.png");
  EXPECT_EQ(acquire_pictures(options, permit)["status"], "waiting");
}

TEST_F(PrototypesOfARun, AreNotReadFromWherePicturesAreWritten) {
  AcquireOptions options = {.source = scene("wide"), .cell = folder_ / "out/cell.toml"};
  options.out = folder_ / "out";
  make_folder(options.out);
  write_file(options.cell, kLonelyCell);
  mark_result_folder(options.out, ResultKind::kAcquire);
  EXPECT_THAT(
      [&] { describe_acquisition(options); },
      testing::ThrowsMessage<ConfigError>(HasSubstr("out/cell.toml: is read, and lies where")));
}

// Its camera would see other grey values: they are no pictures of this design.
TEST_F(PrototypesOfARun, HaveNoPicturesOfAnotherPower) {
  write_file(folder_ / "cell.toml", kLonelyCell);
  AcquireOptions options = {.source = scene("wide"), .cell = folder_ / "cell.toml"};
  options.out = folder_ / "out";
  write_pictures(options);
  const MotionPermit permit = typed_permit(true, "acquire");
  write_file(scene("wide"), scene_text(60, 8));
  EXPECT_THAT([&] { acquire_pictures(options, permit); },
              testing::ThrowsMessage<ConfigError>(HasSubstr("of lights at another power")));
  write_file(scene("dark"), scene_text(70, 0));
  options.source = scene("dark");
  options.out = folder_ / "dark";
  write_pictures(options);
  const std::string off = scene_text(70, 0);
  write_file(scene("dark"), off.substr(0, off.rfind("radiance = [8]")) + "power_w = [3]\n");
  EXPECT_THROW(describe_acquisition(options), ConfigError) << "power of the bar";
}

/// What is said where the pictures of this work are looked for.
std::string refusal(const AcquireOptions& options) {
  try {
    describe_acquisition(options);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

// Tour, lights and exposures are those of the other part, too.
TEST_F(PrototypesOfARun, HaveNoPicturesOfAnotherPartOrByAnotherSetCamera) {
  const std::string cell = kLonelyCell;
  write_file(folder_ / "cell.toml", cell);
  AcquireOptions options = {.source = scene("wide"), .cell = folder_ / "cell.toml"};
  options.out = folder_ / "out";
  write_pictures(options);
  EXPECT_EQ(refusal(options), "");
  std::string longer = scene_text(60);
  longer.replace(longer.find("length_mm = 40"), 14, "length_mm = 41");
  write_file(scene("wide"), longer);
  EXPECT_THAT(refusal(options),
              testing::AllOf(HasSubstr("[part] length_mm is 40"), HasSubstr("and 41")));
  write_file(scene("wide"), scene_text(60));
  write_file(folder_ / "cell.toml", cell + "[camera.features]\nGamma = 0.5\n");
  EXPECT_THAT(refusal(options), HasSubstr("[camera.features] Gamma is not set there, and 0.5"));
}

// The rest of a scan would stand between the pictures that are there, or beside them.
TEST_F(PrototypesOfARun, HaveNoPicturesAtOtherPlacesOfTheStage) {
  const auto write_cell = [&](const std::string& stage) {
    write_file(folder_ / "cell.toml",
               std::string(kLonelyCell) + "[stage]\npositions = 6\n" + stage);
  };
  const std::string rail = "host = \"127.0.0.1\"\n";
  write_cell(rail + "step_mm = 2\n");
  AcquireOptions options = {.source = scene("wide"), .cell = folder_ / "cell.toml"};
  options.out = folder_ / "out";
  write_pictures(options);
  EXPECT_EQ(refusal(options), "");
  write_cell(rail + "step_mm = 1\n");
  EXPECT_THAT(refusal(options), HasSubstr("[stage] step_mm is 2 there, and 1 now"));
  write_cell(rail + "step_mm = 2\nfirst_mm = 20\n");
  EXPECT_THAT(refusal(options), HasSubstr("[stage] first_mm is 0 there, and 20 now"));
  write_cell(rail + "step_mm = 2\nspeed_mm_s = 5\n");
  EXPECT_EQ(refusal(options), "") << "it gets there, if later";
}

// A folder of an earlier program says nothing of its stage, and goes on.
TEST(PictureGrounds, KnowADisplayByThePicturesThatItShows) {
  const TemporaryFolder folder;
  make_folder(folder / "show");
  write_file(folder / "cell.toml",
             std::string(kLonelyCell) +
                 "[stage]\nkind = \"folder\"\nfolder = \"show\"\npositions = 2\n"
                 "pictures = [\"a.png\", \"b.png\", \"c.png\"]\n");
  const auto grounds = [&](const std::string& b, const std::string& c) {
    write_file(folder / "a.png", "a");
    write_file(folder / "b.png", b);
    write_file(folder / "c.png", c);
    return picture_grounds(nullptr, read_cell(folder / "cell.toml"));
  };
  const PictureGrounds first = grounds("b", "c");
  EXPECT_THAT(ground_difference(first, grounds("other", "c")),
              HasSubstr("[stage] pictures, number 2 is SHA-256"));
  EXPECT_EQ(ground_difference(first, grounds("b", "other")), "") << "no position shows it";
  PictureGrounds former = first;
  std::erase_if(former, [](const auto& ground) { return ground.first.starts_with("[stage]"); });
  EXPECT_EQ(ground_difference(former, first), "");
}

// The file's name does not tell what is in it.
TEST(PictureGrounds, KnowAMeshByWhatItsFileHolds) {
  const TemporaryFolder folder;
  write_file(folder / "cell.toml", kLonelyCell);
  const Cell cell = read_cell(folder / "cell.toml");
  SceneSettings scene;
  scene.part.shape = PartSettings::Shape::kMesh;
  const auto grounds = [&](const std::string& name, const std::string& bytes) {
    write_file(folder / name, bytes);
    scene.part.file = folder / name;
    return picture_grounds(&scene, cell);
  };
  const PictureGrounds first = grounds("a.stl", "solid a");
  EXPECT_EQ(ground_difference(first, grounds("b.stl", "solid a")), "");
  EXPECT_THAT(ground_difference(first, grounds("a.stl", "solid b")),
              HasSubstr("[part] file is SHA-256"));
  EXPECT_EQ(ground_difference(first, picture_grounds(nullptr, cell)), "") << "no part is named";
}

/// As programs before powers counted made it.
std::string former_digest(const AcquireOptions& options) {
  const Cell cell = read_cell(options.cell);
  const AcquireSource source = read_source(options.source);
  const AcquireWork work = work_of(source, cell, options.speed_share);
  Json json = {{"positions", work.num_positions}, {"step_mm", work.steps.to_next_mm}};
  for (const TourPoint& point : work.plan.tour) {
    json["tour"].push_back({point.name, joints_deg(point.joints_rad)});
  }
  for (const ViewTask& task : work.plan.tasks) {
    json["tasks"].push_back({task.name, task.point, task.lights, task.exposure_us});
  }
  const CellCamera& camera = camera_of(cell);
  json["camera"] = {
      static_cast<int>(camera.pixel_format), camera.gain_db.value_or(0.0), camera.region_px};
  json["built_lights"] = built_lights(*source.scene);
  return sha256_hex(json.dump());
}

TEST_F(PrototypesOfARun, FindTheirPicturesOfEarlierPrograms) {
  write_file(folder_ / "cell.toml", kLonelyCell);
  AcquireOptions options = {.source = scene("wide"), .cell = folder_ / "cell.toml"};
  options.out = folder_ / "out";
  write_pictures(options, former_digest(options));
  write_file(options.out / "scene.toml", scene_text(60));
  EXPECT_TRUE(describe_acquisition(options)["next"].is_null()) << "every picture is there";
  EXPECT_THROW(acquire_pictures(options, typed_permit(true, "acquire")), IoError)
      << "nobody listens, nobody is asked";
  write_file(options.out / "scene.toml", scene_text(60, 8));
  EXPECT_THROW(describe_acquisition(options), ConfigError)
      << "the scene that it keeps was brighter";
  write_file(options.out / "scene.toml", scene_text(60));
  EXPECT_NO_THROW(describe_acquisition(options));
  const AcquireWork work =
      work_of(read_source(options.source), read_cell(options.cell), options.speed_share);
  AcquireJournal(options.out, former_digest(options), "", work.grounds).end_session();
  EXPECT_THROW(describe_acquisition(options), ConfigError)
      << "the scene is that of a session that took nothing: the pictures may be others";
}

// Sessions of this program keep what they have found to be theirs.
TEST_F(PrototypesOfARun, FindTheirPicturesOfEarlierProgramsAgain) {
  write_file(folder_ / "cell.toml", kLonelyCell);
  AcquireOptions options = {.source = scene("wide"), .cell = folder_ / "cell.toml"};
  options.out = folder_ / "out";
  write_pictures(options, former_digest(options));
  EXPECT_THROW(describe_acquisition(options), ConfigError) << "nobody knows how bright they are";
  write_file(options.out / "scene.toml", scene_text(60));
  const Cell cell = read_cell(options.cell);
  const AcquireWork work = work_of(read_source(options.source), cell, options.speed_share);
  for (int session = 0; session < 2; ++session) {
    EXPECT_TRUE(describe_acquisition(options)["next"].is_null()) << session;
    AcquireJournal journal(options.out,
                           work.digest,
                           session == 0 ? former_digest(options) : work.digest,
                           work.grounds);
    EXPECT_EQ(journal.pictures().size(), 1U);
    EXPECT_EQ(recorded_digest(options.out), work.digest);
  }
  EXPECT_TRUE(describe_acquisition(options)["next"].is_null());
  EXPECT_THROW(AcquireJournal(options.out, "another", former_digest(options)), ConfigError);
}

}  // namespace
}  // namespace glint
