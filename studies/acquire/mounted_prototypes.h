// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which prototype of which light is in the cell. A cell has one light of each name: designs that
// want it built differently need different prototypes, which hands exchange, and a light that only
// some designs have is mounted for them and taken down for the others. Outputs switch which lights
// shine and how brightly, the stage moves the stripes: that needs nobody.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "studies/definition/scene.h"

namespace glint {

/// How each light of a scene is built, whether it shines or not: its table without its powers and
/// the place of its stripes, by its name.
std::map<std::string, std::string> built_lights(const SceneSettings& scene);

class MountedPrototypes {
 public:
  struct Design {
    std::string name;
    std::map<std::string, std::string> lights;  ///< built_lights()
    bool is_read = true;                        ///< else its lights are not known, and may be any
  };

  /// Nothing is known of what is mounted but what a person says.
  /// @param designs  that are to be told apart
  /// @param mounted  names of designs whose prototypes are in the cell; slashes at their end do not
  ///                 count
  /// @throws ConfigError for a name that is no design's, or two that cannot be mounted together
  MountedPrototypes(std::vector<Design> designs, const std::vector<std::string>& mounted);

  /// Those of the run that a scene, or its folder, lies in: RUN/NAME/scene.toml,
  /// RUN/front/NAME/scene.toml. Of a scene outside a run no design is known, and nothing is
  /// exchanged.
  static MountedPrototypes beside(const std::filesystem::path& scene,
                                  const std::vector<std::string>& mounted);

  /// Those of a folder of designs, with or without the study of a run.
  static MountedPrototypes in_run(const std::filesystem::path& run,
                                  const std::vector<std::string>& mounted);

  /// The name of the design whose scene, or folder, this is: NAME, or front/NAME.
  std::string design_in(const std::filesystem::path& scene) const;

  /// What a person has to do before pictures of a design are taken; none: its lights are mounted,
  /// no design has them built differently, or there is no such design.
  std::optional<std::string> wish(const std::string& design) const;

  /// Which of several designs comes next: the first one that needs nobody, else the first.
  /// @param scenes  or folders of designs, at least one
  std::size_t next_of(const std::vector<std::filesystem::path>& scenes) const;

  /// A person has said that the prototypes of a design are in the cell now, and no others.
  void mount(const std::string& design);

 private:
  struct Exchange {
    std::vector<std::string> up;
    std::vector<std::string> down;
  };

  const Design* find(const std::string& name) const;
  const Design& named(const std::string& mounted) const;
  std::map<std::string, std::string> wanted(const Design& design) const;
  Exchange exchange_for(const Design& design) const;
  bool is_exchanged(const std::string& light) const;

  std::filesystem::path run_;  ///< empty: none
  std::vector<Design> designs_;
  std::map<std::string, std::string> mounted_;  ///< lights whose state is known; "": taken down
  std::string last_;                            ///< design that was mounted last
};

}  // namespace glint
