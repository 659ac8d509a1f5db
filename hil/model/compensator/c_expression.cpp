#include "hil/model/compensator/c_expression.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <vector>

namespace forcegate {
namespace {

// Recursive descent with muParser's priorities: ?: < || < && < comparison < + - < * / < ^ (right) < unary minus.
class Reader {
 public:
  Reader(std::string_view text, const std::string& where, const std::map<std::string, std::string>& names)
      : text_(text), where_(where), names_(names) {}

  Result<CExpression> read() {
    std::string out = choice();
    skip();
    if (!error_ && at_ < text_.size()) complain(fmt::format("'{}' is not expected here", text_[at_]));
    if (error_) return Unexpected(*error_);
    result_.text = std::move(out);
    return std::move(result_);
  }

 private:
  void complain(
      std::string text,
      std::string hint = "known: + - * / ^ ( ) comparisons && || ?: exp ln sqrt abs min max sign tanh") {
    if (!error_)
      error_ = Error{ErrorCode::config, std::move(text),
                     fmt::format("{}: \"{}\" at {}", where_, text_, at_ + 1), std::move(hint)};
    at_ = text_.size();
  }
  void skip() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
  }
  bool take(std::string_view token) {
    skip();
    if (text_.substr(at_, token.size()) != token) return false;
    at_ += token.size();
    return true;
  }
  std::string count(std::string text) {
    ++result_.operations;
    return text;
  }

  // A sum, product or quotient.
  std::string of_two(const std::string& a, const char* op, const std::string& b) {
    std::string out = count(fmt::format("({} {} {})", a, op, b));
    return not_negative_.count(a) > 0 && not_negative_.count(b) > 0 ? never_negative(out) : out;
  }

  std::string choice() {
    std::string test = disjunction();
    if (!take("?")) return test;
    const std::string yes = choice();
    if (!take(":")) complain("':' is missing");
    const std::string no = choice();
    return count(fmt::format("({} != 0.0f ? {} : {})", test, yes, no));
  }
  std::string disjunction() {
    std::string out = conjunction();
    while (take("||"))
      out = count(fmt::format("(({} != 0.0f || {} != 0.0f) ? 1.0f : 0.0f)", out, conjunction()));
    return out;
  }
  std::string conjunction() {
    std::string out = comparison();
    while (take("&&"))
      out = count(fmt::format("(({} != 0.0f && {} != 0.0f) ? 1.0f : 0.0f)", out, comparison()));
    return out;
  }
  std::string comparison() {
    std::string out = sum();
    for (const char* op : {"<=", ">=", "!=", "==", "<", ">"})
      if (take(op)) return count(fmt::format("({} {} {} ? 1.0f : 0.0f)", out, op, sum()));
    return out;
  }
  std::string sum() {
    std::string out = product();
    for (;;) {
      if (take("+")) {
        out = of_two(out, "+", product());
      } else if (take("-")) {
        out = count(fmt::format("({} - {})", out, product()));
      } else {
        return out;
      }
    }
  }
  std::string product() {
    std::string out = unary();
    for (;;) {
      if (take("*")) {
        out = of_two(out, "*", unary());
      } else if (take("/")) {
        out = of_two(out, "/", unary());
      } else {
        return out;
      }
    }
  }
  std::string unary() {
    if (take("-")) return count(fmt::format("(-{})", unary()));
    if (take("+")) return unary();
    return power();
  }
  std::string power() {
    const std::size_t begin = at_;
    const std::string base = primary();
    const std::size_t end = at_;
    if (!take("^")) return base;
    const std::size_t from = at_;
    const std::string exponent = unary();
    if (const auto n = whole_number(text_.substr(from, at_ - from))) return whole_power(base, *n);
    if (!error_ && not_negative_.count(base) == 0) {
      const std::string written(text_.substr(begin, end - begin));
      at_ = from;
      complain("\"" + written + "\" may be negative, and its power is no whole number", "write abs(x)^y or max(x, 0)^y");
      return "";
    }
    result_.functions.insert({"fg_exp", "fg_ln", "fg_pow"});
    result_.operations += 40;
    return never_negative(fmt::format("fg_pow({}, {})", base, exponent));
  }
  std::string whole_power(const std::string& base, int n) {
    constexpr int kInline = 6;
    const int times = std::abs(n);
    std::string out = times == 0 ? c_float(1.0) : base;
    if (times <= kInline) {
      for (int k = 1; k < times; ++k) out = count(fmt::format("({} * {})", out, base));
    } else {
      result_.functions.insert("fg_power");
      result_.operations += 2 * std::bit_width(static_cast<unsigned>(times));
      out = fmt::format("fg_power({}, {})", base, times);
    }
    if (n < 0) out = count(fmt::format("(1.0f / {})", out));
    return n % 2 == 0 ? never_negative(out) : out;
  }
  // Of an exponent as it is written, "2", "(-3)" or "4.0".
  static std::optional<int> whole_number(std::string_view written) {
    constexpr double kLargest = 1000.0;
    const auto strip = [&](std::string_view what) {
      while (!written.empty() && what.find(written.front()) != std::string_view::npos) written.remove_prefix(1);
    };
    strip(" \t(+");
    while (!written.empty() && (written.back() == ')' || written.back() == ' ' || written.back() == '\t')) written.remove_suffix(1);
    double value = 0.0;
    const auto [end, bad] = std::from_chars(written.data(), written.data() + written.size(), value);
    if (bad != std::errc{} || end != written.data() + written.size() || value != std::floor(value) || std::fabs(value) > kLargest)
      return std::nullopt;
    return static_cast<int>(value);
  }
  std::string never_negative(std::string text) {
    not_negative_.insert(text);
    return text;
  }
  std::string primary() {
    skip();
    if (at_ >= text_.size()) return complain("the equation ends too early"), "";
    if (take("(")) {
      std::string out = choice();
      if (!take(")")) complain("')' is missing");
      return out;
    }
    const char c = text_[at_];
    if (std::isdigit(static_cast<unsigned char>(c)) || c == '.') {
      double value = 0.0;
      const auto [end, bad] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
      if (bad != std::errc{}) return complain("this is no number"), "";
      at_ = static_cast<std::size_t>(end - text_.data());
      return never_negative(c_float(value));
    }
    std::size_t end = at_;
    while (end < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[end])) || text_[end] == '_'))
      ++end;
    if (end == at_) return complain(fmt::format("'{}' is not expected here", c)), "";
    const std::string name(text_.substr(at_, end - at_));
    const std::size_t begin = at_;
    at_ = end;
    if (take("(")) return call(name, begin);
    if (name == "_pi") return never_negative(c_float(3.14159265358979323846));
    if (name == "_e") return never_negative(c_float(2.71828182845904523536));
    const auto known = names_.find(name);
    if (known == names_.end()) {
      at_ = begin;
      complain("'" + name + "' is not known to the firmware",
               "known names: F, dF, t, T, the states and the parameters");
      return "";
    }
    return name == "t" ? never_negative(known->second) : known->second;
  }
  std::string call(const std::string& name, std::size_t begin) {
    std::vector<std::string> arguments;
    do arguments.push_back(choice());
    while (take(","));
    if (!take(")")) complain("')' is missing");
    const auto needs = [&](std::size_t n) {
      if (arguments.size() != n) complain(fmt::format("{} takes {} arguments", name, n));
      return arguments.size() == n;
    };
    if (name == "min" || name == "max") {
      if (arguments.empty()) return "";
      std::string out = arguments[0];
      for (std::size_t k = 1; k < arguments.size(); ++k)
        out = count(fmt::format("fg_{}({}, {})", name, out, arguments[k]));
      const auto known = std::ranges::count_if(arguments, [&](const std::string& a) { return not_negative_.count(a) > 0; });
      return known == std::ssize(arguments) || (name == "max" && known > 0) ? never_negative(out) : out;
    }
    if (name == "sign") return needs(1) ? count(fmt::format("fg_sign({})", arguments[0])) : "";
    if (name == "abs") return needs(1) ? never_negative(count(fmt::format("fg_abs({})", arguments[0]))) : "";
    if (name == "exp" || name == "ln" || name == "sqrt" || name == "tanh") {
      result_.functions.insert("fg_" + name);
      if (name == "tanh") result_.functions.insert("fg_exp");
      result_.operations += 25;
      if (!needs(1)) return "";
      const std::string out = fmt::format("fg_{}({})", name, arguments[0]);
      return name == "exp" || name == "sqrt" ? never_negative(out) : out;
    }
    at_ = begin;
    complain("the function " + name + " has no version without libm");
    return "";
  }

  std::string_view text_;
  const std::string& where_;
  const std::map<std::string, std::string>& names_;
  std::size_t at_ = 0;
  CExpression result_;
  std::set<std::string> not_negative_;  // texts of C that are known not to be
  std::optional<Error> error_;
};

}  // namespace

Result<CExpression> c_expression(std::string_view equation, const std::string& where,
                                 const std::map<std::string, std::string>& names) {
  return Reader(equation, where, names).read();
}

std::string c_float(double value) {
  std::string text = fmt::format("{}", static_cast<float>(value));
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text + "f";
}

}  // namespace forcegate
