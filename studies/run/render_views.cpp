// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/render_views.h"
#include "studies/definition/scene_viewpoints.h"
#include "studies/definition/study_text.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/cpu_clock.h"
#include "core/file.h"
#include "core/log.h"
#include "core/wall_clock.h"
#include "defects/part/defect_metadata.h"
#include "simulator/render/path_tracing/path_settings.h"
#include "simulator/render/preview/preview.h"
#include "studies/imaging/path_lights.h"
#include "studies/imaging/path_warnings.h"
#include "studies/output/output_folder.h"
#include "studies/output/provenance.h"
#include "studies/output/result_folder.h"
#include "studies/run/design_files.h"
#include "studies/run/render_files.h"
#include "studies/run/render_maps.h"
#include "studies/run/render_page.h"
#include "studies/run/render_study.h"
#include "studies/run/results/scene_facts.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr int kPassWidth_px = 800;
constexpr int kPageWidth_px = 1000;     ///< of one picture on the page
constexpr int kManyPageWidth_px = 560;  ///< the same among many views
constexpr std::size_t kManyViews = 4;

/// Nobody asks for the errors of a picture that is not scored, and one picture converges faster
/// than independent ones together.
PathSettings whole_picture(PathSettings paths) {
  paths.batches = 1;
  return paths;
}

/// The scene with one of its viewpoints.
SceneSettings scene_at(SceneSettings scene, const Viewpoint& viewpoint) {
  scene.viewpoints = {viewpoint};
  scene.viewpoint_set = {};
  return scene;
}

Json viewpoint_json(const Viewpoint& viewpoint) {
  return {{"position_mm", viewpoint.position_mm},
          {"direction", viewpoint.direction},
          {"up", viewpoint.up}};
}

/// JSON has no NaN: null stands for it.
Json number_json(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json view_json(const Film& sums, const Film& seen_sums, bool has_light, double error) {
  std::int64_t samples = 0;
  for (const std::int32_t of_pixel : sums.samples.values()) {
    samples += of_pixel;
  }
  const auto seen = std::ranges::count_if(
      seen_sums.defects, [&](const DefectSums& defect) { return is_seen(seen_sums, defect); });
  Json json = {
      {"samples", *std::ranges::max_element(sums.samples.values())},
      {"mean_samples", static_cast<double>(samples) / static_cast<double>(sums.samples.size())},
      {"rays",
       {{"camera", sums.counts.camera},
        {"shadow", sums.counts.shadow},
        {"bounce", sums.counts.bounce}}},
      {"defects_seen", seen}};
  if (has_light) {
    json["relative_error"] = number_json(error);
  }
  return json;
}

/// Whether a picture ended early somewhere, its error being small enough.
bool has_ended_early(const Film& sums, const PathSettings& paths) {
  const int batches = std::max(1, std::min(paths.batches, paths.samples));
  const int samples = batches * ((paths.samples + batches - 1) / batches);
  return std::ranges::any_of(sums.samples.values(), [&](int count) { return count < samples; });
}

class RenderRun {
 public:
  RenderRun(const Study& study, const RenderOptions& options)
      : study_(scene_study(study)), options_(options), pool_(options.threads), store_(pool_) {
    has_light_ = options.has_light && study_.scene.paths.has_light;
    study_.scene.paths.has_light = has_light_;
  }

  Json execute() {
    prepare();
    OutputFolder folder(options_.out);
    remove_unfinished_files(options_.out);
    source_ = source_seen_from(options_.out, study_.root.place.file);
    mark_result_folder(options_.out, ResultKind::kRender, study_.name, source_);
    write_file(options_.out / "study.resolved.toml", resolved_text(study_));
    render_all(folder);
    return finish(folder);
  }

 private:
  /// Everything that can be refused before anything is written.
  void prepare() {
    check_render_folder(study_, options_.out);
    try {
      viewpoints_ = viewpoints_of(study_.scene, store_.build(study_.scene)->part);
      for (const Viewpoint& viewpoint : viewpoints_) {
        camera_from_world(viewpoint);
      }
      check_cameras_outside_part(store_, study_.scene);
      if (has_light_ && !is_lit(study_.scene)) {
        throw ConfigError("lighting",
                          "holds no light; a picture needs one, masks do not (--masks)");
      }
      if (has_light_) {
        check_part_in_tunnel(store_, study_.scene);
      }
      first_ = scene_at(study_.scene, viewpoints_.front());
      part_ = store_.build_defects(first_);
      const PathView view(first_, part_, viewpoints_.front());
      notes_ = has_light_ ? path_warnings(view.physical()) : std::vector<std::string>{};
      if (const std::string note = shallow_note(part_->made); !note.empty()) {
        notes_.push_back(note + ".");
      }
      drawing_ = draw_lighting(first_, view.area_lights(), *part_->built, "").svg;
    } catch (const ConfigError& error) {
      throw with_place(study_.root, error);
    }
  }

  bool is_interrupted() const { return options_.interrupt != nullptr && *options_.interrupt > 0; }

  std::string folder_of(std::size_t index) const {
    return viewpoints_.size() == 1 ? "baseline" : fmt::format("view_{:02}", index + 1);
  }

  void render_all(OutputFolder& folder) {
    const int samples = study_.scene.paths.samples;
    Progress bar(study_.name,
                 std::max<std::int64_t>(1, samples * static_cast<std::int64_t>(viewpoints_.size())),
                 options_.progress);
    bar_ = &bar;
    for (std::size_t i = 0; i < viewpoints_.size() && !is_interrupted(); ++i) {
      try {
        render_one(i);
      } catch (const ConfigError& error) {
        throw with_place(study_.root, error);
      }
      folder.keep();  // what is rendered is not thrown away
      write_result();
    }
    bar_ = nullptr;
  }

  void render_one(std::size_t index) {
    const double start = process_cpu_s();
    const SceneSettings scene = scene_at(study_.scene, viewpoints_[index]);
    const PathView view(scene, part_, viewpoints_[index]);
    const PathPreview show = [&](const PathProgress& progress) {
      show_pass(index, view, progress);
      return !is_interrupted();
    };
    const bool is_traced = index == 0 && can_be_traced();
    const bool is_scored = has_light_ && is_traced;
    // Masks have the samples of the picture that would be scored, with light or without.
    const PathSettings paths =
        is_traced ? path_settings(scene) : whole_picture(path_settings(scene));
    const auto picture =
        is_scored ? store_.picture(scene, show)  // kept, to be scored
                  : std::make_shared<const PathPicture>(render_view(view, paths, pool_, {}, show));
    const fs::path folder = options_.out / folder_of(index);
    const bool has_design = is_scored && write_scored(scene, folder);
    const Film all_rays = all_camera_rays(view, paths, *picture);
    const Film& seen = all_rays.samples.size() > 0 ? all_rays : picture->sums;
    const Mask part_mask = part_mask_of(is_traced, seen);
    const RenderedView rendered = {.scene = scene,
                                   .part = *part_,
                                   .picture = *picture,
                                   .seen = seen,
                                   .part_mask = part_mask,
                                   .groups = view.group_names()};
    const ViewPictures pictures = write_view_files(rendered, folder, has_design);
    tell_hiding_lights(index, view);
    Json row = {{"folder", folder_of(index)}, {"viewpoint", viewpoint_json(viewpoints_[index])}};
    row.update(view_json(picture->sums, seen, has_light_, pictures.relative_error));
    views_.push_back(row);
    cpu_s_.push_back(process_cpu_s() - start);
    keep_for_page(pictures, row);
  }

  /// A defect that the camera does not see is no mistake here, but leaves nothing to be scored.
  bool can_be_traced() {
    try {
      store_.trace(first_);
      return true;
    } catch (const ConfigError& error) {
      if (has_light_) {
        notes_.push_back(fmt::format("Not scored: {}", error.what()));
      }
      return false;
    }
  }

  /// Camera rays with all samples where a picture with light has fewer; empty where it has them.
  Film all_camera_rays(const PathView& view, PathSettings paths, const PathPicture& picture) {
    if (is_interrupted() || !has_ended_early(picture.sums, paths)) {
      return {};
    }
    paths.has_light = false;
    return render_view(view, paths, pool_).sums;
  }

  /// Mirrors under a tunnel have the mask that their scans are scored in.
  Mask part_mask_of(bool is_traced, const Film& seen) {
    const std::optional<Mask> scanned =
        is_traced ? scanned_part_mask(first_, *store_.trace(first_)) : std::nullopt;
    return scanned ? *scanned : whole_part_mask(seen);
  }

  /// Of views that nothing else has told about.
  void tell_hiding_lights(std::size_t index, const PathView& view) {
    if (!has_light_ || index == 0) {
      return;
    }
    for (const std::string& warning : hiding_warnings(view.physical())) {
      notes_.push_back(fmt::format("{}: {}", folder_of(index), warning));
    }
  }

  void keep_for_page(const ViewPictures& pictures, const Json& row) {
    const bool is_many = viewpoints_.size() > kManyViews;
    const int width = is_many ? kManyPageWidth_px : kPageWidth_px;
    const ImageRgb shown = has_light_ ? side_by_side(pictures.image, pictures.map, width)
                                      : shrunk(pictures.map, width);
    page_views_.push_back({.row = row, .png = png_bytes(shown)});
    small_.push_back(shrunk(has_light_ ? pictures.image : pictures.map, kTileSide_px));
  }

  /// Scores of the first view, where it can be scored: a defect that the camera does not see is no
  /// mistake here.
  bool write_scored(const SceneSettings& scene, const fs::path& folder) {
    if (is_interrupted()) {
      return false;
    }
    OutputFolder created(folder);
    try {
      const Json json = write_design(store_,
                                     scene,
                                     {{"title", study_.title}, {"role", "baseline"}},
                                     folder,
                                     false,
                                     {.fringes = false, .slot = false});
      scores_ = json["scores"];
      for (const Json& note : json["notes"]) {
        if (std::ranges::find(notes_, note.get<std::string>()) == notes_.end()) {
          notes_.push_back(note);
        }
      }
    } catch (const ConfigError& error) {
      notes_.push_back(fmt::format("Not scored: {}", error.what()));
      return false;
    }
    created.keep();
    return true;
  }

  void show_pass(std::size_t index, const PathView& view, const PathProgress& progress) {
    const Film& sums = *progress.sums;
    const ImageRgb shown = has_light_ ? exposed_preview(view, sums)
                                      : shrunk(defect_map(sums, part_->made), kPassWidth_px);
    write_png(options_.out / "preview.png", shown);
    const int samples = study_.scene.paths.samples;
    const std::int64_t done = std::min(samples, progress.samples);
    bar_->update(
        static_cast<std::int64_t>(index) * samples + (progress.tiles_left == 0 ? samples : done),
        fmt::format("view {} of {}, pass {}, {} samples a pixel",
                    index + 1,
                    viewpoints_.size(),
                    progress.pass,
                    progress.samples));
  }

  /// The picture without blur and noise.
  ImageRgb exposed_preview(const PathView& view, const Film& sums) const {
    const FrameFactors factors = mean_factors(view.frames());
    const SensorSettings& sensor = study_.scene.sensor;
    const int factor = std::max(1, (sums.width_px + kPassWidth_px - 1) / kPassWidth_px);
    std::vector<ImageF> channels;
    for (int c = 0; c < static_cast<int>(sums.groups.at(0).channels.size()); ++c) {
      ImageF radiance = channel_radiance(sums, factors, c);
      for (float& value : radiance.values()) {
        value *= static_cast<float>(sensor.exposure * sensor.gain);
      }
      channels.push_back(sums.height_px < factor ? radiance : glint::reduce(radiance, factor));
    }
    return rgb_of(channels);
  }

  Json result_json() const {
    const bool is_whole = views_.size() == viewpoints_.size() && !is_interrupted();
    Json result = {{"schema", 1},
                   {"status", is_whole ? "done" : "interrupted"},
                   {"width_px", study_.scene.camera.width_px},
                   {"height_px", study_.scene.camera.height_px},
                   {"views", views_}};
    if (!scores_.is_null()) {
      result["scores"] = scores_;
    }
    result["notes"] = notes_;
    result["report"] = "report.html";
    return result;
  }

  void write_result() const {
    write_file(options_.out / "result.json", result_json().dump(2) + "\n");
  }

  /// Also of views that an interrupted rendering has not come to: those that an earlier one
  /// finished stay. Empty where there is not even the first.
  std::vector<std::string> folders_of_all() const {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < viewpoints_.size() && !views_.empty(); ++i) {
      names.push_back(folder_of(i));
    }
    return names;
  }

  Json finish(OutputFolder& folder) {
    remove_other_views(options_.out, folders_of_all());
    if (small_.size() > 1) {
      write_png(options_.out / "contact_sheet.png", numbered_sheet(small_));
    }
    write_result();
    Json result = result_json();
    write_file(options_.out / "report.html", render_page(page()));
    write_run_json();
    folder.keep();
    for (std::size_t i = 0; i < cpu_s_.size(); ++i) {
      result["views"][i]["folder"] = (options_.out / folder_of(i)).string();
      result["views"][i]["cpu_s"] = cpu_s_[i];
    }
    result["folder"] = options_.out.string();
    result["report"] = (options_.out / "report.html").string();
    return result;
  }

  RenderPage page() const {
    RenderPage page = {
        .title = study_.title.empty() ? study_.name : study_.title,
        .result = result_json(),
        .views = page_views_,
        .drawing = drawing_,
        .toml = shown_text(study_),
        .facts = scene_facts(first_, part_json(part_->clean->part), study_file(study_)),
        .when = moment_text(utc_text(started_), seconds_since(start_))};
    for (const RealisedDefect& made : part_->made.defects) {
      if (made.is_made) {
        page.types.insert(made.defect.type);
      }
    }
    if (small_.size() > 1) {
      page.sheet_png = png_bytes(numbered_sheet(small_));
    }
    return page;
  }

  void write_run_json() const {
    Json run = provenance();
    run["verb"] = command_of(ResultKind::kRender);
    run["study"] = study_.name;
    run["source"] = source_;
    run["started"] = utc_text(started_);
    run["seed"] = study_.scene.paths.seed;
    run["threads"] = options_.threads;
    run["timings"] = {{"this_run_s", seconds_since(start_)}, {"views_cpu_s", cpu_s_}};
    run["configuration"] = resolved_text(study_);
    write_file(options_.out / "run.json", run.dump(2) + "\n");
  }

  Study study_;
  std::string source_;  ///< its file, as run.json tells it
  bool has_light_ = true;
  const RenderOptions& options_;
  ThreadPool pool_;
  SceneStore store_;
  Clock::time_point start_ = Clock::now();
  std::chrono::system_clock::time_point started_ = std::chrono::system_clock::now();
  std::vector<Viewpoint> viewpoints_;
  SceneSettings first_;
  std::shared_ptr<const BuiltDefects> part_;
  std::string drawing_;
  Progress* bar_ = nullptr;
  Json views_ = Json::array();
  Json scores_;
  std::vector<std::string> notes_;
  std::vector<double> cpu_s_;
  std::vector<PageView> page_views_;
  std::vector<ImageRgb> small_;
};

}  // namespace

Json render_views(const Study& study, const RenderOptions& options) {
  return RenderRun(study, options).execute();
}

}  // namespace glint
