// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/accuracy_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "core/text.h"
#include "metrics/scores.h"
#include "studies/definition/scene_scores.h"

namespace glint {
namespace {

constexpr const char* kTable = "accuracy";
constexpr double kHundredth = 0.01;
constexpr const char* kResolution = "camera.width_px";
constexpr const char* kReflections = "render.paths.max_reflections";
constexpr std::string_view kAllowedTolerance =
    R"(a number > 0 in the score's own unit, "2 %" of its value, or "0.1 points" (hundredths))";

/// The number that a text begins with, and the word behind it.
struct NumberAndWord {
  double number = 0.0;
  std::string word;
};

std::optional<NumberAndWord> number_and_word(const std::string& text) {
  const char* const end = text.data() + text.size();
  double number = 0.0;
  const auto [next, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc()) {
    return std::nullopt;
  }
  std::string word(next, end);
  word.erase(
      0,
      word.find_first_not_of(' ') == std::string::npos ? word.size() : word.find_first_not_of(' '));
  return NumberAndWord{number, word};
}

/// @return nothing where it is no tolerance
std::optional<ScoreWish> read_wish(const std::string& score, const ConfigNode& node) {
  ScoreWish wish = {.score = score};
  if (node.is_number()) {
    wish.tolerance = node.number;
  } else if (node.kind == ConfigNode::Kind::kText) {
    const auto read = number_and_word(node.text);
    const bool is_points = read && (read->word == "points" || read->word == "point");
    if (!read || (read->word != "%" && !is_points)) {
      return std::nullopt;
    }
    wish.is_relative = !is_points;
    wish.tolerance = read->number * kHundredth;
  } else {
    return std::nullopt;
  }
  return wish.tolerance > 0.0 && std::isfinite(wish.tolerance) ? std::optional(wish) : std::nullopt;
}

std::string shown(const ConfigNode& node) {
  return node.is_table() ? "a table" : value_to_toml(node);
}

void read_wishes(const ConfigNode& table,
                 AccuracySettings& settings,
                 std::vector<Problem>& errors) {
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    const ConfigNode& item = table.items[i];
    if (const auto wish = read_wish(table.names[i], item)) {
      settings.wishes.push_back(*wish);
    } else {
      errors.push_back({.kind = Problem::Kind::kOutOfRange,
                        .place = item.place,
                        .context = "accuracy.tolerance",
                        .key = table.names[i],
                        .text = fmt::format("is {}, must be {}", shown(item), kAllowedTolerance)});
    }
  }
}

void read_tolerance(const ConfigNode& table,
                    const ConfigNode* node,
                    AccuracySettings& settings,
                    std::vector<Problem>& errors) {
  const bool is_text = node != nullptr && node->kind == ConfigNode::Kind::kText;
  settings.is_auto = is_text && node->text == "auto";
  if (node != nullptr && node->is_table() && !node->names.empty()) {
    read_wishes(*node, settings, errors);
  } else if (!settings.is_auto) {
    errors.push_back(
        {.kind = Problem::Kind::kOutOfRange,
         .place = node != nullptr ? node->place : table.place,
         .key = "accuracy.tolerance",
         .text = fmt::format(R"({}, must be "auto" or a table {{ "name of a score" = {} }})",
                             node == nullptr ? "is missing" : "is " + shown(*node),
                             kAllowedTolerance)});
  }
}

void visit_confidence(KeyVisitor& keys, AccuracySettings& settings) {
  keys.number("confidence",
              settings.confidence,
              Range::between(0.5, 0.9999),
              "with which the bounds hold, and the share of designs that they hold for");
}

/// What `keep` may name.
std::vector<std::string> keepable() {
  std::vector<std::string> keys = ladder_keys();
  keys.emplace_back(kResolution);
  keys.emplace_back(kReflections);
  return keys;
}

/// The keys of `keep`; nothing without it.
std::optional<std::vector<std::string>> read_keep(const ConfigNode* node,
                                                  std::vector<Problem>& errors) {
  if (node == nullptr) {
    return std::nullopt;
  }
  const std::vector<std::string> known = keepable();
  std::vector<std::string> keys;
  for (const ConfigNode& item : node->items) {
    const bool is_known =
        item.kind == ConfigNode::Kind::kText && std::ranges::find(known, item.text) != known.end();
    if (!is_known || !node->is_array()) {
      errors.push_back({.kind = Problem::Kind::kOutOfRange,
                        .place = item.place,
                        .key = "accuracy.keep",
                        .text = fmt::format("{} is none of the keys that are chosen: \"{}\"",
                                            shown(item),
                                            fmt::join(known, "\", \""))});
      continue;
    }
    keys.push_back(item.text);
  }
  if (!node->is_array()) {
    errors.push_back({.kind = Problem::Kind::kWrongType,
                      .place = node->place,
                      .key = "accuracy.keep",
                      .text = "must be a list of keys, as [\"render.paths.samples\"]"});
  }
  return keys;
}

/// Places that say something about keys that are chosen, other than the tables themselves.
void check_not_varied(const Study& study, std::vector<Problem>& errors) {
  const std::vector<std::string> all = [] {
    std::vector<std::string> keys = ladder_keys();
    keys.emplace_back(kReflections);
    return keys;
  }();
  const auto refuse = [&](const std::string& path, const Place& place, const char* table) {
    if (std::ranges::find(all, path) != all.end()) {
      errors.push_back(
          {.kind = Problem::Kind::kRelation,
           .place = place,
           .context = table,
           .key = path,
           .text = "is chosen by [accuracy] for all designs alike; remove one of them"});
    }
  };
  for (const Variable& variable : study.space.variables) {
    refuse(variable.name, study.root.find("variables")->find(variable.name)->place, "variables");
  }
  for (const Prototype& prototype : study.prototypes) {
    for (const auto& [path, value] : prototype.overrides) {
      refuse(path, value.place, "prototypes");
    }
  }
}

std::string why_no_score(const SceneSettings& scene, const std::string& name) {
  if (is_bound(name) || is_error(name)) {
    return "is the bound or the error of a score; allowed are scores";
  }
  std::string problem = unknown_score(name, defect_labels(scene), group_names(scene));
  problem += problem.empty() ? missing_by_paths(scene, name) : "";
  problem += problem.empty() ? missing_by_reference(scene, name) : "";
  problem += problem.empty() ? missing_by_cell(scene, name) : "";
  return problem;
}

/// @param tolerance  nullptr or anything: other than a table it names no score
void check_scores(const SceneSettings& scene,
                  const ConfigNode* tolerance,
                  std::vector<Problem>& errors) {
  if (tolerance == nullptr || !tolerance->is_table()) {
    return;
  }
  for (std::size_t i = 0; i < tolerance->names.size(); ++i) {
    if (const std::string problem = why_no_score(scene, tolerance->names[i]); !problem.empty()) {
      errors.push_back({.place = tolerance->items[i].place,
                        .key = "accuracy.tolerance",
                        .text = fmt::format("\"{}\" {}", tolerance->names[i], problem)});
    }
  }
}

}  // namespace

const std::vector<std::string>& ladder_keys() {
  static const std::vector<std::string> keys = {"render.method",
                                                "render.rays_per_axis",
                                                "render.max_direction_error_mrad",
                                                "render.paths.samples"};
  return keys;
}

KeptKeys keys_in_file(const ConfigNode& root) {
  const auto has = [&](std::size_t key) { return root.at_path(ladder_keys()[key]) != nullptr; };
  return {
      .method = has(0), .rays_per_axis = has(1), .max_direction_error = has(2), .samples = has(3)};
}

std::vector<std::string> names_of(const KeptKeys& kept) {
  const std::vector<bool> is_kept = {
      kept.method, kept.rays_per_axis, kept.max_direction_error, kept.samples};
  std::vector<std::string> names;
  for (std::size_t i = 0; i < is_kept.size(); ++i) {
    if (is_kept[i]) {
      names.push_back(ladder_keys()[i]);
    }
  }
  if (kept.resolution) {
    names.emplace_back(kResolution);
  }
  if (kept.reflections) {
    names.emplace_back(kReflections);
  }
  return names;
}

std::optional<AccuracySettings> read_accuracy(const ConfigNode& root,
                                              const SceneSettings& scene,
                                              std::vector<Problem>& errors) {
  const ConfigNode* table = root.find(kTable);
  if (table == nullptr) {
    return std::nullopt;
  }
  AccuracySettings settings;
  const std::size_t before = errors.size();
  KeyReader reader(table, kTable, errors);
  visit_confidence(reader, settings);
  const ConfigNode* tolerance = reader.take("tolerance");
  const ConfigNode* keep = reader.take("keep");
  reader.report_unknown();
  if (table->is_table()) {
    read_tolerance(*table, tolerance, settings, errors);
    check_scores(scene, tolerance, errors);
    read_keep(keep, errors);
  } else if (errors.size() == before) {
    errors.push_back({.kind = Problem::Kind::kWrongType,
                      .place = table->place,
                      .key = kTable,
                      .text = "must be a table, like [accuracy]"});
  }
  return settings;
}

void check_accuracy(const Study& study, std::vector<Problem>& errors) {
  if (!study.accuracy) {
    return;
  }
  const ConfigNode& table = *study.root.find(kTable);
  if (!study.has_search() || !study.has_objective) {
    errors.push_back({.kind = Problem::Kind::kRelation,
                      .place = table.place,
                      .key = kTable,
                      .text = "chooses how the designs of a search are rendered; it needs "
                              "[variables] and [objective]"});
    return;
  }
  check_not_varied(study, errors);
}

ConfigNode write_accuracy(const AccuracySettings& settings, const ConfigNode& root) {
  ConfigNode table = ConfigNode::table();
  const auto add = [](ConfigNode& to, const std::string& name, ConfigNode value) {
    to.names.push_back(name);
    to.items.push_back(std::move(value));
  };
  ConfigNode tolerance = ConfigNode::table();
  for (const ScoreWish& wish : settings.wishes) {
    add(tolerance,
        wish.score,
        wish.is_relative
            ? ConfigNode::from_text(fmt::format("{:.12g} %", wish.tolerance / kHundredth))
            : ConfigNode::from_number(wish.tolerance));
  }
  add(table, "tolerance", settings.is_auto ? ConfigNode::from_text("auto") : std::move(tolerance));
  add(table, "confidence", ConfigNode::from_number(settings.confidence));
  ConfigNode keep = ConfigNode::array();
  for (const std::string& name : names_of(kept_keys(root))) {
    keep.items.push_back(ConfigNode::from_text(name));
  }
  add(table, "keep", std::move(keep));
  return table;
}

std::vector<KeyRow> accuracy_keys() {
  std::vector<KeyRow> rows;
  rows.push_back({.path = "accuracy.tolerance",
                  .kind = "tolerance",
                  .allowed = fmt::format(R"("auto" or {{ "score" = {} }})", kAllowedTolerance),
                  .default_text = "none",
                  .doc = "how wrong scores may be in a search: the program takes the cheapest way "
                         "to render that keeps it; \"auto\": the cheapest that ranks designs "
                         "rightly; without the table as [render] says"});
  AccuracySettings settings;
  KeyLister lister(kTable, rows);
  visit_confidence(lister, settings);
  rows.push_back({.path = "accuracy.keep",
                  .kind = "texts",
                  .allowed = fmt::format("of \"{}\"", fmt::join(keepable(), "\", \"")),
                  .default_text = "those that the file gives",
                  .doc = "keys of [render] that stay as they are; render.paths.samples is then the "
                         "most that a search takes; camera.width_px: no half resolution; "
                         "render.paths.max_reflections: no fewer reflections"});
  return rows;
}

KeptKeys kept_keys(const ConfigNode& root) {
  std::vector<Problem> ignored;
  const ConfigNode* table = root.find(kTable);
  const auto keys = read_keep(table != nullptr ? table->find("keep") : nullptr, ignored);
  if (!keys) {
    return keys_in_file(root);
  }
  const auto has = [&](const std::string& key) {
    return std::ranges::find(*keys, key) != keys->end();
  };
  return {.method = has(ladder_keys()[0]),
          .rays_per_axis = has(ladder_keys()[1]),
          .max_direction_error = has(ladder_keys()[2]),
          .samples = has(ladder_keys()[3]),
          .resolution = has(kResolution),
          .reflections = has(kReflections)};
}

std::string wish_text(const ScoreWish& wish) {
  if (wish.is_relative) {
    return fmt::format("{:g} % of {}", wish.tolerance / kHundredth, wish.score);
  }
  return wish.score.starts_with("homogeneity.h_")
             ? fmt::format("{:g} points of {} ({:g})",
                           wish.tolerance / kHundredth,
                           wish.score,
                           wish.tolerance)
             : fmt::format("{:g} of {}", wish.tolerance, wish.score);
}

}  // namespace glint
