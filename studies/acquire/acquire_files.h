// SPDX-License-Identifier: GPL-3.0-or-later
//
// The folder of an acquisition while it is made: pictures into the journal, means of whole views,
// acquired.json and poses.csv.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "hardware/acquisition/acquisition.h"
#include "studies/acquire/acquire_plan.h"
#include "studies/acquire/journal.h"

namespace glint {

class AcquireFiles {
 public:
  /// @param journal, work  outlive this
  AcquireFiles(std::filesystem::path folder,
               AcquireJournal& journal,
               const AcquireWork& work,
               const Cell& cell);

  /// The plan without what the folder has already.
  AcquisitionPlan open_work() const;

  /// Keeps a picture, and its view's mean when it was the last one that was missing.
  /// @throws IoError
  void keep(const TakenPicture& picture);

  /// Means of views that are whole and have none yet.
  void write_means();

  /// Accepted pictures that are there, and all that there should be.
  int num_accepted() const;
  int num_wanted() const;

  /// acquired.json and poses.csv. @param head  everything but the pictures
  /// @return what acquired.json holds
  nlohmann::ordered_json write(nlohmann::ordered_json head) const;

 private:
  std::filesystem::path mean_file(const ViewTask& task) const;
  AcquiredPicture described(const TakenPicture& picture) const;
  std::vector<const AcquiredPicture*> accepted_of(const std::string& view) const;
  std::vector<AcquiredPicture> sorted_pictures() const;

  std::filesystem::path folder_;
  AcquireJournal& journal_;
  const AcquireWork& work_;
  Eigen::Isometry3d tcp_from_flange_;
  PoseSigma sigma_;
  std::optional<double> gain_db_;
  std::optional<StageWay> way_;  ///< of a linear stage
};

}  // namespace glint
