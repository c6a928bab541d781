// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/picture_store.h"

#include <algorithm>
#include <utility>

namespace glint {
namespace {

/// How many pictures this thread is making.
thread_local int t_rendering = 0;

/// Counts while it lives, and calls a function at its end.
class Making {
 public:
  explicit Making(std::function<void()> at_end) : at_end_(std::move(at_end)) { ++t_rendering; }

  ~Making() {
    --t_rendering;
    at_end_();
  }

  Making(const Making&) = delete;
  Making& operator=(const Making&) = delete;

 private:
  std::function<void()> at_end_;
};

}  // namespace

std::shared_ptr<const PathPicture> PictureStore::find_or_wait(const std::string& key) {
  std::unique_lock lock(mutex_);
  while (true) {
    const auto found =
        std::ranges::find_if(pictures_, [&](const Entry& entry) { return entry.key == key; });
    if (found != pictures_.end()) {
      pictures_.splice(pictures_.begin(), pictures_, found);
      return pictures_.front().value;
    }
    if (t_rendering > 0 || !making_.contains(key)) {
      making_.insert(key);
      return nullptr;
    }
    finished_.wait(lock);
  }
}

std::shared_ptr<const PathPicture> PictureStore::get(const std::string& key, const Render& render) {
  if (auto known = find_or_wait(key)) {
    return known;
  }
  const Making making([&] {
    const std::scoped_lock lock(mutex_);
    making_.erase(key);
    finished_.notify_all();
  });
  auto picture = std::make_shared<const PathPicture>(render());
  ++num_rendered_;
  keep(key, picture);
  return picture;
}

void PictureStore::keep(const std::string& key, std::shared_ptr<const PathPicture> picture) {
  constexpr std::size_t kAlwaysKept = 2;  // of one scene, with and without its defects
  const std::scoped_lock lock(mutex_);
  std::erase_if(pictures_, [&](const Entry& entry) { return entry.key == key; });
  pictures_.push_front({key, std::move(picture)});
  std::size_t bytes = 0;
  std::size_t kept = 0;
  for (const Entry& entry : pictures_) {
    bytes += static_cast<std::size_t>(entry.value->bytes());
    if (kept >= kAlwaysKept && bytes > most_bytes_) {
      break;
    }
    ++kept;
  }
  pictures_.resize(kept);
}

std::size_t PictureStore::kept_bytes() const {
  const std::scoped_lock lock(mutex_);
  std::size_t bytes = 0;
  for (const Entry& entry : pictures_) {
    bytes += static_cast<std::size_t>(entry.value->bytes());
  }
  return bytes;
}

}  // namespace glint
