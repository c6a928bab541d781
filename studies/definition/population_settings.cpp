// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/population_settings.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/text.h"

namespace glint {
namespace {

using Kind = ConfigNode::Kind;

constexpr int kMaxParts = 1000000;

const std::array<PodSize, 4>& pod_sizes() {
  static const std::array<PodSize, 4> sizes = {{
      {.key = "height_um",
       .what = "depth",
       .unit = "um",
       .unit_mm = 1e-3,
       .range_mm = {},
       .member = &DefectGroup::height_mm},
      {.key = "diameter_mm",
       .what = "diameter",
       .unit = "mm",
       .range_mm = {},
       .member = &DefectGroup::diameter_mm},
      {.key = "length_mm",
       .what = "length",
       .unit = "mm",
       .range_mm = {},
       .member = &DefectGroup::length_mm},
      {.key = "width_mm",
       .what = "width",
       .unit = "mm",
       .range_mm = {},
       .member = &DefectGroup::width_mm},
  }};
  return sizes;
}

std::array<Interval, 4> pod_ranges(const PodSettings& settings) {
  return {settings.height_mm, settings.diameter_mm, settings.length_mm, settings.width_mm};
}

void visit_counts(KeyVisitor& keys, SortingSettings& settings) {
  keys.integer("parts",
               settings.parts,
               Range::between(4, kMaxParts),
               "simulated parts at the study's own lighting; limits are learned from those with "
               "even numbers and tested on the others");
  keys.integer("flawless",
               settings.flawless,
               Range::between(1, kMaxParts),
               "scans of the flawless part that certify the false alarms");
  keys.integer("prototype_parts",
               settings.prototype_parts,
               Range::between(4, kMaxParts),
               "parts for each prototype: the first ones of the study's own");
  keys.integer("prototype_flawless",
               settings.prototype_flawless,
               Range::between(1, kMaxParts),
               "flawless scans for each prototype");
  keys.integer("imprinted_every",
               settings.imprinted_every,
               Range::between(0, kMaxParts),
               "every so many-th part has its defects imprinted into the mesh; 0: none");
}

void visit_source(KeyVisitor& keys, PartSource& source) {
  keys.number("share",
              source.share,
              Range::positive(),
              "of the parts that come from there, in proportion to the other sources");
}

/// The names of a source's groups, which must be groups of the scene.
void read_groups(KeyReader& reader,
                 const std::vector<NamedGroup>& defects,
                 std::vector<std::string>& groups) {
  const ConfigNode* list = reader.take("groups");
  if (list == nullptr) {
    reader.error(nullptr, "groups", "is missing; must be a list of groups like [\"dent\"] or []");
    return;
  }
  std::vector<std::string> known;
  for (const auto& [name, group] : defects) {
    known.push_back(name);
  }
  if (!list->is_array()) {
    reader.error(list, "groups", "must be a list of groups like [\"dent\"] or []");
    return;
  }
  for (const ConfigNode& item : list->items) {
    if (item.kind != Kind::kText || std::ranges::find(known, item.text) == known.end()) {
      reader.error(&item,
                   "groups",
                   fmt::format("{} is no group of [defects]; there are {}",
                               value_to_toml(item),
                               known.empty() ? "none" : join(known, ", ")));
    } else if (std::ranges::find(groups, item.text) != groups.end()) {
      reader.error(&item, "groups", fmt::format("\"{}\" is listed twice", item.text));
    } else {
      groups.push_back(item.text);
    }
  }
}

void read_sources(const ConfigNode* table,
                  const std::vector<NamedGroup>& defects,
                  std::vector<PartSource>& sources,
                  std::vector<Problem>& errors) {
  if (table == nullptr) {
    return;
  }
  if (!table->is_table()) {
    errors.push_back({.kind = Problem::Kind::kWrongType,
                      .place = table->place,
                      .key = "sorting.sources",
                      .text = "must hold tables, like [sorting.sources.press]"});
    return;
  }
  for (std::size_t i = 0; i < table->names.size(); ++i) {
    PartSource source{.name = table->names[i], .groups = {}};
    KeyReader reader(&table->items[i], "sorting.sources." + source.name, errors);
    visit_source(reader, source);
    if (table->items[i].is_table()) {
      read_groups(reader, defects, source.groups);
    }
    reader.report_unknown();
    sources.push_back(std::move(source));
  }
}

void visit_expert(KeyVisitor& keys, SortingSettings& settings) {
  keys.table(
      "expert",
      [&](KeyVisitor& table) { visit_keys(table, settings.expert); },
      "how an expert grades a part by its true defects");
}

/// Without the group, which is a name and has its own check.
void visit_pod(KeyVisitor& keys, PodSettings& settings) {
  const Range size = Range::at_least(0);
  keys.interval("height_um", settings.height_mm, size, "range of depths that is run through");
  keys.interval("diameter_mm",
                settings.diameter_mm,
                size,
                "range of diameters that is run through, of round defects");
  keys.interval("length_mm",
                settings.length_mm,
                size,
                "range of lengths that is run through, of scratches and gouges");
  keys.interval("width_mm",
                settings.width_mm,
                size,
                "range of widths that is run through, of scratches and gouges");
  keys.integer("levels",
               settings.levels,
               Range::between(3, 1000),
               "sizes, evenly spaced by ratio, both ends included");
  keys.integer("parts",
               settings.parts,
               Range::between(1, kMaxParts),
               "parts for each size, with as many defects as the group counts");
  keys.integer("flawless",
               settings.flawless,
               Range::between(1, kMaxParts),
               "scans of the flawless part that certify the rate of false alarms");
  keys.integer("prototype_flawless",
               settings.prototype_flawless,
               Range::between(1, kMaxParts),
               "flawless scans for each prototype");
}

constexpr const char* kGroupDoc =
    "the group of [defects] that is searched for; others are left out";

void read_group(KeyReader& reader,
                const std::vector<NamedGroup>& defects,
                PodSettings& settings,
                std::vector<Problem>& errors) {
  reader.text("group", settings.group, kGroupDoc);
  if (settings.group.empty() && defects.size() == 1) {
    settings.group = defects.front().first;
  }
  std::vector<std::string> names;
  for (const auto& [name, group] : defects) {
    names.push_back(name);
  }
  const auto found = std::ranges::find(names, settings.group);
  if (found == names.end()) {
    reader.require(false,
                   "group",
                   fmt::format("\"{}\" is no group of [defects]; there are {}",
                               settings.group,
                               names.empty() ? "none" : join(names, ", ")));
    return;
  }
  if (!errors.empty()) {
    return;
  }
  const DefectGroup& group = defects[static_cast<std::size_t>(found - names.begin())].second;
  const PodSize size = size_of(settings);
  const bool is_of_line = size.key == "length_mm" || size.key == "width_mm";
  const bool is_of_round = size.key == "diameter_mm";
  reader.require(!(is_line(group.type) ? is_of_round : is_of_line),
                 size.key,
                 fmt::format("\"{}\" has no such size; it has height_um and {}",
                             settings.group,
                             is_line(group.type) ? "length_mm, width_mm" : "diameter_mm"));
  reader.require(group.type != DefectType::kStain, "group", "a stain has no size to run through");
}

void check_sizes(KeyReader& reader, const PodSettings& settings) {
  int given = 0;
  const std::array<Interval, 4> ranges = pod_ranges(settings);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const bool is_given = ranges[i].max > 0.0;
    given += is_given ? 1 : 0;
    reader.require(!is_given || (ranges[i].min > 0.0 && ranges[i].min < ranges[i].max),
                   pod_sizes()[i].key,
                   "must be a range [smallest, largest] with 0 < smallest < largest");
  }
  reader.require(
      given == 1,
      given == 0 ? "height_um" : "group",
      "exactly one of height_um, diameter_mm, length_mm, width_mm must be given a range");
}

}  // namespace

void visit_keys(KeyVisitor& keys, ExpertRule& rule) {
  keys.number("noticed_um",
              rule.noticed_mm,
              Range::at_least(0),
              "shallower defects do not count for the expert");
  keys.number("perfect_hole_mm",
              rule.perfect_hole_mm,
              Range::at_least(0),
              "diameter of the widest hole, dent or bump on a perfect part");
  keys.integer("perfect_holes",
               rule.perfect_holes,
               Range::between(0, kMaxParts),
               "how many of them a perfect part may have");
  keys.number("acceptable_hole_mm",
              rule.acceptable_hole_mm,
              Range::at_least(0),
              "diameter of the widest one on an acceptable part; a wider one rejects it");
  keys.integer("acceptable_holes",
               rule.acceptable_holes,
               Range::between(0, kMaxParts),
               "how many an acceptable part may have; more reject it");
  keys.number("perfect_scratch_mm",
              rule.perfect_scratch_mm,
              Range::at_least(0),
              "a longer scratch or gouge rejects the part");
  keys.require(rule.acceptable_hole_mm >= rule.perfect_hole_mm,
               "acceptable_hole_mm",
               "must not be smaller than perfect_hole_mm");
  keys.require(rule.acceptable_holes >= rule.perfect_holes,
               "acceptable_holes",
               "must not be smaller than perfect_holes");
}

PodSize size_of(const PodSettings& settings) {
  const std::array<Interval, 4> ranges = pod_ranges(settings);
  std::size_t at = 0;
  while (at + 1 < ranges.size() && ranges[at].max <= 0.0) {
    ++at;
  }
  PodSize size = pod_sizes()[at];
  size.range_mm = ranges[at];
  return size;
}

std::vector<double> level_sizes_mm(const PodSettings& settings) {
  const Interval range_mm = size_of(settings).range_mm;
  std::vector<double> sizes_mm;
  for (int i = 0; i < settings.levels; ++i) {
    const double share = static_cast<double>(i) / (settings.levels - 1);
    sizes_mm.push_back(range_mm.min * std::pow(range_mm.max / range_mm.min, share));
  }
  return sizes_mm;
}

std::optional<SortingSettings> read_sorting(const ConfigNode& root,
                                            const std::vector<NamedGroup>& defects,
                                            std::vector<Problem>& errors) {
  const ConfigNode* table = root.find("sorting");
  if (table == nullptr) {
    return std::nullopt;
  }
  SortingSettings settings;
  KeyReader reader(table, "sorting", errors);
  visit_counts(reader, settings);
  visit_expert(reader, settings);
  read_sources(reader.take("sources"), defects, settings.sources, errors);
  reader.report_unknown();
  reader.require(!defects.empty(), "parts", "there is no table [defects.<name>] to draw from");
  return settings;
}

std::optional<PodSettings> read_pod(const ConfigNode& root,
                                    const std::vector<NamedGroup>& defects,
                                    std::vector<Problem>& errors) {
  const ConfigNode* table = root.find("pod");
  if (table == nullptr) {
    return std::nullopt;
  }
  PodSettings settings;
  std::vector<Problem> own;
  KeyReader reader(table, "pod", own);
  visit_pod(reader, settings);
  check_sizes(reader, settings);
  read_group(reader, defects, settings, own);
  reader.report_unknown();
  errors.insert(errors.end(), own.begin(), own.end());
  return settings;
}

ConfigNode write_sorting(const SortingSettings& settings) {
  SortingSettings copy = settings;
  ConfigNode table = ConfigNode::table();
  KeyWriter writer(table);
  visit_counts(writer, copy);
  visit_expert(writer, copy);
  if (!settings.sources.empty()) {
    ConfigNode sources = ConfigNode::table();
    for (PartSource source : settings.sources) {
      ConfigNode one = ConfigNode::table();
      KeyWriter source_writer(one);
      visit_source(source_writer, source);
      ConfigNode groups = ConfigNode::array();
      for (const std::string& group : source.groups) {
        groups.items.push_back(ConfigNode::from_text(group));
      }
      one.names.emplace_back("groups");
      one.items.push_back(std::move(groups));
      sources.names.push_back(source.name);
      sources.items.push_back(std::move(one));
    }
    table.names.emplace_back("sources");
    table.items.push_back(std::move(sources));
  }
  return table;
}

ConfigNode write_pod(const PodSettings& settings) {
  PodSettings copy = settings;
  ConfigNode table = ConfigNode::table();
  KeyWriter writer(table);
  writer.text("group", copy.group, kGroupDoc);
  visit_pod(writer, copy);
  return table;
}

std::vector<KeyRow> population_keys() {
  std::vector<KeyRow> rows;
  SortingSettings sorting;
  KeyLister sorting_lister("sorting", rows);
  visit_counts(sorting_lister, sorting);
  visit_expert(sorting_lister, sorting);
  PartSource source;
  KeyLister source_lister("sorting.sources.<name>", rows);
  visit_source(source_lister, source);
  rows.push_back({.path = "sorting.sources.<name>.groups",
                  .kind = "texts",
                  .unit = "",
                  .allowed = "names of groups of [defects]; [] for flawless parts",
                  .default_text = "none",
                  .doc = "the groups of defects that parts from there have; without any source "
                         "every part has all groups"});
  PodSettings pod;
  KeyLister pod_lister("pod", rows);
  pod_lister.text("group", pod.group, kGroupDoc);
  visit_pod(pod_lister, pod);
  return rows;
}

}  // namespace glint
