#pragma once
// Curves for pictures: M4 decimation (first, minimum, maximum and last sample of each pixel column; Jugel et al.,
// VLDB 2014) of a trace united with that of its error. Never used for a number in a table.

#include <cstddef>
#include <span>
#include <vector>

namespace forcegate {

/// Rows that survived, the same instants for every channel.
struct DecimatedRows {
  std::vector<float> t_s;
  std::vector<std::vector<float>> value;  ///< one for each channel
};

/// Streaming M4 over several channels. The rows kept are the union over the watched channels, so that neither a
/// crest of the trace nor a one-sample glitch of the error is lost; each kept row holds all channels. Memory is
/// columns x (2 + 2 watched) rows at most, whatever the length of the record. NaN is never a minimum or maximum.
class M4Accumulator {
 public:
  /// `columns` pixel columns over [first_s, last_s]; samples outside fall into the first or last column. `watched`
  /// are the channels whose extremes are kept (usually set-point or ATI, and the error).
  M4Accumulator(std::size_t columns, double first_s, double last_s, std::size_t channels,
                std::vector<std::size_t> watched);

  /// Rows in the order of time; channel[k] points to t_s.size() values.
  void push(std::span<const double> t_s, std::span<const float* const> channel);

  /// All rows kept so far, in the order of time.
  DecimatedRows rows() const;

 private:
  struct Row {
    double t_s = 0.0;
    std::size_t number = 0;
    std::vector<float> value;
  };
  struct Extremes {
    Row low, high;
    bool any = false;
  };
  void store(Row& row, double t_s, std::size_t i, std::span<const float* const> channel) const;
  void close_column();

  double first_s_, last_s_, per_second_;
  std::size_t columns_, channels_;
  std::vector<std::size_t> watched_;
  std::size_t column_ = 0, count_ = 0;
  bool open_ = false;
  Row first_, latest_;
  std::vector<Extremes> extremes_;
  std::vector<Row> kept_;
};

}  // namespace forcegate
