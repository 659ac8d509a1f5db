#include "hil/rig/bench_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "hil/base/iso_date.h"
#include "hil/base/text.h"
#include "hil/interface/device.h"
#include "hil/rig/config.h"

namespace forcegate {
namespace {

constexpr const char* kGuide = "docs/bench.md";

// The noise found is judged by the noise declared: one as large as the forces themselves would let any reference pass.
Result<void> check_declared_noise(const ConfigNode& reference, const BenchFile& bench) {
  constexpr double kLargest = 0.1;
  if (!(bench.reference_noise_N > kLargest * bench.limits.force_max_N)) return {};
  return fail(ErrorCode::config,
              fmt::format("'noise_N' in [reference] = {} is more than a tenth of force_max_N in [limits], {} N: no noise would be too much for such a reference",
                          shortest(bench.reference_noise_N), shortest(bench.limits.force_max_N)),
              reference.find("noise_N")->where, "write the standard deviation of a reading at rest, in N");
}

Result<void> read_limits(const ConfigNode& table, BenchLimits& out) {
  ConfigReader in(table, "[limits]", kGuide);
  in.number("force_max_N", out.force_max_N, 0.01, 100000, ConfigReader::required);
  in.number("velocity_max_rad_per_s", out.velocity_max_rad_per_s, 0.001, 1000, ConfigReader::required);
  in.number("force_rate_max_N_per_s", out.force_rate_max_N_per_s, 0.01, 1e6, ConfigReader::required);
  in.number("reference_stale_s", out.reference_stale_s, 0.002, 1);
  in.number("board_stale_s", out.board_stale_s, 0.02, 1);
  in.number("start_velocity_rad_per_s", out.start_velocity_rad_per_s, 0.01, 10);
  return in.finish();
}

Result<void> read_geometry(const ConfigNode& table, RigGeometry& out) {
  ConfigReader in(table, "[geometry]", kGuide);
  in.number("spring_N_per_mm", out.spring_N_per_mm, 1e-4, 1e4, ConfigReader::required);
  in.number("eccentricity_mm", out.eccentricity_mm, 0.01, 1000, ConfigReader::required);
  in.number("preload_mm", out.preload_mm, 0, 1000);
  constexpr double kHalfTurn_rad = 3.142;  // pi as people write it
  in.number("theta_min_rad", out.theta_min_rad, 0.0, kHalfTurn_rad);
  in.number("theta_max_rad", out.theta_max_rad, 0.0, kHalfTurn_rad);
  if (!(out.theta_min_rad < out.theta_max_rad))
    in.complain(table, "theta_min_rad must be below theta_max_rad");
  return in.finish();
}

Result<void> read_calibrations(const ConfigNode& table, std::vector<BenchCalibration>& out) {
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    const ConfigNode& node = table.items[i];
    const std::string what = "calibration '" + table.names[i] + "'";
    if (node.kind != ConfigNode::Kind::table)
      return fail(ErrorCode::config, what + " must be a table", node.where,
                  "for example spring = { id = \"S-3\", expires = \"2027-01-31\" }");
    ConfigReader in(node, what, kGuide);
    BenchCalibration c;
    c.what = table.names[i];
    in.text("id", c.id, ConfigReader::required);
    if (in.text("expires", c.expires, ConfigReader::required) && !is_iso_date(c.expires))
      in.complain(node, "'expires' of " + what + " is no date", "write it as \"2027-01-31\"");
    FORCEGATE_CHECK_OK(in.finish());
    out.push_back(c);
  }
  return {};
}

Result<void> read_specimens(const ConfigNode& table, BenchSpecimens& out) {
  ConfigReader in(table, "[specimens]", kGuide);
  std::string log, short_rest = "refuse";
  double rest_h = 2.0;
  in.text("log", log, ConfigReader::required);
  in.number("rest_h", rest_h, 0, 1000);
  in.choice("short_rest", short_rest, {"refuse", "widen"});
  const bool told = in.number("short_rest_u_rel", out.short_rest_u_rel, 1e-6, 1.0);
  if (short_rest == "widen" && !told)
    in.complain(table, "short_rest = \"widen\" needs short_rest_u_rel",
                "how much do two records without a rest differ on this sensor?");
  out.log = std::filesystem::path(table.file).parent_path() / log;
  out.rest_s = 3600.0 * rest_h;
  out.widen = short_rest == "widen";
  return in.finish();
}

template <class Kind>
Result<void> choose_adapter(const ConfigNode& table, const std::string& what, std::string& out) {
  const auto names = Registry<Kind>::instance().names();
  const ConfigNode* node = table.find("adapter");
  if (node == nullptr || node->kind != ConfigNode::Kind::text)
    return fail(ErrorCode::config, "[" + what + "] needs the key 'adapter'", table.where,
                "choose one of: " + join(names, ", "));
  if (Registry<Kind>::instance().find(node->text) == nullptr) {
    const std::string near = nearest_name(node->text, names);
    return fail(ErrorCode::config, "there is no adapter '" + node->text + "' for [" + what + "]", node->where,
                near.empty() ? "choose one of: " + join(names, ", ") : "did you mean '" + near + "'?");
  }
  out = node->text;
  return {};
}

void take_number(const ConfigNode& table, const char* key, double& out) {
  if (const ConfigNode* n = table.find(key);
      n != nullptr && (n->kind == ConfigNode::Kind::number || n->kind == ConfigNode::Kind::integer))
    out = n->number;
}

Result<BenchFile> build(ConfigNode root) {
  BenchFile b;
  ConfigReader in(root, "the bench file", kGuide);
  std::int64_t format = 0;
  in.integer("format", format, kBenchFormat, kBenchFormat, ConfigReader::required);
  in.text("name", b.name, ConfigReader::required);
  in.text("id", b.id, ConfigReader::required);
  in.text("doc", b.doc);
  const ConfigNode* limits = in.table("limits", ConfigReader::required);
  const ConfigNode* geometry = in.table("geometry", ConfigReader::required);
  const ConfigNode* calibrations = in.table("calibration", ConfigReader::required);
  const ConfigNode* sensor = in.table("sensor");
  const ConfigNode* specimens = in.table("specimens");
  const ConfigNode* ports = in.table("ports");
  const ConfigNode* motor = in.table("motor", ConfigReader::required);
  const ConfigNode* reference = in.table("reference", ConfigReader::required);
  const ConfigNode* board = in.table("board", ConfigReader::required);
  const ConfigNode* twins = in.table("twins");
  b.twins = twins != nullptr;
  if (const ConfigNode* clock = b.twins ? twins->find("clock") : nullptr) b.paced = clock->text == "paced";
  FORCEGATE_CHECK_OK(in.finish());
  FORCEGATE_CHECK_OK(read_limits(*limits, b.limits));
  FORCEGATE_CHECK_OK(read_geometry(*geometry, b.geometry));
  b.geometry.velocity_max_rad_per_s = b.limits.velocity_max_rad_per_s;
  FORCEGATE_CHECK_OK(read_calibrations(*calibrations, b.calibrations));
  if (specimens != nullptr) FORCEGATE_CHECK_OK(read_specimens(*specimens, b.specimens));
  if (sensor != nullptr) {
    ConfigReader s(*sensor, "[sensor]", kGuide);
    s.number("nominal_gain_N_per_V", b.nominal_gain_N_per_V, 1e-3, 100);
    s.number("nominal_offset_N", b.nominal_offset_N, -50, 50);
    FORCEGATE_CHECK_OK(s.finish());
  }
  if (ports != nullptr)
    for (const ConfigNode& port : ports->items)
      if (port.kind != ConfigNode::Kind::text || !port.text.starts_with("/"))
        return fail(ErrorCode::config, "a port must be the path of a device", port.where,
                    "prefer /dev/serial/by-id/...: those names survive replugging");
  FORCEGATE_CHECK_OK(choose_adapter<MotorKind>(*motor, "motor", b.motor_adapter));
  FORCEGATE_CHECK_OK(choose_adapter<ReferenceKind>(*reference, "reference", b.reference_adapter));
  FORCEGATE_CHECK_OK(choose_adapter<BoardKind>(*board, "board", b.board_adapter));
  take_number(*board, "rate_Hz", b.rate_Hz);
  take_number(*board, "v_range_V", b.v_range_V);
  // what every image takes (docs/protocol.md); beyond it, it would refuse the calibration and be charged with that
  if (b.v_range_V < 0.1 || b.v_range_V > 100.0)
    return fail(ErrorCode::config, "'v_range_V' in [board] = " + shortest(b.v_range_V) + " is out of range", board->find("v_range_V")->where, "give a number from 0.1 to 100");
  double bits = b.adc_bits;
  take_number(*board, "adc_bits", bits);
  b.adc_bits = static_cast<int>(std::clamp(bits, 8.0, 16.0));
  take_number(*reference, "resolution_N", b.reference_resolution_N);
  take_number(*reference, "noise_N", b.reference_noise_N);
  take_number(*reference, "u_rel", b.reference_u_rel);
  if (const ConfigNode* id = reference->find("calibration_id"); id != nullptr && id->kind == ConfigNode::Kind::text) b.reference_calibration_id = id->text;
  FORCEGATE_CHECK_OK(check_declared_noise(*reference, b));
  b.root = std::move(root);
  return b;
}

}  // namespace

const ConfigNode& BenchFile::table(const char* device) const { return *root.find(device); }

Result<BenchFile> read_bench(const std::filesystem::path& path) {
  FORCEGATE_TRY(ConfigNode root, read_config(path));
  FORCEGATE_TRY(BenchFile bench, build(std::move(root)));
  bench.path = path;
  return bench;
}

Result<BenchFile> read_bench_text(std::string_view text, const std::string& name) {
  FORCEGATE_TRY(ConfigNode root, parse_config(text, name));
  return build(std::move(root));
}

std::vector<BenchCalibration> expired(const BenchFile& bench, const std::string& today) {
  std::vector<BenchCalibration> out;
  for (const BenchCalibration& c : bench.calibrations)
    if (c.expires < today) out.push_back(c);
  return out;
}

std::string reference_calibration_remark(const BenchFile& bench) {
  const auto dated = std::ranges::find(bench.calibrations, "reference", &BenchCalibration::what);
  if (dated == bench.calibrations.end()) return "[calibration] has no 'reference': nobody sees when the calibration of the reference is out of date";
  if (bench.reference_calibration_id.empty() || dated->id == bench.reference_calibration_id) return {};
  return fmt::format("the date under [calibration] is that of {}, and calibration_id of [reference] is {}", dated->id, bench.reference_calibration_id);
}

RigInfo rig_info(const BenchFile& b) {
  RigInfo info;
  info.name = "bench";
  info.id = b.id;
  info.version = std::to_string(kBenchFormat);
  info.rate_Hz = b.rate_Hz;
  info.adc_bits = b.adc_bits;
  info.v_range_V = b.v_range_V;
  info.force_max_N = b.limits.force_max_N;
  info.reference_resolution_N = b.reference_resolution_N;
  info.reference_noise_N = b.reference_noise_N;
  info.reference_u_rel = b.reference_u_rel;
  info.geometry = b.geometry;
  info.force_rate_max_N_per_s = b.limits.force_rate_max_N_per_s;
  info.can_move = true;
  info.emulated = b.twins;
  info.details["bench"] = b.name;
  if (b.paced) info.details["clock"] = "paced";
  info.details["nominal_gain_N_per_V"] = shortest(b.nominal_gain_N_per_V);
  info.details["nominal_offset_N"] = shortest(b.nominal_offset_N);
  for (const BenchCalibration& c : b.calibrations)
    info.details["calibration " + c.what] = c.id + ", until " + c.expires;
  if (std::string remark = reference_calibration_remark(b); !remark.empty()) info.details[kReferenceCalibrationRemark] = std::move(remark);
  return info;
}

}  // namespace forcegate
