#pragma once
// A bench of twins for one test: rigs/twin.toml with changes, its session, and a second hand on the control socket.

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hil/rig/bench_session.h"
#include "rigs/emulated/twins/client.h"

namespace forcegate::test {

using Changes = std::vector<std::pair<std::string, std::string>>;

inline std::string bench_text(const std::string& file, const Changes& changes = {}) {
  std::ifstream in(std::string(FORCEGATE_SOURCE_DIR "/rigs/") + file);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  for (const auto& [from, to] : changes) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << "no '" << from << "' in " << file;
    if (at != std::string::npos) text.replace(at, from.size(), to);
  }
  return text;
}

/// A second between 0.5 and 4 N on the emulated specimen q50.
inline RigRecordRequest request_of_a_second() {
  RigRecordRequest q;
  q.specimen = "q50";
  q.seed = 1;
  q.duration_s = 1.0;
  q.force_low_N = 0.5;
  q.force_high_N = 4.0;
  return q;
}

struct TwinBench {
  explicit TwinBench(const std::string& file = "twin.toml", const Changes& changes = {}) {
    auto bench = read_bench_text(bench_text(file, changes), FORCEGATE_SOURCE_DIR "/rigs/" + file);
    if (!bench) {
      ADD_FAILURE() << bench.error().to_text();
      return;
    }
    auto made = BenchSession::make(*bench, {});
    if (!made) {
      ADD_FAILURE() << made.error().to_text();
      return;
    }
    session = std::move(*made);
    auto connected = emulated::TwinClient::connect(session->world().guard_option(), 5.0);
    if (connected) hand.emplace(std::move(*connected));
  }

  template <class T>
  static void ok(const Result<T>& r) {
    EXPECT_TRUE(r) << r.error().to_text();
  }
  void say(const std::string& line) { ok(hand->say(line)); }
  void mount(const std::string& rest = "low_N=0.5 high_N=4") {
    say("mount specimen=q50 seed=1 session=0 record=1 rest_s=7200 " + rest);
  }
  /// A specimen on the bench, everything connected, drive armed, reference and board streaming.
  void run_up(const std::string& rest = "low_N=0.5 high_N=4") {
    mount(rest);
    ok(session->open());
    ok(session->arm());
    ok(session->reference().start());
    ok(session->board().start());
  }
  double status(const std::string& key) {
    auto s = hand->status();
    return s && s->contains(key) ? std::stod(s->at(key)) : -1e9;
  }
  std::string status_text(const std::string& key) {
    auto s = hand->status();
    return s && s->contains(key) ? s->at(key) : "";
  }
  Result<void> advance(double dt_s) { return session->world().advance_to(session->world().now_s() + dt_s); }

  std::unique_ptr<BenchSession> session;
  std::optional<emulated::TwinClient> hand;
};

}  // namespace forcegate::test
