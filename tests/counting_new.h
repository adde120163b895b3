#pragma once

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <new>

/// Replaces the global operator new of a test executable by one that counts. Include it in one file per executable.
namespace hydroscope {

inline std::atomic<std::int64_t> heap_allocations{0};

/// Allocations since its construction.
class AllocationCount {
 public:
  std::int64_t value() const { return heap_allocations - start_; }

 private:
  std::int64_t start_ = heap_allocations;
};

inline void* CountedAllocation(std::size_t size, std::size_t alignment) {
  ++heap_allocations;
  const std::size_t whole = (size + alignment) / alignment * alignment;
  void* memory =
      alignment > alignof(std::max_align_t) ? std::aligned_alloc(alignment, whole) : std::malloc(whole);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace hydroscope

[[gnu::noinline]] void* operator new(std::size_t size) {
  return hydroscope::CountedAllocation(size, alignof(std::max_align_t));
}
[[gnu::noinline]] void* operator new[](std::size_t size) {
  return hydroscope::CountedAllocation(size, alignof(std::max_align_t));
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  return hydroscope::CountedAllocation(size, static_cast<std::size_t>(alignment));
}
[[gnu::noinline]] void* operator new[](std::size_t size, std::align_val_t alignment) {
  return hydroscope::CountedAllocation(size, static_cast<std::size_t>(alignment));
}
// Sorting takes its buffer by these.
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++hydroscope::heap_allocations;
  return std::malloc(size);
}
[[gnu::noinline]] void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  ++hydroscope::heap_allocations;
  return std::malloc(size);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete[](void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}
