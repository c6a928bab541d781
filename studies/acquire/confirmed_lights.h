// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which lights a person has set by hand, as the command line names them: "ring=on", "ring=off", or
// "ring" alone, which stands for the first state that is needed of it. For any other state somebody
// has to be asked.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hardware/acquisition/acquisition.h"
#include "studies/cell/cell_file.h"

namespace glint {

/// Lasts over all acquisitions of one command: the designs of a validation, the rounds of a
/// calibration.
class ConfirmedLights {
 public:
  /// @param names  of manual lights that are as they should be when each is first needed
  explicit ConfirmedLights(const std::vector<std::string>& names = {});

  /// Whether nobody has to be asked: the light is named, and no other state was needed of it last.
  bool is_set(const std::string& light, bool is_on) const;

  /// The light is so from now on, by is_set() or because a person has just said so.
  void note(const std::string& light, bool is_on);

 private:
  std::map<std::string, std::optional<bool>> named_;  ///< by name; empty: not told, nor needed yet
};

/// @param names  of the command line
/// @throws ConfigError for one that is no manual light of the cell
void check_confirmed(const std::vector<std::string>& names, const Cell& cell);

/// Manual lights that a person has to set, and what is to be done.
struct LightWish {
  std::vector<std::string> lights;
  std::vector<std::string> confirm;  ///< what the command line then says of each
  std::string text;
};

/// What has to be set before the pictures of a view are taken; none: nothing.
std::optional<LightWish> light_wish(const ConfirmedLights& confirmed,
                                    const Cell& cell,
                                    const ViewTask& task);

}  // namespace glint
