#include "hil/rig/config.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include "hil/base/read_file.h"
#include "hil/base/text.h"

namespace forcegate {
namespace {

constexpr std::size_t kLargestFile = 1 << 20;
constexpr int kDeepest = 16;

std::string position(const std::string& name, const toml::source_region& at) {
  return fmt::format("{}:{}:{}", name, static_cast<unsigned>(at.begin.line),
                     static_cast<unsigned>(at.begin.column));
}

Result<ConfigNode> convert(const toml::node& from, const std::string& name, int depth) {
  ConfigNode to;
  to.where = position(name, from.source());
  to.file = name;
  if (depth > kDeepest) return fail(ErrorCode::config, "values are nested too deeply", to.where);
  if (const toml::table* table = from.as_table()) {
    to.kind = ConfigNode::Kind::table;
    for (const auto& [key, value] : *table) {
      FORCEGATE_TRY(ConfigNode item, convert(value, name, depth + 1));
      if (key.source().begin.line > 0) item.where = position(name, key.source());
      to.names.push_back(printable_utf8(key.str()));
      to.items.push_back(std::move(item));
    }
  } else if (const toml::array* array = from.as_array()) {
    to.kind = ConfigNode::Kind::array;
    for (const toml::node& value : *array) {
      FORCEGATE_TRY(ConfigNode item, convert(value, name, depth + 1));
      to.items.push_back(std::move(item));
    }
  } else if (const auto* text = from.as_string()) {
    to.kind = ConfigNode::Kind::text;
    to.text = printable_utf8(text->get());
  } else if (const auto* integer = from.as_integer()) {
    to.kind = ConfigNode::Kind::integer;
    to.integer = integer->get();
    to.number = static_cast<double>(to.integer);
  } else if (const auto* number = from.as_floating_point()) {
    to.kind = ConfigNode::Kind::number;
    to.number = number->get();
  } else if (const auto* boolean = from.as_boolean()) {
    to.kind = ConfigNode::Kind::boolean;
    to.boolean = boolean->get();
  }
  return to;
}

}  // namespace

Result<ConfigNode> parse_config(std::string_view text, const std::string& name) {
  if (text.size() > kLargestFile) return fail(ErrorCode::config, "the file is larger than 1 MB", name);
  // Debian's TOML library is built to throw; the exception ends here.
  try {
    return convert(toml::parse(text, name), name, 0);
  } catch (const toml::parse_error& e) {
    return fail(ErrorCode::config, "not valid TOML: " + printable_utf8(e.description()),
                position(name, e.source()), "see https://toml.io for the syntax");
  }
}

Result<ConfigNode> read_config(const std::filesystem::path& path) {
  FORCEGATE_TRY(const std::string text, read_file(path));
  return parse_config(text, path.string());
}

}  // namespace forcegate
