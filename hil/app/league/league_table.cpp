#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "hil/app/league/league.h"
#include "hil/app/league/league_stage.h"
#include "hil/app/league/league_tally.h"
#include "hil/gate/statistics.h"

namespace forcegate {
namespace {

std::string share(const Count& count) {
  if (count.n == 0) return "-";
  const Interval i = wilson_95(count.k, count.n);
  return fmt::format("{}/{} = {:.0f} % [{:.0f}, {:.0f}]", count.k, count.n,
                     100.0 * static_cast<double>(count.k) / static_cast<double>(count.n), 100.0 * i.low,
                     100.0 * i.high);
}

std::string median(const std::vector<double>& shares) {
  return shares.empty() ? "-" : fmt::format("{:.0f} % of {}", 100.0 * score_quantile(shares, 0.5), shares.size());
}

/// Not where the engine says nothing of its starting model.
bool tells_reduction(const LeagueTally& t) {
  return std::any_of(t.tiers.begin(), t.tiers.end(), [](const TierTally& tier) { return !tier.removed.empty(); });
}

std::string first_answer(const LeagueMatch& m) {
  if (!m.error.empty()) return "no answer: " + m.error.substr(0, m.error.find('\n'));
  std::string text = m.answer.verdict;
  for (std::size_t i = 0; i < m.answer.findings.size() && i < 3; ++i)
    text += fmt::format("{} {} {}", i ? "," : ":", m.answer.findings[i].effect,
                        probability_text(m.answer.findings[i].probability));
  return text;
}

std::string miss_line(const LeagueMatch& m) {
  std::string line = fmt::format("  {:<40} {:>14}", m.id, m.seed);
  for (const auto& effect : m.truth.effects) {
    line += fmt::format("  rms {:.2f} %{}", effect.rms_pct, effect.excited ? "" : " (not excited)");
    if (effect.between_records)
      line += fmt::format(", d' {:.1f}{}", effect.detectability, effect.cause_recorded ? "" : ", cause not recorded");
  }
  line += "  -> " + first_answer(m);
  const Miss miss = miss_of(m);
  line += fmt::format("; {}", to_string(miss.stage));
  if (m.kind == LeagueClass::pair && !miss.effect.empty()) line += " of " + miss.effect;
  if (!miss.other.empty() && miss.stage == MissStage::outranked) line += " by " + miss.other;
  if (!miss.detail.empty()) line += ": " + miss.detail;
  if (m.score.look_alike) line += " (told as look-alike)";
  return line;
}

std::string counted(const std::map<std::string, int>& names) {
  std::string text;
  for (const auto& [name, n] : names) text += fmt::format("{}{} x{}", text.empty() ? "" : ", ", name, n);
  return text;
}

std::string exact(const Count& count) {
  if (count.n == 0) return "-";
  const Interval95 i = clopper_pearson_95(count.k, count.n);
  return fmt::format("{}/{} = {:.1f} % [{:.1f}, {:.1f}]", count.k, count.n,
                     100.0 * static_cast<double>(count.k) / static_cast<double>(count.n), 100.0 * i.low,
                     100.0 * i.high);
}

std::string effect_rows(const LeagueTally& t) {
  std::string out = fmt::format(
      "\nby effect: named first (foreign: called unknown)\n  {:<26}{:>6}{:>8}{:>8}{:>10}{:>20}{:>16}   {}\n",
      "", "weak", "medium", "strong", "excited", "RMS % of its span", "RMS in U %",
      "lost at; answered instead");
  for (const auto& [name, e] : t.by_effect) {
    out += fmt::format("  {:<26}", name);
    for (std::size_t k = 0; k < 3; ++k)
      out += fmt::format("{:>{}}", e.named[k].n ? fmt::format("{}/{}", e.named[k].k, e.named[k].n) : "-",
                         k ? 8 : 6);
    const auto range = [](const std::vector<double>& v) {
      return fmt::format("{:.2f} - {:.2f}", score_quantile(v, 0.0), score_quantile(v, 1.0));
    };
    out += fmt::format("{:>10}{:>20}{:>16}", fmt::format("{}/{}", e.excited.k, e.excited.n), range(e.rms_pct),
                       range(e.rms_voltage_pct));
    if (!e.stages.empty()) out += "   " + counted(e.stages) + "; " + counted(e.instead);
    out += '\n';
  }
  return out;
}

std::string single_rows(const LeagueTally& t) {
  std::string out =
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
  row("    within records", &TierTally::within, "");
  row("    between records", &TierTally::between, "");
  row("      plain and cause recorded", &TierTally::between_plain, "");
  row("  side right, of those listed", &TierTally::side, "97 %");
  row("  with a false claim beside", &TierTally::false_claims, "");
  if (!tells_reduction(t)) return out;
  const auto medians = [&](const char* label, auto member, const char* target) {
    out += fmt::format("{:<34}", label);
    for (const TierTally& tier : t.tiers) out += fmt::format("{:<28}", median(tier.*member));
    out += fmt::format("{}\n", target);
  };
  medians("  reducible error removed, median", &TierTally::removed, "85 %");
  medians("    of those named first", &TierTally::removed_named, "");
  return out;
}

// Clean campaigns, foreign effects, pairs, and what no campaign may do.
std::string other_rows(const LeagueTally& t) {
  std::string out;
  const auto row = [&](const char* label, const std::string& value, const char* target) {
    out += fmt::format("{:<34}{:<28}{}\n", label, value, target);
  };
  row("clean campaigns, false discovery", exact(t.control_false), "<= 3 %, interval of Clopper and Pearson");
  row("  of these a false claim", exact(t.control_claims), "0");
  if (!t.control_answers.empty()) out += "  answered " + counted(t.control_answers) + "\n";
  row("foreign effects called unknown", share(t.foreign_honest), ">= 90 %");
  row("  a known effect claimed instead", share(t.foreign_claimed), "");
  row("  the right coordinate named", share(t.foreign_coordinate), "");
  row("pairs, both within three", share(t.pairs), ">= 85 %");
  row("pairs, one within three", share(t.pairs_one), "");
  row("sensor blamed for others' faults", share(t.sensor_blamed), "0");
  row("no answer", share(t.no_answer), "0");
  if (!t.pair_stages.empty()) out += "pairs lost at: " + counted(t.pair_stages) + "\n";
  return out;
}

// What engines without any thought would reach.
std::string baseline_rows(const LeagueTally& t) {
  const auto row = [](const char* label, const std::array<std::string, 5>& cells) {
    return fmt::format("{:<34}{:<28}{:<28}{:<28}{:<20}{}\n", label, cells[0], cells[1], cells[2], cells[3], cells[4]);
  };
  std::string out = row("beside it", {"weak", "medium", "strong", "clean: false", "foreign: honest"});
  const auto zero = [](const Count& c) { return fmt::format("0/{}", c.n); };
  out += row("  always \"none\"", {zero(t.tiers[0].named), zero(t.tiers[1].named), zero(t.tiers[2].named), zero(t.control_false),
                                   zero(t.foreign_honest)});
  if (t.naive_named[0].n + t.naive_named[1].n + t.naive_named[2].n + t.naive_control_false.n > 0)
    out += row("  largest residual correlation", {share(t.naive_named[0]), share(t.naive_named[1]), share(t.naive_named[2]),
                                                  fmt::format("{}/{}", t.naive_control_false.k, t.naive_control_false.n),
                                                  fmt::format("{}/{}", t.naive_foreign_honest.k, t.naive_foreign_honest.n)});
  return out;
}

std::string calibration_rows(const LeagueTally& t) {
  std::string out = fmt::format(
      "\nstated probability against truth (largest gap of a bin of 20 or more: {:.0f} points; target 5)\n",
      100.0 * t.calibration_error);
  for (const CalibrationBin& bin : t.calibration)
    if (bin.truth.n > 0)
      out += fmt::format("  {:.2f} - {:.2f}   stated {:.2f}   true {}\n", bin.low, bin.high,
                         bin.stated / static_cast<double>(bin.truth.n), share(bin.truth));
  return out;
}

std::string miss_rows(const std::vector<LeagueMatch>& matches) {
  std::string out = "\nmisses (id, seed, size, answer; where it was lost)\n";
  if (!matches.empty())
    out += fmt::format("the campaign of one: forcegate mystery DIR --effect EFFECT --strength TIER --minutes {:g} --seed SEED\n",
                       matches.front().minutes);
  for (const LeagueMatch& m : matches)
    if (is_miss(m)) out += miss_line(m) + '\n';
  return out;
}

}  // namespace

std::string league_text(const LeagueResult& result) {
  const LeagueTally t = tally(result);
  std::string out = fmt::format("league seed {}, {} corpus, {} campaigns, engine {}\n\n", result.request.seed,
                                result.request.full ? "full" : "small", result.matches.size(), result.engine);
  out += single_rows(t) + '\n' + other_rows(t) + '\n' + baseline_rows(t);
  out += calibration_rows(t) + effect_rows(t) + miss_rows(result.matches);
  out += fmt::format(
      "\nseconds: engine median {:.2f}, 95 % {:.2f}, worst {:.2f}; making a campaign {:.2f}; whole league "
      "{:.0f}\n",
      score_quantile(t.engine_s, 0.5), score_quantile(t.engine_s, 0.95), score_quantile(t.engine_s, 1.0),
      score_quantile(t.generation_s, 0.5), result.seconds);
  return out;
}

std::string league_next(const LeagueResult& result) {
  const auto graver = [](const LeagueMatch& a, const LeagueMatch& b) {
    const auto rank = [](const LeagueMatch& m) {
      return m.kind == LeagueClass::control ? 100 : m.kind == LeagueClass::single ? 10 + static_cast<int>(m.tier) : static_cast<int>(m.tier);
    };
    return rank(a) > rank(b);
  };
  const LeagueMatch* gravest = nullptr;
  for (const LeagueMatch& m : result.matches)
    if (is_miss(m) && (gravest == nullptr || graver(m, *gravest))) gravest = &m;
  if (gravest == nullptr) return fmt::format("forcegate league --seed {}", result.request.seed + 1);
  const LeagueMatch& m = *gravest;
  std::string command = fmt::format("forcegate mystery missed --seed {} --minutes {:g}", m.seed, m.minutes);
  if (m.kind == LeagueClass::control) return command + " --effect none";
  command += m.effects.size() == 2 ? " --pair " + m.effects[0] + "," + m.effects[1] : " --effect " + m.effects.front();
  return m.tier == hidden::Tier::none ? command : command + " --strength " + std::string(to_string(m.tier));
}

}  // namespace forcegate
