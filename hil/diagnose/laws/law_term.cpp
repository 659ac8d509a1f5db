// Terms of a law in words.

#include "hil/base/text.h"
#include "hil/diagnose/laws/parameter_level.h"

namespace forcegate {

std::string to_string(const LawTerm& t) {
  switch (t.form) {
    case TermForm::linear: return t.covariate;
    case TermForm::logarithm: return "ln " + t.covariate;
    case TermForm::reciprocal: return "1/" + t.covariate;
    case TermForm::square: return t.covariate + "^2";
    case TermForm::product: return t.covariate + " " + t.other;
  }
  return t.covariate;
}

Result<LawTerm> parse_term(std::string_view text) {
  const std::string_view t = trim(text);
  const auto rest = [&](std::size_t n) { return std::string(trim(t.substr(n))); };
  LawTerm out;
  if (t.starts_with("ln ")) {
    out = {TermForm::logarithm, rest(3), {}};
  } else if (t.starts_with("1/")) {
    out = {TermForm::reciprocal, rest(2), {}};
  } else if (t.ends_with("^2")) {
    out = {TermForm::square, std::string(trim(t.substr(0, t.size() - 2))), {}};
  } else if (const std::size_t at = t.find_first_of("* "); at != std::string_view::npos) {
    out = {TermForm::product, std::string(trim(t.substr(0, at))), rest(at + 1)};
    if (out.other == out.covariate) out = {TermForm::square, out.covariate, {}};
  } else {
    out = {TermForm::linear, std::string(t), {}};
  }
  const auto plain = [](const std::string& name) {
    return !name.empty() && name.find_first_of("*/^ ") == std::string::npos;
  };
  if (!plain(out.covariate) || (out.form == TermForm::product && !plain(out.other)))
    return fail(ErrorCode::usage, "\"" + printable_utf8(text) + "\" is no term of a law", {},
                "write f, \"ln f\", 1/f, f^2 or f*m");
  return out;
}

}  // namespace forcegate
