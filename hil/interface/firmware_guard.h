#pragma once
// Where a worker process is when it dies: the lane that runs firmware code inside the process marks its way in and
// out in memory shared with the parent, so that a crash or an endless loop is charged to the firmware only when the
// firmware was running.

#include <atomic>
#include <cstdint>
#include <span>
#include <string_view>

#include "hil/interface/dut.h"

namespace forcegate {

/// What the image was called for.
enum class FirmwareStage : std::uint32_t { samples, opening, closing };

/// Lives in memory shared between worker and parent (mmap MAP_SHARED); lock-free atomics only.
struct FirmwareGuard {
  std::atomic<std::uint32_t> in_firmware{0};   ///< 1 while code of the image runs
  std::atomic<std::uint32_t> sample_index{0};  ///< first index of the block handed to it last
  std::atomic<std::uint32_t> sample_count{0};  ///< samples of that block; 0: not told
  std::atomic<FirmwareStage> stage{FirmwareStage::samples};
  std::atomic<std::uint32_t> loaded{0};        ///< 1 once code of the image is in this process: it may have threads
  std::atomic<std::uint32_t> known{0};         ///< 1 once the image has said who it is
  char board[32] = {}, build_id[48] = {}, algorithm_id[64] = {};  ///< that, with closing zeros
  int protocol_major = 0, protocol_minor = 0, adc_bits = 0;
  double rate_Hz = 0.0;
};
static_assert(std::atomic<std::uint32_t>::is_always_lock_free);

/// What an image said of itself outlives its crash.
inline void tell_guard(FirmwareGuard* guard, const DutInfo& said) {
  if (guard == nullptr) return;
  const auto keep = [](std::string_view text, std::span<char> into) { text.copy(into.data(), into.size() - 1); };
  keep(said.board, guard->board), keep(said.build_id, guard->build_id), keep(said.algorithm_id, guard->algorithm_id);
  guard->protocol_major = said.protocol_major, guard->protocol_minor = said.protocol_minor;
  guard->adc_bits = said.adc_bits, guard->rate_Hz = said.rate_Hz;
  guard->known.store(1, std::memory_order_release);
}

/// Process-global; nullptr (the default) means nobody watches. Set by the worker before any lane is opened.
inline std::atomic<FirmwareGuard*> g_firmware_guard{nullptr};

/// Scope of a call into the image.
class InFirmware {
 public:
  explicit InFirmware(std::uint32_t first_index, std::uint32_t count = 0) : InFirmware(FirmwareStage::samples, first_index, count) {}
  explicit InFirmware(FirmwareStage stage, std::uint32_t samples_so_far = 0) : InFirmware(stage, samples_so_far, 0) {}
  ~InFirmware() {
    if (guard_ != nullptr) guard_->in_firmware.store(0, std::memory_order_release);
  }
  InFirmware(const InFirmware&) = delete;
  InFirmware& operator=(const InFirmware&) = delete;

 private:
  InFirmware(FirmwareStage stage, std::uint32_t first_index, std::uint32_t count) : guard_(g_firmware_guard.load(std::memory_order_relaxed)) {
    if (guard_ == nullptr) return;
    guard_->stage.store(stage, std::memory_order_relaxed);
    guard_->sample_index.store(first_index, std::memory_order_relaxed);
    guard_->sample_count.store(count, std::memory_order_relaxed);
    guard_->loaded.store(1, std::memory_order_relaxed);
    guard_->in_firmware.store(1, std::memory_order_release);
  }
  FirmwareGuard* guard_;
};

}  // namespace forcegate
