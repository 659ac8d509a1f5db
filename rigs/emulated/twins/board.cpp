#include "rigs/emulated/twins/board.h"

#include <algorithm>

namespace forcegate::emulated {
namespace {

constexpr std::size_t kReportUse = 63;

}  // namespace

Result<void> Board::flash(const std::string& path) {
  FORCEGATE_TRY(image_, load_image(path));
  power_cycle();
  return {};
}

void Board::power_cycle() {
  streaming_ = silent_ = false;
  codes_.clear();
  sequence_ = 0;
  index_ = 0;
}

void Board::send(WireEnd* end, BoardFrame frame, double t_s) {
  frame.sequence = sequence_++;
  frame.t_us = static_cast<std::uint32_t>(static_cast<std::uint64_t>(t_s * 1e6));
  Bytes bytes = frame_bytes(frame);
  if (reports_) {
    Bytes reports;
    for (std::size_t at = 0; at < bytes.size(); at += kReportUse) {
      const std::size_t n = std::min(kReportUse, bytes.size() - at);
      reports.push_back(static_cast<std::uint8_t>(n));
      reports.insert(reports.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at),
                     bytes.begin() + static_cast<std::ptrdiff_t>(at + n));
      reports.resize((reports.size() + kReportUse) / (kReportUse + 1) * (kReportUse + 1));
    }
    bytes = std::move(reports);
  }
  wire_.send(end, std::move(bytes), t_s);
}

void Board::serve(WireEnd& end, double t_s) {
  if (!reports_) return understand(end.rest, end, t_s);
  while (end.rest.size() > kReportUse) {
    const std::size_t used = end.rest[0];
    if (used <= kReportUse)
      stream_.insert(stream_.end(), end.rest.begin() + 1,
                     end.rest.begin() + 1 + static_cast<std::ptrdiff_t>(used));
    end.rest.erase(end.rest.begin(), end.rest.begin() + kReportUse + 1);
  }
  understand(stream_, end, t_s);
}

void Board::understand(Bytes& stream, WireEnd& end, double t_s) {
  for (;;) {
    const auto zero = std::find(stream.begin(), stream.end(), std::uint8_t{0});
    if (zero == stream.end()) return;
    const auto frame = frame_of({stream.data(), static_cast<std::size_t>(zero - stream.begin())});
    stream.erase(stream.begin(), zero + 1);
    if (frame && frame->version >> 4 == 1) handle(end, *frame, t_s);
  }
}

void Board::handle(WireEnd& end, const BoardFrame& request, double t_s) {
  if (request.type == 0x02) {  // STREAM
    BoardFrame reply;
    const Bytes& in = request.payload;
    put_u16(reply.payload, request.sequence);
    const bool good = in.size() == 4 && in[0] <= 1 && u16_at(in, 1) >= 1 && in[3] >= 1 && in[3] <= 32;
    if (!good) {
      reply.type = 0x84;
      reply.payload.push_back(2);
      reply.payload.push_back(request.type);
      return send(&end, std::move(reply), t_s);
    }
    streaming_ = in[0] == 1;
    divider_ = u16_at(in, 1);
    batch_ = in[3];
    skipped_ = 0;
    index_ = 0;
    codes_.clear();
    stream_request_ = request.sequence;
    reply.type = 0x89;
    reply.payload.insert(reply.payload.end(), in.begin(), in.end());
    return send(&end, std::move(reply), t_s);
  }
  if (silent_) return;
  auto reply = image_->answer(request);
  if (reply)
    send(&end, std::move(*reply), t_s);
  else
    silent_ = true;  // the image has crashed or hangs: the whole board does
}

void Board::row(double t_s, std::uint16_t code, std::uint16_t last_code) {
  if (!streaming_ || silent_) return;
  const bool frozen = wire_.faults().active("board", WireFault::frozen, t_s);
  if (frozen && !was_frozen_) frozen_code_ = code;
  was_frozen_ = frozen;
  if (frozen) code = frozen_code_;
  if (wire_.faults().active("board", WireFault::saturation, t_s)) code = last_code;
  if (skipped_++ % divider_ != 0) return;
  codes_.push_back(code);
  if (codes_.size() < batch_) return;
  auto samples = image_->convert(index_, codes_);
  index_ += static_cast<std::uint32_t>(codes_.size());
  codes_.clear();
  if (!samples) {
    silent_ = true;
    return;
  }
  BoardFrame frame;
  frame.version = image_->version();
  frame.type = 0x82;
  put_u16(frame.payload, stream_request_);
  frame.payload.insert(frame.payload.end(), samples->begin(), samples->end());
  send(nullptr, std::move(frame), t_s);
}

}  // namespace forcegate::emulated
