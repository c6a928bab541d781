// SPDX-License-Identifier: GPL-3.0-or-later
//
// What earlier calls have left of the placements of a part: which one a person has put down last,
// and where those that were photographed were found. Private to the room.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

namespace glint::calibrate_cell_detail {

class PlacementRecord {
 public:
  /// @param folder  DIR/part, see place_part_run.h
  explicit PlacementRecord(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// DIR/part/NAME_NUMBER and an ending
  std::filesystem::path numbered(const std::string& name,
                                 int number,
                                 const std::string& ending = "") const;

  /// Whether nobody has to put the part down: its pictures have been taken, or it is the placement
  /// that a person has put down last. Not where its folder of pictures has been removed since.
  /// @throws ConfigError where some of its pictures have been taken, and the part was put down for
  ///         another placement since: they cannot be completed
  bool is_put_down(int number) const;

  /// A person has just put the part down. What was found before is of another place.
  void put_down(int number) const;

  /// What keep_found() was told of the same scene and the same accepted pictures; none: nothing.
  std::optional<nlohmann::ordered_json> found(int number, const std::string& scene) const;

  /// @param scene  as it is written
  /// @param told   where the part lies, by the pictures that are there
  void keep_found(int number, const std::string& scene, const nlohmann::ordered_json& told) const;

 private:
  std::filesystem::path file_of_found(int number) const;
  int last_put_down() const;
  nlohmann::ordered_json digests(int number) const;

  std::filesystem::path folder_;
};

}  // namespace glint::calibrate_cell_detail
