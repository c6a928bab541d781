// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate_cell/place_part_run.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/config/toml.h"
#include "core/error.h"
#include "core/file.h"
#include "studies/acquire/acquired.h"
#include "studies/calibrate/place_run.h"
#include "studies/calibrate_cell/edge_placement.h"
#include "studies/calibrate_cell/part_views.h"
#include "studies/calibrate_cell/round_pictures.h"
#include "studies/cell/pose_numbers.h"
#include "studies/definition/scene.h"
#include "studies/reach/scene_cell.h"

namespace glint {
namespace {

using calibrate_cell_detail::EdgePlacing;
using calibrate_cell_detail::PartPhoto;
using Eigen::Isometry3d;
using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

class PartPlacing {
 public:
  PartPlacing(const PlacePartOptions& options, const MotionPermit& permit)
      : options_(options),
        permit_(permit),
        scene_(calibrate_cell_detail::part_scene(options.scene, options.calibration)),
        scene_text_(fmt::format(
            "schema = {}\n{}", needs_schema_2(scene_) ? 2 : 1, to_toml(write_scene(scene_)))),
        folder_(options.acquire.out / "part"),
        place_(isometry_of(transform_of(scene_.cell->base_from_part->pose))) {
    if (options.placed > options.placements) {
      throw ConfigError(
          fmt::format("--placed {}: --placements are {}", options.placed, options.placements));
    }
  }

  Json run() {
    make_folder(folder_);
    write_file(folder_ / "scene.toml", scene_text_);
    prototypes_ =
        MountedPrototypes::beside(folder_ / "scene.toml", options_.acquire.mounted, options_.scene);
    for (int number = 1; number <= options_.placements; ++number) {
      check_order(number);
      if (!is_put_down(number)) {
        return result("waiting");
      }
      const Json taken = photograph(number);
      if (taken["status"] == "stopped") {
        end_ = taken["end"];
        return result("stopped");
      }
      if (taken["status"] == "waiting") {
        next_ = taken["next"];
        return result("waiting");
      }
      if (!is_known(number) && !find_edges(number)) {
        return result("too_few_pictures");
      }
    }
    return placed();
  }

 private:
  fs::path numbered(const std::string& name, int number, const std::string& ending = "") const {
    return folder_ / fmt::format("{}_{}{}", name, number, ending);
  }

  int recorded() const {
    const fs::path file = folder_ / "placed.json";
    const Json json =
        fs::exists(file) ? Json::parse(read_file(file), nullptr, false) : Json::object();
    return json.is_object() ? json.value("placed", 0) : 0;
  }

  std::string wish(int number) const {
    return fmt::format("{} (placement {} of {}), and leave the arm's reach",
                       number == 1 ? "put the part into its place"
                                   : "lift the part and put it back into its place",
                       number,
                       options_.placements);
  }

  /// Pictures of two placements must not be mixed: a part that has been put down again before they
  /// were whole is none that they are of.
  void check_order(int number) const {
    if (options_.placed > number &&
        !calibrate_cell_detail::ended_round(numbered("placement", number))) {
      throw ConfigError(
          fmt::format("--placed {}: placement {} has not been photographed: --placed {} comes "
                      "first",
                      options_.placed,
                      number,
                      number));
    }
  }

  /// Whether a person has said so, on the command line, at the terminal or to an earlier call.
  bool is_put_down(int number) {
    if (recorded() >= number) {
      return true;
    }
    const Confirm& ask = options_.acquire.confirm;
    if (options_.placed != number && !(ask && ask(wish(number)))) {
      next_ = {{"placement", number}, {"text", wish(number)}};
      return false;
    }
    write_file_durably(folder_ / "placed.json", Json{{"placed", number}}.dump() + "\n");
    return true;
  }

  Json photograph(int number) {
    AcquireOptions acquire = options_.acquire;
    acquire.source = folder_ / "scene.toml";
    acquire.views.clear();
    acquire.out = numbered("placement", number);
    return calibrate_cell_detail::acquire_round(acquire, prototypes_, permit_);
  }

  /// Whether an earlier call has found this placement in the same scene: its files are there.
  bool is_known(int number) {
    const fs::path file = numbered("found", number, ".json");
    const Json kept =
        fs::exists(file) ? Json::parse(read_file(file), nullptr, false) : Json::object();
    if (!kept.is_object() || kept.value("scene", "") != scene_text_) {
      return false;
    }
    remember(number, kept.at("told"));
    return true;
  }

  void remember(int number, const Json& told) {
    placements_.push_back(told);
    if (number == 1) {
      place_ = pose_of(told.at("base_from_part"));  // the next ones lie near it
    }
  }

  std::vector<PartPhoto> photos_of(int number) const {
    const Acquired acquired = read_acquired(numbered("placement", number));
    std::vector<PartPhoto> photos;
    for (const std::string& view : acquired.views()) {
      const AcquiredPicture picture = acquired.of_view(view).front();
      photos.push_back({.name = fmt::format("placement_{}/{}", number, picture.file),
                        .file = acquired.folder / picture.file,
                        .base_from_flange = picture.base_from_flange});
    }
    return photos;
  }

  /// Places the part by its edges. @return false: not enough pictures show it
  bool find_edges(int number) {
    EdgePlacing placing = {
        .scene = scene_, .calibration = options_.calibration, .threads = options_.threads};
    placing.scene.cell->base_from_part->pose =
        pose_settings({.rotation = place_.linear(), .translation_mm = place_.translation()});
    placing.photos = photos_of(number);
    const auto found = place_by_edges(placing,
                                      {.edges = numbered("edges", number, ".csv"),
                                       .poses = numbered("poses", number, ".toml"),
                                       .simulated = numbered("simulated", number),
                                       .place = numbered("place", number)});
    Json told = {{"placement", number}, {"pictures", found.pictures}};
    if (!found.is_found) {
      placements_.push_back(std::move(told));
      return false;
    }
    told["passes"] = found.passes;
    told["rms_px"] = found.place["placements"][0]["rms_px"];
    told["base_from_part"] = found.place["base_from_part"];
    write_file(numbered("found", number, ".json"),
               Json{{"scene", scene_text_}, {"told", told}}.dump() + "\n");
    remember(number, told);
    return true;
  }

  PlaceInput input(int number) const {
    return {.file = numbered("edges", number, ".csv"),
            .poses = {numbered("poses", number, ".toml")}};
  }

  CalibrateOptions place_options(const fs::path& out) const {
    return {.camera = options_.calibration, .out = out, .threads = options_.threads};
  }

  Json placed() {
    std::vector<PlaceInput> inputs;
    for (int number = 1; number <= options_.placements; ++number) {
      inputs.push_back(input(number));
    }
    const fs::path out = options_.acquire.out / "place";
    const Json all = place_part(inputs, place_options(out));
    Json json = result("placed");
    json["base_from_part"] = all["base_from_part"];
    json["spread"] = all["spread"];
    json["notes"] = all["notes"];
    json["placement"] = (out / "placement.toml").string();
    return json;
  }

  Json result(const std::string& status) const {
    return {{"schema", 1},
            {"status", status},
            {"ok", status == "placed"},
            {"folder", options_.acquire.out.string()},
            {"placements", placements_},
            {"next", next_},
            {"end", end_}};
  }

  const PlacePartOptions& options_;
  const MotionPermit& permit_;
  SceneSettings scene_;
  std::string scene_text_;  ///< as it is written; what is kept of another one does not count
  fs::path folder_;
  Isometry3d place_;  ///< where the part is known to lie so far
  MountedPrototypes prototypes_ = MountedPrototypes({}, {});  ///< of the scene's run
  Json placements_ = Json::array();
  Json next_;  ///< what a person has to do before it can go on
  Json end_;   ///< of an acquisition that was stopped
};

}  // namespace

Json place_part_in_cell(const PlacePartOptions& options, const MotionPermit& permit) {
  return PartPlacing(options, permit).run();
}

}  // namespace glint
