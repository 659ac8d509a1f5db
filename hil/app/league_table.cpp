#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "hil/app/league.h"
#include "hil/app/league_tally.h"

namespace forcegate {
namespace {

std::string share(const Count& count) {
  if (count.n == 0) return "-";
  const Interval i = wilson_95(count.k, count.n);
  return fmt::format("{}/{} = {:.0f} % [{:.0f}, {:.0f}]", count.k, count.n,
                     100.0 * static_cast<double>(count.k) / static_cast<double>(count.n), 100.0 * i.low,
                     100.0 * i.high);
}

std::string percent(double value) { return std::isnan(value) ? "-" : fmt::format("{:.0f} %", 100.0 * value); }

std::string first_answer(const LeagueMatch& m) {
  if (!m.error.empty()) return "no answer: " + m.error.substr(0, m.error.find('\n'));
  std::string text = m.answer.verdict;
  for (std::size_t i = 0; i < m.answer.findings.size() && i < 3; ++i)
    text += fmt::format("{} {} {:.2f}", i ? "," : ":", m.answer.findings[i].effect,
                        m.answer.findings[i].probability);
  return text;
}

std::string miss_line(const LeagueMatch& m) {
  std::string line = fmt::format("  {:<40} {:>14}", m.id, m.seed);
  for (const auto& effect : m.truth.effects)
    line += fmt::format("  rms {:.2f} %{}", effect.rms_pct, effect.excited ? "" : " (not excited)");
  line += "  -> " + first_answer(m);
  if (m.score.rank > 1) line += fmt::format(" (place {})", m.score.rank);
  if (m.score.look_alike) line += " (told as look-alike)";
  if (!m.answer.reason.empty()) line += "; " + m.answer.reason;
  return line;
}

}  // namespace

std::string league_text(const LeagueResult& result) {
  const LeagueTally t = tally(result);
  std::string out = fmt::format("league seed {}, {} corpus, {} campaigns, engine {}\n\n", result.request.seed,
                                result.request.full ? "full" : "small", result.matches.size(), result.engine);
  out +=
      fmt::format("{:<34}{:<28}{:<28}{:<28}{}\n", "one hidden effect", "weak", "medium", "strong", "target");
  const auto row = [&](const char* label, auto member, const char* target) {
    out += fmt::format("{:<34}", label);
    for (const TierTally& tier : t.tiers) out += fmt::format("{:<28}", share(tier.*member));
    out += fmt::format("{}\n", target);
  };
  row("  named first (top-1)", &TierTally::named, "75 / 92 / 97 %");
  row("  within the first two", &TierTally::top2, "");
  row("  within the first three", &TierTally::top3, "");
  row("  told as inseparable look-alike", &TierTally::look_alike, "");
  row("  named first, where excited", &TierTally::named_excited, "");
  row("  side right, of those listed", &TierTally::side, "97 %");
  row("  with a false claim beside", &TierTally::false_claims, "");
  out += fmt::format("{:<34}", "  reducible error removed, median");
  for (const TierTally& tier : t.tiers) out += fmt::format("{:<28}", percent(score_quantile(tier.removed, 0.5)));
  out += "85 %\n\n";
  out +=
      fmt::format("{:<34}{:<28}{}\n", "clean campaigns, false discovery", share(t.control_false), "<= 3 %");
  out +=
      fmt::format("{:<34}{:<28}{}\n", "foreign effects called unknown", share(t.foreign_honest), ">= 90 %");
  out += fmt::format("{:<34}{:<28}{}\n", "  a known effect claimed instead", share(t.foreign_claimed), "");
  out += fmt::format("{:<34}{:<28}{}\n", "  the right coordinate named", share(t.foreign_coordinate), "");
  out += fmt::format("{:<34}{:<28}{}\n", "pairs, both within three", share(t.pairs), ">= 85 %");
  out += fmt::format("{:<34}{:<28}{}\n", "pairs, one within three", share(t.pairs_one), "");
  out += fmt::format("{:<34}{:<28}{}\n", "sensor blamed for others' faults", share(t.sensor_blamed), "0");
  out += fmt::format("{:<34}{:<28}{}\n\n", "no answer", share(t.no_answer), "0");

  out += "stated probability against truth\n";
  for (const CalibrationBin& bin : t.calibration)
    if (bin.truth.n > 0)
      out += fmt::format("  {:.2f} - {:.2f}   stated {:.2f}   true {}\n", bin.low, bin.high,
                         bin.stated / static_cast<double>(bin.truth.n), share(bin.truth));

  out += "\nby effect: named first, weak / medium / strong\n";
  for (const auto& [name, counts] : t.by_effect) {
    out += fmt::format("  {:<28}", name);
    for (const Count& count : counts) out += fmt::format("{:>4}/{}", count.k, count.n);
    if (const auto at = t.confusions.find(name); at != t.confusions.end()) {
      out += "   instead:";
      for (const auto& [other, n] : at->second) out += fmt::format(" {} x{}", other, n);
    }
    out += '\n';
  }
  out += "\nmisses (id, seed of `forcegate mystery`, size, answer)\n";
  for (const LeagueMatch& m : result.matches)
    if (is_miss(m)) out += miss_line(m) + '\n';
  out += fmt::format(
      "\nseconds: engine median {:.2f}, 95 % {:.2f}, worst {:.2f}; making a campaign {:.2f}; whole league "
      "{:.0f}\n",
      score_quantile(t.engine_s, 0.5), score_quantile(t.engine_s, 0.95), score_quantile(t.engine_s, 1.0),
      score_quantile(t.generation_s, 0.5), result.seconds);
  return out;
}

}  // namespace forcegate
