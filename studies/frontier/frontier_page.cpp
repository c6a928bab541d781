// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/frontier_page.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "studies/definition/ladder/larger_pixels.h"
#include "studies/evaluation/evaluation.h"
#include "studies/frontier/design_ranking.h"
#include "studies/frontier/frontier_choice.h"
#include "studies/frontier/frontier_drawing.h"
#include "studies/frontier/frontier_errors.h"
#include "studies/frontier/frontier_folder.h"
#include "studies/frontier/frontier_methods.h"
#include "studies/frontier/path_frontier.h"
#include "studies/output/output_folder.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

std::string resolution_name(int reduction) {
  return reduction == 1 ? "full" : reduction == 2 ? "half" : fmt::format("1/{}", reduction);
}

Json point_json(const FrontierPoint& point) {
  const ComparedMethod& method = point.method;
  const bool is_noisy = method.is_noisy;
  Json json = {{"method", method_name(method.render.method)},
               {"kind", method.kind},
               {"kind_name", method.kind_name},
               {"is_noisy", is_noisy},
               {"label", point.label},
               {"samples", is_noisy ? Json(method.paths.samples) : Json(nullptr)},
               {"max_reflections", is_noisy ? Json(method.paths.max_reflections) : Json(nullptr)},
               {"rays_per_px", method.rays_per_px > 0 ? Json(method.rays_per_px) : Json(nullptr)},
               {"traced_per_px", point.traced_per_px},
               {"form", point.form},
               {"frame_pixels", point.frame_pixels},
               {"max_direction_error_mrad",
                method.direction_mrad > 0.0 ? Json(method.direction_mrad) : Json(nullptr)},
               {"resolution", resolution_name(point.reduction)},
               {"tessellation", point.tessellation},
               {"realisation", point.realisation.empty() ? "own" : point.realisation},
               {"frames", method.has_frames}};
  if (!point.problem.empty()) {
    json["problem"] = point.problem;
  } else {
    json["cpu_s"] = point.cpu_s;
    json["cold_s"] = point.cold_s;
    json["pictures"] = point.pictures;
    json["rays"] = is_noisy ? Json(point.rays) : Json(nullptr);
    json["frame_rmse"] = optional_json(point.frame_rmse);
    json["smooth_frame_rmse"] = optional_json(point.smooth_frame_rmse);
    json["h_error_points"] = point.h_error_points;
    json["contrast_error_percent"] = optional_json(point.contrast_error_percent());
    json["defects"] = Json::object();
    for (const auto& [label, errors] : point.defects) {
      json["defects"][label] = {{"weber_error_percent", errors.weber_percent},
                                {"change_error_percent", errors.change_percent}};
    }
  }
  for (const auto& [name, score] : point.scores) {
    json["scores"][name] = {
        {"value", score.value}, {"error", score.error}, {"spread", score.spread}};
  }
  json["on_front"] = point.on_front;
  json["is_choice"] = method.is_choice || point.is_chosen;
  json["is_current"] = method.is_current;
  json["is_reference"] = point.is_reference;
  return json;
}

Json reference_json(const FrontierReference& reference) {
  Json defects = Json::object();
  for (const auto& [label, weber] : reference.weber) {
    defects[label] = {{"weber", weber}, {"change", reference.change.at(label)}};
  }
  Json json = {{"method", method_name(reference.method.render.method)},
               {"is_noisy", reference.method.is_noisy},
               {"rays_per_px", reference.method.rays_per_px},
               {"h_rms", reference.h_rms},
               {"defects", defects},
               {"own_frame_rmse", optional_json(reference.own_frame_rmse)}};
  if (reference.method.is_noisy) {
    json["rays_per_px"] = nullptr;
    json["samples"] = reference.method.paths.samples;
    json["max_reflections"] = reference.method.paths.max_reflections;
    json["pictures"] = reference.pictures;
    json["pooled_samples"] = reference.pictures * reference.method.paths.samples;
  }
  for (const auto& [name, score] : reference.scores) {
    json["scores"][name] = {
        {"value", score.value},
        {"standard_error", reference.method.is_noisy ? Json(score.standard_error) : Json(nullptr)}};
  }
  return json;
}

Json ranking_json(const DesignRanking& ranking) {
  Json methods = Json::array();
  for (const MethodRanking& row : ranking.methods) {
    methods.push_back({{"label", row.label},
                       {"score", row.score},
                       {"cpu_s", row.cpu_s},
                       {"tau", row.agreement.tau},
                       {"pairs", row.agreement.pairs},
                       {"winner_behind", row.agreement.winner_behind},
                       {"winner_behind_standard_error", row.agreement.winner_behind_se},
                       {"is_right", row.is_right}});
  }
  return {{"score", ranking.score},
          {"reference", ranking.reference},
          {"designs", ranking.designs},
          {"standard_error", ranking.mean_error},
          {"methods", methods}};
}

std::string time_text(double seconds) {
  return fmt::format("{:.3g} ms", seconds * 1e3);
}

/// Everything that would be refused, before a folder is made.
void check_study_scene(const Study& study, int threads) {
  try {
    ThreadPool pool(threads);
    SceneStore store(pool);
    const ComparedMethod method = frontier_methods(study.scene).front().method;
    SceneSettings quick = rendered_by(method, study.scene);
    if (method.is_noisy) {
      quick = with_larger_pixels(quick, pixel_factor(quick.camera, kMaxFrontierPixels));
      store.leave_out_unseen_defects();
    }
    evaluate(store, quick);
  } catch (const ConfigError& error) {
    throw with_place(study.root, error);
  }
}

/// Of the budget, for designs in the order that methods give them.
constexpr double kRankingShare = 0.3;

Json measure(const Study& study, const FrontierRun& run, Frontier& frontier) {
  const auto start = Clock::now();
  Progress bar(study.name, kProgressSteps, run.progress);
  const bool has_designs = study.has_search() && study.has_objective;
  const double share = has_designs ? 1.0 - kRankingShare : 1.0;
  const auto show = [&](double done, const std::string& next) {
    bar.update(static_cast<std::int64_t>(done * share * kProgressSteps), next);
  };
  const auto show_designs = [&](double done, const std::string& next) {
    bar.update(static_cast<std::int64_t>((share + done * kRankingShare) * kProgressSteps), next);
  };
  const Goal goal = choice_goal(study);
  try {
    frontier = measure_frontier(study.scene,
                                {.threads = run.threads,
                                 .budget_s = share * run.budget_s,
                                 .goal = study.has_objective ? &goal : nullptr,
                                 .on_progress = show});
    find_branch(study, frontier);
    const double taken_s = std::chrono::duration<double>(Clock::now() - start).count();
    frontier.ranking = rank_designs(study,
                                    frontier,
                                    {.threads = run.threads,
                                     .budget_s = std::max(0.0, run.budget_s - taken_s),
                                     .on_progress = show_designs});
    mark_choice(study, frontier);
  } catch (const ConfigError& error) {
    throw with_place(study.root, error);
  }
  bar.update(kProgressSteps);
  return frontier_json(study, frontier);
}

constexpr std::array<const char*, 4> kPathNotes = {
    "A method is rendered up to four times with other random numbers; its error is the root of "
    "the mean square distance of one of these pictures from the reference.",
    "CPU time is that of one more picture and its scores, summed over threads, part built. The "
    "first one also pays for building the part.",
    "Frame error: root of the mean square of grey values, without noise and rounding of the "
    "sensor, over all frames and all pixels that see the part; pictures of larger pixels are "
    "enlarged linearly for it. Full scale is 1.",
    "Contrast error: the worst defect, in the mean image (Weber) or in its best frame (change), "
    "in per cent of its value but of at least 1 % of full contrast."};

/// How path-traced scenes are measured.
std::vector<std::string> path_method_notes(const Frontier& frontier) {
  const FrontierReference& reference = frontier.reference;
  std::vector<std::string> notes = {
      fmt::format("The reference is {} independent pictures together, with {} samples a pixel each "
                  "and at most {} reflections on the part. Its own noise, known from their "
                  "scatter, is subtracted from every error, and what noise does to its scores "
                  "from them (jackknife); smaller differences cannot be distinguished.",
                  reference.pictures,
                  reference.method.paths.samples,
                  reference.method.paths.max_reflections)};
  notes.insert(notes.end(), kPathNotes.begin(), kPathNotes.end());
  if (frontier.pixel_factor > 1) {
    notes.push_back(
        fmt::format("Pictures are reduced to {} x {} px: pixels are {} times as large "
                    "along both sides as the scene's.",
                    frontier.width_px,
                    frontier.height_px,
                    frontier.pixel_factor));
  }
  if (!frontier.unseen.empty()) {
    notes.push_back(
        "Not in sight of the camera, or without a background of their own, and not "
        "scored: " +
        join(frontier.unseen, ", ") + ".");
  }
  return notes;
}

constexpr std::array<const char*, 4> kRayNotes = {
    "CPU time is that of one thread for one more candidate lighting, rays kept: the best of "
    "several repeats. The first candidate also pays for building the part and tracing.",
    "Frame error: root of the mean square of radiance over all frames and all pixels that see "
    "the part; pictures of half resolution are enlarged linearly for it. Full scale is 1.",
    "Contrast error: the worst defect, in the mean image (Weber) or in its best frame "
    "(change), in per cent of its value but of at least 1 % of full contrast.",
    "Glint's own choice is what render.method = \"auto\" does with the scene's "
    "max_direction_error_mrad. It is no rung of [accuracy], whose rungs for mirrors allow other "
    "direction errors."};

std::vector<std::string> method_notes(const Frontier& frontier) {
  if (frontier.reference.method.is_noisy) {
    return path_method_notes(frontier);
  }
  std::vector<std::string> notes = {
      fmt::format("Every method is compared with {} rays a pixel by plain sampling at full "
                  "resolution, without noise and quantisation.",
                  frontier.reference.method.rays_per_px)};
  notes.insert(notes.end(), kRayNotes.begin(), kRayNotes.end());
  if (frontier.reference.own_frame_rmse) {
    notes.push_back(fmt::format(
        "The reference's own frame error is about {:.2g}, extrapolated from 16 and 64 rays; below "
        "that the chart shows no differences.",
        *frontier.reference.own_frame_rmse));
  }
  return notes;
}

std::string page_html(const Study& study, const Frontier& frontier, const Json& json) {
  return frontier_page_html(study,
                            "Cost and error of each rendering method",
                            frontier_sentence(frontier),
                            "frontier",
                            json,
                            method_notes(frontier));
}

/// The scene's own setting, and what is cheaper and no worse.
std::string path_sentence(const Frontier& frontier) {
  const auto own = std::ranges::find_if(frontier.points, [](const FrontierPoint& point) {
    return point.method.is_current && point.problem.empty();
  });
  if (own == frontier.points.end()) {
    return "The scene's own setting could not be measured in the time allowed.";
  }
  const FrontierPoint* cheaper = nullptr;
  for (const FrontierPoint& point : frontier.points) {
    if (point.problem.empty() && point.cpu_s < own->cpu_s &&
        *point.frame_rmse <= *own->frame_rmse &&
        (cheaper == nullptr || point.cpu_s < cheaper->cpu_s)) {
      cheaper = &point;
    }
  }
  const std::string sentence = fmt::format(
      "The scene's own setting ({}) takes {:.3g} CPU seconds a picture, with a frame error of "
      "{:.2g} and {:.2g} points of h",
      own->label,
      own->cpu_s,
      *own->frame_rmse,
      own->h_error_points);
  return (cheaper == nullptr
              ? sentence + "; nothing cheaper is as exact."
              : fmt::format(
                    "{}; {} is no worse at {:.3g} s.", sentence, cheaper->label, cheaper->cpu_s)) +
         " " + choice_sentence(frontier);
}

}  // namespace

std::string frontier_sentence(const Frontier& frontier) {
  if (frontier.reference.method.is_noisy) {
    return path_sentence(frontier);
  }
  const auto choice = std::ranges::find_if(frontier.points, [](const FrontierPoint& point) {
    return point.method.is_choice && point.problem.empty() && point.frame_rmse;
  });
  if (choice == frontier.points.end()) {
    return "The program's own choice could not be measured.";
  }
  const std::string own = fmt::format(
      "Glint's own choice takes {} for {}, with a frame error of "
      "{:.2g}",
      time_text(choice->cpu_s),
      "all pictures of a candidate",
      *choice->frame_rmse);
  const FrontierPoint* equal = nullptr;
  const FrontierPoint* finest = nullptr;
  for (const FrontierPoint& point : frontier.points) {
    const bool is_measured = point.problem.empty() && point.frame_rmse;
    if (!is_measured || !is_like_reference(point, frontier) || point.is_reference) {
      continue;
    }
    finest = &point;
    if (*point.frame_rmse <= *choice->frame_rmse &&
        (equal == nullptr || point.cpu_s < equal->cpu_s)) {
      equal = &point;
    }
  }
  if (equal != nullptr) {
    return fmt::format("{}; plain sampling needs {} and {} for no larger one.",
                       own,
                       equal->label,
                       time_text(equal->cpu_s));
  }
  return finest == nullptr
             ? own + "."
             : fmt::format("{}; plain sampling with {} takes {} and is off by {:.2g}.",
                           own,
                           finest->label,
                           time_text(finest->cpu_s),
                           *finest->frame_rmse);
}

Json frontier_json(const Study& study, const Frontier& frontier) {
  Json points = Json::array();
  for (const FrontierPoint& point : frontier.points) {
    points.push_back(point_json(point));
  }
  Json json = {{"schema", 1},
               {"status", "done"},
               {"study", study.name},
               {"title", study.title},
               {"width_px", frontier.width_px},
               {"height_px", frontier.height_px},
               {"pixel_factor", frontier.pixel_factor},
               {"unseen_defects", frontier.unseen},
               {"reference", reference_json(frontier.reference)},
               {"points", points}};
  json["objective"] = study.has_objective ? Json(study.goal.objective.name) : Json(nullptr);
  if (frontier.split) {
    json["branch"] =
        frontier.branch ? Json(frontier.split->label(*frontier.branch)) : Json(nullptr);
    json["branches"] = {{"variable", frontier.split->name}, {"values", frontier.split->values}};
  }
  json["ranking"] = frontier.ranking ? ranking_json(*frontier.ranking) : Json(nullptr);
  json["report"] = "frontier.html";
  json["drawing"] = "frontier.svg";
  return json;
}

Json frontier_study(const Study& study, const FrontierRun& run) {
  const auto start = Clock::now();
  check_frontier_folder(study, run.out);
  check_study_scene(study, run.threads);
  { const OutputFolder probe(run.out); }  // refused now rather than after all the work
  Frontier frontier;
  Json json = measure(study, run, frontier);
  const double taken_s = std::chrono::duration<double>(Clock::now() - start).count();
  write_frontier_folder(study,
                        run.out,
                        {{"frontier.json", json.dump(2) + "\n"},
                         {"frontier.svg", frontier_svg(frontier, study.title)},
                         {"frontier.html", page_html(study, frontier, json)}},
                        {{"threads", run.threads}, {"timings", {{"this_run_s", taken_s}}}});
  json["report"] = (run.out / "frontier.html").string();
  json["drawing"] = (run.out / "frontier.svg").string();
  return json;
}

}  // namespace glint
