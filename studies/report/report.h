// SPDX-License-Identifier: GPL-3.0-or-later
//
// The report of a run, and the pages of rendered views and of inspections: one HTML file that needs
// no network (web/ holds its page). The caller describes it as one JSON object. All fields may be
// left out; what is absent is not drawn.
//
//   title, subtitle   texts
//   when              date and duration as a text: stands in the page's element of the id `when`,
//                     the only part of a report that another run of the same study changes
//   status            "done" | "budget" | "interrupted" | "no_feasible"; absent: not a search
//   objective         { name: a score's name, sense: "maximise" | "minimise" }
//   constraints       [ { name: a score's name, min?, max? } ]
//   variables         [ { name: a dotted path, kind: "float" | "integer" | "choice" | "boolean",
//                         low, high, log, unit, choices: [..] } ]
//   scene             what was simulated: {
//       picture       base64 PNG of the part, note: the line below it
//       size_px       [ width, height ] that the marks are in
//       marks         [ { label, window_px: [ left, top, width, height ] } ]
//       facts         [ [ name, text ] ]
//       defects       { head: [texts], rows: [ [texts] ], more: text } }
//   designs           cards: winner, baseline, then the others in this order; [ {
//       key, title    unique short name; heading (absent: the key)
//       role          "baseline" | "prototype" | "winner"; absent: from the key
//       run           in a comparison, the title of the run it comes from
//       trial         number of its evaluation
//       feasible      true, false, or absent when there are no constraints
//       limits        by what feasible is judged under noise, absent: by what was seen; see
//                     limits_json() of studies/run/results/judged_limits.h
//       scores        { score: number } with the seeds of the search
//       repeated      { score: [numbers] } of scans with other noise, the same for all designs
//       defects       [ { label, width_px } ]
//       rescored      the same with fresh seeds and finer sampling
//       variables     { path: number | text | boolean }
//       frames        base64 PNGs, see report_png()
//       aspect        base64 PNG
//       closeups      [ { label, image: base64 PNG, size: text, picture: which one it is of,
//                     low, high: what is black and white in it, share of full scale,
//                     pixel_mm, size_px: [ width, height ] for the scale bar,
//                     scores: { score: number } } ]
//       drawing       SVG text, see studies/drawing/drawing.h
//       notes         [ texts ] } ]
//   trials            in the order of their numbers; [ {
//       number, kind  kind is where it came from ("sobol", "bobyqa", "prototype")
//       feasible, failed, message
//       objective     absent or null when it failed
//       values        one per variable, null where a condition switches it off
//       scores        at least those of the constraints } ]
//   runs              only in a comparison of runs; [ { title, status, evaluations, failed,
//                     feasible, scores, rescored, repeated, best_so_far: [number | null],
//                     design: title of the one that stands for a run without a search,
//                     objective, constraints, doubts: [ { code, text } ], limit_lost and
//                     objective_flat of its own report,
//                     group: number of the first run that it may be ranked with (absent: 0),
//                     differs: [ texts ], what is not as in the first run } ]
//   panels            sections of a population; [ {
//       id, title     of the section; lead: the sentence below
//       charts        [ { kind: "sizes" | "lightings" | "pod", its data: web/population.js, or
//                       "curves": web/curves.js } ]
//       tables        [ { caption, head: [texts], rows: [ [texts] ] } ] } ]
//   front             only of several objectives: of add_front_to_page() of
//   studies/front/front_page.h;
//                     `objective` is the first of them
//   analysis          of `glint report --analyse`, see studies/analysis/run_analysis.h
//   frontier          the object of frontier.json, see docs/frontier.md
//   stability         the object of stability.json, see docs/stability.md
//   rendered          of `glint render`; {
//       views         those of its result.json, each with an image: base64 PNG
//       sheet         base64 PNG of all views
//       legend        of the defect map; [ { name, colour } ]
//       drawing       SVG text
//       scores        { score: number } of the first view }
//   inspection        of `glint inspect`: its result.json with what inspect_page.cpp adds
//   coverage          of `glint cover`: its result.json with
//                     pictures: [ { caption, image: base64 PNG } ]
//                     and legend: [ { name, colour, share } ]
//   calibration       of `glint calibrate`: its calibration.json with what calibrate_page.cpp adds
//   comparison        of `glint compare`: its result.json with what compare_page.cpp adds
//   validation        of `glint validate`: its result.json with what validate_page.cpp adds
//   race              that of a run's finalists, where there was one
//   kinds             those of a run's result.json, see best_of_each_kind() of
//                     studies/run/study_search.h
//   methods           [ sentences on method and accuracy ]
//   config_toml       the resolved configuration
//   provenance        { version, seed, compiler, machine, ... }: shown in the order given
//   score_info        { score: { label, format: "percent" | "number", meaning } }; see
//                     complete_report()
//   ranking           of designs without a search, see report_ranking.h and complete_report()
//   probability_best  [ { key, title, probability } ] of designs scanned repeatedly, the most
//   probable first,
//                     see complete_report()
//   verdict           { title: of the section, absent: "Verdict", sentence,
//                     tone: "good" | "neutral" | "bad", details: [texts], findings: [ { code,
//                     text } ], figures: big numbers instead of those of a design, [ { label,
//                     value: text, unit, note } ] }; see complete_report()
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "core/image/image.h"

namespace glint {

/// Fills in what is missing: `score_info` for every score in the data (shares, contrasts and both h
/// as per cent, other scores as numbers) and the `verdict`, worked out from the designs: winner
/// against baseline and best prototype, with the fresh-seed numbers where there are any. Designs
/// without a search get a `ranking` and a section that shows it; with repeated scans of all
/// designs any run gets `probability_best`.
nlohmann::ordered_json complete_report(nlohmann::ordered_json data);

/// The page with the completed data in it. Equal data give equal bytes; numbers that are not finite
/// appear as gaps, broken UTF-8 is replaced.
std::string render_report(const nlohmann::ordered_json& data);

/// A picture for the report: base64 of an 8-bit PNG, reduced by the smallest integer factor that
/// makes it at most max_width_px wide (>= 1).
std::string report_png(const ImageF& image, int max_width_px);

/// The square of 2 half_px + 1 pixels about a pixel, moved inwards where it would leave the image
/// and cut down where the image is smaller.
ImageF closeup(const ImageF& image, int center_x, int center_y, int half_px);

/// Grey values so that low becomes 0 and high becomes 1, clamped; for pictures of faint contrast.
/// An empty range gives the image unchanged.
ImageF stretched(const ImageF& image, float low, float high);

}  // namespace glint
