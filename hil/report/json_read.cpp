#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "hil/base/read_file.h"
#include "hil/base/text.h"
#include "hil/report/result_fields.h"
#include "hil/report/result_json.h"

namespace forcegate {
namespace {

using nlohmann::json;

/// First mistake wins; after it nothing more is read.
struct Failure {
  bool set = false;
  std::string text, where;
};

class Reader {
 public:
  Reader(const json& node, std::string path, Failure* failure)
      : node_(&node), path_(std::move(path)), failure_(failure) {}

  template <class T>
  void operator()(const char* name, T& value) {
    if (const json* child = find(name)) get(*child, place(name), value);
  }
  /// A field that older files of this format do not have.
  template <class T>
  void optional(const char* name, T& value) {
    known_.insert(name);
    if (node_->contains(name)) (*this)(name, value);
  }
  template <class E>
  void choice(const char* name, E& value) {
    const json* child = find(name);
    if (child == nullptr) return;
    const auto words = words_of<E>();
    for (std::size_t at = 0; at < words.size(); ++at) {
      if (child->is_string() && *child == words[at]) {
        value = static_cast<E>(at);
        return;
      }
    }
    mistake(place(name), "is not one of the allowed words");
  }
  void refuse_unknown() {
    for (const auto& item : node_->items())
      if (!known_.contains(item.key()))
        mistake(place(printable_utf8(item.key())), "is not a field of this format");
  }

 private:
  std::string place(const std::string& name) const { return path_.empty() ? name : path_ + "." + name; }
  void mistake(std::string where, std::string text) {
    if (failure_->set) return;
    *failure_ = {true, std::move(text), std::move(where)};
  }
  const json* find(const char* name) {
    known_.insert(name);
    if (failure_->set) return nullptr;
    const auto at = node_->find(name);
    if (at != node_->end()) return &*at;
    mistake(place(name), "is missing");
    return nullptr;
  }
  void get(const json& node, const std::string& where, double& value) {
    if (node.is_number())
      value = node.get<double>();
    else if (node.is_null())
      value = std::numeric_limits<double>::quiet_NaN();
    else if (node == "inf")
      value = std::numeric_limits<double>::infinity();
    else if (node == "-inf")
      value = -std::numeric_limits<double>::infinity();
    else
      mistake(where, "is not a number, null, \"inf\" or \"-inf\"");
  }
  void get(const json& node, const std::string& where, float& value) {
    double wide = 0.0;
    get(node, where, wide);
    value = static_cast<float>(wide);
  }
  template <class I>
  void integer(const json& node, const std::string& where, I& value) {
    if (node.is_number_unsigned() &&
        node.get<std::uint64_t>() <= static_cast<std::uint64_t>(std::numeric_limits<I>::max()))
      value = node.get<I>();
    else if (std::is_signed_v<I> && node.is_number_integer() && !node.is_number_unsigned() &&
             node.get<std::int64_t>() >= static_cast<std::int64_t>(std::numeric_limits<I>::min()))
      value = node.get<I>();
    else
      mistake(where, "is not a whole number in range");
  }
  void get(const json& node, const std::string& where, int& value) { integer(node, where, value); }
  void get(const json& node, const std::string& where, std::uint32_t& value) { integer(node, where, value); }
  void get(const json& node, const std::string& where, std::uint64_t& value) { integer(node, where, value); }
  void get(const json& node, const std::string& where, bool& value) {
    if (node.is_boolean())
      value = node.get<bool>();
    else
      mistake(where, "is not true or false");
  }
  void get(const json& node, const std::string& where, std::string& value) {
    if (node.is_string())
      value = node.get<std::string>();
    else
      mistake(where, "is not a text");
  }
  template <class T>
  void get(const json& node, const std::string& where, std::vector<T>& values) {
    if (!node.is_array()) return mistake(where, "is not a list");
    values.clear();
    values.reserve(node.size());
    for (std::size_t i = 0; i < node.size() && !failure_->set; ++i) {
      T value{};
      if constexpr (std::is_same_v<T, float>) {
        if (node[i].is_number())
          value = node[i].template get<float>();
        else
          get(node[i], where + "[" + std::to_string(i) + "]", value);
      } else {
        get(node[i], where + "[" + std::to_string(i) + "]", value);
      }
      values.push_back(std::move(value));
    }
  }
  void get(const json& node, const std::string& where, std::map<std::string, std::string>& values) {
    if (!node.is_object()) return mistake(where, "is not an object of texts");
    values.clear();
    for (const auto& item : node.items()) get(item.value(), where + "." + item.key(), values[item.key()]);
  }
  template <class T>
  void get(const json& node, const std::string& where, T& value) {
    if (!node.is_object()) return mistake(where, "is not an object");
    Reader inner(node, where, failure_);
    result_fields::walk(inner, value);
    if (!failure_->set) inner.refuse_unknown();
  }

  const json* node_;
  std::string path_;
  Failure* failure_;
  std::set<std::string> known_;
};

}  // namespace

Result<RunResult> result_from_json(std::string_view text, const std::string& name) {
  const json document = json::parse(text, nullptr, false);
  const std::string help = "give a result.json that forcegate gate has written";
  if (document.is_discarded() || !document.is_object())
    return fail(ErrorCode::parse, "not a JSON document of a gate run", name, help);
  const auto format = document.find("format");
  if (format == document.end() || !format->is_number_integer())
    return fail(ErrorCode::parse, "the document has no whole number 'format'", name, help);
  if (*format != kResultFormat)
    return fail(ErrorCode::parse, "result format " + format->dump() + " is not known here", name,
                "this version reads format " + std::to_string(kResultFormat));
  RunResult result;
  Failure failure;
  Reader reader(document, "", &failure);
  result_fields::walk(reader, result);
  if (!failure.set) reader.refuse_unknown();
  if (failure.set) return fail(ErrorCode::parse, failure.where + " " + failure.text, name, help);
  return result;
}

Result<RunResult> read_result(const std::filesystem::path& path) {
  FORCEGATE_TRY(const std::string text, read_file(path));
  return result_from_json(text, path.string());
}

}  // namespace forcegate
