#include "hil/trace/campaign.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "hil/base/largest_first.h"
#include "hil/base/text.h"
#include "hil/trace/columns.h"
#include "hil/trace/convert.h"

namespace forcegate {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

constexpr const char* kFileName = "campaign.json";

bool is_record_file(const fs::path& path) {
  const std::string ending = path.extension().string();
  return ending == ".csv" || ending == ".h5" || ending == ".hdf5" || ending == ".mat";
}

/// Text of campaign.json with what is needed to say where something stands in it.
class Source {
 public:
  Source(fs::path path, std::string text) : path_(std::move(path)), text_(std::move(text)) {}

  const std::string& text() const { return text_; }
  std::string at(std::size_t byte) const {
    byte = std::min(byte, text_.size());
    const auto line = 1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(byte), '\n');
    const std::size_t begin = byte == 0 ? std::string::npos : text_.rfind('\n', byte - 1);
    const std::size_t column = begin == std::string::npos ? byte + 1 : byte - begin;
    return path_.string() + ":" + std::to_string(line) + ":" + std::to_string(column);
  }
  /// Where `key` stands behind the first mention of `anchor` (both as JSON strings); the file when not found.
  std::string find(const std::string& anchor, const std::string& key) const {
    std::size_t from = anchor.empty() ? 0 : text_.find("\"" + anchor + "\"");
    if (from == std::string::npos) return path_.string();
    const std::size_t open = text_.rfind('{', from);
    if (open != std::string::npos && !anchor.empty()) from = open;
    const std::size_t found = text_.find("\"" + key + "\"", from);
    return found == std::string::npos ? path_.string() : at(found);
  }

 private:
  fs::path path_;
  std::string text_;
};

/// One JSON object whose members are read by name and type.
class Members {
 public:
  Members(const Json& object, const Source& source, std::string anchor)
      : object_(object), source_(source), anchor_(std::move(anchor)) {}

  template <class Store>
  Result<void> number(const char* key, Store&& store) const {
    const auto it = object_.find(key);
    if (it == object_.end() || it->is_null()) return {};
    if (!it->is_number()) return wrong(key, "must be a number");
    store(it->template get<double>());
    return {};
  }
  Result<void> text(const char* key, std::string& out) const {
    const auto it = object_.find(key);
    if (it == object_.end() || it->is_null()) return {};
    if (!it->is_string()) return wrong(key, "must be a text");
    out = printable_utf8(it->get_ref<const std::string&>());
    return {};
  }
  /// A name or a whole number.
  Result<void> label(const char* key, std::string& out) const {
    const auto it = object_.find(key);
    if (it == object_.end() || it->is_null()) return {};
    if (it->is_number_integer()) {
      out = it->dump();
      return {};
    }
    if (!it->is_string()) return wrong(key, "must be a name or a whole number");
    return text(key, out);
  }
  Result<void> flag(const char* key, std::optional<bool>& out) const {
    const auto it = object_.find(key);
    if (it == object_.end() || it->is_null()) return {};
    if (!it->is_boolean()) return wrong(key, "must be true or false");
    out = it->get<bool>();
    return {};
  }
  Result<void> range(const char* key, double& low, double& high) const {
    const auto it = object_.find(key);
    if (it == object_.end() || it->is_null()) return {};
    if (!it->is_array() || it->size() != 2 || !(*it)[0].is_number() || !(*it)[1].is_number())
      return wrong(key, "must be two numbers, [lowest, highest]");
    low = (*it)[0].get<double>();
    high = (*it)[1].get<double>();
    if (!(low < high)) return wrong(key, "must ascend");
    return {};
  }
  Unexpected wrong(const char* key, const std::string& what, std::string hint = {}) const {
    return fail(ErrorCode::parse, "\"" + std::string(key) + "\" " + what, source_.find(anchor_, key),
                std::move(hint));
  }

 private:
  const Json& object_;
  const Source& source_;
  std::string anchor_;
};

Result<BenchFacts> bench_of(const Json& object, const Source& source) {
  BenchFacts bench;
  const Members m(object, source, "bench");
  const auto into = [](double& out) { return [&out](double v) { out = v; }; };
  FORCEGATE_CHECK_OK(m.number("spring_N_per_mm", into(bench.spring_N_per_mm)));
  FORCEGATE_CHECK_OK(m.number("reference_resolution_N", into(bench.reference_resolution_N)));
  FORCEGATE_CHECK_OK(m.number("reference_noise_N", into(bench.reference_noise_N)));
  FORCEGATE_CHECK_OK(m.range("voltage_range_V", bench.voltage_min_V, bench.voltage_max_V));
  FORCEGATE_CHECK_OK(m.range("force_range_N", bench.force_min_N, bench.force_max_N));
  FORCEGATE_CHECK_OK(m.text("law", bench.law));
  double bits = 0.0;
  FORCEGATE_CHECK_OK(m.number("adc_bits", into(bits)));
  if (bits != 0.0 && !(bits >= 1 && bits <= 32)) return m.wrong("adc_bits", "must lie between 1 and 32");
  bench.adc_bits = static_cast<int>(bits);
  return bench;
}

/// Everything that campaign.json says about a record, without its samples.
Result<Record> facts_of(const Json& object, const Source& source, const std::string& file) {
  Record record;
  record.name = fs::path(file).stem().string();
  const Members m(object, source, file);
  const auto into = [](std::optional<double>& out) { return [&out](double v) { out = v; }; };
  FORCEGATE_CHECK_OK(m.text("kind", record.kind));
  FORCEGATE_CHECK_OK(m.number("fs_Hz", into(record.rate_Hz)));
  FORCEGATE_CHECK_OK(m.number("start_s", into(record.start_s)));
  FORCEGATE_CHECK_OK(m.number("rest_before_s", into(record.rest_before_s)));
  FORCEGATE_CHECK_OK(m.number("excitation_start_s", into(record.excitation_start_s)));
  FORCEGATE_CHECK_OK(m.number("f_min_Hz", into(record.f_min_Hz)));
  FORCEGATE_CHECK_OK(m.number("A_N", into(record.A_N)));
  FORCEGATE_CHECK_OK(m.number("m_N", into(record.m_N)));
  FORCEGATE_CHECK_OK(m.number("drive_V", into(record.drive_V)));
  FORCEGATE_CHECK_OK(m.number("eccentricity_mm", into(record.eccentricity_mm)));
  FORCEGATE_CHECK_OK(m.number("preload_mm", into(record.preload_mm)));
  for (const char* key : {"temperature_C", "temp_C"}) FORCEGATE_CHECK_OK(m.number(key, into(record.temp_C)));
  for (const char* key : {"rh_pct", "RH_pct", "humidity_pct"}) FORCEGATE_CHECK_OK(m.number(key, into(record.humidity_pct)));
  FORCEGATE_CHECK_OK(m.flag("dynamic", record.dynamic));
  FORCEGATE_CHECK_OK(m.label("mounting", record.mounting));
  if (record.rate_Hz && !(*record.rate_Hz > 0.0)) return m.wrong("fs_Hz", "must be above 0");
  std::string role;
  FORCEGATE_CHECK_OK(m.text("role", role));
  if (!role.empty()) {
    if (role != "fit" && role != "heldout")
      return m.wrong("role", "is \"" + role + "\"", "say \"fit\" or \"heldout\"");
    record.role = role == "heldout" ? RecordRole::heldout : RecordRole::fit;
    record.role_given = true;
  }
  return record;
}

/// One file to read into a record.
struct Reading {
  Record* record = nullptr;
  fs::path file;
  std::vector<std::string> notes;
  std::vector<std::string> mapped;
  Result<void> result;
};

void load(Reading& reading, const CampaignOptions& options) {
  Record& record = *reading.record;
  CsvOptions csv{options.column_map, options.assumed_rate_Hz};
  if (csv.assumed_rate_Hz <= 0.0 && record.rate_Hz) csv.assumed_rate_Hz = *record.rate_Hz;
  Result<TraceFile> read = read_trace(reading.file, csv);
  if (!read) {
    reading.result = tl::unexpected(std::move(read).error());
    return;
  }
  reading.notes = std::move(read->notes);
  reading.mapped = std::move(read->mapped);
  record.trace = std::move(read->trace);
  record.trace.name = record.name;
}

void load_all(std::vector<Reading>& readings, const CampaignOptions& options) {
  std::vector<std::size_t> bytes;
  for (const Reading& reading : readings) {
    std::error_code unknown;
    const std::uintmax_t size = fs::file_size(reading.file, unknown);
    bytes.push_back(unknown ? 0 : static_cast<std::size_t>(size));
  }
  parallel_for_largest_first(bytes, options.threads, [&](std::size_t i) { load(readings[i], options); });
}

/// "r1, r2: the separator is a semicolon": each note once, with the records that it is about. Notes that differ in their
/// numbers alone are one note: the first record's stands for all.
void add_notes(const std::vector<Reading>& readings, Campaign& campaign) {
  struct Shared {
    std::string pattern, text;
    bool same = true;
    std::vector<std::string> names;
  };
  std::vector<Shared> all;
  for (const Reading& reading : readings)
    for (const std::string& note : reading.notes) {
      std::string pattern;
      for (const char c : note)
        if ((c < '0' || c > '9') && c != '.') pattern += c;
      auto at = std::ranges::find(all, pattern, &Shared::pattern);
      if (at == all.end()) at = all.insert(all.end(), {pattern, note, true, {}});
      at->same = at->same && at->text == note;
      at->names.push_back(reading.record->name);
    }
  constexpr std::size_t kMostNames = 4;
  for (Shared& note : all) {
    const bool everyone = note.names.size() == readings.size() && readings.size() > 1;
    const std::string first = note.names.front();
    if (!note.same) note.names.erase(note.names.begin());
    const std::size_t more = note.names.size() > kMostNames ? note.names.size() - kMostNames : 0;
    if (more > 0) note.names.resize(kMostNames);
    const std::string who =
        everyone ? (note.same ? "every record" : "every other record")
                 : join(note.names, ", ") + (more > 0 ? " and " + std::to_string(more) + " more" : "");
    campaign.notes.push_back(note.same ? who + ": " + note.text
                                       : first + ": " + note.text + "; the like in " + who);
  }
}

/// A mapped column that exists nowhere is a typing mistake, and what is then read is not what was meant.
Result<void> check_map(const std::vector<Reading>& readings, const CampaignOptions& options,
                       const fs::path& where) {
  for (const auto& [from, to] : options.column_map) {
    if (std::ranges::any_of(readings, [&, &name = from](const Reading& r) {
          return std::ranges::find(r.mapped, name) != r.mapped.end();
        }))
      continue;
    std::vector<std::string> columns;
    for (const Reading& reading : readings)
      for (const Channel& c : reading.record->trace.channels)
        if (const std::string name = header_of(c.name, c.unit);
            std::ranges::find(columns, name) == columns.end())
          columns.push_back(name);
    return fail(ErrorCode::usage, "no record has a column \"" + from + "\" to map to " + to, where.string(),
                "there are " + join(columns, ", ") + "; only columns of CSV and MAT files can be mapped");
  }
  return {};
}

/// Every record file of the folder, in the order of their names. What cannot be read is skipped and noted.
Result<void> add_folder(const fs::path& folder, const CampaignOptions& options, Campaign& campaign) {
  std::vector<fs::path> files;
  std::error_code failed;
  for (const auto& entry : fs::directory_iterator(folder, failed))
    if (is_record_file(entry.path()) && entry.path().filename().string().front() != '.')
      files.push_back(entry.path());
  if (failed) return fail(ErrorCode::io, "the folder cannot be listed: " + failed.message(), folder.string());
  std::ranges::sort(files, [](const fs::path& a, const fs::path& b) { return natural_less(a.filename().string(), b.filename().string()); });
  if (files.empty())
    return fail(ErrorCode::io, "the folder holds no .csv, .h5 or .mat file", folder.string(), "name the folder of the recordings");

  std::vector<Record> records(files.size());
  std::vector<Reading> readings(files.size());
  for (std::size_t i = 0; i < files.size(); ++i) {
    records[i].name = files[i].stem().string();
    readings[i].record = &records[i];
    readings[i].file = files[i];
  }
  load_all(readings, options);
  std::optional<Error> first_error;
  std::erase_if(readings, [&](Reading& reading) {
    if (reading.result) return false;
    Error& error = reading.result.error();
    campaign.notes.push_back("skipped " + reading.file.filename().string() + ": " + error.text +
                             (error.where.empty() ? "" : " (" + error.where + ")"));
    if (!first_error) first_error = std::move(error);
    return true;
  });
  if (readings.empty()) return tl::unexpected(std::move(*first_error));
  FORCEGATE_CHECK_OK(check_map(readings, options, folder));
  add_notes(readings, campaign);
  for (const Reading& reading : readings) campaign.records.push_back(std::move(*reading.record));
  return {};
}

Result<Campaign> read_described(const fs::path& file, const CampaignOptions& options) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    return fail(ErrorCode::io, "campaign.json cannot be opened", file.string(), "check its permissions");
  std::ostringstream buffer;
  buffer << stream.rdbuf();
  const Source source(file, std::move(buffer).str());

  Json json;
  try {
    json = Json::parse(source.text(), nullptr, true, true);
  } catch (const Json::parse_error& e) {
    const std::string what = e.what();
    const std::size_t reason = what.find(": ", what.find("column"));
    return fail(ErrorCode::parse,
                "campaign.json is not valid JSON: " +
                    printable_utf8(reason == std::string::npos ? what : what.substr(reason + 2)),
                source.at(e.byte > 0 ? e.byte - 1 : 0), "mend the file at this place");
  } catch (const Json::exception& e) {
    return fail(ErrorCode::parse, "campaign.json cannot be read: " + printable_utf8(e.what()), file.string());
  }
  if (!json.is_object())
    return fail(ErrorCode::parse, "campaign.json must be one object { ... }", source.at(0),
                "see docs/campaign.md");

  Campaign campaign;
  campaign.folder = file.parent_path().empty() ? fs::path(".") : file.parent_path();
  campaign.name = fs::absolute(file).parent_path().filename().string();
  const Members m(json, source, "");
  FORCEGATE_CHECK_OK(m.text("campaign", campaign.name));
  FORCEGATE_CHECK_OK(m.text("sensor", campaign.sensor));
  if (const auto bench = json.find("bench"); bench != json.end() && !bench->is_null()) {
    if (!bench->is_object()) return m.wrong("bench", "must be an object");
    FORCEGATE_TRY(campaign.bench, bench_of(*bench, source));
  }
  const auto records = json.find("records");
  if (records == json.end() || records->is_null()) {
    campaign.notes.push_back("campaign.json lists no records; those of the folder are taken in the order of their names");
    FORCEGATE_CHECK_OK(add_folder(campaign.folder, options, campaign));
    return campaign;
  }
  if (!records->is_array() || records->empty())
    return m.wrong("records", "must be a list of at least one record",
                   "{\"file\": \"run1.csv\"} is enough for one");

  std::vector<Reading> readings;
  for (std::size_t i = 0; i < records->size(); ++i) {
    const Json& object = (*records)[i];
    const std::string place = "record " + std::to_string(i + 1);
    if (!object.is_object() || !object.contains("file") || !object["file"].is_string())
      return m.wrong("records", "has no \"file\" in " + place, "name the CSV or HDF5 file of the record");
    const std::string name = object["file"].get<std::string>();
    FORCEGATE_TRY(Record record, facts_of(object, source, name));
    for (const Record& other : campaign.records)
      if (other.name == record.name) record.name += "_" + std::to_string(i + 1);
    const fs::path path = campaign.folder / fs::path(name);
    std::error_code ignored;
    if (!fs::exists(path, ignored))
      return fail(ErrorCode::io, "the file \"" + printable_utf8(name) + "\" of " + place + " does not exist",
                  source.find(name, "file"),
                  "put it into " + campaign.folder.string() + " or take the record out");
    campaign.records.push_back(std::move(record));
    readings.push_back({nullptr, path, {}, {}, {}});
  }
  for (std::size_t i = 0; i < readings.size(); ++i) readings[i].record = &campaign.records[i];
  load_all(readings, options);
  for (Reading& reading : readings) FORCEGATE_CHECK_OK(std::move(reading.result));
  FORCEGATE_CHECK_OK(check_map(readings, options, file));
  add_notes(readings, campaign);
  return campaign;
}

Result<Campaign> read_folder(const fs::path& folder, const CampaignOptions& options) {
  Campaign campaign;
  campaign.folder = folder;
  campaign.name = fs::absolute(folder / ".").parent_path().filename().string();
  campaign.notes.push_back("there is no campaign.json; the records are taken in the order of their names");
  FORCEGATE_CHECK_OK(add_folder(folder, options, campaign));
  return campaign;
}

Result<Campaign> read_single(const fs::path& path, const CampaignOptions& options) {
  Campaign single;
  single.folder = path.parent_path().empty() ? fs::path(".") : path.parent_path();
  single.name = path.stem().string();
  Record record;
  record.name = single.name;
  std::vector<Reading> reading(1);
  reading[0].record = &record;
  reading[0].file = path;
  load_all(reading, options);
  FORCEGATE_CHECK_OK(std::move(reading[0].result));
  FORCEGATE_CHECK_OK(check_map(reading, options, path));
  add_notes(reading, single);
  single.records.push_back(std::move(record));
  return single;
}

}  // namespace

Result<Campaign> read_campaign(const fs::path& path, const CampaignOptions& options) {
  std::error_code failed;
  const fs::file_status status = fs::status(path, failed);
  if (!fs::exists(status))
    return fail(ErrorCode::io, "there is no such file or folder", path.string(), "check the name");
  if (fs::is_directory(status))
    return fs::exists(path / kFileName, failed) ? read_described(path / kFileName, options)
                                                : read_folder(path, options);
  return path.extension() == ".json" ? read_described(path, options) : read_single(path, options);
}

}  // namespace forcegate
