// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/direct/hidden_lights.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "core/error.h"
#include "simulator/render/direct/hideable_emitters.h"

namespace glint {
namespace {

Eigen::AlignedBox3d box_of(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box_mm;
  for (const Eigen::Vector3d& vertex_mm : mesh.vertices_mm) {
    box_mm.extend(vertex_mm);
  }
  return box_mm;
}

/// A group of a light with separate segments is called "<name>.<segment>".
std::string light_of(const Lights& lights, std::size_t emitter) {
  const auto group = static_cast<std::size_t>(lights.emitters[emitter].group);
  const std::string& name = lights.groups[group].name;
  return name.substr(0, name.find('.'));
}

/// Of the light with the most emitters.
Problem too_many_emitters(const Lights& lights) {
  std::map<std::string, int> counts;
  for (std::size_t i = 0; i < lights.emitters.size(); ++i) {
    ++counts[light_of(lights, i)];
  }
  const auto most =
      std::ranges::max_element(counts, {}, [](const auto& row) { return row.second; });
  return {.key = "lighting." + most->first,
          .text = fmt::format("makes {} luminous pieces (segments, LEDs, triangles), all lamps "
                              "together {}; which of them hide each other is looked at for {} at "
                              "most; allowed are fewer pieces, or render.method = \"paths\"",
                              most->second,
                              lights.emitters.size(),
                              kMaxPartedEmitters)};
}

}  // namespace

std::optional<Problem> hidden_lights_problem(const PhysicalScene& scene) {
  const Lights& lights = scene.lights;
  if (lights.emitters.size() > kMaxPartedEmitters) {
    return too_many_emitters(lights);
  }
  const Eigen::AlignedBox3d box_mm = box_of(scene.part.mesh);
  for (std::size_t i = 0; i < lights.emitters.size(); ++i) {
    if (const std::optional<std::size_t> before = emitter_before(lights, i, box_mm)) {
      const std::string name = light_of(lights, i);
      const std::string other = light_of(lights, *before);
      return Problem{
          .key = "lighting." + name,
          .text = fmt::format("may be hidden from the part by {}, which render.method = \"direct\" "
                              "does not model; allowed are lamps that do not stand in each "
                              "other's way, or render.method = \"paths\"",
                              other == name ? "another part of itself" : "lighting." + other)};
    }
  }
  return std::nullopt;
}

void check_lights_unhidden(const PhysicalScene& scene) {
  if (const std::optional<Problem> problem = hidden_lights_problem(scene)) {
    throw ConfigError(problem->key, problem->text);
  }
}

}  // namespace glint
