#include "adapters/process/adapter_process.h"

#include <fmt/format.h>

#include <chrono>
#include <optional>

#include "hil/base/text.h"

namespace forcegate::process {
namespace {

constexpr double kFarewell_s = 0.5;
constexpr double kLook_s = 0.05;
constexpr std::string_view kOpen = "open";

std::filesystem::path folder_of_bench(const ConfigNode& table) {
  return std::filesystem::absolute(table.file).parent_path();
}

}  // namespace

void read_process_options(ConfigReader& in, const ConfigNode& table, ProcessOptions& out) {
  std::string folder = ".";
  std::int64_t reply_ms = 1000, start_ms = 5000;
  in.any("adapter");
  out.options.kind = ConfigNode::Kind::table;
  if (in.texts("command", out.command, ConfigReader::required) &&
      (out.command.empty() || out.command.front().empty()))
    in.complain(*in.any("command"), "'command' names no program",
                "for example command = [\"/usr/bin/python3\", \"-m\", \"forcegate_adapter\", \"ati\"]");
  in.text("folder", folder);
  in.text("port", out.port);
  if (const ConfigNode* options = in.table("options")) out.options = *options;
  in.integer("reply_timeout_ms", reply_ms, 10, 60000);
  in.integer("start_timeout_ms", start_ms, 10, 60000);
  out.bench_folder = folder_of_bench(table);
  out.folder = out.bench_folder / folder;
  out.reply_timeout_s = static_cast<double>(reply_ms) * 1e-3;
  out.start_timeout_s = static_cast<double>(start_ms) * 1e-3;
}

std::string AdapterProcess::where() const { return options_.device + ": " + join(options_.command, " "); }

Unexpected AdapterProcess::bad(const std::string& what) const {
  return fail(ErrorCode::device, what, where(),
              "docs/adapters.md says what an adapter's program has to answer");
}

Unexpected AdapterProcess::gone() {
  child_.finish(kFarewell_s);
  const std::string how = child_.ended().value_or("no end");
  const std::string last = log_folder_ ? last_line(log_folder_->path() / "log") : "";
  end();
  return fail(ErrorCode::device,
              "the adapter's program ended (" + how + ")" + (last.empty() ? "" : ": " + last), where(),
              "run its command by hand to see what it says");
}

Result<DeviceIdentity> AdapterProcess::open(bool exclusive) {
  end();
  Fields fields{{"exclusive", exclusive}, {"options", &options_.options}};
  if (!options_.port.empty()) {
    auto path = world_.serial_path(options_.port);
    if (!path)
      return fail(path.error().code, path.error().text, options_.device + ": " + path.error().where,
                  path.error().hint);
    fields.emplace_back("port", *path);
  }
  std::vector<std::string> argv = options_.command;
  const auto program = find_program(argv.front(), options_.bench_folder);
  if (!program)
    return fail(ErrorCode::config, "the program of the adapter is not installed: " + argv.front(), where(),
                "install it, or name its file: with '/' it is relative to the bench file, " + options_.bench_folder.string());
  argv.front() = program->string();
  std::error_code ignored;
  if (!std::filesystem::is_directory(options_.folder, ignored))
    return fail(ErrorCode::config,
                "the folder of the adapter's program does not exist: " + options_.folder.string(), where(),
                "make it, or correct 'folder': it is relative to the bench file");
  if (!log_folder_) {
    FORCEGATE_TRY(PrivateFolder made, PrivateFolder::make());
    log_folder_.emplace(std::move(made));
  }
  FORCEGATE_TRY(line_, child_.start_connected(argv, options_.folder, log_folder_->path() / "log"));
  if (started_before_) ++restarts_;
  started_before_ = true;
  pending_.clear();
  clock_.clear();
  FORCEGATE_TRY(const Reply reply, exchange(kOpen, fields, options_.start_timeout_s));
  const auto text = [&](const char* key) {
    const auto at = reply.text.find(key);
    return at != reply.text.end() ? at->second : std::string();
  };
  if (text("model").empty()) return bad("the adapter's program does not say which 'model' it has opened");
  return DeviceIdentity{text("model"), text("serial"), text("firmware"), text("calibration")};
}

void AdapterProcess::end() noexcept {
  const bool ran = line_ != nullptr;
  line_.reset();
  if (ran) child_.finish(kFarewell_s);
}

Result<Reply> AdapterProcess::ask(std::string_view verb, const Fields& fields) {
  if (!line_) return fail(ErrorCode::device, "the adapter's program does not run", where());
  return exchange(verb, fields, options_.reply_timeout_s);
}

Result<Reply> AdapterProcess::exchange(std::string_view verb, const Fields& fields, double timeout_s) {
  using Clock = std::chrono::steady_clock;
  const std::uint64_t id = next_id_++;
  const double sent_s = world_.now_s();
  const std::string line = encode_request(id, verb, sent_s, fields) + "\n";
  const auto end = Clock::now() + std::chrono::duration<double>(timeout_s);
  if (auto sent = line_->write({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()}, timeout_s);
      !sent) {
    if (sent.error().code != ErrorCode::timeout) return gone();
    return fail(ErrorCode::timeout, "the adapter's program does not read its input", where());
  }
  std::optional<std::uint64_t> other;  // id of an answer to nothing that was asked
  for (;;) {
    if (const std::size_t at = pending_.find('\n'); at != std::string::npos) {
      auto reply = decode_reply(std::string_view(pending_).substr(0, at));
      pending_.erase(0, at + 1);
      if (!reply) return bad(reply.error().text);
      if (reply->id != id) {
        if (reply->id > id) other = reply->id;
        ++stale_;
        continue;
      }
      if (const auto clock = reply->number.find("clock_s"); clock != reply->number.end())
        clock_.add(sent_s, clock->second, world_.now_s());
      if (!reply->good) return fail(ErrorCode::device, reply->error, where(), reply->hint);
      return reply;
    }
    if (pending_.size() > kLineMax) {
      pending_.clear();
      return bad("the adapter's program says a line without end");
    }
    if (Clock::now() >= end && other)
      return fail(ErrorCode::timeout, fmt::format("the adapter's program answers '{}' under the id {}, and it was asked under {}", verb, *other, id), where(),
                  "an answer repeats the id of its request (docs/adapters.md)");
    if (Clock::now() >= end)
      return fail(ErrorCode::timeout, "the adapter's program does not answer '" + std::string(verb) + "'",
                  where(), fmt::format("look whether its instrument is on, or raise {} ({:.0f})", verb == kOpen ? "start_timeout_ms" : "reply_timeout_ms", 1e3 * timeout_s));
    std::uint8_t bytes[4096];
    const double left_s = std::chrono::duration<double>(end - Clock::now()).count();
    const auto n = line_->read(bytes, std::max(0.001, std::min(kLook_s, left_s)));
    if (!n) return gone();
    pending_.append(reinterpret_cast<const char*>(bytes), *n);
  }
}

}  // namespace forcegate::process
