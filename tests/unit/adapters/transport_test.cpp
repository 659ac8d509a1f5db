#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "adapters/transport/child_process.h"
#include "adapters/transport/private_folder.h"
#include "adapters/transport/serial.h"
#include "adapters/transport/unix_socket.h"

namespace forcegate {
namespace {

std::string text_of(Transport& t, std::size_t size) {
  std::string out;
  std::uint8_t chunk[64];
  while (out.size() < size) {
    const auto n = t.read(chunk, 2.0);
    if (!n || *n == 0) break;
    out.append(chunk, chunk + *n);
  }
  return out;
}

const std::uint8_t kHello[5] = {'h', 'e', 'l', 'l', 'o'};

TEST(UnixSocket, CarriesBytesBothWaysAndTellsWhenThePeerIsGone) {
  auto folder = PrivateFolder::make();
  ASSERT_TRUE(folder);
  auto listener = UnixListener::listen_at(folder->path() / "s");
  ASSERT_TRUE(listener);
  auto client = connect_unix(folder->path() / "s");
  ASSERT_TRUE(client);
  auto server = listener->accept_peer(1.0);
  ASSERT_TRUE(server && *server);
  ASSERT_TRUE((*client)->write(kHello, 1.0));
  EXPECT_EQ(text_of(**server, 5), "hello");
  std::uint8_t byte[1];
  EXPECT_EQ((*server)->read(byte, 0.01).value(), 0U);
  client->reset();
  EXPECT_EQ((*server)->read(byte, 1.0).error().code, ErrorCode::io);
  EXPECT_FALSE((*server)->write(kHello, 0.1));
}

TEST(Serial, SpeaksOverAPseudoTerminalAtAnOddRateAndHoldsThePortAlone) {
  auto terminal = open_pseudo_terminal();
  ASSERT_TRUE(terminal);
  auto port = open_serial(terminal->slave, {1250000, Parity::none});
  ASSERT_TRUE(port) << port.error().to_text();
  ASSERT_TRUE((*port)->write(kHello, 1.0));
  EXPECT_EQ(text_of(*terminal->master, 5), "hello");
  const std::uint8_t all[4] = {0x00, 0x11, 0x13, 0x0D};  // nothing is swallowed or changed: raw line
  ASSERT_TRUE(terminal->master->write(all, 1.0));
  EXPECT_EQ(text_of(**port, 4), std::string("\0\x11\x13\x0D", 4));
  const auto second = open_serial(terminal->slave, {});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::device);
}

TEST(Serial, AMissingPortIsADeviceErrorWithAHint) {
  const auto port = open_serial("/dev/no_such_port", {});
  ASSERT_FALSE(port);
  EXPECT_EQ(port.error().code, ErrorCode::device);
  EXPECT_FALSE(port.error().hint.empty());
}

TEST(ChildProcess, TellsExitCodesAndSignalsInWordsAndLeavesNobodyBehind) {
  auto folder = PrivateFolder::make();
  ASSERT_TRUE(folder);
  const auto log = folder->path() / "log";
  ChildProcess child;
  ASSERT_TRUE(child.start({"/bin/sh", "-c", "echo said; exit 3"}, folder->path(), log));
  child.finish(5.0);
  EXPECT_EQ(child.ended().value(), "exit code 3");
  EXPECT_EQ(last_line(log), "said");
  ASSERT_TRUE(child.start({"/bin/sleep", "60"}, folder->path(), log));
  EXPECT_FALSE(child.ended());
  const pid_t id = child.id();
  child.kill_and_reap();
  EXPECT_EQ(child.ended().value(), "killed by signal 9 (Killed)");
  EXPECT_EQ(kill(id, 0), -1);
}

TEST(ChildProcess, TakesWhatItHasStartedWithItHoweverItEnds) {
  auto folder = PrivateFolder::make();
  ASSERT_TRUE(folder);
  const auto log = folder->path() / "log";
  const auto grandchild = [&] {
    std::string id;
    for (int i = 0; i < 2000 && id.empty(); ++i) {
      id = last_line(log);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return static_cast<pid_t>(std::atoi(id.c_str()));
  };
  // An orphan that is dead may wait for its new parent to reap it.
  const auto runs = [](pid_t id) {
    std::ifstream stat("/proc/" + std::to_string(id) + "/stat");
    std::string number, name, state;
    return stat >> number >> name >> state && state != "Z" && state != "X";
  };
  const auto ends = [&](pid_t id) {
    for (int i = 0; i < 2000 && runs(id); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return !runs(id);
  };
  ChildProcess child;
  ASSERT_TRUE(child.start({"/bin/sh", "-c", "sleep 300 & echo $!; wait"}, folder->path(), log));
  pid_t id = grandchild();
  ASSERT_GT(id, 1);
  child.kill_and_reap();
  EXPECT_TRUE(ends(id)) << "the program was killed";
  if (runs(id)) kill(id, SIGKILL);

  ASSERT_TRUE(child.start({"/bin/sh", "-c", "sleep 300 & echo $!"}, folder->path(), log));
  id = grandchild();
  ASSERT_GT(id, 1);
  child.finish(5.0);
  EXPECT_EQ(child.ended().value(), "exit code 0");
  EXPECT_TRUE(ends(id)) << "the program ended by itself";
  if (runs(id)) kill(id, SIGKILL);
}

TEST(PrivateFolder, IsGoneWithItsContents) {
  std::filesystem::path path;
  {
    auto folder = PrivateFolder::make();
    ASSERT_TRUE(folder);
    path = folder->path();
    std::filesystem::create_directory(path / "inner");
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace forcegate
