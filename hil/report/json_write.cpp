#include <charconv>
#include <cmath>

#include "hil/base/text.h"
#include "hil/report/result_fields.h"
#include "hil/report/result_json.h"

namespace forcegate {
namespace {

class Writer {
 public:
  template <class T>
  void operator()(const char* name, T& value) {
    key(name);
    put(value);
  }
  /// Left out where there is nothing to say, as in files of before the field.
  template <class T>
  void optional(const char* name, T& value) {
    if (value != T{}) (*this)(name, value);
  }
  template <class E>
  void choice(const char* name, E& value) {
    key(name);
    text(to_string(value));
  }
  template <class T>
  void document(T& value) {
    put(value);
    out_ += '\n';
  }
  std::string take() { return std::move(out_); }

 private:
  void new_line() {
    out_ += '\n';
    out_.append(2 * depth_, ' ');
  }
  void key(const char* name) {
    if (!first_) out_ += ',';
    first_ = false;
    new_line();
    out_ += '"';
    out_ += name;
    out_ += "\": ";
  }
  template <class T>
  void number(T value) {
    char buffer[48];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
    out_.append(buffer, end);
  }
  template <class T>
  void real(T value) {
    if (std::isnan(value))
      out_ += "null";
    else if (std::isinf(value))
      out_ += value > 0 ? "\"inf\"" : "\"-inf\"";
    else
      number(value == 0 ? T{0} : value);
  }
  void put(double value) { real(value); }
  void put(float value) { real(value); }
  void put(int value) { number(value); }
  void put(std::uint32_t value) { number(value); }
  void put(std::uint64_t value) { number(value); }
  void put(bool value) { out_ += value ? "true" : "false"; }
  void put(std::string& value) { text(value); }
  void put(const std::string& value) { text(value); }
  void text(std::string_view value) {
    static const char kHex[] = "0123456789abcdef";
    out_ += '"';
    for (const char c : printable_utf8(value)) {
      if (c == '"' || c == '\\')
        (out_ += '\\') += c;
      else if (c == '\n')
        out_ += "\\n";
      else if (c == '\t')
        out_ += "\\t";
      else if (static_cast<unsigned char>(c) < 0x20)
        ((out_ += "\\u00") += kHex[c >> 4]) += kHex[c & 15];
      else
        out_ += c;
    }
    out_ += '"';
  }
  void put(std::vector<float>& values) {
    out_ += '[';
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (i > 0) out_ += ',';
      put(values[i]);
    }
    out_ += ']';
  }
  template <class T>
  void put(std::vector<T>& values) {
    out_ += '[';
    ++depth_;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (i > 0) out_ += ',';
      new_line();
      put(values[i]);
    }
    --depth_;
    if (!values.empty()) new_line();
    out_ += ']';
  }
  void put(std::map<std::string, std::string>& values) {
    out_ += '{';
    ++depth_;
    bool first = true;
    for (const auto& [name, value] : values) {
      if (!first) out_ += ',';
      first = false;
      new_line();
      text(name);
      out_ += ": ";
      put(value);
    }
    --depth_;
    if (!values.empty()) new_line();
    out_ += '}';
  }
  template <class T>
  void put(T& value) {
    out_ += '{';
    ++depth_;
    first_ = true;
    result_fields::walk(*this, value);
    first_ = false;
    --depth_;
    new_line();
    out_ += '}';
  }

  std::string out_;
  std::size_t depth_ = 0;
  bool first_ = true;
};

}  // namespace

std::string to_json(const RunResult& result) {
  RunResult copy = result;  // the shared field list wants references it may also write to
  Writer writer;
  writer.document(copy);
  return writer.take();
}

}  // namespace forcegate
