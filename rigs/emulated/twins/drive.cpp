#include "rigs/emulated/twins/drive.h"

#include <cmath>
#include <limits>

namespace forcegate::emulated {
namespace {

constexpr double kCountsPerRad = 131072.0 / 6.28318530717958647693;
constexpr std::int32_t kVelocityMax = 400000;
constexpr std::uint32_t kSerial = 4201;

std::uint16_t high(std::int32_t v) { return static_cast<std::uint16_t>(static_cast<std::uint32_t>(v) >> 16); }
std::uint16_t low(std::int32_t v) { return static_cast<std::uint16_t>(static_cast<std::uint32_t>(v)); }

}  // namespace

std::uint16_t Drive::status() const {
  return static_cast<std::uint16_t>(((control_ & 0x20U) ? 1U : 0U) | (running() ? 0x20U : 0U) |
                                    (alarm_ ? 0x80U : 0U));
}

std::optional<std::uint16_t> Drive::read(int address) {
  switch (address) {
    case 0x007D: return control_;
    case 0x0100: return status();
    case 0x0101: return static_cast<std::uint16_t>(alarm_);
    case 0x0102: return high(position_);
    case 0x0103: return low(position_);
    case 0x0104: return high(velocity_);
    case 0x0105: return low(velocity_);
    case 0x0106: return scratch_;
    case 0x0180: return std::uint16_t{0};
    case 0x0200: return static_cast<std::uint16_t>(kSerial >> 16);
    case 0x0201: return static_cast<std::uint16_t>(kSerial);
    case 0x0480: return high(velocity_set_);
    case 0x0481: return low(velocity_set_);
    case 0x1000: return timeout_ms_;
    default: return std::nullopt;
  }
}

int Drive::write(int address, std::uint16_t word) {
  const auto with_high = [&](std::int32_t v) {
    return static_cast<std::int32_t>((static_cast<std::uint32_t>(v) & 0xFFFFU) |
                                     static_cast<std::uint32_t>(word) << 16);
  };
  const auto with_low = [&](std::int32_t v) {
    return static_cast<std::int32_t>((static_cast<std::uint32_t>(v) & 0xFFFF0000U) | word);
  };
  switch (address) {
    case 0x007D: control_ = word; return 0;
    case 0x0106:
      if (!frozen_) scratch_ = word;
      return 0;
    case 0x0180:
      if (word == 1) {
        alarm_ = 0;
        control_ = 0;
      }
      return 0;
    case 0x0480: velocity_set_ = with_high(velocity_set_); return 0;
    case 0x0481:
      velocity_set_ = with_low(velocity_set_);
      return velocity_set_ > kVelocityMax || velocity_set_ < -kVelocityMax ? 3 : 0;
    case 0x1000:
      if (word != 0 && (word < 20 || word > 5000)) return 3;
      timeout_ms_ = word;
      return 0;
    default: return 2;
  }
}

void Drive::power_cycle() {
  const std::int32_t position = position_;
  *this = Drive();
  position_ = position;
}

double Drive::watchdog_s() const {
  if (!running() || timeout_ms_ == 0) return std::numeric_limits<double>::infinity();
  return heard_s_ + timeout_ms_ * 1e-3;
}

bool Drive::tick(double t_s) {
  if (t_s < watchdog_s()) return false;
  alarm_ = kCommunicationTimeout;
  control_ = 0;
  return true;
}

void Drive::see(double theta_rad, double velocity_rad_per_s, bool following_error) {
  if (following_error && alarm_ == 0) alarm_ = kFollowingError;
  if (frozen_) return;
  position_ = static_cast<std::int32_t>(std::lround(theta_rad * kCountsPerRad));
  velocity_ = static_cast<std::int32_t>(std::lround(velocity_rad_per_s * 1e4));
}

double Drive::velocity_rad_per_s() const {
  if (!running()) return 0.0;
  const std::int32_t v = velocity_set_ > kVelocityMax    ? kVelocityMax
                         : velocity_set_ < -kVelocityMax ? -kVelocityMax
                                                         : velocity_set_;
  return v * 1e-4;
}

}  // namespace forcegate::emulated
