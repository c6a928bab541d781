// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace glint {

/// A file that appears only when it is whole: write to temporary_path(), then commit(). Without
/// commit() the temporary file is removed.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// In the same folder and with the same extension as the final path.
  const std::filesystem::path& temporary_path() const { return temporary_; }

  void commit();  ///< @throws IoError when the rename fails

 private:
  std::filesystem::path path_;
  std::filesystem::path temporary_;
  bool committed_ = false;
};

/// Writes all bytes, then renames into place. @throws IoError (unwritable, disk full).
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// The same, and its bytes and its name are on the disk when this returns: for what a record that
/// is written later relies on, also after a power cut. Devices and pipes are only written.
void write_file_durably(const std::filesystem::path& path, std::string_view bytes);

/// Writes into the file itself, and its bytes are on the disk when this returns; its name is after
/// sync_folder(). @throws IoError
void write_synced(const std::filesystem::path& path, std::string_view bytes);

/// The folder's list of names is on the disk when this returns. @throws IoError
void sync_folder(const std::filesystem::path& folder);

/// The new name is on the disk when this returns; both lie in one folder. @throws IoError
void rename_durably(const std::filesystem::path& from, const std::filesystem::path& to);

/// make_folder(), and the names of those that were made are on the disk when this returns.
void make_folder_durably(const std::filesystem::path& path);

/// The whole file. @throws IoError with the system's reason.
std::string read_file(const std::filesystem::path& path);

/// Whether there is such a file or folder; not where that cannot be told.
bool is_there(const std::filesystem::path& path);

/// Creates the folder and its parents. @throws IoError
void make_folder(const std::filesystem::path& path);

}  // namespace glint
