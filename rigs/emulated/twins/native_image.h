#pragma once
// The four functions of the native port (docs/protocol.md) called in a child process over a pair of sockets.

#include <array>
#include <memory>
#include <string>

#include "rigs/emulated/twins/board_image.h"

namespace forcegate::emulated {

/// CAL as the board keeps it.
struct BoardCalibration {
  float gain_N_per_V = 0.5F, offset_N = 0, v_range_V = 10, b_scale = 1, q_scale = 1;
  std::uint32_t adc_bits = 16;
  std::array<char, 16> id{'n', 'o', 'm', 'i', 'n', 'a', 'l'};
};

/// What the image says of itself, its echoes of nonce and CAL included: a board passes them on as they are.
struct BoardIdentity {
  std::uint32_t nonce = 0;
  std::uint8_t version = 0x10;  ///< major << 4 | minor
  BoardCalibration calibration;
  std::array<char, 24> board{};
  std::array<char, 40> build_id{};
  std::array<char, 32> algorithm{};
  std::uint32_t rate_Hz = 1000;
};

/// What a board's monitor program answers around an algorithm.
class MonitorImage : public BoardImage {
 public:
  std::optional<BoardFrame> answer(const BoardFrame& request) final;
  std::optional<Bytes> convert(std::uint32_t first_index, std::span<const std::uint16_t> adc) final;
  std::uint8_t version() const final { return version_; }

 protected:
  /// Fresh state with this calibration; false: refused.
  virtual bool restart(std::uint32_t nonce, const BoardCalibration& calibration, BoardIdentity& identity) = 0;
  virtual bool run(std::uint32_t first_index, std::span<const std::uint16_t> adc, float* force_N,
                   std::uint8_t* flags) = 0;

 private:
  BoardCalibration calibration_, told_;  ///< as set, and as the image echoed it
  std::uint32_t nonce_ = 0;
  std::uint8_t version_ = 0x10;
};

Result<std::unique_ptr<BoardImage>> load_native_image(const std::string& path);
Result<std::unique_ptr<BoardImage>> load_uart_image(const std::string& path, const std::string& machine);

}  // namespace forcegate::emulated
