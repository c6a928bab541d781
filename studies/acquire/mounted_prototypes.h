// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which prototype of which light is in the cell. A cell has one light of each name: designs that
// want it built differently need different prototypes, which hands exchange, and a light that only
// some designs have is mounted for them and taken down for the others. How brightly a light shines
// is set by hand, too. Outputs switch which lights shine, the stage moves the stripes: that needs
// nobody.
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

/// How each light that shines is set: its table with its powers, without the place of its stripes,
/// by its name.
std::map<std::string, std::string> set_lights(const SceneSettings& scene);

class MountedPrototypes {
 public:
  struct Design {
    std::string name;
    std::map<std::string, std::string> lights;        ///< built_lights()
    std::map<std::string, std::string> set = {};      ///< set_lights()
    bool is_read = true;                              ///< else its lights are not known, may be any
    std::string unread = "its scene cannot be read";  ///< why they are not
  };

  /// Nothing is known of what is mounted but what a person says.
  /// @param designs  that are to be told apart
  /// @param mounted  names of designs whose prototypes are in the cell; slashes at their end do not
  ///                 count
  /// @throws ConfigError for a name that is no design's, or two that cannot be mounted together
  MountedPrototypes(std::vector<Design> designs, const std::vector<std::string>& mounted);

  /// Those of the run that a source (source_files.h) belongs to, and of the source itself. A scene
  /// that is no design's scene.toml counts by the lights that it has: where a design has the same,
  /// as that design, else as one more. A source that belongs to no run has no design, and nothing
  /// is exchanged.
  /// @param made_from  the source that it was copied from; empty: it is none's copy
  static MountedPrototypes beside(const std::filesystem::path& source,
                                  const std::vector<std::string>& mounted,
                                  const std::filesystem::path& made_from = {});

  /// Those of a folder of designs, with or without the study of a run.
  static MountedPrototypes in_run(const std::filesystem::path& run,
                                  const std::vector<std::string>& mounted);

  /// The name of the design that a scene, its folder or the source of beside() is: NAME, or
  /// front/NAME; of a scene that is no design's its path from the run on.
  std::string design_in(const std::filesystem::path& scene) const;

  /// What a person has to do before pictures of a design are taken; none: its lights are mounted
  /// and set, no design has them differently, or there is no such design.
  std::optional<std::string> wish(const std::string& design) const;

  /// Which of several designs comes next: the first one that needs nobody, else the first.
  /// @param scenes  or folders of designs, at least one
  std::size_t next_of(const std::vector<std::filesystem::path>& scenes) const;

  /// A person has said that the prototypes of a design are in the cell now, set as it has them, and
  /// no others.
  void mount(const std::string& design);

 private:
  using LightTables = std::map<std::string, std::string>;

  struct Exchange {
    std::vector<std::string> up;
    std::vector<std::string> set;
    std::vector<std::string> down;
  };

  const Design* find(const std::string& name) const;
  const Design& named(const std::string& mounted) const;
  LightTables wanted(const Design& design) const;
  Exchange exchange_for(const Design& design) const;
  bool is_exchanged(const std::string& light) const;
  bool is_set_by_hand(const std::string& light) const;
  void take_named(const std::string& name);

  std::filesystem::path run_;  ///< empty: none
  std::vector<Design> designs_;
  std::filesystem::path source_;  ///< of beside(), where its own folder does not tell its design
  std::string source_name_;       ///< what it is then
  LightTables mounted_;           ///< lights whose state is known; "": taken down
  LightTables set_;               ///< how those that are known are set
  std::string last_;              ///< design that was mounted last
};

}  // namespace glint
