#include "hil/characterize/study_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "hil/base/read_file.h"
#include "hil/base/text.h"
#include "hil/characterize/session.h"
#include "hil/rig/config.h"

namespace forcegate::characterize {
namespace {

constexpr const char* kGuide = "docs/characterize.md";
constexpr int kFormat = 1;
constexpr double kDay_s = 86400.0;
constexpr std::int64_t kMostSpecimens = 10000;

void read_numbers(ConfigReader& r, std::string_view name, std::vector<double>& out, double low, double high) {
  const ConfigNode* node = r.array(name);
  if (node == nullptr) return;
  out.clear();
  for (const ConfigNode& item : node->items) {
    const bool number = item.kind == ConfigNode::Kind::number || item.kind == ConfigNode::Kind::integer;
    if (!number || !(item.number >= low && item.number <= high))
      return r.complain(
          item, fmt::format("'{}' must hold numbers from {} to {}", name, shortest(low), shortest(high)));
    out.push_back(item.number);
  }
}

// f_Hz, A_N and m_N of one length each.
void read_sines(const ConfigNode* table, const std::string& what, std::vector<SineSpec>& out,
                Result<void>& state) {
  if (table == nullptr || !state) return;
  ConfigReader r(*table, what, kGuide);
  std::vector<double> f, A, m;
  read_numbers(r, "f_Hz", f, 0.001, 50.0);
  read_numbers(r, "A_N", A, 0.05, 2.7);
  read_numbers(r, "m_N", m, 0.05, 5.0);
  if (r.good() && (f.empty() || f.size() != A.size() || f.size() != m.size()))
    r.complain(*table, what + " needs f_Hz, A_N and m_N, lists of one length");
  for (std::size_t i = 0; r.good() && i < f.size(); ++i) {
    if (m[i] < A[i] || m[i] + A[i] > 5.25)
      r.complain(*table, fmt::format("{}: sine {} leaves the contact or the range (m >= A, m + A <= 5.25 N)",
                                     what, i + 1));
    out.push_back({f[i], A[i], m[i]});
  }
  state = r.finish();
}

Result<void> read_population(const ConfigNode& node, StudyPlan& plan) {
  ConfigReader r(node, "[population]", kGuide);
  std::int64_t count = 0, identification = 0, sessions = plan.sessions;
  r.texts("specimens", plan.specimens);
  r.integer("count", count, 0, kMostSpecimens);
  r.integer("identification", identification, 0, kMostSpecimens);
  r.integer("sessions", sessions, 1, 1000);
  r.text("exemplar", plan.exemplar);
  plan.sessions = static_cast<int>(sessions);
  for (std::int64_t i = 1; i <= count; ++i) plan.specimens.push_back("seed:" + std::to_string(i));
  if (r.good() && plan.specimens.empty())
    r.complain(node, "[population] names no specimen", "give specimens = [\"q50\"], or count = 30");
  if (r.good() && identification > static_cast<std::int64_t>(plan.specimens.size()))
    r.complain(node, "more specimens to identify on than there are");
  FORCEGATE_CHECK_OK(r.finish());
  for (std::int64_t i = 0; i < identification; ++i)
    plan.identification.push_back(plan.specimens[static_cast<std::size_t>(i)]);
  return {};
}

Result<void> read_procedures(ConfigReader& r, const ConfigNode& node, std::string_view sensor,
                             std::vector<std::string>& out) {
  if (!r.texts(sensor, out)) return {};
  const auto known = Registry<ProcedureKind>::instance().names();
  for (const std::string& name : out)
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      const std::string near = nearest_name(name, known);
      r.complain(*node.find(sensor), fmt::format("there is no procedure named '{}'", printable_utf8(name)),
                 near.empty() ? "choose from: " + join(known, ", ") : "did you mean '" + near + "'?");
      break;
    }
  return {};
}

Result<void> read_limit(const ConfigNode& node, StudyPlan& plan) {
  if (node.kind != ConfigNode::Kind::table)
    return fail(ErrorCode::config, "a limit must be a table", node.where, "write [[limit]]");
  StudyLimit limit;
  ConfigReader r(node, "a limit", kGuide);
  r.text("key", limit.key, ConfigReader::required);
  const bool low = r.number("minimum", limit.minimum, -1e9, 1e9),
             high = r.number("maximum", limit.maximum, -1e9, 1e9);
  r.text("source", limit.source, ConfigReader::required);
  FORCEGATE_CHECK_OK(r.finish());
  if (!low && !high)
    return fail(ErrorCode::config, "a limit needs minimum or maximum", node.where, "add one, in the unit of its key '" + printable_utf8(limit.key) + "', or take the limit out");
  if (const ConfigNode* key = node.find("key"); key != nullptr) limit.where = key->where;
  plan.limits.push_back(std::move(limit));
  return {};
}

Result<void> read_profiles(const ConfigNode& node, StudyPlan& p) {
  ConfigReader r(node, "[profiles]", kGuide);
  r.number("record_s", p.record_s, 30.0, kDay_s);
  r.number("rest_s", p.rest_s, 0.0, 1e9);
  r.number("sweep_low_N", p.sweep_low_N, 0.0, 5.0);
  r.number("sweep_high_N", p.sweep_high_N, 0.5, 5.25);
  r.number("sweep_s", p.sweep_s, 1.0, 7200.0);
  std::int64_t sweeps = p.sweeps;
  r.integer("sweeps", sweeps, 1, 20);
  p.sweeps = static_cast<int>(sweeps);
  read_numbers(r, "two_sines_f1_Hz", p.two_sines_f1_Hz, 0.001, 10.0);
  read_numbers(r, "two_sines_f2_Hz", p.two_sines_f2_Hz, 0.001, 10.0);
  r.number("two_sines_A_N", p.two_sines_A_N, 0.05, 1.3);
  r.number("two_sines_m_N", p.two_sines_m_N, 0.1, 5.0);
  r.number("sweep_up_Hz", p.sweep_up_Hz, 0.1, 10.0);
  r.number("sweep_A_N", p.sweep_A_N, 0.05, 2.7);
  r.number("sweep_m_N", p.sweep_m_N, 0.05, 5.0);
  r.number("four_sines_m_N", p.four_sines_m_N, 1.0, 4.0);
  r.number("prbs_Hz", p.prbs_Hz, 0.1, 10.0);
  r.number("prbs_A_N", p.prbs_A_N, 0.05, 2.7);
  r.number("prbs_m_N", p.prbs_m_N, 0.05, 5.0);
  read_numbers(r, "recovery_s", p.recovery_s, 1.0, kDay_s);
  r.number("control_f_Hz", p.control_f_Hz, 0.05, 2.0);
  r.number("control_A_N", p.control_A_N, 0.05, 2.0);
  r.number("control_m_N", p.control_m_N, 0.05, 4.0);
  r.number("learning_s", p.learning_s, 0.0, 600.0);
  if (r.good() && !(p.sweep_high_N > p.sweep_low_N + 0.5))
    r.complain(node, "the calibration sweep must span more than 0.5 N");
  if (r.good() && p.two_sines_f1_Hz.size() != p.two_sines_f2_Hz.size())
    r.complain(node, "two_sines_f1_Hz and two_sines_f2_Hz must be of one length");
  return r.finish();
}

}  // namespace

Result<StudyPlan> parse_study_plan(std::string_view text, const std::string& name) {
  FORCEGATE_TRY(const ConfigNode root, parse_config(text, name));
  StudyPlan plan;
  plan.path = name;
  ConfigReader r(root, "the plan", kGuide);
  std::int64_t format = 0, seed = static_cast<std::int64_t>(plan.seed);
  std::string kind;
  r.integer("format", format, 1, kFormat, ConfigReader::required);
  r.text("kind", kind, ConfigReader::required);
  if (r.good() && kind != "characterize")
    r.complain(*root.find("kind"), "this plan is not one of a characterisation",
               "write kind = \"characterize\"");
  r.text("name", plan.name, ConfigReader::required);
  r.text("doc", plan.doc);
  r.integer("seed", seed, 0, std::numeric_limits<std::int64_t>::max());
  plan.seed = static_cast<std::uint64_t>(seed);
  const ConfigNode* population = r.table("population", ConfigReader::required);
  const ConfigNode* procedures = r.table("procedures", ConfigReader::required);
  const ConfigNode* profiles = r.table("profiles");
  const ConfigNode* harmonic = r.table("harmonic");
  const ConfigNode* validation = r.table("validation");
  const ConfigNode* limits = r.array("limit");
  FORCEGATE_CHECK_OK(r.finish());
  FORCEGATE_CHECK_OK(read_population(*population, plan));
  {
    ConfigReader p(*procedures, "[procedures]", kGuide);
    FORCEGATE_CHECK_OK(read_procedures(p, *procedures, "flexiforce", plan.flexiforce));
    FORCEGATE_CHECK_OK(read_procedures(p, *procedures, "fsr", plan.fsr));
    FORCEGATE_CHECK_OK(read_procedures(p, *procedures, "once", plan.once));
    FORCEGATE_CHECK_OK(p.finish());
  }
  if (profiles != nullptr) FORCEGATE_CHECK_OK(read_profiles(*profiles, plan));
  Result<void> state;
  read_sines(harmonic, "[harmonic]", plan.harmonic, state);
  read_sines(validation, "[validation]", plan.validation, state);
  FORCEGATE_CHECK_OK(state);
  if (limits != nullptr)
    for (const ConfigNode& item : limits->items) FORCEGATE_CHECK_OK(read_limit(item, plan));
  return plan;
}

Result<StudyPlan> read_study_plan(const std::filesystem::path& path) {
  FORCEGATE_TRY(const std::string text, read_file(path));
  FORCEGATE_TRY(StudyPlan plan, parse_study_plan(text, path.string()));
  plan.path = path;
  return plan;
}

}  // namespace forcegate::characterize
