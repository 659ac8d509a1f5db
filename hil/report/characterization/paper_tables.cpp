#include "hil/report/characterization/paper_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/base/text.h"
#include "hil/characterize/printed_table.h"

namespace forcegate {
namespace {

using characterize::DecayRecord;
using characterize::Laws;
using characterize::LeftOut;
using characterize::mean_and_sd;
using characterize::SensorStudy;
using characterize::SessionSheet;

// The k-th record of a set over all sound sheets.
std::vector<const DecayRecord*> records_of(const SensorStudy& study, std::string_view set, std::size_t k) {
  std::vector<const DecayRecord*> out;
  for (const SessionSheet& s : study.sheets) {
    std::size_t seen = 0;
    for (const DecayRecord& r : s.decays)
      if (!s.failure && r.set == set && seen++ == k) out.push_back(&r);
  }
  return out;
}

template <class Get>
std::string mean_sd(const std::vector<const DecayRecord*>& records, int decimals, Get get) {
  std::vector<double> v;
  for (const DecayRecord* r : records)
    if (r->fitted) v.push_back(get(*r));
  const characterize::MeanSd m = characterize::mean_and_sd(v);
  return m.n == 0   ? "-"
         : m.n == 1 ? fmt::format("{:.{}f}", m.mean, decimals)
                    : fmt::format("{:.{}f} ± {:.{}f}", m.mean, decimals, m.sd, decimals);
}

std::string law_row(const char* name, const char* unit, double paper, double ours, double se, int decimals) {
  return fmt::format("| {} | {} | {:.{}f} | {} | {:.2f} |\n", name, unit, paper, decimals,
                     se > 0.0 ? fmt::format("{:.{}f} ± {:.{}f}", ours, decimals, se, decimals)
                              : fmt::format("{:.{}f}", ours, decimals),
                     ours / paper);
}

}  // namespace

std::string short_number(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  if (value == 0.0) return "0";
  const int whole = std::max(0, digits - 1 - static_cast<int>(std::floor(std::log10(std::abs(value)))));
  return fmt::format("{:.{}f}", value, std::min(whole, 6));
}

std::string table_II_markdown(const SensorStudy& study, const characterize::StudyPlan& plan) {
  std::string out =
      "| f Hz | A N | m N | a V, paper | a V, ours | 10³ b 1/s, paper | 10³ b 1/s, ours | c V, paper | c V, ours | c/a, paper | c/a, ours | RMSE V, paper | RMSE V, ours |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  const auto printed = characterize::printed_table_II();
  for (std::size_t k = 0; k < plan.harmonic.size(); ++k) {
    const auto& spec = plan.harmonic[k];
    const auto records = records_of(study, "series", k);
    if (records.empty()) continue;
    const auto row = std::find_if(printed.begin(), printed.end(), [&](const characterize::PrintedRow& p) {
      return p.f_Hz == spec.f_Hz && p.A_N == spec.A_N && p.m_N == spec.m_N;
    });
    const bool has = row != printed.end();
    const auto paper = [&](double v, int decimals) {
      return has ? fmt::format("{:.{}f}", v, decimals) : std::string("-");
    };
    out += fmt::format(
        "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", shortest(spec.f_Hz),
        shortest(spec.A_N), shortest(spec.m_N), paper(has ? row->a_V : 0, 2),
        mean_sd(records, 2, [](const DecayRecord& r) { return r.fit.a_V; }),
        paper(has ? 1e3 * row->b_per_s : 0, 2),
        mean_sd(records, 2, [](const DecayRecord& r) { return 1e3 * r.fit.b_per_s; }),
        paper(has ? row->c_V : 0, 2), mean_sd(records, 2, [](const DecayRecord& r) { return r.fit.c_V; }),
        paper(has ? row->c_V / row->a_V : 0, 2),
        mean_sd(records, 2, [](const DecayRecord& r) { return r.fit.c_V / r.fit.a_V; }),
        paper(has ? row->rmse_V : 0, 3),
        mean_sd(records, 3, [](const DecayRecord& r) { return r.fit.rmse_V; }));
  }
  return out;
}

std::string table_III_markdown(const SensorStudy& study) {
  if (!study.laws.available) return {};
  std::string out =
      "| f₁ Hz | f₂ Hz | error of a %, paper | ours | error of b %, paper | ours | error of c %, paper | ours |\n|---|---|---|---|---|---|---|---|\n";
  for (const characterize::PrintedPair& p : characterize::printed_table_III()) {
    std::vector<double> a, b, c;
    for (const SessionSheet& s : study.sheets)
      for (const DecayRecord& r : s.decays)
        if (!s.failure && r.set == "two sines" && r.f_Hz == p.f1_Hz && r.f2_Hz == p.f2_Hz && r.fitted &&
            r.fit.a_V > 0.0 && r.fit.c_V > 0.0) {
          const auto e = characterize::errors_of_laws(study.laws.fitted, r, s.calibration);
          a.push_back(e.a_pct), b.push_back(e.b_pct), c.push_back(e.c_pct);
        }
    if (a.empty()) continue;
    out += fmt::format("| {} | {} | {:.0f} | {} | {:.0f} | {} | {:.0f} | {} |\n", shortest(p.f1_Hz),
                       shortest(p.f2_Hz), p.a_pct, short_number(mean_and_sd(a).mean, 2), p.b_pct,
                       short_number(mean_and_sd(b).mean, 2), p.c_pct, short_number(mean_and_sd(c).mean, 2));
  }
  return out;
}

std::string laws_markdown(const characterize::LawStudy& study) {
  if (!study.available) return "The laws were not fitted: " + study.why_not + ".\n";
  const Laws paper, &l = study.fitted;
  std::string out = fmt::format(
      "Fitted to {} records of {} specimens; standard errors by jackknife over the specimens.\n\n", l.records,
      l.specimens);
  out += "| coefficient | unit | printed | ours | ratio |\n|---|---|---|---|---|\n";
  out += law_row("a = **p₂** A² + p₁ A", "V/N²", paper.a2_V_per_N2, l.a2_V_per_N2, l.se_a2, 3);
  out += law_row("a = p₂ A² + **p₁** A", "V/N", paper.a1_V_per_N, l.a1_V_per_N, l.se_a1, 3);
  out += law_row("b = **b₁** f + b₀", "1", paper.b1_s_per_s, l.b1_s_per_s, l.se_b1, 5);
  out += law_row("b = b₁ f + **b₀**", "1/s", paper.b0_per_s, l.b0_per_s, l.se_b0, 5);
  out += law_row("c/a = 1/(1 + **k** A²)", "1/N²", paper.k_per_N2, l.k_per_N2, l.se_k, 3);
  out +=
      "\nThe coefficients of a differ because a and c in volts cannot agree with law (1): at 0-10 V over 0-5 N the swing is 2A/G = a + c, "
      "that is 4 V per newton of A, while the printed laws give a + c of only 2.2 to 2.9 V per newton. Only b and the ratio c/a enter eq. (7); they agree.\n";
  return out;
}

std::string levels_markdown(const SensorStudy& study) {
  std::string out =
      "| level | what is known of the specimen | MRE maxima %, mean | 5 % .. 95 % of the sessions | MRE minima %, mean | sessions within 4.5 / 7.5 % | the paper's 4.5 % is quantile | run away |\n"
      "|---|---|---|---|---|---|---|---|\n";
  struct Level {
    const char *name, *what;
  };
  for (const Level& level : {Level{"nominal", "the type's values"}, Level{"static", "G and F0 by two sweeps"},
                             Level{"identified", "b and c/a too, from an earlier record"}}) {
    const std::string key = std::string("control.") + level.name;
    const auto *maxima = study.find(key + "_maxima"), *minima = study.find(key + "_minima");
    if (maxima == nullptr || minima == nullptr) continue;
    std::size_t n = 0, both = 0, below = 0;
    for (const SessionSheet& s : study.sheets) {
      const double high = s.value(key + "_maxima"), low = s.value(key + "_minima");
      if (s.failure || !std::isfinite(high)) continue;
      ++n;
      both += high <= 4.5 && low <= 7.5 ? 1u : 0u;
      below += high <= 4.5 ? 1u : 0u;
    }
    const auto away = study.share_where(key + "_away", [](double v) { return v > 50.0; });
    out += fmt::format(
        "| {} | {} | {} | {} .. {} | {} | {} of {} ({:.0f} %) | {:.2f} | {:.0f} of {} ({:.1f} %) |\n",
        level.name, level.what, short_number(maxima->mean, 2), short_number(maxima->q05, 2),
        short_number(maxima->q95, 2), short_number(minima->mean, 2), both, n,
        100.0 * static_cast<double>(both) / static_cast<double>(n),
        static_cast<double>(below) / static_cast<double>(n), away.share * static_cast<double>(away.n), away.n,
        100.0 * away.share);
  }
  return out;
}

std::string printed_table_markdown() {
  const auto e = characterize::errors_on_printed_table();
  std::string out = fmt::format(
      "Eq. (5) on the 20 printed rows misses a, b and c by **{:.0f}, {:.0f} and {:.0f} %** on average; the text says 17, 30 and 14 %. The printed parameters lose "
      "{:.0f} % of the swing in 20 min, the laws {:.0f} %; the text says 83 %. So the text's figures come from more data (four specimens) than the table shows.\n\n"
      "Does the table hold a dependence that the laws leave out? Each law was refitted to the 20 rows (relative least squares) with one more term; p is two-sided, "
      "significance by Holm at 5 % over all terms tried; the error is leave-one-out.\n\n",
      e.a_pct, e.b_pct, e.c_pct, e.loss_printed_pct, e.loss_laws_pct);
  out +=
      "| parameter | term added | coefficient / its standard error | p | significant | leave-one-out error % without | with |\n|---|---|---|---|---|---|---|\n";
  const auto found = characterize::search_printed_table();
  bool any = false;
  for (const LeftOut& x : found) {
    any = any || x.significant;
    out += fmt::format("| {} | {} | {:.1f} | {:.3f} | {} | {:.1f} | {:.1f} |\n", x.parameter, x.term,
                       x.coefficient / x.se, x.p, x.significant ? "yes" : "no", x.loo_before_pct,
                       x.loo_after_pct);
  }
  out +=
      any ? "\nVerdict: the terms marked are needed; with 20 points from one series each, the other series must confirm them.\n"
          : fmt::format(
                "\nVerdict: **nothing significant**. The strongest candidates are {} on {} (p = {:.3f}) and {} on {} (p = {:.3f}); with {} terms tried, p = {:.3f} "
                "would be needed for the first one. They lower the leave-one-out error a little and are worth an experiment with more amplitudes; 20 points in three "
                "series that each change one thing cannot tell them from the scatter between specimens, which is as large as the misfit.\n",
                found[0].parameter, found[0].term, found[0].p, found[1].parameter, found[1].term, found[1].p,
                found.size(), 0.05 / static_cast<double>(found.size()));
  return out;
}

}  // namespace forcegate
