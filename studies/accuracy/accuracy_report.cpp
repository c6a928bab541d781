// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/accuracy_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "studies/definition/accuracy_table.h"
#include "studies/report/report_wording.h"
#include "studies/report/score_words.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using report_detail::measured;

/// Of a difference: shares are read in points.
std::string value_text(const std::string& score, double value) {
  return (value < 0.0 ? "\u2212" : "") +
         report_detail::Wording::of_score(score).size(std::abs(value));
}

Json tolerance_json(const AccuracySettings& wish) {
  if (wish.is_auto) {
    return "auto";
  }
  Json json = Json::object();
  for (const ScoreWish& one : wish.wishes) {
    json[one.score] = wish_text(one);
  }
  return json;
}

Json settings_json(const RenderRung& rung) {
  if (rung.is_summed) {
    return {{"method", std::string(method_name(rung.render.method))},
            {"rays_per_axis", rung.render.rays_per_axis}};
  }
  if (rung.is_noisy) {
    Json json = {{"samples", rung.paths.samples}, {"max_reflections", rung.paths.max_reflections}};
    if (rung.pixel_factor > 1) {
      json["resolution"] = "half";
    }
    return json;
  }
  return {{"method", std::string(method_name(rung.render.method))},
          {"max_direction_error_mrad", 1e3 * rung.render.max_direction_error_rad},
          {"rays_per_axis", rung.render.rays_per_axis}};
}

Json scores_of_rung(const StepReport& step, bool is_auto) {
  Json list = Json::array();
  for (const ScoreBound& bound : step.bounds) {
    list.push_back({{"score", bound.score},
                    {"tolerance", is_auto ? Json(nullptr) : Json(bound.tolerance)},
                    {"bound", bound.bound},
                    {"wide_bound", bound.wide_bound},
                    {"bias", bound.bias},
                    {"spread", bound.spread},
                    {"top_error", bound.top_error},
                    {"top_bias", bound.top_bias},
                    {"top_spread", bound.top_spread}});
  }
  return list;
}

Json rungs_json(const ChosenAccuracy& chosen) {
  Json list = Json::array();
  for (std::size_t i = 0; i < chosen.ladder.size(); ++i) {
    const RenderRung& rung = chosen.ladder[i];
    const StepReport& step = chosen.choice.steps[i];
    Json json = {{"name", rung.name},
                 {"level", rung.level},
                 {"work", rung.work},
                 {"for_search", rung.is_for_search},
                 {"tried", step.is_tried},
                 {"serves", step.serves},
                 {"skipped", step.skipped},
                 {"tau", Json::object()},
                 {"bounds", Json::object()}};
    for (const OrderOf& order : step.orders) {
      json["tau"][order.objective] = order.agreement.tau;
    }
    for (const ScoreBound& bound : step.bounds) {
      json["bounds"][bound.score] = bound.bound;
    }
    list.push_back(json);
  }
  return list;
}

std::string order_text(const StepReport& step) {
  std::vector<std::string> parts;
  for (const OrderOf& order : step.orders) {
    const RankAgreement& agreement = order.agreement;
    parts.push_back(fmt::format("{}: Kendall's tau {:.2f} over {} pairs, {}",
                                report_detail::score_label(order.objective),
                                agreement.tau,
                                agreement.pairs,
                                agreement.winner_behind == 0.0
                                    ? "the same best design"
                                    : "the best design within two standard errors"));
  }
  return join(parts, "; ");
}

std::string bounds_text(const StepReport& step) {
  std::vector<std::string> parts;
  for (const ScoreBound& bound : step.bounds) {
    parts.push_back(fmt::format("{} within {}, {} allowed",
                                report_detail::score_label(bound.score),
                                value_text(bound.score, bound.bound),
                                value_text(bound.score, bound.tolerance)));
  }
  return join(parts, "; ");
}

std::vector<std::string> reasons(const Study& study, const ChosenAccuracy& chosen) {
  const LadderChoice& choice = chosen.choice;
  const StepReport& step = choice.steps[choice.step];
  const std::string& name = chosen.rung().name;
  if (!choice.problem.empty()) {
    return {fmt::format("The search is rendered by \"{}\", the dearest way that it may use: {}.",
                        name,
                        choice.problem)};
  }
  if (!choice.is_reached) {
    return {
        fmt::format("The search is rendered by \"{}\", the dearest way that it may use, and not "
                    "as exactly as asked for: {}.",
                    name,
                    join(choice.unreached, "; "))};
  }
  return {fmt::format(
      "The search is rendered by \"{}\", the cheapest way that {} ({}).",
      name,
      study.accuracy->is_auto
          ? fmt::format("ranks {} designs as \"{}\" does", choice.designs.size(), chosen.top().name)
          : "keeps every tolerance",
      study.accuracy->is_auto ? order_text(step) : bounds_text(step))};
}

std::string work_text(const Json& work) {
  const double search = work["search"].get<double>();
  if (search == 0.0) {
    return fmt::format(
        "Choosing it took as much counted work as {:.0f} evaluations; with finalists' accuracy "
        "each "
        "evaluation would take {:.1f} times the work.",
        work["checking"].get<double>() / work["evaluation"].get<double>(),
        work["full_evaluation"].get<double>() / work["evaluation"].get<double>());
  }
  return fmt::format(
      "Choosing it took {:.0f} % of the counted work of the search; with finalists' "
      "accuracy the search would have taken {:.1f} times the work.",
      100.0 * work["checking"].get<double>() / search,
      work["full"].get<double>() / search);
}

std::string offsets_text(const RenderRung& rung) {
  std::vector<std::string> parts;
  for (const auto& [score, offset] : rung.offsets) {
    parts.push_back(
        fmt::format("{} by {}", report_detail::score_label(score), value_text(score, -offset)));
  }
  return fmt::format(
      "Scores of half resolution are corrected by their mean error over the designs that were "
      "tried: {}.",
      join(parts, ", "));
}

Json rungs_table(const Json& accuracy) {
  Json rows = Json::array();
  const double top = accuracy["rungs"].back()["work"].get<double>();
  for (const Json& rung : accuracy["rungs"]) {
    std::vector<std::string> taus;
    for (const auto& [objective, tau] : rung["tau"].items()) {
      taus.push_back(fmt::format("{:.2f}", tau.get<double>()));
    }
    std::vector<std::string> bounds;
    for (const auto& [score, bound] : rung["bounds"].items()) {
      bounds.push_back(fmt::format(
          "{} {}", report_detail::score_label(score), value_text(score, bound.get<double>())));
    }
    const auto skipped = rung["skipped"].get<std::string>();
    std::string result = !skipped.empty()              ? "left out: " + skipped
                         : !rung["serves"].get<bool>() ? "not exact enough"
                                                       : "serves";
    if (rung["name"] == accuracy["rung"]) {
      result += ", used by the search";
    } else if (!rung["for_search"].get<bool>()) {
      result = "compared with";
    }
    rows.push_back({rung["name"],
                    measured(100.0 * rung["work"].get<double>() / top) + " %",
                    taus.empty() ? "-" : join(taus, ", "),
                    bounds.empty() ? "-" : join(bounds, "; "),
                    result});
  }
  return {{"caption",
           fmt::format("The ladder, tried on {} designs with the same random numbers: {}. Work is "
                       "counted, as a share of the last row's; bounds hold at a confidence of {:g} "
                       "%.",
                       accuracy["designs"].size(),
                       join(accuracy["designs"].get<std::vector<std::string>>(), ", "),
                       100.0 * accuracy["confidence"].get<double>())},
          {"head", {"way to render", "work", "Kendall's tau", "errors within", "result"}},
          {"rows", rows}};
}

std::string settings_text(const Json& settings) {
  std::vector<std::string> parts;
  for (const auto& [key, value] : settings.items()) {
    parts.push_back(
        fmt::format("{} = {}", key, value.is_string() ? value.get<std::string>() : value.dump()));
  }
  return join(parts, ", ");
}

std::string wish_text(const Json& accuracy) {
  const Json& tolerance = accuracy["tolerance"];
  std::vector<std::string> parts;
  if (tolerance.is_object()) {
    for (const auto& [score, text] : tolerance.items()) {
      parts.push_back(text.get<std::string>());
    }
  }
  return fmt::format("{}, at a confidence of {:g} %",
                     parts.empty() ? "\"auto\": the right order of designs" : join(parts, "; "),
                     100.0 * accuracy["confidence"].get<double>());
}

/// @param key  "bound" or "wide_bound"
std::string bounds_text(const Json& accuracy, const char* key) {
  std::vector<std::string> parts;
  for (const Json& score : accuracy["scores"]) {
    const auto name = score["score"].get<std::string>();
    parts.push_back(fmt::format("{} within {}",
                                report_detail::score_label(name),
                                value_text(name, score[key].get<double>())));
  }
  return parts.empty() ? "none: too few designs could be evaluated" : join(parts, "; ");
}

/// "12.3 million paths; 41 % of the search"
std::string cost_text(const Json& work, double amount) {
  const double search = work["search"].get<double>();
  const std::string share =
      search > 0.0 ? fmt::format("; {} % of the search", measured(100.0 * amount / search)) : "";
  return fmt::format("{} {}{}", measured(amount), work["unit"].get<std::string>(), share);
}

/// By the evaluations that there are; of one where their number is not known.
std::string search_text(const Json& work) {
  const double search = work["search"].get<double>();
  return search > 0.0 ? cost_text(work, search)
                      : fmt::format("{} for each evaluation",
                                    cost_text(work, work["evaluation"].get<double>()));
}

std::string full_text(const Json& work) {
  return work["search"].get<double>() > 0.0
             ? cost_text(work, work["full"].get<double>())
             : fmt::format("{} for each evaluation",
                           cost_text(work, work["full_evaluation"].get<double>()));
}

/// What the section is about, in one place.
Json facts_table(const Json& accuracy) {
  const Json& work = accuracy["work"];
  Json rows =
      Json::array({{"asked for", wish_text(accuracy)},
                   {"level", accuracy["level"]},
                   {"rendered by", accuracy["rung"]},
                   {"settings", settings_text(accuracy["settings"])},
                   {"errors of one more design", bounds_text(accuracy, "bound")},
                   {"of all designs, unchecked ones too", bounds_text(accuracy, "wide_bound")},
                   {"the search takes", search_text(work)},
                   {"choosing takes", cost_text(work, work["checking"].get<double>())}});
  if (accuracy.contains("check")) {
    const Json& check = accuracy["check"];
    rows.push_back({"checked", check["sentence"]});
    rows.push_back({"checking took", cost_text(work, check["work"].get<double>())});
    rows.push_back(
        {"finalists at the top took", cost_text(work, check["finalist_work"].get<double>())});
  }
  rows.push_back({"full physics would have taken", full_text(work)});
  return {{"caption", "In one place; work is counted, not measured:"},
          {"head", {"what", "how"}},
          {"rows", rows}};
}

Json unmodelled_table(const Json& accuracy) {
  Json rows = Json::array();
  for (const Json& note : accuracy["not_modelled"]) {
    rows.push_back({note});
  }
  return {{"caption", "What no way to render models, with rough estimates:"},
          {"head", {"left out"}},
          {"rows", rows}};
}

/// With what its check came to, of a run that was finished.
std::string sentences(const Json& accuracy) {
  const auto sentence = accuracy["sentence"].get<std::string>();
  return accuracy.contains("check")
             ? sentence + " " + accuracy["check"]["sentence"].get<std::string>()
             : sentence;
}

}  // namespace

Json accuracy_json(const Study& study,
                   const ChosenAccuracy& chosen,
                   int evaluations,
                   const std::vector<std::string>& unmodelled,
                   double earlier_work) {
  const LadderChoice& choice = chosen.choice;
  const Json work = {{"unit", "million camera paths with direct light, counted"},
                     {"evaluation", chosen.rung().work},
                     {"checking", choice.work},
                     {"full_evaluation", chosen.top().work},
                     {"search", earlier_work + chosen.rung().work * evaluations},
                     {"full", chosen.top().work * evaluations}};
  std::vector<std::string> why = reasons(study, chosen);
  if (choice.num_alike > 0) {
    why.push_back(
        fmt::format("{} designs that were looked at are mirrors, which every one of these "
                    "ways renders alike: how exact their scores are was not compared.",
                    choice.num_alike));
  }
  why.push_back(work_text(work));
  if (!chosen.rung().offsets.empty()) {
    why.push_back(offsets_text(chosen.rung()));
  }
  Json json = {{"tolerance", tolerance_json(*study.accuracy)},
               {"confidence", study.accuracy->confidence},
               {"level", chosen.rung().level},
               {"rung", chosen.rung().name},
               {"settings", settings_json(chosen.rung())},
               {"reached", choice.is_reached},
               {"sentence", join(why, " ")},
               {"why", why},
               {"unreached", choice.unreached},
               {"scores", scores_of_rung(choice.steps[choice.step], study.accuracy->is_auto)},
               {"designs", chosen.designs},
               {"failed", choice.num_failed},
               {"alike", choice.num_alike},
               {"rungs", rungs_json(chosen)},
               {"work", work},
               {"not_modelled", unmodelled}};
  if (!chosen.rung().offsets.empty()) {
    json["offsets"] = chosen.rung().offsets;
  }
  return json;
}

Json accuracy_panel(const Json& accuracy) {
  return {{"id", "accuracy"},
          {"title", "How exactly it was rendered"},
          {"lead", sentences(accuracy)},
          {"tables", {facts_table(accuracy), rungs_table(accuracy), unmodelled_table(accuracy)}}};
}

std::string accuracy_text(const Json& accuracy) {
  return fmt::format("  {}\n", sentences(accuracy));
}

}  // namespace glint
