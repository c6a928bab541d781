// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "core/error.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

using FilePointer = std::unique_ptr<std::FILE, FileCloser>;

/// A descriptor that is closed.
class Descriptor {
 public:
  Descriptor(const fs::path& path, int flags)
      : number_(::open(path.c_str(), flags | O_CLOEXEC, 0644)) {}

  ~Descriptor() {
    const int reason = errno;  // of what failed before
    if (number_ >= 0) {
      ::close(number_);
    }
    errno = reason;
  }

  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  bool is_open() const { return number_ >= 0; }

  /// @return whether all bytes were taken
  bool write(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t count = ::write(number_, bytes.data(), bytes.size());
      if (count < 0 && errno != EINTR) {
        return false;
      }
      bytes.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(0, count)));
    }
    return true;
  }

  /// What has no disk below it (pipes, some network folders) says EINVAL: there is nothing to do.
  bool sync() const { return ::fsync(number_) == 0 || errno == EINVAL; }

 private:
  int number_;
};

[[noreturn]] void throw_unwritable(const fs::path& path) {
  throw IoError(fmt::format("{}: cannot be written: {}", path.string(), last_system_error()));
}

/// Writes into the file itself. @return whether its bytes are on the disk; else errno tells why not
bool is_put_on_disk(const fs::path& path, std::string_view bytes) {
  const Descriptor file(path, O_WRONLY | O_CREAT | O_TRUNC);
  return file.is_open() && file.write(bytes) && file.sync();
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// Devices and pipes (/dev/stdout, /dev/full) are written in place: a rename would replace them.
bool is_device(const fs::path& path) {
  std::error_code ignored;
  return fs::is_other(fs::status(path, ignored));
}

/// Why a folder cannot be made: a link in its path that leads to nothing, the system's reason, or a
/// file.
std::string obstacle(const fs::path& path, const std::error_code& reason) {
  std::error_code ignored;
  for (fs::path each = path; each.has_relative_path(); each = each.parent_path()) {
    if (fs::is_symlink(each, ignored) && !is_there(each)) {
      return each == path ? "a link of that name leads to nothing"
                          : fmt::format("the link {} leads to nothing", each.string());
    }
  }
  return reason ? reason.message() : "a file of that name is in the way";
}

}  // namespace

AtomicFile::AtomicFile(fs::path path) : path_(std::move(path)) {
  if (is_device(path_)) {
    temporary_ = path_;
    return;
  }
  temporary_ =
      path_.parent_path() /
      fmt::format(".{}.{}.part{}", path_.stem().string(), ::getpid(), path_.extension().string());
}

AtomicFile::~AtomicFile() {
  if (!committed_ && temporary_ != path_) {
    std::error_code ignored;
    fs::remove(temporary_, ignored);
  }
}

void AtomicFile::commit() {
  if (temporary_ == path_) {
    committed_ = true;
    return;
  }
  std::error_code error;
  fs::rename(temporary_, path_, error);
  if (error) {
    throw IoError(fmt::format("{}: cannot be written: {}", path_.string(), error.message()));
  }
  committed_ = true;
}

void write_file(const fs::path& path, std::string_view bytes) {
  AtomicFile output(path);
  const FilePointer file(std::fopen(output.temporary_path().c_str(), "wb"));
  if (!file) {
    throw IoError(fmt::format("{}: cannot be written: {}", path.string(), last_system_error()));
  }
  const bool is_written = std::fwrite(bytes.data(), 1, bytes.size(), file.get()) == bytes.size() &&
                          std::fflush(file.get()) == 0;
  if (!is_written) {
    throw IoError(fmt::format("{}: cannot be written: {}", path.string(), last_system_error()));
  }
  output.commit();
}

void write_synced(const fs::path& path, std::string_view bytes) {
  if (!is_put_on_disk(path, bytes)) {
    throw_unwritable(path);
  }
}

void sync_folder(const fs::path& folder) {
  const Descriptor list(folder, O_RDONLY | O_DIRECTORY);
  if (!list.is_open() || !list.sync()) {
    throw_unwritable(folder);
  }
}

void rename_durably(const fs::path& from, const fs::path& to) {
  if (std::rename(from.c_str(), to.c_str()) != 0) {
    throw_unwritable(to);
  }
  sync_folder(folder_of(to));
}

void write_file_durably(const fs::path& path, std::string_view bytes) {
  if (is_device(path)) {
    write_file(path, bytes);
    return;
  }
  AtomicFile output(path);
  if (!is_put_on_disk(output.temporary_path(), bytes)) {
    throw_unwritable(path);  // by the name that was asked for
  }
  output.commit();
  sync_folder(folder_of(path));
}

void make_folder_durably(const fs::path& path) {
  std::vector<fs::path> new_ones;
  for (fs::path folder = path; !folder.empty() && !is_there(folder);
       folder = folder.parent_path()) {
    new_ones.push_back(folder);
  }
  make_folder(path);
  std::ranges::for_each(new_ones, [](const fs::path& made) { sync_folder(folder_of(made)); });
}

std::string read_file(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) {
    throw IoError(fmt::format("{}: cannot be read: it is a folder", path.string()));
  }
  const FilePointer file(std::fopen(path.c_str(), "rb"));
  if (!file) {
    throw IoError(fmt::format("{}: cannot be read: {}", path.string(), last_system_error()));
  }
  std::string bytes;
  std::vector<char> buffer(1 << 16);
  for (;;) {
    const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), file.get());
    bytes.append(buffer.data(), count);
    if (count < buffer.size()) {
      break;
    }
  }
  if (std::ferror(file.get()) != 0) {
    throw IoError(fmt::format("{}: cannot be read: {}", path.string(), last_system_error()));
  }
  return bytes;
}

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

void make_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error || !fs::is_directory(path, error)) {
    throw IoError(
        fmt::format("{}: the folder cannot be made: {}", path.string(), obstacle(path, error)));
  }
}

}  // namespace glint
