#pragma once
// A sensor board with its own converter: link protocol on the wire, free-running stream (docs/protocol.md).

#include <memory>

#include "rigs/emulated/twins/board_image.h"
#include "rigs/emulated/twins/wire.h"

namespace forcegate::emulated {

class Board {
 public:
  /// `reports`: the wire carries 64-byte HID reports (length, then that many bytes of the stream).
  Board(Wire& wire, bool reports) : wire_(wire), reports_(reports), image_(blank_board()) {}

  Result<void> flash(const std::string& path);
  void serve(WireEnd& end, double t_s);
  /// One conversion.
  void row(double t_s, std::uint16_t code, std::uint16_t last_code);
  void power_cycle();
  bool streaming() const { return streaming_; }
  /// Conversions sent since the stream began.
  std::uint32_t sent_samples() const { return index_; }
  /// How the image ended, as the process that runs it tells; "" while it runs.
  std::string fate() const { return image_->fate(); }

 private:
  void understand(Bytes& stream, WireEnd& end, double t_s);
  void handle(WireEnd& end, const BoardFrame& request, double t_s);
  void send(WireEnd* end, BoardFrame frame, double t_s);

  Wire& wire_;
  bool reports_;
  Bytes stream_;  ///< what the reports brought
  std::unique_ptr<BoardImage> image_;
  std::uint16_t sequence_ = 0, stream_request_ = 0;
  bool streaming_ = false, silent_ = false;
  unsigned divider_ = 1, batch_ = 10, skipped_ = 0;
  std::uint32_t index_ = 0;
  std::vector<std::uint16_t> codes_;
  std::uint16_t frozen_code_ = 0;
  bool was_frozen_ = false;
};

}  // namespace forcegate::emulated
