#pragma once
// A block of values that is handed to code of an image in this process. Before and behind it lie marks, and beyond them
// memory that nobody may touch: writing a little too far is seen by the marks, writing or reading further is a crash inside
// the image and never damage of our own data.

#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstring>
#include <span>

namespace forcegate {

template <class T>
class FencedBlock {
 public:
  FencedBlock() = default;
  FencedBlock(const FencedBlock&) = delete;
  FencedBlock& operator=(const FencedBlock&) = delete;
  ~FencedBlock() { release(); }

  /// n values of unknown content, marks set anew. The span holds until the next call; one without data: there is no memory.
  std::span<T> make(std::size_t n) {
    if (!reserve((n + 2 * kMarks) * sizeof(T))) return {};
    n_ = n;
    std::memset(begin() - kMarks, kMark, kMarks * sizeof(T));
    std::memset(begin() + n, kMark, kMarks * sizeof(T));
    return {begin(), n};
  }
  bool marks_hold() const { return holds(begin() - kMarks) && holds(begin() + n_); }

 private:
  static constexpr std::size_t kMarks = 32;
  static constexpr std::size_t kFence = std::size_t{4} << 20;  // bytes of address space on either side, no memory
  static constexpr unsigned char kMark = 0xA5;

  // The block ends where the marks behind it do, at the fence.
  T* begin() const { return reinterpret_cast<T*>(area_ + room_) - kMarks - n_; }
  static bool holds(const T* first) {
    static const auto kMarked = [] {
      std::array<unsigned char, kMarks * sizeof(T)> bytes{};
      bytes.fill(kMark);
      return bytes;
    }();
    return std::memcmp(first, kMarked.data(), kMarked.size()) == 0;  // at every call into the image
  }
  bool reserve(std::size_t bytes) {
    if (bytes <= room_) return true;
    release();
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    const std::size_t room = (bytes + page - 1) / page * page;
    void* all = mmap(nullptr, room + 2 * kFence, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (all == MAP_FAILED) return false;
    whole_ = static_cast<unsigned char*>(all), area_ = whole_ + kFence, room_ = room;
    if (mprotect(area_, room, PROT_READ | PROT_WRITE) == 0) return true;
    release();
    return false;
  }
  void release() {
    if (whole_ != nullptr) munmap(whole_, room_ + 2 * kFence);
    whole_ = area_ = nullptr;
    room_ = n_ = 0;
  }

  unsigned char *whole_ = nullptr, *area_ = nullptr;
  std::size_t room_ = 0, n_ = 0;
};

}  // namespace forcegate
