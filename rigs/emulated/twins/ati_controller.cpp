#include "rigs/emulated/twins/ati_controller.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace forcegate::emulated {

Bytes AtiController::binary_record(std::uint8_t error, double counts_Fz, bool checksum) {
  // The cell is loaded along its axis; the other channels show their zero.
  const int axes[6] = {3, -2, static_cast<int>(std::lround(std::clamp(counts_Fz, -32768.0, 32767.0))),
                       1, 0,  -1};
  Bytes out{error};
  for (const int counts : axes) {
    out.push_back(static_cast<std::uint8_t>(static_cast<unsigned>(counts) >> 8));
    out.push_back(static_cast<std::uint8_t>(counts));
  }
  if (checksum) {
    unsigned sum = 0;
    for (const std::uint8_t b : out) sum += b;
    out.push_back(static_cast<std::uint8_t>(sum));
  }
  return out;
}

Bytes AtiController::ascii_record(std::uint8_t error, double counts_Fz) {
  const int z = static_cast<int>(std::lround(std::clamp(counts_Fz, -32768.0, 32767.0)));
  char text[64];
  const int n =
      std::snprintf(text, sizeof text, "%d,%6d,%6d,%6d,%6d,%6d,%6d\r\n", error % 10, 3, -2, z, 1, 0, -1);
  return Bytes(text, text + n);
}

void AtiController::power_cycle() {
  binary_ = checksum_ = streaming_ = false;
  line_.clear();
  bias_N_ = 0.0;
}

Bytes AtiController::record(double t_s) {
  double force_N = sampled_N_ - bias_N_;
  const bool frozen = wire_.faults().active("reference", WireFault::frozen, t_s);
  if (frozen && !was_frozen_) frozen_N_ = force_N;
  was_frozen_ = frozen;
  if (frozen) force_N = frozen_N_;
  const bool saturated = sampled_saturated_ || wire_.faults().active("reference", WireFault::saturation, t_s);
  const auto error = static_cast<std::uint8_t>(saturated ? 1 : 0);
  const double counts = force_N * p_.counts_per_N;
  return binary_ ? binary_record(error, counts, checksum_) : ascii_record(error, counts);
}

void AtiController::row(double t_s, double force_N, bool saturated) {
  force_N_ = force_N;
  saturated_ = saturated;
  if (!streaming_) return;
  const double bytes = binary_ ? (checksum_ ? 14 : 13) : 45;
  const double period_s = bytes * 10.0 / p_.baud;
  if (next_s_ <= 0.0 || next_s_ < t_s - 1.0) {  // the stream begins: this row is the first measurement
    next_s_ = t_s + period_s;
    sampled_N_ = force_N;
    sampled_saturated_ = saturated;
    return;
  }
  while (next_s_ <= t_s) {
    wire_.send(nullptr, record(t_s), t_s);
    sampled_N_ = force_N;
    sampled_saturated_ = saturated;
    next_s_ += period_s;
  }
}

std::string AtiController::execute(const std::string& c) {
  if (c == "CD A" || c == "CD B") {
    binary_ = c == "CD B";
  } else if (c == "CD E" || c == "CD U") {
    checksum_ = c == "CD E";
  } else if (c == "SB") {
    bias_N_ = force_N_;
  } else if (c == "SU" || c == "SZ") {
    bias_N_ = 0.0;
  } else if (c.starts_with("CD ") || c.starts_with("SA ") || c.starts_with("SM ") || c.starts_with("CF ") ||
             c.starts_with("CL ") || c.starts_with("CV ") || c.starts_with("SP ") || c == "SC") {
    return {};
  } else if (!c.empty()) {
    return "? unknown command";
  }
  return {};
}

void AtiController::serve(WireEnd& end, double t_s) {
  if (streaming_ && !end.rest.empty()) streaming_ = false;  // any character stops the stream
  for (const std::uint8_t byte : end.rest) {
    if (byte == 0x14) {  // ^T: one record with the least handshake
      sampled_N_ = force_N_;
      sampled_saturated_ = saturated_;
      wire_.send(&end, record(t_s), t_s);
      continue;
    }
    if (byte == 0x17) {  // ^W: warm start
      power_cycle();
      continue;
    }
    if (byte != '\r') {
      if (byte != '\n' && line_.size() < 80) line_.push_back(static_cast<char>(byte));
      continue;
    }
    std::string reply = line_ + "\r\n";
    if (line_ == "QS") {
      streaming_ = true;
      next_s_ = 0.0;
    } else if (line_ == "QR") {
      sampled_N_ = force_N_;
      sampled_saturated_ = saturated_;
      const Bytes one = record(t_s);
      reply.append(one.begin(), one.end());
      reply += "\r\n>";
    } else {
      const std::string answer = execute(line_);
      reply += answer + (answer.empty() ? "\r\n>" : "\r\n\r\n>");
    }
    line_.clear();
    wire_.send(&end, Bytes(reply.begin(), reply.end()), t_s);
  }
  end.rest.clear();
}

}  // namespace forcegate::emulated
