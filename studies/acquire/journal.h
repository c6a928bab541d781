// SPDX-License-Identifier: GPL-3.0-or-later
//
// What has been taken, so that a run which was killed goes on where it ended: one SQLite file
// beside the pictures. A picture comes into being in this order, each step on the disk before the
// next:
//
//   its bytes under a hidden name -> its row, with their SHA-256 and the pose -> its own name
//
// Of a run that ended in between, a file without a row is removed, and a row whose bytes are there
// under the hidden name gives them their own. A row whose bytes are nowhere is taken away: that
// picture is taken again. So no picture is missing, doubled, or beside the pose of another one.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "studies/acquire/acquired.h"
#include "studies/acquire/picture_grounds.h"

namespace glint {

/// The pictures that a folder has whole: with a row, and bytes of its SHA-256. Changes nothing.
/// @return  none without a journal, or where it cannot be read
/// @throws ConfigError when the folder holds pictures of another plan or other grounds
std::vector<AcquiredPicture> whole_pictures(const std::filesystem::path& folder,
                                            const std::string& plan_digest,
                                            const PictureGrounds& grounds = {});

/// The digest that a folder's pictures were taken under; empty: it has none, or cannot be read.
std::string recorded_digest(const std::filesystem::path& folder);

/// Whether a folder's pictures are of these grounds; also where it has none, or recorded none.
/// @throws ConfigError that names what differs
void check_recorded_grounds(const std::filesystem::path& folder, const PictureGrounds& grounds);

/// How many sessions a folder has seen, with pictures or without; 0: none, or it cannot be read.
int recorded_sessions(const std::filesystem::path& folder);

class AcquireJournal {
 public:
  /// Opens or makes DIR/journal.sqlite, begins a session and repairs what the last one left.
  /// @param plan_digest    of everything that decides what is taken from where
  /// @param former_digest  under which pictures in the folder count as those of this plan, too:
  ///                       from now on they are recorded under plan_digest; empty: none
  /// @param grounds        picture_grounds(); a folder of an earlier program, which knew none,
  /// takes
  ///                       them over
  /// @throws ConfigError when the folder holds pictures of another plan or other grounds, IoError
  AcquireJournal(std::filesystem::path folder,
                 const std::string& plan_digest,
                 const std::string& former_digest = "",
                 const PictureGrounds& grounds = {});
  ~AcquireJournal();
  AcquireJournal(const AcquireJournal&) = delete;
  AcquireJournal& operator=(const AcquireJournal&) = delete;

  /// In the order in which they were taken.
  const std::vector<AcquiredPicture>& pictures() const { return pictures_; }

  /// How many pictures earlier sessions have left.
  int num_resumed() const { return num_resumed_; }

  /// Keeps a picture. @param bytes  of its file; `picture.file` tells its name, the digest is added
  /// @throws IoError: then it is as if the picture had never been taken
  void keep(AcquiredPicture picture, const std::string& bytes);

  /// The number for the next rejected picture whose file is called `stem`, number, ".png": one more
  /// than the largest that is there, as the files of earlier ones may be gone.
  int next_try(const std::string& stem) const;

  /// The session ends as it should.
  void end_session();

 private:
  struct Rows;

  void repair();
  bool find_bytes(const AcquiredPicture& picture) const;
  void remove_strangers(const std::filesystem::path& below) const;

  std::filesystem::path folder_;
  std::unique_ptr<Rows> rows_;
  std::vector<AcquiredPicture> pictures_;
  int num_resumed_ = 0;
};

}  // namespace glint
