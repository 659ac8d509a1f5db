#include "adapters/process/messages.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "hil/base/text.h"

namespace forcegate::process {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::size_t kRowsMax = 100000;

Json json_of(const ConfigNode& node) {
  switch (node.kind) {
    case ConfigNode::Kind::text: return node.text;
    case ConfigNode::Kind::integer: return node.integer;
    case ConfigNode::Kind::number: return node.number;
    case ConfigNode::Kind::boolean: return node.boolean;
    case ConfigNode::Kind::array: {
      Json list = Json::array();
      for (const ConfigNode& item : node.items) list.push_back(json_of(item));
      return list;
    }
    case ConfigNode::Kind::table: {
      Json object = Json::object();
      for (std::size_t i = 0; i < node.names.size(); ++i) object[node.names[i]] = json_of(node.items[i]);
      return object;
    }
    case ConfigNode::Kind::other: break;
  }
  return nullptr;
}

Unexpected malformed(const std::string& what) {
  return fail(ErrorCode::device, "the adapter's program says " + what);
}

Result<std::vector<double>> row_of(const Json& row) {
  if (!row.is_array() || row.empty() || row.size() > kRowWidth)
    return malformed("a row that is no short list");
  std::vector<double> out;
  for (const Json& value : row) {
    if (!value.is_number() && !value.is_null()) return malformed("a row with something that is no number");
    out.push_back(value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>());
    if (std::isinf(out.back())) return malformed("an infinite number");
  }
  return out;
}

}  // namespace

std::string encode_request(std::uint64_t id, std::string_view verb, double now_s, const Fields& fields) {
  Json request{{"id", id}, {"do", verb}, {"now_s", now_s}};
  for (const auto& [name, value] : fields) {
    if (const auto* node = std::get_if<const ConfigNode*>(&value))
      request[name] = *node != nullptr ? json_of(**node) : Json::object();
    else if (const auto* text = std::get_if<std::string>(&value))
      request[name] = *text;
    else if (const auto* truth = std::get_if<bool>(&value))
      request[name] = *truth;
    else if (const auto* whole = std::get_if<std::int64_t>(&value))
      request[name] = *whole;
    else
      request[name] = std::get<double>(value);
  }
  return request.dump(-1, ' ', true, Json::error_handler_t::replace);
}

Result<Reply> decode_reply(std::string_view line) {
  if (line.size() > kLineMax) return malformed("a line without end");
  const Json document = Json::parse(line, nullptr, false);
  if (!document.is_object() && (line.find("NaN") != std::string_view::npos || line.find("Infinity") != std::string_view::npos))
    return fail(ErrorCode::device, "the adapter's program says NaN or Infinity, which is no JSON: '" + printable_utf8(line.substr(0, 60)) + "'", {},
                "let it write null for a value that is not there");
  if (!document.is_object())
    return malformed("'" + printable_utf8(line.substr(0, 60)) + "' instead of a JSON object");
  const auto id = document.find("id"), ok = document.find("ok");
  if (id == document.end() || !id->is_number_unsigned() || ok == document.end() || !ok->is_boolean())
    return malformed("an object without the number 'id' and the truth value 'ok'");
  Reply reply;
  reply.id = id->get<std::uint64_t>();
  reply.good = ok->get<bool>();
  for (const auto& [name, value] : document.items()) {
    if (name == "id" || name == "ok") continue;
    if (name == "error" || name == "hint") {
      if (!value.is_string()) return malformed("'" + name + "' that is no text");
      (name == "error" ? reply.error : reply.hint) = printable_utf8(value.get_ref<const std::string&>());
    } else if (name == "rows") {
      if (!value.is_array() || value.size() > kRowsMax) return malformed("'rows' that is no list");
      for (const Json& row : value) {
        FORCEGATE_TRY(auto numbers, row_of(row));
        reply.rows.push_back(std::move(numbers));
      }
    } else if (value.is_string()) {
      reply.text[printable_utf8(name)] = printable_utf8(value.get_ref<const std::string&>());
    } else if (value.is_number() || value.is_boolean()) {
      const double number = value.is_boolean() ? (value.get<bool>() ? 1.0 : 0.0) : value.get<double>();
      if (!std::isfinite(number)) return malformed("an infinite number");
      reply.number[printable_utf8(name)] = number;
    } else if (!value.is_null()) {
      return malformed("'" + printable_utf8(name) + "' of a kind that nobody asked for");
    }
  }
  if (!reply.good && reply.error.empty()) return malformed("'ok' false without 'error'");
  return reply;
}

}  // namespace forcegate::process
