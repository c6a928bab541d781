// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/direct/hidden_lights.h"

#include <string>

#include "core/error.h"
#include "simulator/render/direct/hideable_emitters.h"

namespace glint {

void check_lights_unhidden(const PhysicalScene& scene) {
  Eigen::AlignedBox3d box_mm;
  for (const Eigen::Vector3d& vertex_mm : scene.part.mesh.vertices_mm) {
    box_mm.extend(vertex_mm);
  }
  const Lights& lights = scene.lights;
  const std::vector<std::uint8_t> is_hideable = hideable_emitters(lights, box_mm);
  for (std::size_t i = 0; i < is_hideable.size(); ++i) {
    if (is_hideable[i] != 0) {
      // A group of a light with separate segments is called "<name>.<segment>".
      const std::string& group =
          lights.groups[static_cast<std::size_t>(lights.emitters[i].group)].name;
      throw ConfigError("lighting." + group.substr(0, group.find('.')),
                        "may be hidden from the part by another lamp, which render.method = "
                        "\"direct\" does not model; allowed are lamps that do not stand in each "
                        "other's way, or render.method = \"paths\"");
    }
  }
}

}  // namespace glint
