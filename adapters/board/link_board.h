#pragma once
// A sensor board that speaks the link protocol (docs/protocol.md) over any byte stream: handshake, free-running stream,
// loss made visible by indices and sequence numbers. The serial and the HID board differ only in the stream.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "adapters/link/frame.h"
#include "adapters/link/messages.h"
#include "hil/interface/device.h"

namespace forcegate {

struct LinkBoardOptions {
  int adc_bits = 16;
  int batch = 10;
  std::string serial;
  bool serial_by_file = true;  ///< false: the line was opened by it
  double reply_timeout_s = 1.0;  ///< wall time; a request is sent three times
};

class LinkBoard final : public SensorBoard {
 public:
  using OpenLine = std::function<Result<std::unique_ptr<Transport>>()>;
  LinkBoard(LinkBoardOptions options, OpenLine open_line, BenchWorld& world)
      : options_(std::move(options)), open_line_(std::move(open_line)), world_(world) {}
  ~LinkBoard() override { close(); }

  Result<DeviceIdentity> open() override;
  void close() noexcept override;
  Result<DutInfo> load(const DutSession& session) override;
  Result<void> start() override;
  Result<void> poll(std::vector<BoardSample>& out) override;
  Result<void> stop() override;
  DutCounters counters() const override;
  std::map<std::string, std::uint64_t> counts() const override;
  ClockFit clock() const override { return clock_.fit(); }

 private:
  std::string where() const;
  Error told(const Error& error) const;
  Result<link::Frame> ask(link::Type type, const std::vector<std::uint8_t>& payload, link::Type answer);
  Result<void> send(link::Type type, const std::vector<std::uint8_t>& payload);
  /// False when nothing arrived within the time.
  Result<bool> receive(double timeout_s);
  Result<void> note(const link::Frame& frame);
  Result<void> ask_time();
  void take_time(const link::Frame& frame);
  Result<void> take(const link::Frame& frame, std::vector<BoardSample>& out);
  Unexpected no_answer() const;
  Unexpected wider(std::uint16_t code) const;

  LinkBoardOptions options_;
  OpenLine open_line_;
  BenchWorld& world_;
  std::unique_ptr<Transport> line_;
  std::vector<std::uint8_t> buffer_;
  std::string first_bytes_;  ///< since the line was opened
  std::uint64_t bytes_ = 0, frames_ = 0;
  std::uint16_t sequence_ = 0, stream_request_ = 0, expected_sequence_ = 0;
  bool expects_sequence_ = false, streaming_ = false;
  bool image_loaded_ = false;            ///< what runs on the board is what is judged
  std::uint64_t lost_frames_seen_ = 0;  ///< damaged and missing frames up to the last SAMPLES
  std::uint32_t next_index_ = 0;
  std::uint16_t device_dropped_ = 0, device_bad_ = 0;
  DutCounters counters_;
  std::uint64_t repeats_ = 0, foreign_ = 0;
  DeviceClock clock_;
  double asked_s_ = -1e9;  ///< bench time of the last TIME
  std::uint16_t time_request_ = 0;
  bool time_open_ = false;  ///< its reply has not come yet
  std::uint32_t last_us_ = 0;
  std::uint64_t turns_ = 0;  ///< of the board's 32-bit microseconds
};

}  // namespace forcegate
