#include "rigs/emulated/hidden/campaign_writer.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "hil/base/read_file.h"
#include "rigs/emulated/hidden/documentation.h"
#include "rigs/emulated/hidden/played_forces.h"
#include "rigs/emulated/hidden/seal.h"

namespace forcegate::hidden {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Fixed-point text of a double: an order faster than a general conversion.
char* put_fixed(char* at, double value, int decimals) {
  static constexpr std::int64_t kTen[] = {1, 10, 100, 1000, 10000, 100000, 1000000};
  const std::int64_t unit = kTen[decimals];
  std::int64_t scaled = std::llround(value * static_cast<double>(unit));
  if (scaled < 0) *at++ = '-', scaled = -scaled;
  at = std::to_chars(at, at + 20, scaled / unit).ptr;
  if (decimals == 0) return at;
  *at++ = '.';
  std::int64_t rest = scaled % unit;
  for (int d = decimals - 1; d >= 0; --d) at[d] = static_cast<char>('0' + rest % 10), rest /= 10;
  return at + decimals;
}

struct Column {
  const char* name;
  const std::vector<double>* values;
  int decimals;
  double factor = 1.0;        ///< written = value * factor
  const char* exponent = "";  ///< text after the number
};

std::string csv_text(const RecordData& record) {
  std::vector<Column> columns = {
      {"t_s", &record.stamp_s, 6}, {"F_ref_N", &record.force_ref_N, 3}, {"U_V", &record.voltage_V, 5}};
  if (!record.theta_rad.empty()) columns.push_back({"theta_rad", &record.theta_rad, 4});
  if (!record.temperature_C.empty()) columns.push_back({"temp_C", &record.temperature_C, 2});
  if (!record.humidity_pct.empty()) columns.push_back({"humidity_pct", &record.humidity_pct, 1});
  if (!record.capacitance_F.empty()) columns.push_back({"C_F", &record.capacitance_F, 0, 1e15, "e-15"});
  if (!record.setpoint_N.empty()) columns.push_back({"F_cmd_N", &record.setpoint_N, 4});
  std::string text;
  text.resize(record.stamp_s.size() * columns.size() * 14 + 256);
  char* at = text.data();
  for (const Column& column : columns) {
    if (&column != &columns.front()) *at++ = ',';
    for (const char* c = column.name; *c; ++c) *at++ = *c;
  }
  *at++ = '\n';
  for (std::size_t i = 0; i < record.stamp_s.size(); ++i) {
    if (static_cast<std::size_t>(at - text.data()) + 256 > text.size()) {
      const auto used = at - text.data();
      text.resize(text.size() + text.size() / 2 + 256);
      at = text.data() + used;
    }
    for (const Column& column : columns) {
      if (&column != &columns.front()) *at++ = ',';
      const double value = (*column.values)[i];
      if (!std::isfinite(value)) continue;
      at = put_fixed(at, value * column.factor, column.decimals);
      for (const char* c = column.exponent; *c; ++c) *at++ = *c;
    }
    *at++ = '\n';
  }
  text.resize(static_cast<std::size_t>(at - text.data()));
  return text;
}

// Whole or not at all: a recording that a full disk cut off would be read as a short one.
Result<void> write_text(const fs::path& path, const std::string& text) {
  const fs::path part = path.string() + ".part";
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(part.c_str(), "wb"), &std::fclose);
  bool written = file && std::fwrite(text.data(), 1, text.size(), file.get()) == text.size() && std::fflush(file.get()) == 0;
  file.reset();
  std::error_code failed;
  if (written) fs::rename(part, path, failed);
  if (written && !failed) return {};
  fs::remove(part, failed);
  return fail(ErrorCode::io, "cannot write the file", path.string(),
              "is the folder writable and the disk not full?");
}

template <class T>
void put(Json& object, const char* key, const std::optional<T>& value) {
  if (value) object[key] = *value;
}

Json description_of(const RecordNotes& said) {
  Json r = {{"file", said.file}};
  if (!said.kind.empty()) r["kind"] = said.kind;
  put(r, "role", said.role);
  put(r, "fs_Hz", said.rate_Hz);
  put(r, "duration_s", said.duration_s);
  put(r, "start_s", said.start_s);
  put(r, "rest_before_s", said.rest_before_s);
  put(r, "excitation_start_s", said.excitation_start_s);
  put(r, "dynamic", said.dynamic);
  put(r, "f_min_Hz", said.f_min_Hz);
  put(r, "A_N", said.A_N);
  put(r, "m_N", said.m_N);
  put(r, "drive_V", said.drive_V);
  put(r, "eccentricity_mm", said.eccentricity_mm);
  put(r, "preload_mm", said.preload_mm);
  put(r, "mounting", said.mounting);
  return r;
}

Json description(const MadeCampaign& made) {
  const BenchNotes notes = write_down(made.truth.seed, made.truth.campaign, made.conditions, made.records);
  Json bench = Json::object();
  put(bench, "spring_N_per_mm", notes.spring_N_per_mm);
  if (notes.law) bench["law"] = "F = k (preload + eccentricity (1 - cos theta))";
  if (notes.voltage_range) bench["voltage_range_V"] = {0, made.conditions.voltage_max_V};
  if (notes.force_range) bench["force_range_N"] = {0, 5};
  put(bench, "reference_resolution_N", notes.reference_resolution_N);
  put(bench, "reference_noise_N", notes.reference_noise_N);
  put(bench, "adc_bits", notes.adc_bits);
  Json records = Json::array();
  for (const RecordNotes& said : notes.records) records.push_back(description_of(said));
  return Json{
      {"campaign", made.truth.campaign}, {"sensor", notes.sensor}, {"bench", bench}, {"records", records}};
}

// Recordings of the mystery that is overwritten. Without its seal the campaign is somebody's own, and stays.
void remove_recordings(const fs::path& folder) {
  std::error_code ignored;
  const auto text = read_file(folder / "campaign.json");
  if (!text || !fs::exists(folder / kSealedFile, ignored)) return;
  const Json json = Json::parse(*text, nullptr, false, true);
  if (!json.is_object() || !json.contains("records") || !json["records"].is_array()) return;
  for (const Json& record : json["records"]) {
    if (!record.is_object() || !record.contains("file") || !record["file"].is_string()) continue;
    const fs::path file = record["file"].get<std::string>();
    if (file == file.filename() && file.extension() == ".csv") fs::remove(folder / file, ignored);
  }
  for (const char* of_the_old : {kSealedFile, kPlayedFile}) fs::remove(folder / of_the_old, ignored);  // they would be taken for those of the new campaign
}

}  // namespace

Result<void> write_campaign(const MadeCampaign& made, const fs::path& folder, bool overwrite, const std::function<bool()>& interrupted) {
  std::error_code error;
  const fs::path list = folder / "campaign.json";
  if (!overwrite && fs::exists(list, error))
    return fail(ErrorCode::usage, "there is a campaign already", list.string(),
                "choose another folder, or --force");
  fs::create_directory(folder, error);
  if (error) return fail(ErrorCode::io, "cannot create the folder: " + error.message(), folder.string());
  remove_recordings(folder);
  const Json json = description(made);
  std::vector<fs::path> files;
  for (const Json& record : json["records"]) {
    files.push_back(folder / record["file"].get<std::string>());
    fs::remove(files.back(), error);  // of a campaign that is overwritten
  }
  FORCEGATE_CHECK_OK(write_text(list, json.dump(1) + "\n"));
  for (std::size_t i = 0; i < files.size(); ++i) {
    auto written = interrupted && interrupted() ? Result<void>(fail(ErrorCode::cancelled, "interrupted: what was written is taken back", folder.string(),
                                                                    "the same command writes the campaign anew"))
                                                : write_text(files[i], csv_text(made.records[i]));
    if (written) continue;
    take_back_campaign(made, folder);
    return written;
  }
  return {};
}

void take_back_campaign(const MadeCampaign& made, const fs::path& folder) {
  std::error_code ignored;
  fs::remove(folder / "campaign.json", ignored);
  const Json json = description(made);
  for (const Json& record : json["records"]) fs::remove(folder / record["file"].get<std::string>(), ignored);
}

Result<std::vector<std::string>> append_records(const MadeCampaign& made,
                                                const std::vector<std::string>& names,
                                                const fs::path& folder) {
  const fs::path list = folder / "campaign.json";
  FORCEGATE_TRY(const std::string text, read_file(list));
  Json json = Json::parse(text, nullptr, false, true);
  if (json.is_discarded() || !json.contains("records") || !json["records"].is_array())
    return fail(ErrorCode::parse, "the campaign's description cannot be read", list.string());
  const BenchNotes notes = write_down(made.truth.seed, made.truth.campaign, made.conditions, made.records);
  std::vector<std::string> files;
  std::error_code ignored;
  for (std::size_t i = 0; i < made.records.size(); ++i) {
    RecordNotes said = notes.records[i];
    said.file = names[i] + ".csv";
    said.role.reset();
    if (fs::exists(folder / said.file, ignored))
      return fail(ErrorCode::usage, "there is such a record already", (folder / said.file).string(),
                  "choose another folder");
    FORCEGATE_CHECK_OK(write_text(folder / said.file, csv_text(made.records[i])));
    json["records"].push_back(description_of(said));
    files.push_back(said.file);
  }
  FORCEGATE_CHECK_OK(write_text(list, json.dump(1) + "\n"));
  return files;
}

}  // namespace forcegate::hidden
