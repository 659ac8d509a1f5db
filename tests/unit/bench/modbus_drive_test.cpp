// What the Modbus adapter says to a drive, and how a drive forgets its fault.

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <set>
#include <thread>

#include "adapters/transport/descriptor.h"
#include "rigs/emulated/twins/drive.h"
#include "tests/support/line_world.h"
#include "tests/support/twin_bench.h"

namespace forcegate {
namespace {

using test::Changes;
using test::TwinBench;

/// A drive on Modbus TCP for one client, which keeps the functions that were asked of it.
class ListeningDrive {
 public:
  ListeningDrive() : listener_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(listener_.get(), reinterpret_cast<const sockaddr*>(&address), size), 0);
    EXPECT_EQ(listen(listener_.get(), 1), 0);
    EXPECT_EQ(getsockname(listener_.get(), reinterpret_cast<sockaddr*>(&address), &size), 0);
    port = ntohs(address.sin_port);
    thread_ = std::thread([this] { serve(); });
  }
  ~ListeningDrive() {
    shutdown(listener_.get(), SHUT_RDWR);
    if (thread_.joinable()) thread_.join();
  }
  /// Of a client that has gone.
  const std::set<int>& functions() {
    thread_.join();
    return functions_;
  }
  int port = 0;

 private:
  void serve() {
    const Descriptor client(accept(listener_.get(), nullptr, nullptr));
    emulated::Drive drive;
    std::uint8_t bytes[300];
    for (ssize_t n; (n = recv(client.get(), bytes, sizeof bytes, 0)) > 7;) {  // loopback: one request, one read
      functions_.insert(bytes[7]);
      const emulated::Bytes body = emulated::modbus_reply(drive, {bytes + 7, static_cast<std::size_t>(n) - 7});
      emulated::Bytes reply(bytes, bytes + 7);
      reply[4] = 0;
      reply[5] = static_cast<std::uint8_t>(body.size() + 1);
      reply.insert(reply.end(), body.begin(), body.end());
      send(client.get(), reply.data(), reply.size(), MSG_NOSIGNAL);
    }
  }
  Descriptor listener_;
  std::set<int> functions_;
  std::thread thread_;
};

class DriveWorld final : public test::LineWorld {
 public:
  explicit DriveWorld(int port) : LineWorld([]() -> std::unique_ptr<Transport> { return nullptr; }), port_(port) {}
  Result<int> tcp_port(const std::string&, int) override { return port_; }

 private:
  int port_;
};

std::set<int> functions_with(const Changes& changes) {
  ListeningDrive drive;
  {
    DriveWorld world(drive.port);
    const auto bench = read_bench_text(test::bench_text("twin.toml", changes), "t.toml");
    EXPECT_TRUE(bench) << bench.error().to_text();
    auto motor = Registry<MotorKind>::instance().find("modbus_motor")->make(bench->table("motor"), world);
    EXPECT_TRUE(motor) << motor.error().to_text();
    const auto opened = (*motor)->open();
    EXPECT_TRUE(opened) << opened.error().to_text();
  }
  return drive.functions();
}

TEST(ModbusDrive, HoldingRegistersAreReadTogetherWithTheHeartbeat) {
  EXPECT_TRUE(functions_with({}).contains(23));
}

TEST(ModbusDrive, InputRegistersAreReadByTheirOwnFunction) {
  Changes changes;
  for (const char* r : {"status = { addr = 0x0100", "fault_code = { addr = 0x0101", "position = { addr = 0x0102", "velocity_actual = { addr = 0x0104", "scratch = { addr = 0x0106"})
    changes.emplace_back(r, std::string(r) + ", read_fc = 4");
  const std::set<int> functions = functions_with(changes);
  EXPECT_TRUE(functions.contains(4));
  EXPECT_FALSE(functions.contains(23)) << "it reads holding registers";
}

Error error_with(int port) {
  DriveWorld world(port);
  const auto bench = read_bench_text(test::bench_text("twin.toml", {{"response_timeout_ms = 1000", "response_timeout_ms = 20"}}), "t.toml");
  EXPECT_TRUE(bench);
  auto motor = Registry<MotorKind>::instance().find("modbus_motor")->make(bench->table("motor"), world);
  EXPECT_TRUE(motor);
  const auto opened = (*motor)->open();
  EXPECT_FALSE(opened);
  return opened ? Error{} : opened.error();
}

TEST(ModbusDrive, ThatCannotBeReachedIsToldWithWhatToLookAt) {
  const Error refused = error_with(1);  // nobody listens there
  EXPECT_NE(refused.hint.find("tcp_port"), std::string::npos) << refused.to_text();
  emulated::FaultScript no_faults;
  emulated::Wire wire("motor", no_faults, true);  // takes the connection and never answers
  const auto port = wire.open_server(0);
  ASSERT_TRUE(port);
  const Error silent = error_with(*port);
  EXPECT_EQ(silent.code, ErrorCode::timeout);
  EXPECT_NE(silent.hint.find("response_timeout_ms"), std::string::npos) << silent.to_text();
  emulated::Wire second("motor", no_faults, true);
  const auto taken = second.open_server(*port);
  ASSERT_FALSE(taken);
  EXPECT_NE(taken.error().hint.find("give 0"), std::string::npos) << taken.error().to_text();
  const auto bench = read_bench_text(test::bench_text("twin.toml", {{"tcp_port = 0", "tcp_port = " + std::to_string(*port)}}), "t.toml");
  ASSERT_TRUE(bench);
  const auto session = BenchSession::make(*bench, {});
  ASSERT_FALSE(session);
  EXPECT_EQ(session.error().hint, taken.error().hint) << "whoever starts the twins is told too";
}

void stop_by_silence(TwinBench& b) {
  TwinBench::ok(b.session->open());
  TwinBench::ok(b.session->arm());
  TwinBench::ok(b.session->motor().command_velocity(2.0));
  TwinBench::ok(b.advance(0.5));
  const auto state = b.session->motor().read();
  ASSERT_TRUE(state);
  ASSERT_TRUE(state->fault);
}

/// The wheel turns at 2 rad/s until an error; with what the drive is told after it.
Error error_while_turning(TwinBench& b) {
  for (int i = 0; i < 60; ++i) {
    if (const auto told = b.session->motor().command_velocity(2.0); !told) return told.error();
    EXPECT_TRUE(b.advance(0.01));
    if (const auto state = b.session->motor().read(); !state) return state.error();
  }
  ADD_FAILURE() << "nothing was seen";
  return {};
}

TEST(ModbusDrive, ThatBeganAnewIsNotStartedWithoutItsTimeout) {
  for (const char* file : {"twin.toml", "twin_rtu.toml"}) {
    TwinBench b(file);
    b.run_up();
    b.say("fault motor reset 0.3 1e9 1 0");
    const Error seen = error_while_turning(b);
    EXPECT_EQ(seen.code, ErrorCode::safety);
    EXPECT_NE(seen.text.find("lost its communication timeout"), std::string::npos) << seen.to_text();
    EXPECT_TRUE(seen.where.starts_with("motor")) << seen.to_text();
    EXPECT_EQ(b.status("command_rad_per_s"), 0.0);
  }
}

TEST(ModbusDrive, ThatBeganAnewWhileItDidNotAnswerIsFoundOut) {
  TwinBench b("twin.toml", {{"response_timeout_ms = 1000", "response_timeout_ms = 60"}});
  b.run_up();
  b.say("fault motor reset 0.3 1e9 1 0");
  b.say("fault motor drop 0.29 1e9 1 0");
  EXPECT_EQ(error_while_turning(b).code, ErrorCode::safety);
  EXPECT_EQ(b.status("command_rad_per_s"), 0.0);
}

TEST(ModbusDrive, ThatAnotherHandHasStoppedIsNotStartedAgain) {
  TwinBench b;
  b.run_up();
  TwinBench::ok(b.session->motor().command_velocity(2.0));
  TwinBench::ok(b.advance(0.05));
  TwinBench::ok(b.session->motor().read());
  TwinBench::ok(stop_motor_now(b.session->bench(), {{"attach", b.session->world().guard_option()}}));
  const Error seen = error_while_turning(b);
  EXPECT_EQ(seen.code, ErrorCode::device);
  EXPECT_NE(seen.text.find("nobody told it to"), std::string::npos) << seen.to_text();
}

TEST(ModbusDrive, ThatIsToldToStopMayStandAndGoOn) {
  TwinBench b;
  b.run_up();
  for (int round = 0; round < 2; ++round) {
    TwinBench::ok(b.session->motor().command_velocity(2.0));
    TwinBench::ok(b.advance(0.05));
    TwinBench::ok(b.session->motor().read());
    TwinBench::ok(b.session->motor().stop());
    TwinBench::ok(b.advance(0.05));
    TwinBench::ok(b.session->motor().read());
  }
}

TEST(ModbusDrive, ForgetsItsFaultStoppedAndSwitchedOff) {
  TwinBench b;
  stop_by_silence(b);
  TwinBench::ok(b.session->motor().reset_fault());
  const MotorState state = b.session->motor().read().value();
  EXPECT_FALSE(state.fault);
  EXPECT_FALSE(state.running);
  TwinBench::ok(b.advance(0.2));
  EXPECT_EQ(b.status("command_rad_per_s"), 0.0);
  EXPECT_FALSE(b.session->motor().command_velocity(1.0)) << "it was disarmed";
  TwinBench::ok(b.session->motor().arm());
}

TEST(ModbusDrive, ThatKeepsItsFaultIsSaidToDoSo) {
  TwinBench b("twin.toml", {{"{ reg = \"reset\", value = 1 }", "{ reg = \"reset\", value = 2 }"}});
  stop_by_silence(b);
  const auto reset = b.session->motor().reset_fault();
  ASSERT_FALSE(reset);
  EXPECT_EQ(reset.error().code, ErrorCode::device);
  EXPECT_NE(reset.error().text.find("still reports fault 0x84"), std::string::npos) << reset.error().to_text();
}

TEST(ModbusDrive, WhoseBenchFileNamesNoResetIsNotReset) {
  TwinBench b("twin.toml", {{"fault_reset = [{ reg = \"reset\", value = 1 }]\n", ""}});
  stop_by_silence(b);
  const auto reset = b.session->motor().reset_fault();
  ASSERT_FALSE(reset);
  EXPECT_EQ(reset.error().code, ErrorCode::config);
  EXPECT_NE(reset.error().hint.find("fault_reset"), std::string::npos);
}

}  // namespace
}  // namespace forcegate
