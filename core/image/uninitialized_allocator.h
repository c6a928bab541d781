// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <new>
#include <utility>

namespace glint {

/// Leaves new elements unset: for arrays that are written right after they are made.
template <class T>
struct UninitializedAllocator : std::allocator<T> {
  template <class Other>
  struct rebind {  // NOLINT(readability-identifier-naming): the name that allocators must have
    using other = UninitializedAllocator<Other>;
  };

  void construct(T* place) noexcept { ::new (static_cast<void*>(place)) T; }

  template <class... Arguments>
  void construct(T* place, Arguments&&... arguments) {
    ::new (static_cast<void*>(place)) T(std::forward<Arguments>(arguments)...);
  }
};

}  // namespace glint
