#include "hil/gate/waiver.h"

#include <fmt/format.h>

#include <algorithm>

#include "hil/base/iso_date.h"
#include "hil/base/text.h"
#include "hil/rig/config.h"

namespace forcegate {
namespace {

bool matches(const Waiver& w, const Check& c) {
  // "case/specimen" of a record (a session or attempt may follow); a check of the whole run names both behind its id:
  // "promise_maxima/force_control", "mre_maxima/four_sines/q50".
  std::vector<std::string> words = split(c.case_id.empty() ? c.id : c.id + "/" + c.case_id, '/');
  words.resize(3);
  return (w.check == "*" || w.check == words[0]) && (w.case_name == "*" || w.case_name == words[1]) &&
         (w.specimen == "*" || w.specimen == words[2]);
}

bool may_be_waived(const Check& c) {
  if (!c.required || c.id == "safety_stop" || c.id == "firmware_runs" || c.id == "session") return false;
  return c.verdict == Verdict::fail || c.verdict == Verdict::marginal || c.verdict == Verdict::inconclusive ||
         c.verdict == Verdict::not_run;
}

std::string in_words(const Waiver& w) {
  return fmt::format("{}/{} {} (owner {}, until {}: {})", w.case_name, w.specimen, w.check, w.owner,
                     w.expires, w.reason);
}

}  // namespace

Result<std::vector<Waiver>> read_waivers(const std::filesystem::path& path) {
  FORCEGATE_TRY(const ConfigNode root, read_config(path));
  ConfigReader r(root, "the waivers", "docs/trust.md");
  std::int64_t format = 0;
  r.integer("format", format, 1, 1, ConfigReader::required);
  const ConfigNode* list = r.array("waiver", ConfigReader::required);
  FORCEGATE_CHECK_OK(r.finish());
  std::vector<Waiver> waivers;
  for (const ConfigNode& item : list->items) {
    if (item.kind != ConfigNode::Kind::table)
      return fail(ErrorCode::config, "a waiver must be a table", item.where, "write [[waiver]]");
    ConfigReader one(item, "a waiver", "docs/trust.md");
    Waiver w;
    w.where = item.where;
    one.text("case", w.case_name, ConfigReader::required);
    one.text("specimen", w.specimen);
    one.text("check", w.check, ConfigReader::required);
    one.text("owner", w.owner, ConfigReader::required);
    one.text("reason", w.reason, ConfigReader::required);
    one.text("expires", w.expires, ConfigReader::required);
    FORCEGATE_CHECK_OK(one.finish());
    if (w.owner.empty() || w.reason.empty())
      return fail(ErrorCode::config, "a waiver needs an owner and a reason", w.where);
    if (!is_iso_date(w.expires))
      return fail(ErrorCode::config, "'" + w.expires + "' is no date", w.where,
                  "write expires = \"2026-12-31\"");
    if (w.case_name == "*" && w.check == "*")
      return fail(ErrorCode::config, "this waiver would waive everything", w.where,
                  "name the case or the check");
    waivers.push_back(std::move(w));
  }
  return waivers;
}

void apply_waivers(const std::vector<Waiver>& waivers, const std::string& today,
                   std::vector<JudgedCheck>& of_run, std::vector<PlayedRecord>& records,
                   std::vector<std::string>& notes) {
  apply_waivers(waivers, today, of_run, all_checks(of_run, records), notes);
}

void apply_waivers(const std::vector<Waiver>& waivers, const std::string& today,
                   std::vector<JudgedCheck>& of_run, const std::vector<JudgedCheck*>& all,
                   std::vector<std::string>& notes) {
  std::vector<JudgedCheck> expired;
  for (const Waiver& w : waivers) {
    if (w.expires < today) {
      JudgedCheck j;
      j.judgeable = false;
      j.check.id = "waiver_valid";
      j.check.title = "Waivers that are past their day";
      j.check.value = 1.0;
      j.check.unit = "1";
      j.check.limit = {Limit::Kind::upper, 0.0, "ours: an expired waiver fails"};
      j.check.verdict = Verdict::fail;
      j.check.blame = Blame::user;
      j.check.evidence =
          fmt::format("expired on {}, today is {}: {}; {}", w.expires, today, in_words(w), w.where);
      expired.push_back(std::move(j));
      continue;
    }
    std::size_t met = 0;
    for (JudgedCheck* j : all)
      if (Check& c = j->check; matches(w, c) && may_be_waived(c)) {
        c.evidence = fmt::format("waived by {} until {}: {} (was {}: {})", w.owner, w.expires, w.reason,
                                 to_string(c.verdict), c.evidence);
        c.verdict = Verdict::waived;
        ++met;
      }
    notes.push_back(met > 0 ? fmt::format("waiver for {}: {} checks waived; the day was taken as {}",
                                          in_words(w), met, today)
                            : fmt::format("waiver for {} met nothing: remove it", in_words(w)));
  }
  for (JudgedCheck& j : expired) of_run.push_back(std::move(j));
}

}  // namespace forcegate
