// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is validated: designs of a run that have real pictures.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "studies/definition/study.h"
#include "studies/imaging/scene_store.h"
#include "studies/validate/real_pictures.h"

namespace glint {

struct ValidatedDesign {
  std::string name;
  SceneSettings nominal;  ///< as the run has it, exposed as the pictures are
  SceneSettings scene;    ///< with the calibrated camera
  RealDesign real;
  std::vector<Viewpoint> nominal_views;  ///< of each picture, without the calibration
  std::vector<Viewpoint> views;          ///< with it
};

/// A design that was to be validated and has no picture that could be.
struct LeftOutDesign {
  std::string name;
  std::string reason;
};

struct ValidationSources {
  std::vector<ValidatedDesign> designs;  ///< at least one; the winner, if there is one, first
  std::optional<Study> study;            ///< of the run; empty: its file is not there
  std::vector<std::string> run_designs;  ///< all folders of designs in the run
  /// "front/NAME" of all designs of the front of several objectives.
  std::vector<std::string> front_designs = {};
  std::vector<LeftOutDesign> left_out = {};  ///< the notes tell of them, too
  bool is_calibrated = false;                ///< a calibration beside the designs' own was taken
  std::vector<std::string> notes;
};

/// In the results: the first design without the calibration.
inline constexpr const char* kBeforeFolder = "before";

/// All designs that the run has written: its folders of designs, and those of its front.
std::vector<std::string> written_designs(const ValidationSources& sources);

/// out/<name of the run>/validate
std::filesystem::path default_validate_folder(const std::filesystem::path& run);

/// Files and folders directly in a folder of results of these designs.
std::vector<std::string> validation_files(const std::vector<std::string>& designs);

/// What an earlier validation has written into its folder beside validation_files(), as its
/// result.json tells: files and folders, relative to it. None where it is no validation's.
std::vector<std::filesystem::path> earlier_validation(const std::filesystem::path& out);

/// To be asked before pictures are taken for it.
/// @throws ConfigError where that folder holds the validation of another run or by other pictures
void check_default_validate_folder(const std::filesystem::path& run,
                                   const std::filesystem::path& pictures);

/// What would end the validation when all pictures are taken, told before a robot takes them.
/// @param out          of the results; empty: default_validate_folder()
/// @param calibration  empty: none
/// @param designs      that have their scenes in the run
/// @throws ConfigError where the results cannot be written, or the calibration is none, or one of
///         pictures of another size; IoError
void check_before_pictures(const std::filesystem::path& run,
                           const std::filesystem::path& out,
                           const std::filesystem::path& calibration,
                           const std::vector<std::string>& designs);

/// Names with commas between them.
std::vector<std::string> names_in(const std::string& list);

/// @param run          folder of `glint run`, or of a single design
/// @param pictures     holds a folder for each design
/// @param designs      names with commas between them; empty: as [validate] says, or winner and
///                     prototypes that have pictures
/// @param calibration  calibration.toml; empty: what acquired.json names, if anything
/// @throws ConfigError, IoError
ValidationSources find_validated(const std::filesystem::path& run,
                                 const std::filesystem::path& pictures,
                                 const std::string& designs,
                                 const std::filesystem::path& calibration,
                                 SceneStore& store);

}  // namespace glint
