// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a folder's pictures are of and by, beyond their plan: told by names, so that what differs
// can be named.
#pragma once

#include <map>
#include <string>

#include "studies/cell/cell_file.h"
#include "studies/definition/scene.h"

namespace glint {

/// Values by their names: "[part] length_mm" and "48", "[camera.features] BlackLevel" and "0".
using PictureGrounds = std::map<std::string, std::string>;

/// Of a scene's part, its mesh by the SHA-256 of its file; of the camera which one it is, and how
/// it is set but for the exposure, with its named features; of the stage where it stands at each
/// position of the scan, or the SHA-256 of each picture that it shows there.
/// @param scene  null: the part is not known
/// @throws IoError when the mesh or a picture cannot be read
PictureGrounds picture_grounds(const SceneSettings* scene, const Cell& cell);

/// The first name whose values differ, as "[part] length_mm is 40 there, and 48 now"; but for named
/// features only names that both have count, as another program may know more of them. Empty: none
/// differs.
std::string ground_difference(const PictureGrounds& there, const PictureGrounds& now);

}  // namespace glint
