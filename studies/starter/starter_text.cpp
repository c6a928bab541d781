// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/starter/starter_text.h"

#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/config/config.h"
#include "core/shell_word.h"
#include "core/text.h"

namespace glint {
namespace {

/// A key with its value, and perhaps a comment behind it.
struct KeyLine {
  std::string key;
  std::string value;
  std::string comment = {};
};

using KeyLines = std::vector<KeyLine>;

std::string rounded(double value) {
  return fmt::format("{:.4g}", value);
}

std::string in_quotes(const std::string& text) {
  return value_to_toml(ConfigNode::from_text(text));
}

/// A file's name may hold anything: a comment ends with its line.
std::string in_comment(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return (c >= 0 && c < ' ') || c == 0x7f; }, '?');
  return text;
}

std::string block(const std::string& table, const KeyLines& keys) {
  std::string text = fmt::format("\n[{}]\n", table);
  for (const KeyLine& line : keys) {
    const std::string pair = fmt::format("{} = {}", line.key, line.value);
    text += line.comment.empty() ? pair + "\n" : fmt::format("{:<23} # {}\n", pair, line.comment);
  }
  return text;
}

std::string inline_table(const KeyLines& keys) {
  std::vector<std::string> pairs;
  for (const KeyLine& line : keys) {
    pairs.push_back(fmt::format("{} = {}", line.key, line.value));
  }
  return fmt::format("{{ {} }}", join(pairs, ", "));
}

/// Distance of a ring from the camera: nearer to it than to the part.
double ring_height_mm(const StarterSizes& sizes) {
  return 0.45 * sizes.working_distance_mm;
}

double farthest_ring_mm(const StarterSizes& sizes) {
  return std::min(0.75 * sizes.working_distance_mm, 0.9 * sizes.top_mm);
}

/// Beyond the cone of view wherever the ring may stand.
double smallest_ring_mm(const StarterSizes& sizes) {
  return 1.1 * sizes.view_radius_mm * farthest_ring_mm(sizes) / sizes.working_distance_mm;
}

double ring_radius_mm(const StarterSizes& sizes) {
  return std::max(0.2 * sizes.working_distance_mm, 1.2 * smallest_ring_mm(sizes));
}

/// Beyond the cone of view where it passes the top of a dome.
double dome_opening_mm(const StarterSizes& sizes) {
  const double narrowed =
      (sizes.working_distance_mm - sizes.dome_radius_mm) / sizes.working_distance_mm;
  return std::ceil(2.3 * sizes.view_radius_mm * narrowed + 2.0);
}

double bar_place_mm(const StarterSizes& sizes) {
  return std::max(0.55 * sizes.working_distance_mm, 1.2 * sizes.view_radius_mm);
}

KeyLines light_keys(const StarterSizes& s, StarterLight kind) {
  switch (kind) {
    case StarterLight::kRing:
      return {{"mount", "\"camera\"", "moves with the camera"},
              {"inner_radius_mm", rounded(ring_radius_mm(s))},
              {"outer_radius_mm", rounded(1.6 * ring_radius_mm(s))},
              {"height_mm", rounded(ring_height_mm(s)), "in front of the camera"},
              {"tilt_deg", "0"},
              {"radiance", "[2]"}};
    case StarterLight::kDome:
      return {{"mount", "\"camera\""},
              {"position_mm",
               fmt::format("[0, 0, {}]", rounded(s.working_distance_mm)),
               "its centre lies on the part"},
              {"radius_mm", rounded(s.dome_radius_mm)},
              {"opening_mm", rounded(dome_opening_mm(s)), "lets the camera look in"},
              {"radiance", "[2]"}};
    case StarterLight::kBar:
      return {{"mount", "\"camera\""},
              {"position_mm",
               fmt::format("[0, {}, {}]",
                           rounded(-bar_place_mm(s)),
                           rounded(s.working_distance_mm - bar_place_mm(s))),
               "beside the view, 45 degrees above the part"},
              {"direction", "[0, 1, 1]"},
              {"length_mm", rounded(2.4 * s.view_radius_mm)},
              {"width_mm", rounded(0.15 * s.working_distance_mm)},
              {"radiance", "[2]"}};
    default:
      return {{"shape", "\"semicylinder\""},
              {"radius_mm", rounded(s.tunnel_radius_mm)},
              {"slot_mm", rounded(s.slot_mm), "lets the camera look in"},
              {"length_mm", rounded(s.length_mm)},
              {"period_mm", rounded(s.period_mm)},
              {"duty", "0.5"}};
  }
}

std::string light_table(const StarterPlan& plan, StarterLight kind) {
  return block(fmt::format("lighting.{}", light_name(kind)), light_keys(plan.sizes, kind));
}

std::string head(const StarterPlan& plan) {
  const std::string title = is_mirror(plan.light) ? "Fringe tunnel for "
                            : plan.light == StarterLight::kAll
                                ? "Which light shows a dent on "
                                : fmt::format("A {} light for ", light_name(plan.light));
  return fmt::format(
      "# A lighting study for {0}, written by `glint new`.\n"
      "# `glint explain KEY` says what a key means, its unit, range and default.\n"
      "# `glint check {1}` validates this file, `glint run {1}` runs it.\n"
      "schema = 1\n"
      "title = {2}\n",
      in_comment(plan.name),
      in_comment(shell_word(plan.study_file)),
      in_quotes(title + plan.name));
}

std::string part_tables(const StarterPlan& plan) {
  std::string text = fmt::format(
      "\n[part]\n"
      "file = {}\n"
      "unit = \"{}\"        # of the file\n"
      "# crease_deg = 30     # edges sharper than this stay sharp; flatter ones are smoothed\n"
      "rotation_deg = [{}, 0, 0]   # flat faces that look straight at the camera mirror it\n",
      in_quotes(plan.part_file),
      plan.unit,
      shortest(plan.sizes.tilt_deg));
  if (!is_mirror(plan.light)) {
    text += block("material",
                  {{"type", "\"conductor\"", "a mirror would show the lamps themselves"},
                   {"colour_srgb", "[196, 199, 199]", "steel"},
                   {"roughness", "0.3", "blasted or fine ground; polished: 0.05"}});
  }
  return text;
}

std::string camera_tables(const StarterPlan& plan, StarterLight kind) {
  std::string text = fmt::format("\n[camera]\nworking_distance_mm = {}\n",
                                 shortest(plan.sizes.working_distance_mm));
  text += plan.camera_keys.empty()
              ? fmt::format("width_px = {}\nheight_px = {}\nobject_pixel_mm = {:.4g}\n",
                            plan.sizes.width_px,
                            plan.sizes.height_px,
                            plan.sizes.object_pixel_mm)
              : plan.camera_keys;
  KeyLines sensor;
  if (is_mirror(plan.light)) {
    sensor.push_back({"gain", "2.0", "saturation makes defects show in the mean of a scan"});
  } else {
    sensor.push_back({"exposure", rounded(plan.exposure(kind)), "fills the picture"});
    sensor.push_back({"wavelengths_nm", "[630]", "grey, under red light"});
  }
  sensor.push_back({"blur_px", "0.7"});
  sensor.push_back({"bits", "8"});
  sensor.push_back({"full_well_e", "10000", "noise of a common CMOS camera"});
  sensor.push_back({"read_noise_e", "6"});
  return text + block("sensor", sensor);
}

std::string scan_table(StarterLight light) {
  if (light != StarterLight::kTunnel && light != StarterLight::kAll) {
    return "";
  }
  return block("scan",
               {{"positions",
                 is_mirror(light) ? "24" : "8",
                 "pictures; a multiple of 1 / duty keeps the flawless surface even"}});
}

std::string paths_table(StarterLight light) {
  if (is_mirror(light)) {
    return "";
  }
  return block("render.paths",
               {{"samples", "32", "of each pixel; four times as many halve the rendering's noise"},
                {"batches", "4"},
                {"max_reflections", "2"}});
}

/// Nothing before places are known.
/// A coordinate of all places, as the elements of a list.
std::string places_text(const StarterPlan& plan, int axis) {
  std::vector<std::string> texts;
  for (const Eigen::Vector2d& place : plan.places_mm) {
    texts.push_back(fmt::format("{:.3f}", place[axis]));
  }
  return join(texts, ", ");
}

std::string defect_table(const StarterPlan& plan) {
  if (plan.places_mm.empty()) {
    return "";
  }
  std::string text = fmt::format(
      "\n# The smallest defect that must show: a dent of {:g} mrad at its steepest, where the "
      "camera\n# sees it and light reaches it.\n",
      1e3 * plan.slope_rad);
  for (const std::string& remark : plan.remarks) {
    text += "# " + remark + "\n";
  }
  return text + fmt::format(
                    "[defects.dent]\n"
                    "x_mm = [{}]\n"
                    "y_mm = [{}]\n"
                    "height_um = {:.4g}\n"
                    "diameter_mm = {:.4g}\n",
                    places_text(plan, 0),
                    places_text(plan, 1),
                    1e3 * plan.depth_mm(),
                    plan.sizes.diameter_mm);
}

std::string variables_table(const StarterPlan& plan) {
  std::string text = "\n# What the search may change.\n[variables]\n";
  for (const Variable& variable : starter_space(plan).variables) {
    text += fmt::format("\"{}\" = {{ min = {}, max = {}{} }}\n",
                        variable.name,
                        rounded(variable.low),
                        rounded(variable.high),
                        variable.is_log ? ", log = true" : "");
  }
  return text;
}

std::string prototype_tables(const StarterPlan& plan) {
  std::string text = "\n# The study's own light is the ring; these stand beside it.\n";
  for (const StarterLight kind : {StarterLight::kDome, StarterLight::kBar, StarterLight::kTunnel}) {
    const std::string name(light_name(kind));
    std::string title = name;
    title.front() = static_cast<char>(title.front() - 'a' + 'A');
    text += fmt::format(
        "[prototypes.{0}]\n"
        "title = \"{1}\"\n"
        "lighting = {{ {0} = {2} }}\n"
        "\"sensor.exposure\" = {3}\n\n",
        name,
        title,
        inline_table(light_keys(plan.sizes, kind)),
        rounded(plan.exposure(kind)));
  }
  text.pop_back();
  return text;
}

std::string goal_tables(const StarterPlan& plan) {
  std::string text = fmt::format(
      "\n# The worst defect is to stand out as far as it can ...\n"
      "[objective]\n"
      "maximise = \"{}\"\n"
      "\n# ... in a picture that is {}not overexposed.\n"
      "[constraints]\n",
      objective_of(plan.light),
      plan.light == StarterLight::kAll ? "" : "not much less even than at the start, and ");
  if (plan.light != StarterLight::kAll) {
    text += fmt::format("\"homogeneity.h_rms\" = {{ min = {:.2f} }}\n", plan.min_h);
  }
  return text +
         fmt::format("\"homogeneity.clipped_share\" = {{ max = {:.2f} }}\n", plan.max_clipped);
}

std::string search_tables(StarterLight light) {
  return light == StarterLight::kAll ? ""
                                     : "\n[search]\nbatch = 2\n\n[budget]\nevaluations = 200\n";
}

Variable range(const char* name, double low, double high, bool is_log = false) {
  return {.name = name, .low = low, .high = high, .is_log = is_log};
}

void add_light_variables(const StarterPlan& plan, std::vector<Variable>& variables) {
  const StarterSizes& s = plan.sizes;
  const double distance_mm = s.working_distance_mm;
  if (plan.light == StarterLight::kRing) {
    const double radius_mm = ring_radius_mm(s);
    variables = {range("lighting.ring.inner_radius_mm", smallest_ring_mm(s), 1.3 * radius_mm),
                 range("lighting.ring.outer_radius_mm", 1.4 * radius_mm, 2.5 * radius_mm),
                 range("lighting.ring.height_mm", 0.1 * distance_mm, farthest_ring_mm(s)),
                 range("lighting.ring.tilt_deg", -20.0, 60.0)};
  } else if (plan.light == StarterLight::kDome) {
    const double opening_mm = dome_opening_mm(s);
    variables = {range("lighting.dome.height_mm", -0.1 * distance_mm, 0.1 * distance_mm),
                 range("lighting.dome.opening_mm", opening_mm, 3.0 * opening_mm)};
  } else if (plan.light == StarterLight::kBar) {
    const double place_mm = bar_place_mm(s);
    variables = {range("lighting.bar.position_mm.1", -2.0 * place_mm, -0.7 * place_mm),
                 range("lighting.bar.position_mm.2", 0.1 * distance_mm, 0.8 * distance_mm),
                 range("lighting.bar.width_mm", 0.05 * distance_mm, 0.3 * distance_mm)};
  }
  const double exposure = plan.exposure(plan.light);
  variables.push_back(range("sensor.exposure", 0.2 * exposure, 5.0 * exposure, true));
}

void add_tunnel_variables(const StarterSizes& s, std::vector<Variable>& variables) {
  const double largest_mm =
      std::max(s.tunnel_radius_mm, std::min(2.0 * s.tunnel_radius_mm, 0.9 * s.working_distance_mm));
  variables = {
      range("lighting.tunnel.radius_mm", s.tunnel_radius_mm, largest_mm),
      range("lighting.tunnel.base_mm", -0.2 * s.tunnel_radius_mm, 0.1 * s.tunnel_radius_mm),
      range("lighting.tunnel.slot_mm", 0.7 * s.slot_mm, 1.2 * s.slot_mm),
      range("lighting.tunnel.period_mm", 0.25 * s.period_mm, 2.0 * s.period_mm, true),
      range("sensor.gain", 1.2, 3.0)};
}

}  // namespace

SearchSpace starter_space(const StarterPlan& plan) {
  SearchSpace space;
  if (is_mirror(plan.light)) {
    add_tunnel_variables(plan.sizes, space.variables);
  } else if (plan.light != StarterLight::kAll) {
    add_light_variables(plan, space.variables);
  }
  return space;
}

std::string starter_text(const StarterPlan& plan, StarterLight kind) {
  return head(plan) + part_tables(plan) + camera_tables(plan, kind) + scan_table(plan.light) +
         paths_table(plan.light) + light_table(plan, kind) + defect_table(plan);
}

std::string starter_text(const StarterPlan& plan) {
  const bool is_comparison = plan.light == StarterLight::kAll;
  return starter_text(plan, is_comparison ? StarterLight::kRing : plan.light) +
         (is_comparison ? prototype_tables(plan) : variables_table(plan)) + goal_tables(plan) +
         search_tables(plan.light);
}

}  // namespace glint
