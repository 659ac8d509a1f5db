#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "hil/base/digest.h"
#include "hil/base/read_file.h"
#include "hil/base/rng.h"
#include "hil/base/text.h"
#include "hil/gate/plan.h"
#include "hil/interface/controller.h"
#include "hil/interface/dut.h"
#include "hil/rig/config.h"

namespace forcegate {
namespace {

constexpr double kDay_s = 86400.0;
constexpr std::size_t kMostCases = 1000, kMostSpecimens = 1000;

// A name becomes a part of file names and of console lines.
bool usable_name(const std::string& name) {
  if (name.empty() || name.size() > 80 || name.front() == '.') return false;
  return name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.+-:") ==
         std::string::npos;
}

Result<StimulusSpec> read_stimulus(const ConfigNode& node, std::uint64_t seed) {
  StimulusSpec spec;
  spec.seed = seed;
  for (std::size_t i = 0; i < node.names.size(); ++i) {
    const std::string& name = node.names[i];
    const ConfigNode& item = node.items[i];
    if (name == "name") {
      if (item.kind != ConfigNode::Kind::text)
        return fail(ErrorCode::config, "'name' of a stimulus must be a text in quotes", item.where, "write name = \"sine\" (forcegate stimulus --help lists them)");
      spec.name = item.text;
    } else if (name == "seed") {
      if (item.kind != ConfigNode::Kind::integer || item.integer < 0)
        return fail(ErrorCode::config, "'seed' of a stimulus must be a whole number from 0", item.where, "write seed = 1");
      spec.seed = static_cast<std::uint64_t>(item.integer);
    } else if (item.kind == ConfigNode::Kind::number || item.kind == ConfigNode::Kind::integer) {
      spec.numbers[name] = item.number;
    } else if (item.kind == ConfigNode::Kind::text) {
      spec.texts[name] = item.text;
    } else if (item.kind == ConfigNode::Kind::array) {
      for (const ConfigNode& value : item.items) {
        if (value.kind != ConfigNode::Kind::number && value.kind != ConfigNode::Kind::integer)
          return fail(ErrorCode::config, fmt::format("'{}' of a stimulus must hold numbers", name),
                      value.where, "write " + name + " = [0.5, 1]");
        spec.lists[name].push_back(value.number);
      }
    } else {
      return fail(ErrorCode::config, fmt::format("'{}' of a stimulus cannot be {}", name, item.kind_name()),
                  item.where, "give a number, a text in quotes or a list of numbers");
    }
  }
  if (spec.name.empty())
    return fail(ErrorCode::config, "a stimulus needs the key 'name'", node.where,
                "for example stimulus = { name = \"sine\", f_Hz = 0.5, A_N = 1.05, m_N = 2.15 }");
  const auto made = make_stimulus(spec);
  if (!made) return fail(ErrorCode::config, made.error().text, node.where, made.error().hint);
  const double duration_s = (*made)->duration_s();
  if (!(duration_s > 0.0 && duration_s <= kDay_s))
    return fail(ErrorCode::config, "the stimulus lasts " + shortest(duration_s) + " s", node.where,
                "a record lasts more than 0 s and at most a day");
  return spec;
}

// What the rig would stop at is no profile.
Result<void> below_the_stop(const Plan& plan, double highest_N, const std::string& what, const std::string& where) {
  if (!(highest_N >= plan.safety.force_max_N)) return {};
  return fail(ErrorCode::config, fmt::format("{} goes to {} N, and a record is stopped at {} N", what, shortest(highest_N), shortest(plan.safety.force_max_N)),
              where, "lower it, or raise force_max_N of [safety]");
}

// The firmware and the ATI are averaged over an extremum, the set-point they are held against is not: 0.6 % of a swing at the most.
Result<void> averages_little(const PlanCase& c, const std::string& where) {
  constexpr double kOfPeriod = 0.03;
  double f_Hz = 0.0;
  if (const auto one = c.stimulus.numbers.find("f_Hz"); one != c.stimulus.numbers.end()) f_Hz = one->second;
  if (const auto many = c.stimulus.lists.find("f_Hz"); many != c.stimulus.lists.end())
    for (const double f : many->second) f_Hz = std::max(f_Hz, f);
  if (!(c.half_width_s * f_Hz > kOfPeriod)) return {};
  return fail(ErrorCode::config,
              fmt::format("half_width_ms of case '{}' averages over more of its period of {} ms than an extremum is wide", c.name,
                          shortest(1000.0 / f_Hz)),
              where, fmt::format("give at most {} ms, {} of the period", shortest(1000.0 * kOfPeriod / f_Hz), shortest(kOfPeriod)));
}

double highest_N(const StimulusSpec& spec) {
  const auto made = make_stimulus(spec);
  return made ? (*made)->facts().maximum_N : std::numeric_limits<double>::quiet_NaN();
}

// A program that knows none of the kind (a test of the reader alone) has nothing to say.
template <class Kind>
const Kind* known_kind(ConfigReader& r, const ConfigNode& table, const char* key, const std::string& name) {
  const auto& kinds = Registry<Kind>::instance();
  const Kind* const kind = kinds.find(name);
  const ConfigNode* const given = table.find(key);
  if (kind != nullptr || kinds.names().empty() || given == nullptr) return kind;
  const std::string near = nearest_name(name, kinds.names());
  r.complain(*given, fmt::format("there is no {} named '{}'", key, printable_utf8(name)),
             near.empty() ? "choose from: " + join(kinds.names(), ", ") : "did you mean '" + near + "'?");
  return nullptr;
}

// A controller that looks at no estimate leaves a closed loop open, and the other way round.
void read_devices(ConfigReader& r, const ConfigNode& node, PlanCase& c) {
  c.controller = c.loop == LoopMode::closed ? "force_integral" : "open_loop";
  r.text("controller", c.controller);
  r.text("lane", c.lane);
  if (!c.lane.empty()) known_kind<LaneKind>(r, node, "lane", c.lane);
  const ControllerKind* const kind = known_kind<ControllerKind>(r, node, "controller", c.controller);
  const bool closed = c.loop == LoopMode::closed;
  if (kind == nullptr || node.find("controller") == nullptr || kind->make()->uses_estimate() == closed) return;
  r.complain(*node.find("controller"),
             fmt::format("the controller '{}' {} the firmware's estimate, the loop is {}", c.controller, closed ? "does not look at" : "needs", to_string(c.loop)),
             closed ? "leave loop = \"closed\" out, or take force_integral" : "add loop = \"closed\", or leave the controller out");
}

Result<void> read_specimens(ConfigReader& r, std::vector<std::string>& out, const ConfigNode& table) {
  if (!r.texts("specimens", out)) return {};
  std::set<std::string> seen;
  for (const std::string& specimen : out) {
    if (!usable_name(specimen))
      r.complain(*table.find("specimens"), fmt::format("'{}' cannot name a specimen", specimen), "use up to 80 letters, digits and _ . + -");
    if (!seen.insert(specimen).second)
      r.complain(*table.find("specimens"), fmt::format("specimen '{}' is named twice", specimen), "name every specimen once");
  }
  if (out.empty() || out.size() > kMostSpecimens)
    r.complain(*table.find("specimens"), "a list of specimens holds 1 to 1000 names", "write specimens = [\"q50\"], or leave the key of a case out: it then takes the panel");
  return {};
}

Result<void> read_checks(ConfigReader& r, const ConfigNode& table, PlanCase& c) {
  static const std::vector<std::string> kNames{"conformance", "promise", "accuracy", "hold", "golden"};
  std::vector<std::string> names;
  if (!r.texts("checks", names)) return {};
  for (const std::string& name : names) {
    const auto at = std::find(kNames.begin(), kNames.end(), name);
    if (at == kNames.end()) {
      const std::string near = nearest_name(name, kNames);
      r.complain(*table.find("checks"), fmt::format("there is no check named '{}'", name),
                 near.empty() ? "choose from: " + join(kNames, ", ") : "did you mean '" + near + "'?");
      return {};
    }
    c.checks |= 1u << (at - kNames.begin());
  }
  return {};
}

Result<PlanCase> read_case(const ConfigNode& node, const Plan& plan) {
  PlanCase c;
  c.where = node.where;
  ConfigReader r(node, "a case");
  if (r.text("name", c.name, ConfigReader::required) && !usable_name(c.name))
    r.complain(*node.find("name"), fmt::format("'{}' cannot name a case", c.name),
               "use up to 80 letters, digits and _ . + -");
  c.title = c.name;
  r.text("title", c.title);
  c.source = "ours";
  r.text("source", c.source);
  std::string loop = "open";
  r.choice("loop", loop, {"open", "closed"});
  c.loop = loop == "closed" ? LoopMode::closed : LoopMode::open;
  read_devices(r, node, c);
  FORCEGATE_CHECK_OK(read_checks(r, node, c));
  FORCEGATE_CHECK_OK(read_specimens(r, c.specimens, node));
  r.number("rest_before_s", c.rest_before_s = plan.calibration.rest_s, 0.0, 1e9);
  r.number("prominence_N", c.prominence_N, 0.01, 5.0);
  double half_width_ms = 1000.0 * c.half_width_s;
  const bool own_width = r.number("half_width_ms", half_width_ms, 0.0, 1000.0);
  if (own_width) c.half_width_s = half_width_ms / 1000.0;
  r.number("tail_s", c.tail_s, 0.0, kDay_s);
  r.number("prelude_s", c.prelude_s, 0.0, kDay_s);
  double limit = 0.0;
  for (const auto& [key, given] : {std::pair{"maxima_pct", &c.maxima_pct}, std::pair{"minima_pct", &c.minima_pct}}) {
    if (!r.number(key, limit, 0.0, 1000.0)) continue;
    *given = limit;
    if (limit == 0.0)
      r.complain(*node.find(key), fmt::format("{} = 0 passes no firmware: every error has an uncertainty", key),
                 "leave it out, and derive limits (forcegate limits)");
  }
  r.text("limit_source", c.limit_source);
  const ConfigNode* stimulus = r.table("stimulus", ConfigReader::required);
  FORCEGATE_CHECK_OK(r.finish());  // a misspelt key explains one that is missing
  if (r.good() && (c.maxima_pct || c.minima_pct) && c.limit_source.empty())
    r.complain(node, fmt::format("case '{}' gives a limit without saying whose it is", c.name),
               "add limit_source = \"Lebosse 2011, IV-B2\" or \"ours: reason\"");
  if (r.good() && c.checks & kCheckPromise && c.loop == LoopMode::open)
    r.complain(*node.find("checks"), "the check 'promise' is about the closed loop", "add loop = \"closed\"");
  if (r.good() && c.checks & kCheckPromise && !(c.maxima_pct && c.minima_pct))
    r.complain(*node.find("checks"), "the check 'promise' needs maxima_pct, minima_pct and limit_source",
               "add them: what the mean over the panel may be off, in %, and who says so");
  FORCEGATE_CHECK_OK(r.finish());
  FORCEGATE_TRY(c.stimulus, read_stimulus(*stimulus, mix_seed(plan.seed, "stimulus/" + c.name)));
  FORCEGATE_CHECK_OK(below_the_stop(plan, highest_N(c.stimulus), "the profile of case '" + c.name + "'", stimulus->where));
  if (own_width) FORCEGATE_CHECK_OK(averages_little(c, node.find("half_width_ms")->where));
  return c;
}

Result<void> read_calibration(const ConfigNode& node, Plan& plan) {
  PlanCalibration& c = plan.calibration;
  ConfigReader r(node, "[calibration]");
  std::string level = "identified";
  r.choice("level", level, {"nominal", "static", "identified"});
  c.level = level == "nominal"  ? CalibrationLevel::nominal
            : level == "static" ? CalibrationLevel::statical
                                : CalibrationLevel::identified;
  r.number("sweep_low_N", c.sweep_low_N, 0.0, 5.0);
  r.number("sweep_high_N", c.sweep_high_N, 0.0, 5.5);
  r.number("sweep_s", c.sweep_s, 1.0, 7200.0);
  std::int64_t sweeps = c.sweeps;
  if (r.integer("sweeps", sweeps, 1, 20)) c.sweeps = static_cast<int>(sweeps);
  r.number("rest_s", c.rest_s, 0.0, 1e9);
  if (r.good() && !(c.sweep_high_N > c.sweep_low_N + 0.5))
    r.complain(node, "the calibration sweep must span more than 0.5 N", "raise sweep_high_N, or lower sweep_low_N");
  const ConfigNode* identification = r.table("identification");
  FORCEGATE_CHECK_OK(r.finish());
  if (identification != nullptr) {
    ConfigReader i(*identification, "[calibration.identification]");
    PlanIdentification record;
    record.source = "ours";
    i.text("source", record.source);
    const ConfigNode* stimulus = i.table("stimulus", ConfigReader::required);
    FORCEGATE_CHECK_OK(i.finish());
    FORCEGATE_TRY(record.stimulus, read_stimulus(*stimulus, mix_seed(plan.seed, "identification")));
    c.identification = record;
  }
  if (c.level == CalibrationLevel::identified && !c.identification)
    return fail(ErrorCode::config, "level 'identified' needs [calibration.identification]", node.where,
                "name the sine record from which b and c/a are identified");
  if (c.level == CalibrationLevel::nominal) return {};
  const ConfigNode* const sweep = node.find("sweep_high_N");
  FORCEGATE_CHECK_OK(below_the_stop(plan, c.sweep_high_N, "the calibration sweep", sweep != nullptr ? sweep->where : node.where));
  if (c.level != CalibrationLevel::identified) return {};
  return below_the_stop(plan, highest_N(c.identification->stimulus), "the record of the identification", identification->where);
}

Result<void> read_rule(const ConfigNode& node, DecisionRule& rule) {
  ConfigReader r(node, "[rule]");
  r.choice("name", rule.name, {"guarded", "simple"});
  r.number("alpha", rule.alpha, 1e-6, 0.2);
  r.number("coverage", rule.coverage, 0.5, 0.9999);
  std::int64_t looks = rule.looks;
  if (r.integer("looks", looks, 1, 10)) rule.looks = static_cast<int>(looks);
  return r.finish();
}

Result<void> read_retry(const ConfigNode& node, PlanRetry& retry) {
  ConfigReader r(node, "[retry]");
  std::int64_t attempts = retry.attempts;
  if (r.integer("attempts", attempts, 1, 10)) retry.attempts = static_cast<int>(attempts);
  return r.finish();
}

Result<void> read_safety(const ConfigNode& node, SafetyLimits& s) {
  ConfigReader r(node, "[safety]");
  r.number("force_max_N", s.force_max_N, 0.1, 100.0);
  r.number("velocity_max_rad_per_s", s.velocity_max_rad_per_s, 0.0, 1000.0);
  std::int64_t lost = s.reference_lost_samples;
  if (r.integer("reference_lost_samples", lost, 1, 1000000))
    s.reference_lost_samples = static_cast<int>(lost);
  return r.finish();
}

Result<void> read_limits(const ConfigNode& node, PlanLimits& l) {
  ConfigReader r(node, "[limits]");
  r.text("goldens", l.goldens);
  if (r.text("derived", l.derived)) l.derived_where = node.find("derived")->where;
  r.number("learning_s", l.learning_s, 0.0, kDay_s);
  if (r.number("lag_s", l.lag_s, 0.0, 60.0) && l.lag_s == 0.0)
    r.complain(*node.find("lag_s"), "lag_s = 0 passes no firmware: every distance in time has an uncertainty", "give the longest one, in s (0.05 where nothing is said)");
  if (r.number("output_max_N", l.output_max_N, 0.0, 1e6) && l.output_max_N == 0.0)
    r.complain(*node.find("output_max_N"), "output_max_N = 0 passes no firmware: every force lies above it", "give the largest output that is no fault, in N; leave it out for the one that is meant for the panel's sensors");
  r.number("spike_max_N", l.spike_max_N, 0.0, 1e6);
  r.number("excursion_max_N", l.excursion_max_N, 0.0, 1e6);
  r.number("hold_pct", l.hold_pct, 0.0, 1000.0);
  r.number("minima_floor_N", l.minima_floor_N, 0.0, 5.0);
  r.number("increase_pct", l.increase_pct, 0.0, 100.0);
  r.number("instructions", l.instructions, 0.0, 1e9);
  r.number("stack_bytes", l.stack_bytes, 0.0, 1e9);
  r.number("ram_bytes", l.ram_bytes, 0.0, 1e9);
  r.number("flash_bytes", l.flash_bytes, 0.0, 1e9);
  return r.finish();
}

Result<void> read_uncertainty(const ConfigNode& node, PlanUncertainty& u) {
  ConfigReader r(node, "[uncertainty]");
  r.number("reference_rel", u.reference_rel, 0.0, 1.0);
  r.number("alignment_rel", u.alignment_rel, 0.0, 1.0);
  r.number("record_repeat_pct", u.record_repeat_pct, 0.0, 100.0);
  return r.finish();
}

Result<void> read_self_check(const ConfigNode& node, SelfCheckLimits& s) {
  ConfigReader r(node, "[self_check]");
  r.number("zero_N", s.zero_N, 0.0, 5.0);
  r.number("spring_bias_N", s.spring_bias_N, 0.0, 5.0);
  r.number("spring_slope", s.spring_slope, 0.0, 1.0);
  r.number("spring_scatter_N", s.spring_scatter_N, 0.0, 5.0);
  r.number("following_rad", s.following_rad, 0.0, 10.0);
  r.number("reference_lag_s", s.reference_lag_s, 0.0, 10.0);
  r.number("noise_factor", s.noise_factor, 0.0, 1000.0);
  r.number("reference_bad_share", s.reference_bad_share, 0.0, 1.0);
  r.number("lost_share", s.lost_share, 0.0, 1.0);
  r.number("stale_share", s.stale_share, 0.0, 1.0);
  r.number("sensor_odd_share", s.sensor_odd_share, 0.0, 1.0);
  r.number("jump_share", s.jump_share, 0.0, 1.0);
  r.number("gap_s", s.gap_s, 0.0, kDay_s);
  r.number("clock_rel", s.clock_rel, 0.0, 1.0);
  r.number("frozen_s", s.frozen_s, 0.0, kDay_s);
  r.number("wheel_still_s", s.wheel_still_s, 0.0, kDay_s);
  r.number("sensor_dead_s", s.sensor_dead_s, 0.0, kDay_s);
  return r.finish();
}

}  // namespace

std::string_view to_string(LoopMode mode) { return mode == LoopMode::closed ? "closed" : "open"; }

const std::vector<std::string>& specimens_of(const Plan& plan, const PlanCase& planned) {
  return planned.specimens.empty() ? plan.panel : planned.specimens;
}

Result<Plan> parse_plan(std::string_view text, const std::string& name) {
  FORCEGATE_TRY(const ConfigNode root, parse_config(text, name));
  Plan plan;
  plan.path = name;
  plan.sha256 = sha256_hex(text);
  if (const ConfigNode* kind = root.find("kind"))
    return fail(
        ErrorCode::config,
        "this is a plan of kind '" + kind->text + "', not one of cases for a gate on the test bench",
        kind->where,
        "forcegate gate, plan and check take kind capacitance-gate, forcegate characterize takes characterize and capacitance, and checks such a plan before it plays it");
  ConfigReader r(root, "the plan");
  std::int64_t format = 0, seed = 1;
  r.integer("format", format, 1, kPlanFormat, ConfigReader::required);
  r.text("name", plan.name, ConfigReader::required);
  if (r.good() && !usable_name(plan.name)) r.complain(*root.find("name"), "this cannot name a plan", "use up to 80 letters, digits and _ . + -");
  r.text("doc", plan.doc);
  r.integer("seed", seed, 0, std::numeric_limits<std::int64_t>::max());
  plan.seed = static_cast<std::uint64_t>(seed);
  const ConfigNode* const rule = r.table("rule");
  const ConfigNode* const retry = r.table("retry");
  const ConfigNode* const panel = r.table("panel", ConfigReader::required);
  const ConfigNode* const calibration = r.table("calibration", ConfigReader::required);
  const ConfigNode* const safety = r.table("safety");
  const ConfigNode* const limits = r.table("limits");
  const ConfigNode* const uncertainty = r.table("uncertainty");
  const ConfigNode* const self = r.table("self_check");
  const ConfigNode* const cases = r.array("case", ConfigReader::required);
  FORCEGATE_CHECK_OK(r.finish());
  if (rule != nullptr) FORCEGATE_CHECK_OK(read_rule(*rule, plan.rule));
  if (retry != nullptr) FORCEGATE_CHECK_OK(read_retry(*retry, plan.retry));
  {
    ConfigReader p(*panel, "[panel]");
    FORCEGATE_CHECK_OK(read_specimens(p, plan.panel, *panel));
    if (panel->find("specimens") == nullptr) p.complain(*panel, "[panel] needs the key 'specimens'", "write specimens = [\"q50\"]");
    FORCEGATE_CHECK_OK(p.finish());
  }
  if (safety != nullptr) FORCEGATE_CHECK_OK(read_safety(*safety, plan.safety));
  FORCEGATE_CHECK_OK(read_calibration(*calibration, plan));
  if (limits != nullptr) FORCEGATE_CHECK_OK(read_limits(*limits, plan.limits));
  if (uncertainty != nullptr) FORCEGATE_CHECK_OK(read_uncertainty(*uncertainty, plan.uncertainty));
  if (self != nullptr) FORCEGATE_CHECK_OK(read_self_check(*self, plan.self_check));
  if (cases->items.empty() || cases->items.size() > kMostCases)
    return fail(ErrorCode::config, "a plan holds 1 to 1000 cases", cases->where, "write a [[case]] for each");
  std::set<std::string> names;
  for (const ConfigNode& item : cases->items) {
    if (item.kind != ConfigNode::Kind::table)
      return fail(ErrorCode::config, "a case must be a table", item.where, "write [[case]]");
    FORCEGATE_TRY(PlanCase c, read_case(item, plan));
    if (!names.insert(c.name).second)
      return fail(ErrorCode::config, fmt::format("two cases are named '{}'", c.name), item.where, "give every case a name of its own");
    plan.cases.push_back(std::move(c));
  }
  return plan;
}

Result<Plan> read_plan(const std::filesystem::path& path) {
  FORCEGATE_TRY(const std::string text, read_file(path));
  FORCEGATE_TRY(Plan plan, parse_plan(text, path.string()));
  plan.path = path;
  return plan;
}

}  // namespace forcegate
