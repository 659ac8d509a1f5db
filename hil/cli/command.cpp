#include "hil/cli/command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>

#include "hil/base/text.h"
#include "hil/cli/interrupt.h"

namespace forcegate {
namespace {

template <class T>
bool parse_whole(std::string_view text, T& value, int base = 10) {
  if (text.starts_with('+')) text.remove_prefix(1);
  std::from_chars_result r{};
  if constexpr (std::is_floating_point_v<T>)
    r = std::from_chars(text.data(), text.data() + text.size(), value);
  else
    r = std::from_chars(text.data(), text.data() + text.size(), value, base);
  return !text.empty() && r.ec == std::errc{} && r.ptr == text.data() + text.size();
}

bool is_option(const Command& command, std::string_view name) {
  return std::any_of(command.options.begin(), command.options.end(),
                     [&](const Option& o) { return o.name == name; });
}

std::string shown(const Command& command, std::string_view name) {
  return is_option(command, name) ? "--" + std::string(name) : std::string(name);
}

Unexpected not_a_number(const Command& command, std::string_view name, std::string_view text,
                        std::string_view kind, const std::string& range) {
  return fail(ErrorCode::usage, fmt::format("{} wants {}, not \"{}\"", shown(command, name), kind, text),
              "forcegate " + command.name, "give " + range);
}

// A number it is, but none that the option takes.
template <class T>
Unexpected outside(const Command& command, std::string_view name, std::string_view text, T low, T high) {
  return fail(ErrorCode::usage, fmt::format("{} is {}, outside of {} to {}", shown(command, name), text, shortest(low), shortest(high)),
              "forcegate " + command.name, fmt::format("give a number from {} to {}", shortest(low), shortest(high)));
}

}  // namespace

std::vector<Option> joined(std::initializer_list<std::vector<Option>> lists) {
  std::vector<Option> all;
  for (const auto& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

int exit_code_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::usage:
    case ErrorCode::config:
    case ErrorCode::parse:
    case ErrorCode::io: return kExitUsage;
    case ErrorCode::device:
    case ErrorCode::timeout: return kExitRigFault;
    case ErrorCode::firmware: return kExitReject;
    case ErrorCode::safety: return kExitSafetyStop;
    case ErrorCode::cancelled: return kExitInterrupted;
    case ErrorCode::internal: return kExitInternal;
  }
  return kExitInternal;
}

std::string Invocation::command_line_without(std::string_view option) const {
  std::string line = "forcegate";
  for (const LineWord& word : words_)
    if (!word.quoted.empty() && (option.empty() || word.option != option)) line += " " + word.quoted;
  return line;
}

const std::string* Invocation::fallback_of(std::string_view name) const {
  for (const Option& o : command_->options)
    if (o.name == name) return &o.fallback;
  for (const Positional& p : command_->positionals) {
    static const std::string kNone;
    if (p.name == name) return &kNone;
  }
  return nullptr;
}

bool Invocation::given(std::string_view name) const {
  assert(fallback_of(name) != nullptr && "asked for a name that the row does not have");
  return values_.find(name) != values_.end();
}

std::string Invocation::text(std::string_view name) const {
  const std::string* fallback = fallback_of(name);
  assert(fallback != nullptr && "asked for a name that the row does not have");
  if (const auto it = values_.find(name); it != values_.end()) return it->second.back();
  return fallback != nullptr ? *fallback : std::string();
}

std::vector<std::string> Invocation::texts(std::string_view name) const {
  const std::string* fallback = fallback_of(name);
  assert(fallback != nullptr && "asked for a name that the row does not have");
  if (const auto it = values_.find(name); it != values_.end()) return it->second;
  if (fallback == nullptr || fallback->empty()) return {};
  return {*fallback};
}

Result<double> Invocation::number(std::string_view name, double low, double high) const {
  const std::string written = text(name);
  double value = 0.0;
  const bool is_number = parse_whole(written, value) && std::isfinite(value);
  if (is_number && (value < low || value > high)) return outside(*command_, name, written, low, high);
  if (!is_number)
    return not_a_number(*command_, name, written, "a number",
                        fmt::format("a decimal number from {} to {}", shortest(low), shortest(high)));
  return value;
}

Result<std::int64_t> Invocation::integer(std::string_view name, std::int64_t low, std::int64_t high) const {
  const std::string written = text(name);
  std::int64_t value = 0;
  const bool is_number = parse_whole(written, value);
  if (is_number && (value < low || value > high)) return outside(*command_, name, written, static_cast<double>(low), static_cast<double>(high));
  if (!is_number)
    return not_a_number(*command_, name, written, "a whole number",
                        fmt::format("a whole number from {} to {}", low, high));
  return value;
}

Result<std::uint64_t> Invocation::seed(std::string_view name) const {
  const std::string written = text(name);
  const bool hexadecimal = written.starts_with("0x") || written.starts_with("0X");
  std::uint64_t value = 0;
  if (!parse_whole(std::string_view(written).substr(hexadecimal ? 2 : 0), value, hexadecimal ? 16 : 10))
    return not_a_number(*command_, name, written, "a seed",
                        "a whole number from 0 to 2^64 - 1, decimal or 0x...");
  return value;
}

const std::atomic<bool>& Invocation::interrupt_flag() const { return catch_interrupt(); }

}  // namespace forcegate
