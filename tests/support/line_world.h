#pragma once
// A bench of one line that a test makes up, in time that moves only when told to.

#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "hil/interface/bench_world.h"

namespace forcegate::test {

class LineWorld : public BenchWorld {
 public:
  using Line = std::function<std::unique_ptr<Transport>()>;
  explicit LineWorld(Line line) : line_(std::move(line)) {}

  Result<std::string> serial_path(const std::string&) override {
    return fail(ErrorCode::device, "there is no such port");
  }
  Result<std::unique_ptr<Transport>> open_line(const std::string&, const LineSettings&) override { return line_(); }
  Result<std::unique_ptr<Transport>> open_hid(unsigned short, unsigned short, const std::string&) override {
    return line_();
  }
  Result<std::unique_ptr<Transport>> open_datagrams(const std::string&, const std::string&, int) override {
    return line_();
  }
  Result<int> tcp_port(const std::string&, int) override { return 1; }  // nobody listens there
  double now_s() const override { return t_s_; }
  Result<void> advance_to(double t_s) override {
    t_s_ = t_s;
    return {};
  }
  bool is_virtual() const override { return true; }
  Result<void> mount(const RigRecordRequest&) override { return {}; }
  bool flashes() const override { return false; }
  Result<void> flash(const std::string&) override { return {}; }

 private:
  Line line_;
  double t_s_ = 0.0;
};

}  // namespace forcegate::test
