// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/file.h"

#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "core/error.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

using FilePointer = std::unique_ptr<std::FILE, FileCloser>;

/// Devices and pipes (/dev/stdout, /dev/full) are written in place: a rename would replace them.
bool is_device(const fs::path& path) {
  std::error_code ignored;
  return fs::is_other(fs::status(path, ignored));
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
  if (error || !fs::is_directory(path)) {
    throw IoError(fmt::format("{}: the folder cannot be made: {}",
                              path.string(),
                              error ? error.message() : "a file of that name is in the way"));
  }
}

}  // namespace glint
