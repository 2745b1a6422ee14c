// Vectors that begin with a cache line, so that registers of 64 bytes are loaded from one line
// each.
#pragma once

#include <new>
#include <vector>

namespace palpate::deformation {

template <class T>
struct CacheLineAllocator {
  static constexpr std::align_val_t kLine{64};
  using value_type = T;

  CacheLineAllocator() = default;
  template <class U>
  explicit CacheLineAllocator(const CacheLineAllocator<U>& /*other*/) {}

  T* allocate(std::size_t count) {
    return static_cast<T*>(::operator new(count * sizeof(T), kLine));
  }
  void deallocate(T* memory, std::size_t /*count*/) { ::operator delete(memory, kLine); }
  bool operator==(const CacheLineAllocator& /*other*/) const { return true; }
};

template <class T>
using AlignedVector = std::vector<T, CacheLineAllocator<T>>;

}  // namespace palpate::deformation
