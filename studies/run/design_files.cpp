// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/design_files.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/cpu_clock.h"
#include "core/file.h"
#include "core/image/image_io.h"
#include "core/wall_clock.h"
#include "defects/part/defect_metadata.h"
#include "studies/definition/render_methods.h"
#include "studies/definition/scene_notes.h"
#include "studies/drawing/drawing.h"
#include "studies/drawing/light_drawing.h"
#include "studies/drawing/wall_plan.h"
#include "studies/imaging/defect_windows.h"
#include "studies/output/output_folder.h"
#include "studies/run/render_files.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

PixelDepth depth_of(const SensorSettings& sensor) {
  return sensor.bits == 8 ? PixelDepth::k8Bit : PixelDepth::k16Bit;
}

Json view_json(const DefectView& view, double width_px, const DefectScores& scores) {
  return {{"area_px", view.area_px},
          {"width_px", width_px},
          {"best_frames", {{"difference", scores.frame}, {"change", scores.change_frame}}},
          {"window_px", {view.left_px, view.top_px, view.distance.width(), view.distance.height()}},
          {"scores",
           {{"weber", scores.weber},
            {"peak", scores.peak},
            {"cnr", scores.cnr},
            {"dprime", scores.dprime},
            {"signature", scores.signature}}}};
}

Json defects_json(const Evaluation& evaluation, const PinholeIntrinsics& intrinsics) {
  Json list = Json::array();
  const PinholeCamera camera(intrinsics);
  const DefectivePart& part = evaluation.traced->part->made;
  const std::vector<double> slopes = defect_slopes_rad(*evaluation.traced->part);
  std::size_t seen = 0;  // among the defects that were made
  for (std::size_t i = 0; i < part.defects.size(); ++i) {
    if (part.defects[i].is_made && seen < evaluation.defects.size()) {
      const double width_px =
          narrowest_px(part.outlines[seen], camera, evaluation.traced->camera_from_world);
      Json view = view_json(evaluation.traced->views[seen], width_px, evaluation.defects[seen]);
      const Eigen::Vector3d centre_mm =
          evaluation.traced->camera_from_world * part.outlines[seen].centre_mm;
      view["pixel_mm"] = centre_mm.z() / intrinsics.focal_px.x();  // across the line of sight
      if (const auto place_px = camera.project(centre_mm)) {
        view["place_px"] = {place_px->x(), place_px->y()};
      }
      list.push_back(
          defect_in_view_json(part.defects[i].defect, part.outlines[seen], slopes[i], view));
      ++seen;
    }
  }
  return {{"schema", 1}, {"defects", list}};
}

/// Study and design.
std::string sheet_title(const Json& head) {
  const std::string study = head.value("study", "");
  const std::string title = head.value("title", "");
  return study.empty() || study == title ? title : study + " - " + title;
}

/// @param stem  the files' path without their ending
void write_drawing(const LightingDrawing& drawing, const fs::path& stem) {
  const auto path = [&](const char* ending) { return fs::path(stem).replace_extension(ending); };
  write_file(path(".svg"), drawing.svg);
  write_file(path(".dxf"), drawing.dxf);
  if (drawing.csv.empty()) {
    fs::remove(path(".csv"));  // of a tunnel that stood here before
  } else {
    write_file(path(".csv"), drawing.csv);
  }
}

/// Half the angle of view across the tunnel, from the image's height or width.
double view_half_angle_rad(const SceneSettings& scene) {
  const PinholeIntrinsics in = intrinsics_of(scene);
  const RigidTransform pose = camera_from_world(scene.viewpoint());
  const bool rows_run_across = std::abs(pose.rotation(1, 1)) > std::abs(pose.rotation(0, 1));
  return rows_run_across ? std::atan(0.5 * in.height_px / in.focal_px.y())
                         : std::atan(0.5 * in.width_px / in.focal_px.x());
}

/// The tunnel of a scene, its part and its camera; nothing but these without a tunnel.
CrossSection cross_section_of(const SceneSettings& scene,
                              const BuiltPart& built,
                              const std::string& title) {
  const Tunnel tunnel(scene.tunnel);
  const Eigen::Vector3d camera = inverse(camera_from_world(scene.viewpoint())).translation_mm;
  return {.panels_yz_mm = tunnel.outline(1.0),
          .part_yz_mm = built.outline_yz_mm,
          .camera_mm = camera,
          .view_half_angle_rad = view_half_angle_rad(scene),
          .slot_mm = scene.tunnel.slot_mm,
          .length_mm = scene.tunnel.length_mm,
          .part_length_mm = built.max_x_mm - built.min_x_mm,
          .period_mm = scene.tunnel.period_mm,
          .duty = scene.tunnel.duty,
          .orientation_rad = scene.tunnel.orientation_rad,
          .step_mm = scan_step_mm(scene.scan, scene.tunnel),
          .positions = scene.scan.positions,
          .title = title};
}

/// The scene scanned once more, as a search does it, beside its full sequence.
Json rendering_json(SceneStore& store,
                    const SceneSettings& scene,
                    const WantedScores& wanted,
                    const Scores& full) {
  const FrameMethod frames = frame_method(scene);
  Json json = {{"frames", frames.name}};
  for (const auto& [name, value] : frames.numbers) {
    json[name] = value;
  }
  if (!frames.has_closed_mean) {
    return json;
  }
  WantedScores of_search = wanted.of_one_scan();
  of_search.picture = true;  // also where the search itself needs none
  const Evaluation closed = evaluate(store, scene, {}, of_search);
  const std::string h = "homogeneity.h_rms";
  json["search_form"] = std::string(form_name(closed.form.kind));
  json["table_pixels"] = closed.form.table_pixels;
  json["frame_pixels"] = closed.form.frame_pixels;
  json["h_rms_difference_points"] = 100.0 * (closed.scores.at(h) - full.at(h));
  return json;
}

/// Scores with fresh seeds and finer sampling.
Json rescored_json(SceneStore& store,
                   const SceneSettings& scene,
                   const WantedScores& wanted,
                   DesignWatch* watch) {
  if (watch != nullptr && watch->on_rescoring) {
    watch->on_rescoring();
  }
  const double start = process_cpu_s();
  const auto begin = std::chrono::steady_clock::now();
  Outcome outcome;
  outcome.scores =
      evaluate(store, rescoring_settings(scene), {}, wanted.with_whole_scan(kFreshParts)).scores;
  outcome.seconds = seconds_since(begin);
  if (watch != nullptr) {
    watch->rescoring_cpu_s += process_cpu_s() - start;
  }
  if (watch != nullptr && watch->on_rescored) {
    watch->on_rescored(outcome);
  }
  return scores_json(outcome.scores);
}

void add_defect_notes(const TracedScene& traced,
                      const SceneSettings& scene,
                      std::vector<std::string>& notes) {
  if (const std::string note = shallow_note(traced.part->made); !note.empty()) {
    notes.push_back(note + ".");
  }
  if (const std::string note = defect_stripes_note(traced, scene); !note.empty()) {
    notes.push_back(note);
  }
}

/// Each frame is written as it is rendered.
Evaluation evaluate_into_sequence(SceneStore& store,
                                  const SceneSettings& scene,
                                  const fs::path& folder,
                                  const WantedScores& wanted,
                                  DesignWatch* watch) {
  const auto frame_path = [&](int index) {
    return folder / "sequence" / fmt::format("frame_{:03}.png", index);
  };
  int num_frames = 0;
  const auto write_frame = [&](int index, const ImageF& grey) {
    num_frames = std::max(num_frames, index + 1);
    write_png(frame_path(index), grey, depth_of(scene.sensor));
    if (watch != nullptr && watch->on_frame) {
      watch->on_frame(num_frames);
    }
  };
  Evaluation evaluation = evaluate(store, scene, write_frame, wanted.with_whole_scan());
  // A longer sequence rendered into this folder before must not follow this one.
  for (int index = num_frames; fs::remove(frame_path(index)); ++index) {
  }
  return evaluation;
}

void write_pictures(const Evaluation& evaluation,
                    const SceneSettings& scene,
                    const fs::path& folder) {
  write_png(folder / "aspect.png", evaluation.aspect, depth_of(scene.sensor));
  write_exr(folder / "aspect.exr", evaluation.aspect);
  write_mask_png(folder / "part_mask.png", evaluation.traced->part_mask);
  write_file(folder / "defects.json",
             defects_json(evaluation, intrinsics_of(scene)).dump(2) + "\n");
  write_file(folder / "scene.toml", to_toml(write_scene(scene)));
}

}  // namespace

Json scores_json(const Scores& scores) {
  Json json = Json::object();
  for (const auto& [name, value] : scores) {
    json[name] = value;
  }
  return json;
}

LightingDrawing draw_lighting(const SceneSettings& scene,
                              const PhysicalScene* area_lights,
                              const BuiltPart& built,
                              const std::string& title) {
  const CrossSection section = cross_section_of(scene, built, title);
  if (area_lights != nullptr) {
    return {.svg = area_lights_svg(scene, *area_lights, title),
            .dxf = area_lights_dxf(scene, *area_lights, title),
            .csv = area_lights->lights.has_wall() ? wall_csv(section) : std::string()};
  }
  return {.svg = cross_section_svg(section), .dxf = wall_dxf(section), .csv = wall_csv(section)};
}

std::string drawing_svg(const SceneSettings& scene,
                        const Evaluation& evaluation,
                        const std::string& title) {
  const SceneLamps lamps(scene, evaluation.traced->part);
  return draw_lighting(scene, lamps.area_lights(), evaluation.traced->built(), title).svg;
}

std::vector<std::string> notes_of(const SceneSettings& scene,
                                  const Scores& scores,
                                  const SceneLamps& lamps) {
  std::vector<std::string> notes = note_texts(scene_notes(scene, scores));
  std::ranges::copy(lamps.warnings(), std::back_inserter(notes));
  return notes;
}

std::string rendering_note(const Json& rendering) {
  if (!rendering.contains("search_form")) {
    return "";
  }
  const std::string form = rendering["search_form"];
  if (form == form_name(ScanForm::Kind::kFrames)) {
    return "A search renders all frames of this scan: no closed form is valid for its mean, or the "
           "search scores single frames.";
  }
  const int by_table = rendering["table_pixels"].get<int>();
  const int by_frames = rendering["frame_pixels"].get<int>();
  const double difference = rendering["h_rms_difference_points"].get<double>();
  const bool is_linear = form == form_name(ScanForm::Kind::kMeanRadiance);
  return fmt::format(
      "A search takes the mean of this scan from a closed form ({}), with {} pixels rendered frame "
      "by frame ({}); h (rms) is {:.3f} points {} than from the full sequence.",
      is_linear ? "mean radiance: the sensor does not clip"
                : fmt::format("table: the sensor clips; {} pixels", by_table),
      by_frames,
      is_linear
          ? "around the defects where these are scored"
          : "near edges of the light, on curved surface, where few positions leave a pattern, "
            "and around the defects where these are scored",
      std::abs(difference),
      difference < 0.0 ? "lower" : "higher");
}

Json write_design(SceneStore& store,
                  const SceneSettings& wanted_scene,
                  const Json& head,
                  const fs::path& folder,
                  bool is_rescored,
                  const WantedScores& wanted,
                  DesignWatch* watch) {
  const SceneSettings scene = first_view(store, wanted_scene);
  make_folder(folder / "sequence");
  remove_unfinished_files(folder);
  remove_unfinished_files(folder / "sequence");
  const Evaluation evaluation = evaluate_into_sequence(store, scene, folder, wanted, watch);
  write_pictures(evaluation, scene, folder);
  const SceneLamps lamps(scene, evaluation.traced->part);
  write_drawing(
      draw_lighting(scene, lamps.area_lights(), evaluation.traced->built(), sheet_title(head)),
      folder / "cross_section");
  std::vector<std::string> notes = notes_of(scene, evaluation.scores, lamps);
  add_defect_notes(*evaluation.traced, scene, notes);
  Json json = head;
  json["scores"] = scores_json(evaluation.scores);
  json["rendering"] = rendering_json(store, scene, wanted, evaluation.scores);
  if (const std::string note = rendering_note(json["rendering"]); !note.empty()) {
    notes.push_back(note);
  }
  if (is_rescored) {
    try {
      json["rescored"] = rescored_json(store, scene, wanted, watch);
    } catch (const ConfigError& error) {  // the finer picture may not fit into memory
      json["rescored"] = nullptr;
      notes.push_back(fmt::format("Not re-scored: {}", error.what()));
    }
  }
  json["notes"] = notes;
  write_file(folder / "scores.json", json.dump(2) + "\n");
  return json;
}

}  // namespace glint
