// SPDX-License-Identifier: GPL-3.0-or-later
//
// Keeps the last pictures that were rendered, found again by their keys.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "studies/imaging/path_picture.h"

namespace glint {

/// Safe to use from several threads. Several pictures may be in the making at once; whoever asks
/// for one of them waits for it, without any lock, unless it is itself called by a thread that is
/// rendering (a thread of a pool may turn to other work while it waits): then it renders anew, as
/// two threads that wait for each other's pictures would never end. Equal keys give equal bytes, so
/// that does not change results.
class PictureStore {
 public:
  using Render = std::function<PathPicture()>;

  /// @param most_bytes  what the pictures may take together; the last two are kept in any case
  explicit PictureStore(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  /// The picture of that key, kept or made. What render throws goes on to its caller; others that
  /// wait for the same picture try by themselves.
  std::shared_ptr<const PathPicture> get(const std::string& key, const Render& render);

  std::size_t kept_bytes() const;

  int num_rendered() const { return num_rendered_; }

 private:
  struct Entry {
    std::string key;
    std::shared_ptr<const PathPicture> value;
  };

  /// Empty: to be rendered by the caller.
  std::shared_ptr<const PathPicture> find_or_wait(const std::string& key);
  void keep(const std::string& key, std::shared_ptr<const PathPicture> picture);

  std::size_t most_bytes_;
  mutable std::mutex mutex_;
  std::condition_variable finished_;
  std::list<Entry> pictures_;     ///< most recently used first
  std::set<std::string> making_;  ///< keys
  std::atomic<int> num_rendered_ = 0;
};

}  // namespace glint
