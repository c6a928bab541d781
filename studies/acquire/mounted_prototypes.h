// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which prototype of which light is in the cell. A cell has one light of each name: designs that
// want it built differently need different prototypes, which hands exchange. Outputs switch which
// lights shine and how brightly, the stage moves the stripes: that needs nobody.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "studies/definition/scene.h"

namespace glint {

/// How each light of a scene that shines is built: its table without its powers, by its name.
std::map<std::string, std::string> built_lights(const SceneSettings& scene);

class MountedPrototypes {
 public:
  struct Design {
    std::string name;
    std::map<std::string, std::string> lights;  ///< built_lights()
  };

  /// Nothing is known of what is mounted but what a person says.
  /// @param designs  that are to be told apart
  /// @param mounted  names of designs whose prototypes are in the cell
  /// @throws ConfigError for a name that is no design's, or two that cannot be mounted together
  MountedPrototypes(std::vector<Design> designs, const std::vector<std::string>& mounted);

  /// Those of the run that the scene of a design lies in: RUN/NAME/scene.toml, or its folder. Of
  /// any other file no design is known, and nothing is exchanged.
  static MountedPrototypes beside(const std::filesystem::path& scene,
                                  const std::vector<std::string>& mounted);

  /// The name of the design whose scene, or folder, this is.
  static std::string design_in(const std::filesystem::path& scene);

  /// What a person has to do before pictures of a design are taken; none: its lights are mounted,
  /// or no design has them built differently.
  std::optional<std::string> wish(const std::string& design) const;

  /// A person has said that the prototypes of a design are in the cell now.
  void mount(const std::string& design);

 private:
  const Design& design_of(const std::string& name) const;
  bool is_exchanged(const std::string& light) const;

  std::vector<Design> designs_;
  std::map<std::string, std::string> mounted_;  ///< lights that are known to be in the cell
};

}  // namespace glint
