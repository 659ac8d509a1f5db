#include "hil/app/recording/campaign_recorder.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "hil/app/files/write_file.h"
#include "hil/base/some_of.h"
#include "hil/gate/play_profile.h"
#include "hil/trace/recording_files.h"
#include "hil/trace/trace_recorder.h"

namespace forcegate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kBetweenRecords_s = 60.0;

std::size_t samples_a_row(double rig_rate_Hz, double asked_Hz) { return static_cast<std::size_t>(std::max(1.0, std::round(rig_rate_Hz / asked_Hz))); }

std::string kind_of(const StimulusSpec& spec, const StimulusFacts& facts) {
  if (spec.name == "chirp") return "sweep";
  if (spec.name == "jump") return "switch";
  if (spec.name == "step") return "hold";
  if (spec.name == "replay") return facts.dynamic ? "multisine" : "steps";
  return spec.name;
}

// Rows of one record, averaged over `per_row` samples; the clock is that of the middle of each row.
class CsvRows {
 public:
  CsvRows(std::size_t per_row, bool wheel) : per_row_(per_row), wheel_(wheel) {
    text_ = wheel ? "t_s,F_ref_N,U_V,theta_rad,F_cmd_N\n" : "t_s,F_ref_N,U_V,F_cmd_N\n";
  }
  void push(const RigBlock& block, std::size_t rows, double volts_per_code) {
    for (std::size_t i = 0; i < rows; ++i) {
      t_s_ += block.t_s[i];
      U_V_ += volts_per_code * block.adc[i];
      cmd_N_ += static_cast<double>(block.setpoint_N[i]);
      if (std::isfinite(block.force_ref_N[i])) ref_N_ += static_cast<double>(block.force_ref_N[i]), ++known_;
      theta_rad_ = static_cast<double>(block.theta_rad[i]);
      if (++filled_ < per_row_) continue;
      const double n = static_cast<double>(per_row_);
      fmt::format_to(std::back_inserter(text_), "{:.4f},", t_s_ / n);
      if (known_ > 0)
        fmt::format_to(std::back_inserter(text_), "{:.4f}", ref_N_ / static_cast<double>(known_));
      fmt::format_to(std::back_inserter(text_), ",{:.5f},", U_V_ / n);
      if (wheel_) fmt::format_to(std::back_inserter(text_), "{:.4f},", theta_rad_);
      fmt::format_to(std::back_inserter(text_), "{:.4f}\n", cmd_N_ / n);
      t_s_ = U_V_ = cmd_N_ = ref_N_ = 0.0;
      filled_ = known_ = 0;
      ++rows_;
    }
  }
  const std::string& text() const { return text_; }
  std::uint64_t rows() const { return rows_; }

 private:
  std::size_t per_row_;
  bool wheel_;
  std::string text_;
  double t_s_ = 0, U_V_ = 0, cmd_N_ = 0, ref_N_ = 0, theta_rad_ = 0;
  std::size_t filled_ = 0, known_ = 0;
  std::uint64_t rows_ = 0;
};

Result<Json> description_of(const fs::path& list, const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(list, error)) return Json{{"campaign", folder.filename().string()}};
  std::ifstream file(list, std::ios::binary);
  Json json = Json::parse(file, nullptr, false, true);
  if (json.is_discarded() || !json.is_object())
    return fail(ErrorCode::parse, "the campaign's description cannot be read", list.string(), "it must be one JSON object; or choose another folder");
  return json;
}

void describe_bench(Json& json, const RecordingBench& bench, const RigInfo& rig, const std::map<std::string, std::string>& settings, std::size_t planned) {
  const auto sensor = rig.details.find("sensor");
  json["sensor"] = (sensor == rig.details.end() ? rig.id : sensor->second) + ", specimen " + bench.specimen;
  json["bench"] = {{"spring_N_per_mm", rig.geometry.spring_N_per_mm},
                   {"law", "F = k (preload + eccentricity (1 - cos theta))"},
                   {"voltage_range_V", {0, rig.v_range_V}},
                   {"force_range_N", {0, rig.force_max_N}},
                   {"reference_resolution_N", rig.reference_resolution_N},
                   {"reference_noise_N", rig.reference_noise_N},
                   {"adc_bits", rig.adc_bits}};
  json["recorded_with"] = {{"rig", rig.name + "/" + rig.version},
                           {"seed", bench.seed},
                           {"session", bench.session},
                           {"rate_Hz", rate_of_rows(rig.rate_Hz, bench.rate_Hz)},
                           {"rig_rate_Hz", rig.rate_Hz},
                           {"planned_records", planned}};
  if (rig.name == "bench") json["recorded_with"]["rig_id"] = rig.id;
  if (!settings.empty()) json["recorded_with"]["rig_options"] = settings;
  json["records"] = Json::array();
}

Json describe_record(const std::string& file, const ProfileToRecord& p, const Stimulus& stimulus,
                     double start_s, const RecordingBench& bench, const RigInfo& rig) {
  const StimulusFacts f = stimulus.facts();
  Json numbers = Json::object();
  for (const auto& [name, value] : p.stimulus.numbers) numbers[name] = value;
  for (const auto& [name, values] : p.stimulus.lists) numbers[name] = values;
  Json r = {{"file", file},
            {"kind", kind_of(p.stimulus, f)},
            {"fs_Hz", rate_of_rows(rig.rate_Hz, bench.rate_Hz)},
            {"duration_s", stimulus.duration_s()},
            {"start_s", start_s},
            {"rest_before_s", p.rest_before_s},
            {"dynamic", f.dynamic},
            {"eccentricity_mm", rig.geometry.eccentricity_mm},
            {"preload_mm", rig.geometry.preload_mm},
            {"stimulus", numbers}};
  if (f.dynamic) {
    r["excitation_start_s"] = f.excitation_start_s;
    if (std::isfinite(f.lowest_frequency_Hz) && f.lowest_frequency_Hz > 0.0)
      r["f_min_Hz"] = f.lowest_frequency_Hz;
    r["A_N"] = f.amplitude_N;
    r["m_N"] = f.mean_N;
  }
  return r;
}

/// A campaign.json that lists the new records alone would hide those that the folder holds.
Result<void> check_nothing_is_hidden(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error) || fs::exists(folder / "campaign.json", error)) return {};
  FORCEGATE_TRY(const RecordingFiles found, recording_files(folder));
  if (found.records.empty()) return {};
  std::vector<std::string> names;
  for (const fs::path& file : found.records) names.push_back(file.filename().string());
  return fail(ErrorCode::usage, "the folder holds recordings without a campaign.json, and the one that would be written hides them: " + some_of(names), folder.string(),
              "choose another folder with -o");
}

/// What an instrument said is not written over by another attempt.
Result<void> check_no_leftover(const fs::path& csv, bool is_listed) {
  std::error_code error;
  for (const char* ending : {".csv", ".fgj", ".h5"}) {
    const fs::path path = fs::path(csv).replace_extension(ending);
    if (!fs::exists(path, error)) continue;
    const bool journal = path.extension() == ".fgj";
    if (is_listed && path.extension() == ".h5")
      return fail(ErrorCode::usage, "the file " + csv.filename().string() + " of a listed record is gone, and what the instruments said of it is still there", path.string(),
                  "move it out of the folder, and --continue records the profile again");
    return fail(ErrorCode::usage, journal ? "there is the journal of an earlier attempt at this record" : "there is such a record already", path.string(),
                journal ? "forcegate recover makes a file of it; move both away, or choose another folder" : "move it away, or choose another folder");
  }
  return {};
}

JournalHeader header_of(const std::string& name, const RecordingBench& bench, const RigInfo& rig) {
  JournalHeader header;
  header.name = name;
  header.time_bases.push_back({"rig", rig.rate_Hz});
  header.channels = {{"F_cmd", "N", "force", SampleType::f32, 0},
                     {"F_ref", "N", "force", SampleType::f32, 0},
                     {"U", "counts", "voltage", SampleType::u16, 0},
                     {"theta", "rad", "angle", SampleType::f32, 0},
                     {"status", "counts", "status", SampleType::u16, 0}};
  header.provenance = {{"rig", rig.name + "/" + rig.version}, {"specimen", bench.specimen}};
  return header;
}

}  // namespace

double rate_of_rows(double rig_rate_Hz, double asked_Hz) { return rig_rate_Hz / static_cast<double>(samples_a_row(rig_rate_Hz, asked_Hz)); }

std::string file_of_record(std::size_t number, const std::string& name) { return fmt::format("r{:02d}_{}.csv", number, name); }

Result<std::vector<RecordedFile>> record_profiles(const RecordingBench& bench,
                                                  const std::vector<ProfileToRecord>& profiles,
                                                  const ClaimedFolder& claimed, const RecordingProgress& progress,
                                                  const std::atomic<bool>* cancelled) {
  const fs::path& folder = claimed.path();
  FORCEGATE_TRY(const std::unique_ptr<Rig> rig, make_rig(bench.rig, bench.rig_options));
  const RigInfo info = rig->info();
  if (!info.can_move)
    return fail(ErrorCode::usage, "the rig " + info.name + " plays no profile of ours", "--rig",
                "use --rig emulated or a bench file");
  std::vector<std::unique_ptr<Stimulus>> made;
  double total_s = 0.0, done_s = 0.0;
  for (const ProfileToRecord& p : profiles) {
    FORCEGATE_TRY(std::unique_ptr<Stimulus> stimulus, make_stimulus(p.stimulus));
    total_s += stimulus->duration_s();
    made.push_back(std::move(stimulus));
  }
  FORCEGATE_CHECK_OK(check_nothing_is_hidden(folder));
  std::error_code error;
  const fs::path list = folder / "campaign.json";
  FORCEGATE_TRY(Json json, description_of(list, folder));
  if (!json.contains("records")) describe_bench(json, bench, info, rig->settings(), profiles.size());
  double campaign_s = 0.0;
  for (const Json& r : json["records"])
    campaign_s = std::max(campaign_s, r.value("start_s", 0.0) + r.value("duration_s", 0.0));
  const std::size_t per_row = samples_a_row(info.rate_Hz, bench.rate_Hz);
  const double volts = info.v_range_V / static_cast<double>((1u << info.adc_bits) - 1u);

  std::vector<RecordedFile> out;
  for (std::size_t k = 0; k < profiles.size(); ++k) {
    const ProfileToRecord& p = profiles[k];
    RigRecordRequest request;
    request.specimen = bench.specimen;
    request.seed = bench.seed;
    request.session = bench.session;
    request.record = p.record > 0 ? p.record : json["records"].size() + 1;
    request.rest_before_s = p.rest_before_s;
    CsvRows rows(per_row, info.geometry.spring_N_per_mm > 0.0);
    PlayedProfile played;
    const auto sink = [&](const RigBlock& block, std::size_t n) {
      rows.push(block, n, volts);
      if (progress) progress((done_s + block.t_s[n - 1]) / total_s, p.name);
    };
    const std::string file = file_of_record(request.record, p.name);
    FORCEGATE_CHECK_OK(check_no_leftover(folder / file, p.record > 0));
    // An emulated record can be made again; what instruments said cannot.
    std::optional<TraceRecorder> journal;
    ProfileSaver saver;
    if (rig->board_firmware() != nullptr) {
      FORCEGATE_TRY(TraceRecorder created, TraceRecorder::create((folder / file).replace_extension(".h5"),
                                                                 header_of(p.name, bench, info)));
      journal.emplace(std::move(created));
      saver = [&journal](const RigBlock& b, std::size_t from, std::size_t n) {
        const auto part = [from, n](const auto& column) {
          return ColumnView(std::span(column.data() + from, n));
        };
        const ColumnView columns[] = {part(b.setpoint_N), part(b.force_ref_N), part(b.adc), part(b.theta_rad),
                                      part(b.status)};
        return journal->append({b.t_s.data() + from, n}, columns);
      };
    }
    if (auto ok = play_profile(*rig, *made[k], request, bench.safety, sink, cancelled, played, saver); !ok) {
      Error& e = ok.error();
      if (e.where.empty()) e.where = p.name;
      if (journal && played.samples > 0)
        e.hint += std::string(e.hint.empty() ? "" : "; ") +
                  "what was recorded until then: forcegate recover " + journal->journal_path().string();
      return Unexpected(e);
    }
    if (journal) FORCEGATE_CHECK_OK(journal->close());
    done_s += made[k]->duration_s();
    FORCEGATE_CHECK_OK(write_file_atomically(folder / file, rows.text()));
    const bool again = p.record > 0 && !journal;  // an emulated record is made anew, as it was; instruments measure another one, later
    const double start_s = again ? json["records"][p.record - 1].value("start_s", 0.0) : campaign_s + (json["records"].empty() ? 0.0 : p.rest_before_s + kBetweenRecords_s);
    const Json described = describe_record(file, p, *made[k], start_s, bench, played.rig);
    if (p.record > 0) json["records"][p.record - 1] = described;
    else json["records"].push_back(described);
    campaign_s = std::max(campaign_s, start_s + made[k]->duration_s());
    // after every record: what is recorded stays, whatever happens to the next one
    if (auto listed = write_file_atomically(list, json.dump(1) + "\n"); !listed) {
      fs::remove(folder / file, error);  // no record of the campaign; what instruments said is in the HDF5 file
      return Unexpected(listed.error());
    }
    out.push_back({p.name, file, made[k]->duration_s(), rows.rows(), rate_of_rows(info.rate_Hz, bench.rate_Hz), info.rate_Hz});
  }
  return out;
}

}  // namespace forcegate
