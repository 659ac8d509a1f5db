#include "hil/base/config_node.h"

#include <fmt/format.h>

#include <algorithm>

#include "hil/base/read_number.h"
#include "hil/base/text.h"

namespace forcegate {
namespace {

std::string_view name_of(ConfigNode::Kind kind) {
  switch (kind) {
    case ConfigNode::Kind::table: return "a table";
    case ConfigNode::Kind::array: return "a list";
    case ConfigNode::Kind::text: return "a text in quotes";
    case ConfigNode::Kind::number: return "a number";
    case ConfigNode::Kind::integer: return "a whole number";
    case ConfigNode::Kind::boolean: return "true or false";
    case ConfigNode::Kind::other: return "a date or time";
  }
  return "something else";
}

// How a value of that kind is written. Of a number in quotes the quotes alone are wrong.
std::string example_of(std::string_view name, ConfigNode::Kind kind, const ConfigNode& given) {
  const bool quoted = given.kind == ConfigNode::Kind::text && read_number(given.text).has_value();
  switch (kind) {
    case ConfigNode::Kind::number: return quoted ? fmt::format("leave the quotes out: {} = {}", name, given.text) : fmt::format("write {} = 0.5", name);
    case ConfigNode::Kind::integer: return fmt::format("write {} = 1", name);
    case ConfigNode::Kind::text: return fmt::format("write {} = \"...\"", name);
    case ConfigNode::Kind::array: return fmt::format("write {} = [...]", name);
    case ConfigNode::Kind::table: return fmt::format("write [{}] and its keys below it", name);
    case ConfigNode::Kind::boolean: return fmt::format("write {} = true, or false", name);
    case ConfigNode::Kind::other: break;
  }
  return {};
}

}  // namespace

std::string_view ConfigNode::kind_name() const { return name_of(kind); }

const ConfigNode* ConfigNode::find(std::string_view name) const {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) return &items[i];
  return nullptr;
}

ConfigReader::ConfigReader(const ConfigNode& table, std::string what, std::string guide)
    : table_(table), what_(std::move(what)), guide_(std::move(guide)) {}

void ConfigReader::complain(const ConfigNode& at, std::string text, std::string hint) {
  if (!good_) return;
  good_ = false;
  error_ = {ErrorCode::config, std::move(text), at.where, std::move(hint)};
}

const ConfigNode* ConfigReader::any(std::string_view name) {
  known_.emplace_back(name);
  return table_.find(name);
}

const ConfigNode* ConfigReader::take(std::string_view name, ConfigNode::Kind kind, Need need) {
  const ConfigNode* node = any(name);
  if (!good_) return nullptr;
  if (node == nullptr) {
    // A misspelt key explains a missing one better than "missing".
    if (need == required) {
      for (std::size_t i = 0; i < table_.names.size(); ++i) {
        const std::vector<std::string> wanted{std::string(name)};
        if (!nearest_name(table_.names[i], wanted).empty()) {
          complain(table_.items[i], fmt::format("unknown key '{}' in {}", table_.names[i], what_),
                   fmt::format("did you mean '{}'?", name));
          return nullptr;
        }
      }
      complain(table_, fmt::format("{} needs the key '{}'", what_, name), guide_ + " lists the keys");
    }
    return nullptr;
  }
  const bool number_from_integer =
      kind == ConfigNode::Kind::number && node->kind == ConfigNode::Kind::integer;
  if (node->kind != kind && !number_from_integer) {
    complain(*node,
             fmt::format("'{}' in {} must be {}, not {}", name, what_, name_of(kind), node->kind_name()), example_of(name, kind, *node));
    return nullptr;
  }
  return node;
}

bool ConfigReader::text(std::string_view name, std::string& out, Need need) {
  const ConfigNode* node = take(name, ConfigNode::Kind::text, need);
  if (node != nullptr) out = node->text;
  return node != nullptr;
}

bool ConfigReader::number(std::string_view name, double& out, double minimum, double maximum, Need need) {
  const ConfigNode* node = take(name, ConfigNode::Kind::number, need);
  if (node == nullptr) return false;
  if (!(node->number >= minimum && node->number <= maximum)) {  // NaN is out of range
    complain(*node, fmt::format("'{}' in {} = {} is out of range", name, what_, shortest(node->number)),
             fmt::format("give a value from {} to {}", shortest(minimum), shortest(maximum)));
    return false;
  }
  out = node->number;
  return true;
}

bool ConfigReader::integer(std::string_view name, std::int64_t& out, std::int64_t minimum,
                           std::int64_t maximum, Need need) {
  const ConfigNode* node = take(name, ConfigNode::Kind::integer, need);
  if (node == nullptr) return false;
  if (node->integer < minimum || node->integer > maximum) {
    complain(*node, fmt::format("'{}' in {} = {} is out of range", name, what_, node->integer),
             fmt::format("give a whole number from {} to {}", minimum, maximum));
    return false;
  }
  out = node->integer;
  return true;
}

bool ConfigReader::count(std::string_view name, std::size_t& out, std::int64_t minimum, std::int64_t maximum,
                         Need need) {
  std::int64_t value = 0;
  if (!integer(name, value, minimum, maximum, need)) return false;
  out = static_cast<std::size_t>(value);
  return true;
}

bool ConfigReader::boolean(std::string_view name, bool& out) {
  const ConfigNode* node = take(name, ConfigNode::Kind::boolean, optional);
  if (node != nullptr) out = node->boolean;
  return node != nullptr;
}

bool ConfigReader::texts(std::string_view name, std::vector<std::string>& out, Need need) {
  const ConfigNode* node = take(name, ConfigNode::Kind::array, need);
  if (node == nullptr) return false;
  std::vector<std::string> read;
  for (const ConfigNode& item : node->items) {
    if (item.kind != ConfigNode::Kind::text) {
      complain(item,
               fmt::format("'{}' in {} must hold texts in quotes, not {}", name, what_, item.kind_name()));
      return false;
    }
    read.push_back(item.text);
  }
  out = std::move(read);
  return true;
}

bool ConfigReader::choice(std::string_view name, std::string& out, const std::vector<std::string>& choices,
                          Need need) {
  const ConfigNode* node = take(name, ConfigNode::Kind::text, need);
  if (node == nullptr) return false;
  if (std::find(choices.begin(), choices.end(), node->text) == choices.end()) {
    const std::string near = nearest_name(node->text, choices);
    complain(*node, fmt::format("'{}' in {} cannot be '{}'", name, what_, node->text),
             near.empty() ? "choose one of: " + join(choices, ", ") : "did you mean '" + near + "'?");
    return false;
  }
  out = node->text;
  return true;
}

const ConfigNode* ConfigReader::table(std::string_view name, Need need) {
  return take(name, ConfigNode::Kind::table, need);
}

const ConfigNode* ConfigReader::array(std::string_view name, Need need) {
  return take(name, ConfigNode::Kind::array, need);
}

Result<void> ConfigReader::finish() {
  for (std::size_t i = 0; good_ && i < table_.names.size(); ++i) {
    const std::string& name = table_.names[i];
    if (std::find(known_.begin(), known_.end(), name) != known_.end()) continue;
    const std::string near = nearest_name(name, known_);
    complain(table_.items[i], fmt::format("unknown key '{}' in {}", name, what_),
             near.empty() ? "known keys: " + join(known_, ", ") : "did you mean '" + near + "'?");
  }
  if (!good_) return Unexpected(error_);
  return {};
}

}  // namespace forcegate
