#include "hil/app/diagnose/laws.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "hil/base/some_of.h"
#include "hil/base/text.h"
#include "hil/base/units.h"
#include "hil/trace/csv_table.h"

namespace forcegate {
namespace {

std::string plain_name(const std::string& header) {
  const auto split_off = split_unit_suffix(header);
  return split_off ? split_off->name : header;
}

const CsvColumn* find_column(const CsvTable& table, const std::string& name) {
  for (const CsvColumn& c : table.columns)
    if (c.header == name || plain_name(c.header) == name) return &c;
  return nullptr;
}

Result<const CsvColumn*> column(const CsvTable& table, const std::string& name, const LawsRequest& request) {
  if (const CsvColumn* found = find_column(table, name)) return found;
  for (const TextColumn& text : table.text_columns)
    if (text.header == name || plain_name(text.header) == name)
      return fail(ErrorCode::usage, "the column '" + printable_utf8(name) + "' holds text: '" + printable_utf8(text.cell) + "'", fmt::format("{}:{}", request.table.string(), text.line),
                  text.hint.empty() ? "give each of its words a number, or a column of 0 and 1" : text.hint);
  std::vector<std::string> names;
  for (const CsvColumn& c : table.columns) names.push_back(plain_name(c.header));
  const std::string near = nearest_name(name, names);
  return fail(ErrorCode::usage, "the table has no column '" + printable_utf8(name) + "'",
              request.table.string(),
              near.empty() ? "it has: " + join(names, ", ") : "did you mean '" + near + "'?");
}

std::string unit_of(const std::string& header) {
  const auto split_off = split_unit_suffix(header);
  return split_off ? split_off->unit.symbol : "";
}

/// Which rows have every value that is asked for.
class SoundRows {
 public:
  explicit SoundRows(std::size_t rows) : kept_(rows, 1) {}

  void ask(const std::string& name, const std::vector<double>& value) {
    for (std::size_t r = 0; r < kept_.size(); ++r)
      if (!std::isfinite(value[r]) && kept_[r] != 0) kept_[r] = 0, gaps_.emplace_back(r, name);
  }
  Result<void> check(const CsvTable& table, const LawsRequest& request) const {
    if (4 * gaps_.size() <= kept_.size()) return {};
    const auto first = std::ranges::min_element(gaps_);
    return fail(ErrorCode::usage, fmt::format("{} of {} rows have a gap: the first one in {}", gaps_.size(), kept_.size(), first->second),
                fmt::format("{}:{}", request.table.string(), table.line_of_row(first->first)), "fill the cells, or name with --over the columns that count");
  }
  bool has(std::size_t row) const { return kept_[row] != 0; }
  std::vector<double> of(const std::vector<double>& value) const {
    std::vector<double> out;
    for (std::size_t r = 0; r < value.size(); ++r)
      if (kept_[r] != 0) out.push_back(value[r]);
    return out;
  }
  std::vector<std::string> notes(const CsvTable& table) const {
    std::vector<std::string> parts;
    for (const auto& [row, name] : gaps_) parts.push_back(fmt::format("line {} ({})", table.line_of_row(row), name));
    if (parts.empty()) return {};
    return {(parts.size() == 1 ? "a row with a gap is left out: " : "rows with a gap are left out: ") + some_of(parts)};
  }

 private:
  std::vector<char> kept_;
  std::vector<std::pair<std::size_t, std::string>> gaps_;
};

// Rounding of a sum is no scatter between records.
bool is_constant(const std::vector<double>& value) {
  constexpr double kRounding = 1e-12;
  const auto [low, high] = std::ranges::minmax(value);
  return high - low <= kRounding * std::max(std::abs(low), std::abs(high));
}

ParameterAnswer constant_answer(const ParameterQuestion& q, ParameterAnswer answer) {
  answer.added.clear(), answer.ranking.clear();
  answer.law = {{"1", q.scale == ResponseScale::logarithm ? std::log(q.value.front()) : q.scale == ResponseScale::reciprocal ? 1.0 / q.value.front() : q.value.front(), 0.0}};
  answer.loo_constant = answer.loo_before = answer.loo_after = answer.scatter = 0.0;
  answer.sentence = fmt::format("{} is the same in every record, {:.6g}{}: there is nothing to explain", q.name, q.value.front(), q.unit.empty() ? "" : " " + q.unit);
  return answer;
}

// The table alone knows the line.
Result<void> check_uncertainties(const CsvTable& table, const SoundRows& sound, const CsvColumn& u, const LawsRequest& request) {
  for (std::size_t r = 0; r < u.value.size(); ++r)
    if (sound.has(r) && !(u.value[r] > 0.0))
      return fail(ErrorCode::usage, fmt::format("the uncertainty {} = {} is not above 0", printable_utf8(u.header), shortest(u.value[r])),
                  fmt::format("{}:{}", request.table.string(), table.line_of_row(r)), "mend it, or leave out the row or the whole column");
  return {};
}

Result<void> check_asked_once(const CsvTable& table, const LawsRequest& request) {
  std::set<const CsvColumn*> asked;
  for (const std::string& name : request.of) {
    FORCEGATE_TRY(const CsvColumn* c, column(table, name, request));
    if (!asked.insert(c).second) return fail(ErrorCode::usage, "the parameter '" + printable_utf8(name) + "' is named twice", "--of", "name every parameter once");
  }
  return {};
}

}  // namespace

Result<std::vector<ParameterAnswer>> laws(const LawsRequest& request, std::vector<std::string>* notes) {
  FORCEGATE_TRY(const CsvTable table, read_csv_table(request.table));
  FORCEGATE_CHECK_OK(check_asked_once(table, request));
  ParameterQuestion base;
  base.alpha = request.alpha / static_cast<double>(std::max<std::size_t>(1, request.of.size()));
  base.seed = request.seed;
  base.scale = request.scale == "log"          ? ResponseScale::logarithm
               : request.scale == "reciprocal" ? ResponseScale::reciprocal
                                               : ResponseScale::linear;
  std::vector<std::string> over = request.over;
  if (over.empty())
    for (const CsvColumn& c : table.columns) {
      const std::string name = plain_name(c.header);
      if (!name.starts_with("u_") &&
          std::find(request.of.begin(), request.of.end(), name) == request.of.end() &&
          std::find(request.of.begin(), request.of.end(), c.header) == request.of.end())
        over.push_back(name);
    }
  const auto take = [&](const std::string& text, const char* option) -> Result<std::string> {
    FORCEGATE_TRY(const CsvColumn* c, column(table, text, request));
    const std::string name = plain_name(c->header);
    for (const std::string& of : request.of)
      if (of == name || of == c->header) return fail(ErrorCode::usage, "nothing is explained by itself: " + name + " is the parameter to explain", option, "name what was different between the records");
    if (std::ranges::find(base.covariates, name, &Covariate::name) == base.covariates.end()) base.covariates.push_back({name, unit_of(c->header), c->value});
    return name;
  };
  for (const std::string& text : over) FORCEGATE_CHECK_OK(take(text, "--over"));
  for (const std::string& text : request.law) {
    FORCEGATE_TRY(LawTerm term, parse_term(text));
    for (std::string* name : {&term.covariate, &term.other})
      if (!name->empty()) {
        FORCEGATE_TRY(*name, take(*name, "--law"));
      }
    base.law.push_back(std::move(term));
  }
  SoundRows sound(table.rows());
  for (const Covariate& c : base.covariates) sound.ask(c.name, c.value);
  for (const std::string& name : request.of) {
    FORCEGATE_TRY(const CsvColumn* c, column(table, name, request));
    sound.ask(name, c->value);
    if (const CsvColumn* u = find_column(table, "u_" + name)) sound.ask(u->header, u->value);
  }
  FORCEGATE_CHECK_OK(sound.check(table, request));
  for (Covariate& c : base.covariates) c.value = sound.of(c.value);
  if (notes != nullptr) {
    if (request.over.empty())
      for (const TextColumn& text : table.text_columns)
        notes->push_back("the column '" + printable_utf8(text.header) + "' holds text ('" + printable_utf8(text.cell) + "') and is no covariate: give each of its words a number");
    for (std::string& note : sound.notes(table)) notes->push_back(std::move(note));
  }
  std::vector<ParameterAnswer> out;
  for (const std::string& name : request.of) {
    ParameterQuestion q = base;
    FORCEGATE_TRY(const CsvColumn* c, column(table, name, request));
    q.name = name;
    q.unit = request.scale == "log" ? "" : unit_of(c->header);
    q.value = sound.of(c->value);
    if (const CsvColumn* u = find_column(table, "u_" + name)) {
      FORCEGATE_CHECK_OK(check_uncertainties(table, sound, *u, request));
      q.u = sound.of(u->value);
    }
    FORCEGATE_TRY(ParameterAnswer answer, missing_dependence(q));
    out.push_back(is_constant(q.value) ? constant_answer(q, std::move(answer)) : std::move(answer));
  }
  return out;
}

std::string laws_text(const std::vector<ParameterAnswer>& answers) {
  std::string out;
  for (const ParameterAnswer& a : answers) {
    if (a.ranking.empty() && a.scatter == 0.0 && a.law.size() == 1) {
      out += a.sentence + "\n";
      continue;
    }
    out += a.sentence + "\n  law: " + a.response + " =";
    for (std::size_t k = 0; k < a.law.size(); ++k) {
      const LawCoefficient& c = a.law[k];
      const bool falls = k > 0 && c.value < 0.0;
      out += fmt::format(" {}{}{}", k == 0 ? "" : falls ? "- " : "+ ", with_uncertainty(falls ? -c.value : c.value, c.u), c.term == "1" ? "" : " " + c.term);
    }
    out += fmt::format(
        "\n  leave-one-out error{}: constant {:.3g}, the law given {:.3g}, the law now {:.3g}; scatter between records {:.3g}\n",
        a.response == a.name ? "" : " of " + a.response, a.loo_constant, a.loo_before, a.loo_after, a.scatter);
    out += "  candidates beside the law given:\n";
    for (std::size_t k = 0; k < std::min<std::size_t>(5, a.ranking.size()); ++k) {
      const RankedTerm& r = a.ranking[k];
      out += fmt::format(
          "    {:<14} F {:>7.2f}  p {:.4f} (alone {:.4f})  takes {:>3.0f} %  leave-one-out {:.3g}\n",
          to_string(r.term), r.F, r.p, r.p_alone, 100.0 * r.r2, r.loo_after);
    }
  }
  return out;
}

std::string laws_json(const std::vector<ParameterAnswer>& answers, const std::vector<std::string>& notes) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  const auto term_json = [](const RankedTerm& r) {
    return nlohmann::ordered_json{
        {"term", to_string(r.term)}, {"F", r.F},      {"p", r.p},
        {"p_alone", r.p_alone},      {"share", r.r2}, {"leave_one_out", r.loo_after}};
  };
  for (const ParameterAnswer& a : answers) {
    nlohmann::ordered_json added = nlohmann::ordered_json::array(), ranking = added, law = added;
    for (const FoundTerm& f : a.added) {
      nlohmann::ordered_json one = term_json(f.found);
      one["fits_as_well"] = nlohmann::ordered_json::array();
      for (const LawTerm& t : f.fits_as_well) one["fits_as_well"].push_back(to_string(t));
      added.push_back(one);
    }
    for (const RankedTerm& r : a.ranking) ranking.push_back(term_json(r));
    for (const LawCoefficient& c : a.law) law.push_back({{"term", c.term}, {"value", c.value}, {"u", c.u}});
    list.push_back(
        {{"parameter", a.name},
         {"response", a.response},
         {"unit", a.unit},
         {"records", a.n},
         {"candidates", a.candidates},
         {"missing", added},
         {"law", law},
         {"leave_one_out", {{"constant", a.loo_constant}, {"before", a.loo_before}, {"after", a.loo_after}}},
         {"scatter", a.scatter},
         {"smallest_share_seen", a.smallest_share},
         {"ranking", ranking},
         {"sentence", a.sentence}});
  }
  return nlohmann::ordered_json{{"format", 1}, {"parameters", list}, {"notes", notes}}.dump(2) + "\n";
}

}  // namespace forcegate
