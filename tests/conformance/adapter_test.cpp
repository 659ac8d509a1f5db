// Every registered instrument, whoever wrote it: a bench in rigs/ shows how it is used; wrong keys are refused with a
// position; a line that is dead, silent, full of garbage or cut off ends in an error that names the instrument, never in
// a hang and never in a value.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "adapters/transport/serial.h"
#include "hil/base/rng.h"
#include "hil/interface/device.h"
#include "hil/rig/bench_file.h"
#include "tests/support/line_world.h"

namespace forcegate {
namespace {

enum class LineKind { dead, silent, garbage, cut };

std::string_view name_of(LineKind kind) {
  return kind == LineKind::dead ? "dead" : kind == LineKind::silent ? "silent" : kind == LineKind::garbage ? "full of garbage" : "cut";
}

/// Writes go nowhere; reads give what the kind of the line says.
class BadLine final : public Transport {
 public:
  explicit BadLine(LineKind kind) : kind_(kind) {}
  Result<void> write(std::span<const std::uint8_t>, double) override {
    if (kind_ == LineKind::dead) return fail(ErrorCode::io, "the far end is gone", name());
    return {};
  }
  Result<std::size_t> read(std::span<std::uint8_t> into, double) override {
    if (kind_ == LineKind::dead || (kind_ == LineKind::cut && ++reads_ > 3))
      return fail(ErrorCode::io, "the far end is gone", name());
    if (kind_ == LineKind::silent || (reads_ += 1) % 2 == 0) return std::size_t{0};
    const std::size_t n = std::min<std::size_t>(into.size(), 64);
    for (std::size_t i = 0; i < n; ++i) into[i] = static_cast<std::uint8_t>(rng_.next());
    return n;
  }
  std::string name() const override { return "test line"; }

 private:
  LineKind kind_;
  int reads_ = 0;
  Rng rng_{7, "bad_line"};
};

class BadWorld final : public test::LineWorld {
 public:
  explicit BadWorld(LineKind kind) : LineWorld([kind] { return std::make_unique<BadLine>(kind); }), kind_(kind) {
    auto made = open_pseudo_terminal();
    if (made) terminal_ = std::move(*made);
  }
  Result<std::string> serial_path(const std::string&) override {
    if (kind_ == LineKind::dead) return fail(ErrorCode::device, "there is no such port");
    return terminal_.slave.string();
  }

 private:
  LineKind kind_;
  PseudoTerminal terminal_;
};

std::vector<BenchFile> benches() {
  std::vector<BenchFile> out;
  for (const auto& entry : std::filesystem::directory_iterator(FORCEGATE_SOURCE_DIR "/rigs")) {
    if (entry.path().extension() != ".toml") continue;
    auto bench = read_bench(entry.path());
    EXPECT_TRUE(bench) << bench.error().to_text();
    if (bench) out.push_back(std::move(*bench));
  }
  return out;
}

bool same(const ConfigNode& a, const ConfigNode& b) {
  if (a.kind != b.kind || a.text != b.text || a.number != b.number || a.boolean != b.boolean ||
      a.names != b.names || a.items.size() != b.items.size())
    return false;
  for (std::size_t i = 0; i < a.items.size(); ++i)
    if (!same(a.items[i], b.items[i])) return false;
  return true;
}

/// Different tables of delivered benches that use an adapter, with short waits.
std::vector<ConfigNode> tables_of(const std::string& device, const std::string& adapter) {
  std::vector<ConfigNode> out;
  for (const BenchFile& b : benches()) {
    const std::string& own = device == "motor"       ? b.motor_adapter
                             : device == "reference" ? b.reference_adapter
                                                     : b.board_adapter;
    if (own != adapter) continue;
    ConfigNode table = b.table(device.c_str());
    for (std::size_t i = 0; i < table.names.size(); ++i)
      if (table.names[i].ends_with("_timeout_ms") || table.names[i] == "worst_reply_ms")
        table.items[i].integer = 20, table.items[i].number = 20.0;
    if (std::none_of(out.begin(), out.end(), [&](const ConfigNode& t) { return same(t, table); }))
      out.push_back(std::move(table));
  }
  return out;
}

template <class T>
void examine(const std::string& device) {
  for (const DeviceKind<T>& kind : Registry<DeviceKind<T>>::instance().all()) {
    SCOPED_TRACE(device + " " + kind.name);
    EXPECT_FALSE(kind.doc.empty());
    const auto tables = tables_of(device, kind.name);
    EXPECT_FALSE(tables.empty()) << "no bench in rigs/ shows how this adapter is used";
    for (const ConfigNode& table : tables) {
      BadWorld world(LineKind::silent);
      const auto sound = kind.make(table, world);
      EXPECT_TRUE(sound) << sound.error().to_text();
      ConfigNode wrong = table;
      wrong.names.push_back("no_such_key");
      wrong.items.push_back(ConfigNode{});
      wrong.items.back().where = "bench.toml:99:1";
      const auto refused = kind.make(wrong, world);
      ASSERT_FALSE(refused);
      EXPECT_EQ(refused.error().code, ErrorCode::config);
      EXPECT_EQ(refused.error().where, "bench.toml:99:1");
      for (const LineKind line : {LineKind::dead, LineKind::silent, LineKind::garbage, LineKind::cut}) {
        BadWorld bad(line);
        auto made = kind.make(table, bad);
        ASSERT_TRUE(made);
        const auto opened = (*made)->open();
        ASSERT_FALSE(opened) << "a line that is " << name_of(line) << " opens like a sound one";
        EXPECT_FALSE(opened.error().text.empty());
        if (line != LineKind::dead) {
          EXPECT_TRUE(opened.error().where.starts_with(device)) << opened.error().to_text();
        }
        (*made)->close();
        (*made)->close();
      }
    }
  }
}

TEST(Adapters, MotorsFailCleanlyOnBadLines) { examine<MotorDrive>("motor"); }
TEST(Adapters, ReferencesFailCleanlyOnBadLines) { examine<ReferenceSensor>("reference"); }
TEST(Adapters, BoardsFailCleanlyOnBadLines) { examine<SensorBoard>("board"); }

TEST(Adapters, NoMotorMovesBeforeItIsArmedOrOpened) {
  for (const MotorKind& kind : Registry<MotorKind>::instance().all())
    for (const ConfigNode& table : tables_of("motor", kind.name)) {
      BadWorld world(LineKind::silent);
      auto motor = kind.make(table, world);
      ASSERT_TRUE(motor);
      const auto moved = (*motor)->command_velocity(1.0);
      ASSERT_FALSE(moved) << kind.name;
      EXPECT_EQ(moved.error().code, ErrorCode::safety);
      EXPECT_FALSE((*motor)->read());
      EXPECT_GT((*motor)->drive_timeout_s(), 0.0);
    }
}

}  // namespace
}  // namespace forcegate
