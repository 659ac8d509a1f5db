#pragma once
// What a recorded channel is before its samples arrive.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace forcegate {

/// Type of one sample on disk. The floating types are physical values, the integers device counts.
enum class SampleType : std::uint8_t { f64 = 0, f32 = 1, i32 = 2, u16 = 3, u8 = 4 };

constexpr std::size_t size_of(SampleType type) {
  return type == SampleType::f64                              ? 8
         : type == SampleType::f32 || type == SampleType::i32 ? 4
         : type == SampleType::u16                            ? 2
                                                              : 1;
}
constexpr bool is_counts(SampleType type) { return type != SampleType::f64 && type != SampleType::f32; }

struct ChannelSpec {
  std::string name;      ///< "F_ref"; a counts channel of the same name holds that channel's raw values
  std::string unit;      ///< canonical, "N"; "counts" for device counts
  std::string quantity;  ///< "force"
  SampleType type = SampleType::f32;
  std::size_t time_base = 0;
};

struct TimeBaseSpec {
  std::string device = "rig";
  double nominal_rate_Hz = 0.0;  ///< 0 = unknown: no gaps can be found
};

/// Samples of one channel by reference; made from a vector or span of the element type.
struct ColumnView {
  const void* data = nullptr;
  std::size_t n = 0;
  SampleType type = SampleType::f64;

  ColumnView(std::span<const double> v) : data(v.data()), n(v.size()), type(SampleType::f64) {}
  ColumnView(std::span<const float> v) : data(v.data()), n(v.size()), type(SampleType::f32) {}
  ColumnView(std::span<const std::int32_t> v) : data(v.data()), n(v.size()), type(SampleType::i32) {}
  ColumnView(std::span<const std::uint16_t> v) : data(v.data()), n(v.size()), type(SampleType::u16) {}
  ColumnView(std::span<const std::uint8_t> v) : data(v.data()), n(v.size()), type(SampleType::u8) {}
  ColumnView(const void* values, std::size_t count, SampleType kind) : data(values), n(count), type(kind) {}
  template <class T>
  ColumnView(const std::vector<T>& v) : ColumnView(std::span<const T>(v)) {}
};

}  // namespace forcegate
