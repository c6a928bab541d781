// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate_cell/place_part_run.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/config/toml.h"
#include "core/error.h"
#include "core/file.h"
#include "core/units.h"
#include "studies/acquire/acquired.h"
#include "studies/calibrate/place_run.h"
#include "studies/calibrate_cell/part_views.h"
#include "studies/calibrate_cell/placement_record.h"
#include "studies/calibrate_cell/round_pictures.h"
#include "studies/cell/pose_numbers.h"
#include "studies/definition/scene.h"
#include "studies/output/result_folder.h"
#include "studies/reach/scene_cell.h"

namespace glint {
namespace {

using calibrate_cell_detail::PlaceDoubt;
using calibrate_cell_detail::SeenEdge;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr std::size_t kMinPictures = 2;
constexpr int kMaxPasses = 6;
constexpr int kMaxHalvings = 6;
constexpr double kRuler_mm = 1.0;  ///< standard deviations by a ruler
constexpr double kRulerRad = 0.5 * kRadPerDeg;
constexpr double kSettled_px = 0.1;  ///< the part moved less: rendering it again tells nothing new

std::string not_settled_text(const Json& told) {
  return fmt::format(
      "placement {}: has not settled, in the last of {} passes its edges moved by {:.2f} px: its "
      "place may be farther off than is stated",
      told["placement"].get<int>(),
      told["passes"].get<int>(),
      told["moved_px"].get<double>());
}

class PartPlacing {
 public:
  PartPlacing(const PlacePartOptions& options, const MotionPermit& permit)
      : options_(options),
        permit_(permit),
        scene_(calibrate_cell_detail::part_scene(options.scene, options.calibration)),
        scene_text_(fmt::format(
            "schema = {}\n{}", needs_schema_2(scene_) ? 2 : 1, to_toml(write_scene(scene_)))),
        folder_(options.acquire.out / "part"),
        record_(folder_),
        place_(isometry_of(transform_of(scene_.cell->base_from_part->pose))) {
    if (options.placed > options.placements) {
      throw ConfigError(
          fmt::format("--placed {}: --placements are {}", options.placed, options.placements));
    }
    check_inputs_kept(std::array{options.scene}, folder_, std::array<std::string, 1>{"scene.toml"});
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
        end_ = taken["end"];
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
    return record_.numbered(name, number, ending);
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
    if (record_.is_put_down(number)) {
      return true;
    }
    const Confirm& ask = options_.acquire.confirm;
    if (options_.placed != number && !(ask && ask(wish(number)))) {
      next_ = {{"placement", number}, {"text", wish(number)}};
      end_ = interrupted_end(options_.acquire);
      return false;
    }
    record_.put_down(number);
    return true;
  }

  Json photograph(int number) {
    AcquireOptions acquire = options_.acquire;
    acquire.source = folder_ / "scene.toml";
    acquire.views.clear();
    acquire.out = numbered("placement", number);
    return calibrate_cell_detail::acquire_round(acquire, prototypes_, permit_);
  }

  /// Whether an earlier call has found this placement in the same scene and the same pictures: its
  /// files are there.
  bool is_known(int number) {
    const std::optional<Json> told = record_.found(number, scene_text_);
    if (told) {
      remember(number, *told);
    }
    return told.has_value();
  }

  void remember(int number, const Json& told) {
    placements_.push_back(told);
    if (number == 1) {
      place_ = pose_of(told.at("base_from_part"));  // the next ones lie near it
    }
  }

  /// Renders the part where it is known to lie, finds its edges, places it by them, and again until
  /// it does not move any more. @return false: not enough pictures show it
  bool find_edges(int number) {
    const Acquired acquired = read_acquired(numbered("placement", number));
    Isometry3d place = place_;
    PlaceDoubt doubt = first_doubt();
    Json told = {{"placement", number}};
    for (int pass = 1; pass <= kMaxPasses; ++pass) {
      const auto seen = edges_at(place, acquired, number, doubt);
      told["pictures"] = seen.size();
      if (seen.size() < kMinPictures) {
        placements_.push_back(std::move(told));
        return false;
      }
      const Json found = place_part({input(number)}, place_options(numbered("place", number)));
      const Isometry3d next = pose_of(found["base_from_part"]);
      const Move move = largest_move(seen, place, next);
      place = next;
      doubt = {.mm = move.mm};
      told["passes"] = pass;
      told["rms_px"] = found["placements"][0]["rms_px"];
      told["moved_px"] = move.px;
      told["settled"] = pass > 1 && move.px < kSettled_px;
      told["base_from_part"] = found["base_from_part"];
      if (told["settled"]) {
        break;
      }
    }
    record_.keep_found(number, scene_text_, told);
    remember(number, told);
    return true;
  }

  /// Two standard deviations of where the scene says that the part lies; of a ruler, where it does
  /// not tell how well that is known.
  PlaceDoubt first_doubt() const {
    const MeasuredPoseSettings& known = *scene_.cell->base_from_part;
    const double sigma_mm = std::ranges::max(known.sigma_mm);
    const double sigma_rad = std::ranges::max(known.sigma_rad);
    return {.mm = 2.0 * (sigma_mm > 0.0 ? sigma_mm : kRuler_mm),
            .rad = 2.0 * (sigma_rad > 0.0 ? sigma_rad : kRulerRad)};
  }

  /// Edges in the pictures of a placement, rendered where the part is thought to lie.
  struct RenderedViews {
    SceneSettings scene;
    std::vector<AcquiredPicture> taken;
    std::vector<PictureOfView> pictures;
    std::vector<std::vector<SpaceEdge>> edges;
  };

  RenderedViews rendered_at(const Isometry3d& base_from_part,
                            const Acquired& acquired,
                            int number) const {
    RenderedViews views{.scene = scene_};
    views.scene.cell->base_from_part->pose = pose_settings(
        {.rotation = base_from_part.linear(), .translation_mm = base_from_part.translation()});
    for (const std::string& view : acquired.views()) {
      const AcquiredPicture& taken = views.taken.emplace_back(acquired.of_view(view).front());
      views.pictures.push_back(
          {.file = acquired.folder / taken.file,
           .viewpoint = calibrate_cell_detail::viewpoint_at(views.scene, taken.base_from_flange)});
    }
    const fs::path simulated = numbered("simulated", number);
    fs::remove_all(simulated);
    views.edges = edges_in_pictures(views.scene, views.pictures, simulated, options_.threads);
    return views;
  }

  /// Writes the files that place_part() reads. Where too few edges lie alone, nearer ones serve,
  /// too: as many more as two pictures need.
  /// @return edges of each picture that shows the part
  std::vector<std::vector<SeenEdge>> edges_at(const Isometry3d& base_from_part,
                                              const Acquired& acquired,
                                              int number,
                                              PlaceDoubt doubt) const {
    const RenderedViews views = rendered_at(base_from_part, acquired, number);
    for (int halving = 0;; ++halving) {
      auto seen = write_edges(views, number, doubt);
      if (seen.size() >= kMinPictures || halving == kMaxHalvings) {
        return seen;
      }
      doubt = {.mm = 0.5 * doubt.mm, .rad = 0.5 * doubt.rad};
    }
  }

  std::vector<std::vector<SeenEdge>> write_edges(const RenderedViews& views,
                                                 int number,
                                                 const PlaceDoubt& doubt) const {
    std::string rows = calibrate_cell_detail::edge_header();
    std::string poses = calibrate_cell_detail::pose_convention_toml();
    std::vector<std::vector<SeenEdge>> all;
    for (std::size_t i = 0; i < views.edges.size(); ++i) {
      auto seen = calibrate_cell_detail::seen_edges(
          views.scene, views.pictures[i].viewpoint, views.edges[i], doubt);
      if (seen.size() >= kMinEdges) {
        const AcquiredPicture& taken = views.taken[i];
        const std::string name = fmt::format("placement_{}/{}", number, taken.file);
        rows += calibrate_cell_detail::edge_rows(name, seen);
        poses += calibrate_cell_detail::pose_toml(name, taken.base_from_flange);
        all.push_back(std::move(seen));
      }
    }
    write_file(numbered("edges", number, ".csv"), rows);
    write_file(numbered("poses", number, ".toml"), poses);
    return all;
  }

  /// The farthest that an edge has moved.
  struct Move {
    double mm = 0.0;
    double px = 0.0;
  };

  static Move largest_move(const std::vector<std::vector<SeenEdge>>& pictures,
                           const Isometry3d& before,
                           const Isometry3d& after) {
    Move largest;
    for (const auto& edges : pictures) {
      for (const SeenEdge& edge : edges) {
        const double moved_mm = (after * edge.part_mm - before * edge.part_mm).norm();
        largest.mm = std::max(largest.mm, moved_mm);
        largest.px = std::max(largest.px, edge.px_per_mm * moved_mm);
      }
    }
    return largest;
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
    for (const Json& told : placements_) {
      if (!told["settled"]) {
        json["notes"].push_back(not_settled_text(told));
      }
    }
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

  static constexpr std::size_t kMinEdges = 20;

  const PlacePartOptions& options_;
  const MotionPermit& permit_;
  SceneSettings scene_;
  std::string scene_text_;  ///< as it is written; what is kept of another one does not count
  fs::path folder_;
  calibrate_cell_detail::PlacementRecord record_;
  Isometry3d place_;  ///< where the part is known to lie so far
  MountedPrototypes prototypes_ = MountedPrototypes({}, {});  ///< of the scene's run
  Json placements_ = Json::array();
  Json next_;  ///< what a person has to do before it can go on
  Json end_;   ///< of an acquisition that was stopped, or a question that was
};

}  // namespace

Json place_part_in_cell(const PlacePartOptions& options, const MotionPermit& permit) {
  return PartPlacing(options, permit).run();
}

}  // namespace glint
