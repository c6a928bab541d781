// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/accuracy_report.h"

#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "studies/accuracy/error_text.h"
#include "studies/definition/accuracy_table.h"
#include "studies/report/score_words.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using report_detail::error_text;

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

std::string order_text(const std::vector<OrderOf>& orders) {
  std::vector<std::string> parts;
  for (const OrderOf& order : orders) {
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
                                error_text(bound.score, bound.bound),
                                error_text(bound.score, bound.tolerance)));
  }
  return join(parts, "; ");
}

/// "The search is rendered by ..."
std::string rendered_text(const ChosenAccuracy& chosen) {
  return chosen.label.empty()
             ? fmt::format("The search is rendered by \"{}\"", chosen.rung().name)
             : fmt::format(
                   "Designs with {} are rendered by \"{}\"", chosen.label, chosen.rung().name);
}

/// @param chosen  of the search or, with tolerances, of a branch
std::string reason(const Study& study, const ChosenAccuracy& chosen) {
  const LadderChoice& choice = chosen.choice;
  const StepReport& step = choice.steps[choice.step];
  const std::string rendered = rendered_text(chosen);
  const char* who = chosen.label.empty() ? "it" : "the search";
  if (!choice.problem.empty()) {
    return fmt::format("{}, the dearest way that {} may use: {}.", rendered, who, choice.problem);
  }
  if (!choice.is_reached) {
    return fmt::format("{}, the dearest way that {} may use, and not as exactly as asked for: {}.",
                       rendered,
                       who,
                       join(choice.unreached, "; "));
  }
  return fmt::format(
      "{}, the cheapest way that {} ({}).",
      rendered,
      study.accuracy->is_auto
          ? fmt::format("ranks {} designs as \"{}\" does", choice.designs.size(), chosen.top().name)
          : "keeps every tolerance",
      study.accuracy->is_auto ? order_text(step.orders) : bounds_text(step));
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
        fmt::format("{} by {}", report_detail::score_label(score), error_text(score, -offset)));
  }
  return fmt::format(
      "Scores of half resolution are corrected by their mean error over the designs that were "
      "tried: {}.",
      join(parts, ", "));
}

/// Of designs that were not compared.
std::string alike_text(const LadderChoice& choice) {
  return fmt::format(
      "{} designs that were looked at are mirrors, which every one of these "
      "ways renders alike: how exact their scores are was not compared.",
      choice.num_alike);
}

/// @param evaluations   of the search
/// @param earlier_work  at cheaper rungs
Json work_json(const ChosenAccuracy& chosen, int evaluations, double earlier_work) {
  double checking = 0.0;
  for (const ChosenAccuracy& part : chosen.parts()) {
    checking += part.choice.work;
  }
  return {{"unit", "million camera paths with direct light, counted"},
          {"evaluation", chosen.evaluation_work()},
          {"checking", checking},
          {"full_evaluation", chosen.full_evaluation_work()},
          {"search", earlier_work + chosen.evaluation_work() * evaluations},
          {"full", chosen.full_evaluation_work() * evaluations}};
}

/// How the designs of all branches are ranked together, with "auto".
std::string joint_text(const ChosenAccuracy& chosen) {
  std::size_t designs = 0;
  for (const ChosenAccuracy& part : chosen.branches) {
    if (part.choice.problem.empty()) {
      designs += part.choice.designs.size();
      if (!part.choice.is_reached) {
        return fmt::format("That is not as exact as asked for: {}.",
                           join(part.choice.unreached, "; "));
      }
    }
  }
  return chosen.orders.empty()
             ? std::string("Of no branch enough designs could be ranked.")
             : fmt::format("Together these rank {} designs as the tops of their ladders do ({}).",
                           designs,
                           order_text(chosen.orders));
}

std::vector<std::string> branch_reasons(const Study& study, const ChosenAccuracy& chosen) {
  std::vector<std::string> why;
  for (const ChosenAccuracy& part : chosen.branches) {
    why.push_back(study.accuracy->is_auto && part.choice.problem.empty() ? rendered_text(part) + "."
                                                                         : reason(study, part));
    if (part.choice.num_alike > 0) {
      why.push_back(fmt::format("Of {}: {}", part.label, alike_text(part.choice)));
    }
    if (!part.rung().offsets.empty()) {
      why.push_back(fmt::format("Of {}: {}", part.label, offsets_text(part.rung())));
    }
    if (!part.stays.empty()) {
      why.push_back(part.stays);
    }
  }
  if (study.accuracy->is_auto) {
    why.push_back(joint_text(chosen));
  }
  return why;
}

/// Of choices that change how designs are rendered, and make no branches.
/// @param names  one or more
std::string common_text(const std::vector<std::string>& names, bool has_branches) {
  return fmt::format(
      "All values of {} have {}, though they change how designs are rendered: a choice with a "
      "condition or of more than {} values makes no branches, nor does one with which there would "
      "be more than {}; a search goes on with those that it began with.",
      join(names, ", "),
      has_branches ? "one ladder in each branch" : "one ladder",
      kMaxBranchValues,
      kMaxBranches);
}

void add_common_choices(const Study& study,
                        const ChosenAccuracy& chosen,
                        std::vector<std::string>& why) {
  const std::vector<std::string> names = choices_in_common(study, chosen.split);
  if (!names.empty()) {
    why.push_back(common_text(names, chosen.split.has_value()));
  }
}

Json branch_json(const ChosenAccuracy& part, const std::string& value, bool is_auto) {
  const LadderChoice& choice = part.choice;
  Json json = {{"value", value},
               {"level", part.rung().level},
               {"rung", part.rung().name},
               {"settings", settings_json(part.rung())},
               {"reached", choice.is_reached},
               {"scores", scores_of_rung(choice.steps[choice.step], is_auto)},
               {"designs", part.designs},
               {"failed", choice.num_failed},
               {"alike", choice.num_alike},
               {"rungs", rungs_json(part)},
               {"share", part.share},
               {"work",
                {{"evaluation", part.rung().work},
                 {"checking", choice.work},
                 {"full_evaluation", part.top().work}}}};
  if (!part.rung().offsets.empty()) {
    json["offsets"] = part.rung().offsets;
  }
  return json;
}

/// Of a search with a rung for each branch.
Json branched_json(const Study& study, const ChosenAccuracy& chosen, const Json& work) {
  Json branches = Json::array();
  std::vector<std::string> levels;
  std::vector<std::string> unreached;
  bool is_reached = true;
  for (std::size_t i = 0; i < chosen.branches.size(); ++i) {
    const ChosenAccuracy& part = chosen.branches[i];
    const std::string& value = chosen.split->values[i];
    branches.push_back(branch_json(part, value, study.accuracy->is_auto));
    if (chosen.split->choices.size() > 1) {
      branches.back()["label"] = part.label;
    }
    levels.push_back(fmt::format("{}: {}", value, part.rung().level));
    is_reached = is_reached && part.choice.is_reached;
    for (const std::string& text : part.choice.unreached) {
      unreached.push_back(study.accuracy->is_auto ? text : fmt::format("{}: {}", part.label, text));
    }
  }
  if (study.accuracy->is_auto && unreached.size() > 1) {
    unreached.resize(1);  // it is of all branches
  }
  std::vector<std::string> why = branch_reasons(study, chosen);
  add_common_choices(study, chosen, why);
  why.push_back(work_text(work));
  Json tau = Json::object();
  for (const OrderOf& order : chosen.orders) {
    tau[order.objective] = order.agreement.tau;
  }
  return {{"tolerance", tolerance_json(*study.accuracy)},
          {"confidence", study.accuracy->confidence},
          {"level", join(levels, "; ")},
          {"rung", chosen.rungs().name()},
          {"reached", is_reached},
          {"sentence", join(why, " ")},
          {"why", why},
          {"unreached", unreached},
          {"variable", chosen.split->name},
          {"tau", tau},
          {"branches", branches},
          {"work", work}};
}

}  // namespace

Json accuracy_json(const Study& study,
                   const ChosenAccuracy& chosen,
                   int evaluations,
                   const std::vector<std::string>& unmodelled,
                   double earlier_work) {
  const Json work = work_json(chosen, evaluations, earlier_work);
  if (chosen.split) {
    Json json = branched_json(study, chosen, work);
    json["not_modelled"] = unmodelled;
    return json;
  }
  const LadderChoice& choice = chosen.choice;
  std::vector<std::string> why = {reason(study, chosen)};
  if (choice.num_alike > 0) {
    why.push_back(alike_text(choice));
  }
  add_common_choices(study, chosen, why);
  why.push_back(work_text(work));
  if (!chosen.rung().offsets.empty()) {
    why.push_back(offsets_text(chosen.rung()));
  }
  if (!chosen.stays.empty()) {
    why.push_back(chosen.stays);
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

}  // namespace glint
