#include "hil/trace/campaign_description.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "hil/base/text.h"
#include "hil/trace/air_lists.h"
#include "hil/trace/air_notes.h"
#include "hil/trace/air_words.h"
#include "hil/trace/cycle_words.h"
#include "hil/trace/lab_notes.h"
#include "hil/trace/said_in_words.h"

namespace forcegate {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

const std::vector<std::string> kCampaignKeys = {"campaign", "sensor", "bench", "records"};
const std::vector<std::string> kBenchKeys = {"spring_N_per_mm", "law", "voltage_range_V", "force_range_N", "reference_resolution_N", "reference_noise_N", "reference_lowpass_Hz", "adc_bits"};
const std::vector<std::string> kRecordKeys = {"file", "kind", "role", "fs_Hz", "start_s", "rest_before_s", "excitation_start_s", "dynamic", "f_min_Hz", "A_N", "m_N", "drive_V", "mounting",
                                              "cycles_before", "eccentricity_mm", "preload_mm", "temp_C", "temperature_C", "humidity_pct", "rh_pct", "RH_pct"};

constexpr const char* kLeaveOut = "leave it out when it is not known";

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
    if (!(low < high)) return wrong(key, "must ascend", "write the lower end first, [0, 10]");
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
  FORCEGATE_CHECK_OK(m.number("reference_lowpass_Hz", into(bench.reference_lowpass_Hz)));
  std::optional<double> bits;
  FORCEGATE_CHECK_OK(m.number("adc_bits", [&](double v) { bits = v; }));
  if (bits && !(*bits >= 1 && *bits <= 32 && *bits == std::floor(*bits)))
    return m.wrong("adc_bits", "must be a whole number between 1 and 32", "leave it out when it is not known");
  bench.adc_bits = static_cast<int>(bits.value_or(0.0));
  if (bench.reference_noise_N < 0.0) return m.wrong("reference_noise_N", "must not be negative", "it is a standard deviation; leave it out when it is not known");
  if (bench.reference_resolution_N < 0.0) return m.wrong("reference_resolution_N", "must not be negative", "leave it out when it is not known");
  if (bench.reference_lowpass_Hz <= 0.0) return m.wrong("reference_lowpass_Hz", "must be above 0", "it is the corner of a filter that only F_ref goes through; leave it out when there is none");
  if (bench.spring_N_per_mm <= 0.0) return m.wrong("spring_N_per_mm", "must be above 0", "leave it out when it is not known");
  return bench;
}

std::string text_of(const Json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); }

/// Of a short word one letter may be missing, too many or in another's place; another letter makes another word ("rule", "role"), and a
/// symbol with its unit ("x_N") is as near to one as to the next.
bool is_slip_of(const std::string& key, const std::string& known) {
  constexpr std::size_t kShortest = 3, kShort = 5;
  if (key.size() >= kShort) return true;
  if (key.size() < kShortest || key.find('_') != std::string::npos) return false;
  return key.size() != known.size() || std::ranges::is_permutation(key, known);
}

/// A lab may write down what it likes; a key that nearly is a known one, and stands in its place, is a slip.
void note_mistyped(const Json& object, std::span<const std::string> known, std::vector<std::string>& notes) {
  for (const auto& [key, value] : object.items()) {
    if (std::ranges::find(known, key) != known.end()) continue;
    std::string meant;
    for (const std::string& name : known)
      if (ascii_lower(key) == ascii_lower(name) || (meant.empty() && value.is_number() && key.size() > 1 && name.starts_with(key + "_"))) meant = name;
    if (meant.empty())
      if (const std::string near = nearest_name(key, known); !near.empty() && is_slip_of(key, near)) meant = near;
    if (meant.empty() || object.contains(meant)) continue;
    const AirNotes air = value.is_number() ? air_notes({{key, value.get<double>()}}) : AirNotes{};
    if (air.temp_C || air.humidity_pct || air.drive_V) continue;
    if (value.is_primitive() && !lab_notes({{key, text_of(value)}}).empty()) continue;
    const std::string note = "campaign.json: nothing reads the key \"" + printable_utf8(key) + "\"; did you mean \"" + meant + "\"?";
    if (std::ranges::find(notes, note) == notes.end()) notes.push_back(note);
  }
}

CampaignMembers members_of(const Json& campaign) {
  CampaignMembers out;
  for (const auto& [key, value] : campaign.items()) {
    if (value.is_string()) out.texts.emplace_back(key, value.get<std::string>());
    if (value.is_array() && std::ranges::all_of(value, [](const Json& v) { return v.is_number(); })) out.lists.emplace_back(key, value.get<std::vector<double>>());
  }
  return out;
}

/// Readings that were taken one after the other: [{"t_s": 0, "air_C": 21.4}, ...].
Json means_of(const Json& readings) {
  std::map<std::string, std::pair<double, double>> sums;  // and how many
  for (const Json& reading : readings)
    if (reading.is_object())
      for (const auto& [key, value] : reading.items())
        if (value.is_number()) sums[key].first += value.get<double>(), sums[key].second += 1.0;
  Json out = Json::object();
  for (const auto& [key, sum] : sums) out[key] = sum.first / sum.second;
  return out;
}

/// Numbers of a record by name, those inside an object of it ("environment": {...}) too. What a stimulus asks for is no note of the air.
std::vector<std::pair<std::string, double>> numbers_of(const Json& record) {
  std::vector<std::pair<std::string, double>> out;
  const auto add = [&](const Json& object) {
    for (const auto& [key, value] : object.items())
      if (value.is_number()) out.emplace_back(key, value.get<double>());
  };
  add(record);
  for (const auto& [key, value] : record.items()) {
    if (value.is_object() && key != "stimulus") add(value);
    if (value.is_array()) add(means_of(value));
  }
  return out;
}

/// What no key here knows, as text.
std::vector<std::pair<std::string, std::string>> foreign_members(const Json& record) {
  std::vector<std::pair<std::string, std::string>> out;
  for (const auto& [key, value] : record.items())
    if (std::ranges::find(kRecordKeys, key) == kRecordKeys.end() && value.is_primitive() && !value.is_null())
      out.emplace_back(key, text_of(value));
  return out;
}

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
  FORCEGATE_CHECK_OK(m.number("cycles_before", into(record.cycles_before)));
  FORCEGATE_CHECK_OK(m.number("eccentricity_mm", into(record.eccentricity_mm)));
  FORCEGATE_CHECK_OK(m.number("preload_mm", into(record.preload_mm)));
  for (const char* key : {"temperature_C", "temp_C"}) FORCEGATE_CHECK_OK(m.number(key, into(record.temp_C)));
  for (const char* key : {"rh_pct", "RH_pct", "humidity_pct"}) FORCEGATE_CHECK_OK(m.number(key, into(record.humidity_pct)));
  const AirNotes air = air_notes(numbers_of(object));
  if (!record.temp_C) record.temp_C = air.temp_C;
  if (!record.humidity_pct) record.humidity_pct = air.humidity_pct;
  if (!record.drive_V) record.drive_V = air.drive_V;
  FORCEGATE_CHECK_OK(m.flag("dynamic", record.dynamic));
  FORCEGATE_CHECK_OK(m.label("mounting", record.mounting));
  for (const auto& [key, value] : {std::pair{"fs_Hz", record.rate_Hz}, std::pair{"f_min_Hz", record.f_min_Hz}})
    if (value && !(*value > 0.0)) return m.wrong(key, "must be above 0", kLeaveOut);
  for (const auto& [key, value] : {std::pair{"rest_before_s", record.rest_before_s}, std::pair{"A_N", record.A_N}, std::pair{"cycles_before", record.cycles_before}})
    if (value && *value < 0.0) return m.wrong(key, "must not be negative", kLeaveOut);
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

Result<DescribedRecord> record_of(const Json& object, const Source& source, const Members& campaign, std::size_t number) {
  if (!object.is_object() || !object.contains("file") || !object["file"].is_string())
    return campaign.wrong("records", "has no \"file\" in record " + std::to_string(number), "name the CSV or HDF5 file of the record");
  DescribedRecord out;
  out.file = object["file"].get<std::string>();
  out.where = source.find(out.file, "file");
  FORCEGATE_TRY(out.facts, facts_of(object, source, out.file));
  const auto members = foreign_members(object);
  out.notes = lab_notes(members);
  std::string words;
  for (const auto& [key, text] : members) words += key + " " + text + "; ";
  out.air = air_in_words(words);
  out.cycles_before = cycles_in_words(words);
  return out;
}

// JSON keeps the last of two members of one name and says nothing.
Json::parser_callback_t keys_given_twice(std::vector<std::string>& twice) {
  auto objects = std::make_shared<std::vector<std::set<std::string>>>();
  return [objects, &twice](int, Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start) objects->emplace_back();
    else if (event == Json::parse_event_t::object_end) objects->pop_back();
    else if (event == Json::parse_event_t::key && !objects->back().insert(parsed.get<std::string>()).second) twice.push_back(printable_utf8(parsed.get<std::string>()));
    return true;
  };
}

// Values of the right type that no bench has: they are read, and whoever wrote them hears of it.
void note_unlikely(const Record& r, std::vector<std::string>& notes) {
  constexpr double kMost_V = 1e3, kMost_mm = 1e4, kMost_s = 1e8;  // three years
  const auto note = [&](const char* key, const std::optional<double>& value, double least, double most, const char* unit) {
    if (value && !(*value >= least && *value <= most))
      notes.push_back(fmt::format("campaign.json gives {} {} = {:.4g} {}, which no bench has: check sign and unit", r.name, key, *value, unit));
  };
  note("drive_V", r.drive_V, 0.0, kMost_V, "V");
  note("excitation_start_s", r.excitation_start_s, -kMost_s, kMost_s, "s");
  note("rest_before_s", r.rest_before_s, 0.0, kMost_s, "s");
  note("preload_mm", r.preload_mm, -kMost_mm, kMost_mm, "mm");
  note("eccentricity_mm", r.eccentricity_mm, -kMost_mm, kMost_mm, "mm");
}

// What `forcegate record` was to record and has not.
void note_cut_short(const Json& campaign, std::size_t records, std::vector<std::string>& notes) {
  const auto with = campaign.find("recorded_with");
  const auto planned = with != campaign.end() && with->is_object() ? with->value("planned_records", Json()) : Json();
  if (planned.is_number_unsigned() && planned.get<std::size_t>() > records)
    notes.push_back(fmt::format("the recording was cut short: {} of the {} records that were planned {} there; the same forcegate record with --continue makes the others", records,
                                planned.get<std::size_t>(), records == 1 ? "is" : "are"));
}

}  // namespace

Result<CampaignDescription> read_description(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    return fail(ErrorCode::io, "campaign.json cannot be opened", file.string(), "check its permissions");
  std::ostringstream buffer;
  buffer << stream.rdbuf();
  const Source source(file, std::move(buffer).str());

  Json json;
  std::vector<std::string> twice;
  try {
    json = Json::parse(source.text(), keys_given_twice(twice), true, true);
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

  CampaignDescription out;
  for (const std::string& key : twice) out.notes.push_back("campaign.json has the key \"" + key + "\" twice in one object: the last one counts");
  out.name = fs::absolute(file).parent_path().filename().string();
  const Members m(json, source, "");
  FORCEGATE_CHECK_OK(m.text("campaign", out.name));
  FORCEGATE_CHECK_OK(m.text("sensor", out.sensor));
  if (const auto bench = json.find("bench"); bench != json.end() && !bench->is_null()) {
    if (!bench->is_object()) return m.wrong("bench", "must be an object");
    FORCEGATE_TRY(out.bench, bench_of(*bench, source));
    note_mistyped(*bench, kBenchKeys, out.notes);
  }
  note_mistyped(json, kCampaignKeys, out.notes);
  out.members = members_of(json);
  const auto records = json.find("records");
  if (records == json.end() || records->is_null()) return out;
  if (!records->is_array() || records->empty())
    return m.wrong("records", "must be a list of at least one record", "{\"file\": \"run1.csv\"} is enough for one");
  out.records.emplace();
  for (std::size_t i = 0; i < records->size(); ++i) {
    FORCEGATE_TRY(DescribedRecord record, record_of((*records)[i], source, m, i + 1));
    note_mistyped((*records)[i], kRecordKeys, out.notes);
    note_unlikely(record.facts, out.notes);
    out.records->push_back(std::move(record));
  }
  note_cut_short(json, out.records->size(), out.notes);
  take_lists(out.members, *out.records);
  take_words(*out.records, out.notes);
  return out;
}

}  // namespace forcegate
