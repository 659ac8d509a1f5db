#include "hil/trace/campaign.h"

#include <algorithm>

#include "hil/base/largest_first.h"
#include "hil/base/some_of.h"
#include "hil/base/text.h"
#include "hil/trace/campaign_checks.h"
#include "hil/trace/campaign_description.h"
#include "hil/trace/column_map.h"
#include "hil/trace/columns.h"
#include "hil/trace/common_clock.h"
#include "hil/trace/compression.h"
#include "hil/trace/conductance.h"
#include "hil/trace/convert.h"
#include "hil/trace/declared_facts.h"
#include "hil/trace/long_pauses.h"
#include "hil/trace/plausible_sizes.h"
#include "hil/trace/recording_files.h"
#include "hil/trace/said_in_words.h"
#include "hil/trace/sensor_name.h"

namespace forcegate {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFileName = "campaign.json";

/// The files of a folder that are records by their endings; where there are none, its text files: .txt may be a logger's or a note.
Result<std::vector<fs::path>> record_files(const fs::path& folder, bool& only_text) {
  FORCEGATE_TRY(RecordingFiles found, recording_files(folder));
  only_text = found.records.empty();
  std::vector<fs::path>& files = only_text ? found.texts : found.records;
  if (files.empty())
    return fail(ErrorCode::io, "the folder holds no .csv, .h5 or .mat file", folder.string(), "name the folder of the recordings");
  return std::move(files);
}

/// One file to read into a record.
struct Reading {
  Record* record = nullptr;
  fs::path file;
  std::vector<std::string> notes;
  std::vector<std::string> mapped;
  std::string sensor;  ///< as the file calls it
  Result<void> result;
};

void load(Reading& reading, const CampaignOptions& options) {
  Record& record = *reading.record;
  record.file = reading.file;
  CsvOptions csv{options.column_map, options.assumed_rate_Hz};
  if (csv.assumed_rate_Hz <= 0.0 && record.rate_Hz) csv.assumed_rate_Hz = *record.rate_Hz;
  Result<TraceFile> read = read_trace(reading.file, csv);
  if (!read) {
    reading.result = tl::unexpected(std::move(read).error());
    return;
  }
  if (reading.result = check_plausible_sizes(read->trace, read->headers, reading.file); !reading.result) return;
  reading.notes = std::move(read->notes);
  reading.mapped = std::move(read->mapped);
  reading.sensor = std::move(read->sensor);
  record.trace = std::move(read->trace);
  record.trace.name = record.name;
  record.header_line = read->header_line;
  record.headers = read->headers;
  if (auto note = put_on_common_clock(record.trace)) reading.notes.push_back(std::move(*note));
  // files of Forcegate hold channels that are there to be looked at
  const std::string ending = reading.file.extension().string();
  if (const auto unused = unused_columns(record.trace, read->headers); !unused.empty() && ending != ".h5" && ending != ".hdf5" && record.trace.find("F_ref"))
    reading.notes.push_back("not used: " + some_columns(unused));
  // what was mapped out is not offered again
  std::erase_if(record.trace.channels, [](const Channel& c) { return c.name == "unused" || c.name.starts_with("unused_"); });
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
      // two columns of one record are two notes
      auto at = std::ranges::find_if(all, [&](const Shared& s) { return s.pattern == pattern && s.names.back() != reading.record->name; });
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

/// What nobody declared, and the files or their names tell.
void take_sensor(const std::vector<Reading>& readings, Campaign& campaign) {
  if (!campaign.sensor.empty()) return;
  std::vector<std::string> said, names{campaign.name};
  for (const Reading& reading : readings) {
    said.push_back(reading.sensor);
    names.push_back(reading.file.stem().string());
  }
  campaign.sensor = only_sensor_named(std::ranges::all_of(said, &std::string::empty) ? names : said);
}

Result<void> check_map(const std::vector<Reading>& readings, const CampaignOptions& options,
                       const fs::path& where) {
  std::vector<std::string> mapped;
  std::vector<const Trace*> traces;
  for (const Reading& reading : readings) {
    mapped.insert(mapped.end(), reading.mapped.begin(), reading.mapped.end());
    traces.push_back(&reading.record->trace);
  }
  return check_column_map(options.column_map, mapped, traces, where);
}

/// A folder holds what it holds: a record that cannot stand beside those that can is skipped. Where none can, all are kept, and who reads them says why.
void skip_unfit(std::vector<Reading>& readings, Campaign& campaign) {
  for (std::string Unfit::*const why : {&Unfit::too_short, &Unfit::no_column}) {
    std::vector<std::string> reasons;
    for (const Reading& reading : readings) reasons.push_back(unfit(reading.record->trace).*why);
    if (std::ranges::none_of(reasons, &std::string::empty)) continue;
    std::size_t at = 0;
    std::erase_if(readings, [&](const Reading& reading) {
      const std::string& reason = reasons[at++];
      if (!reason.empty()) campaign.notes.push_back("skipped " + reading.file.filename().string() + ": " + reason);
      return !reason.empty();
    });
  }
}

/// Nobody said what the file is: it may hold several records.
void add_record(Record record, Campaign& campaign) {
  std::vector<Record> parts = records_between_pauses(record, campaign.notes);
  if (parts.empty()) parts.push_back(std::move(record));
  std::ranges::move(parts, std::back_inserter(campaign.records));
}

/// Every record file of the folder, in the order of their names. What cannot be read is skipped and noted.
Result<void> add_folder(const fs::path& folder, const CampaignOptions& options, Campaign& campaign) {
  bool only_text = false;
  FORCEGATE_TRY(const std::vector<fs::path> files, record_files(folder, only_text));

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
  if (readings.empty() && only_text)
    return fail(ErrorCode::io, "the folder holds no .csv, .h5 or .mat file, and its text cannot be read as one: " + first_error->text, first_error->where, first_error->hint);
  if (readings.empty()) return tl::unexpected(std::move(*first_error));
  skip_unfit(readings, campaign);
  FORCEGATE_CHECK_OK(check_map(readings, options, folder));
  add_notes(readings, campaign);
  take_sensor(readings, campaign);
  for (const Reading& reading : readings) add_record(std::move(*reading.record), campaign);
  return {};
}

// Of records that campaign.json does not list it may tell something all the same, a number for each.
void take_lists(const CampaignMembers& members, Campaign& campaign) {
  std::vector<DescribedRecord> described;
  for (Record& record : campaign.records) described.emplace_back().facts = std::move(record);
  take_lists(members, described);
  take_words(described, campaign.notes);
  for (std::size_t k = 0; k < described.size(); ++k) campaign.records[k] = std::move(described[k].facts);
}

Result<Campaign> read_described(const fs::path& file, const CampaignOptions& options) {
  FORCEGATE_TRY(CampaignDescription description, read_description(file));
  Campaign campaign;
  campaign.folder = file.parent_path().empty() ? fs::path(".") : file.parent_path();
  campaign.name = std::move(description.name);
  campaign.sensor = std::move(description.sensor);
  campaign.bench = std::move(description.bench);
  campaign.notes = std::move(description.notes);
  if (!description.records) {
    campaign.notes.push_back("campaign.json lists no records; those of the folder are taken in the order of their names");
    FORCEGATE_CHECK_OK(add_folder(campaign.folder, options, campaign));
    take_lists(description.members, campaign);
    return campaign;
  }
  std::vector<Reading> readings;
  for (DescribedRecord& described : *description.records) {
    const std::string number = std::to_string(readings.size() + 1);
    Record record = std::move(described.facts);
    for (const Record& other : campaign.records)
      if (other.name == record.name) record.name += "_" + number;
    const fs::path path = campaign.folder / fs::path(described.file);
    std::error_code ignored;
    if (!fs::exists(path, ignored))
      return fail(ErrorCode::io, "the file \"" + printable_utf8(described.file) + "\" of record " + number + " does not exist", described.where,
                  "put it into " + campaign.folder.string() + " or take the record out");
    campaign.records.push_back(std::move(record));
    readings.push_back({nullptr, path, {}, {}, {}, {}});
  }
  for (std::size_t i = 0; i < readings.size(); ++i) readings[i].record = &campaign.records[i];
  load_all(readings, options);
  for (Reading& reading : readings) FORCEGATE_CHECK_OK(std::move(reading.result));
  FORCEGATE_CHECK_OK(check_map(readings, options, file));
  add_notes(readings, campaign);
  take_sensor(readings, campaign);
  return campaign;
}

/// forcegate record keeps what the instruments said beside each record: r01_hold.h5 of r01_hold.csv.
bool is_journal_of(const Record& record, const fs::path& file) { return file.extension() == ".h5" && record.file == fs::path(file).replace_extension(".csv"); }

/// Who names the folder may take all that lies in it for the campaign.
void note_unlisted(const fs::path& folder, Campaign& campaign) {
  std::vector<std::string> unlisted;
  if (const auto found = recording_files(folder))
    for (const fs::path& file : found->records) {
      std::error_code ignored;
      if (std::ranges::none_of(campaign.records, [&](const Record& r) { return fs::equivalent(r.file, file, ignored) || is_journal_of(r, file); })) unlisted.push_back(file.filename().string());
    }
  if (!unlisted.empty()) campaign.notes.push_back("not read, since campaign.json does not list " + std::string(unlisted.size() == 1 ? "it: " : "them: ") + some_of(unlisted));
}

Result<Campaign> read_folder(const fs::path& folder, const CampaignOptions& options) {
  Campaign campaign;
  campaign.folder = folder;
  campaign.name = fs::absolute(folder / ".").parent_path().filename().string();
  campaign.notes.push_back("there is no campaign.json; the records are taken in the order of their names");
  FORCEGATE_CHECK_OK(add_folder(folder, options, campaign));
  return campaign;
}

/// A campaign.json beside a file that is named itself, which it lists or which lists none: one with a kind would be asked other questions.
bool is_described_beside(const fs::path& path, const fs::path& folder) {
  std::error_code failed;
  if (!fs::exists(folder / kFileName, failed)) return false;
  const Result<CampaignDescription> description = read_description(folder / kFileName);
  if (!description || !description->records) return true;
  return std::ranges::any_of(*description->records, [&](const DescribedRecord& r) { return fs::equivalent(folder / fs::path(r.file), path, failed); });
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
  take_sensor(reading, single);
  if (is_described_beside(path, single.folder))
    single.notes.push_back("campaign.json beside " + path.filename().string() + " is not read for a file that is named itself: name the folder, " + single.folder.string() +
                           ", to use what it says of the bench and of its records");
  add_record(std::move(record), single);
  return single;
}

Result<Campaign> read_any(const fs::path& path, const CampaignOptions& options) {
  std::error_code failed;
  const fs::file_status status = fs::status(path, failed);
  if (!fs::exists(status))
    return fail(ErrorCode::io, "there is no such file or folder", path.empty() ? "\"\"" : path.string(), "check the name");
  if (fs::is_directory(status) && fs::exists(path / kFileName, failed)) {
    FORCEGATE_TRY(Campaign campaign, read_described(path / kFileName, options));
    note_unlisted(path, campaign);
    return campaign;
  }
  if (fs::is_directory(status)) return read_folder(path, options);
  return path.extension() == ".json" ? read_described(path, options) : read_single(path, options);
}

}  // namespace

std::string output_unit(const Campaign& campaign) {
  const Channel* output = campaign.records.empty() ? nullptr : campaign.records.front().trace.find("U");
  if (output == nullptr || output->unit.empty() || (output->unit == "1" && output->quantity != "ratio")) return "V";
  return output->unit;
}

bool is_in_counts(const Campaign& campaign) {
  const Channel* output = campaign.records.empty() ? nullptr : campaign.records.front().trace.find("U");
  return output != nullptr && output->quantity == "code";
}

Result<Campaign> read_campaign(const fs::path& path, const CampaignOptions& options) {
  FORCEGATE_TRY(Campaign campaign, read_any(path, options));
  drop_copies(campaign);
  turn_compression_over(campaign, options.threads);
  note_contradictions(campaign);
  note_unused_rate(campaign, options.assumed_rate_Hz);
  check_declared_facts(campaign);
  take_varied_supply(campaign);
  const bool chosen = std::ranges::any_of(options.column_map, [](const auto& entry) { return known_name(meaning_of_target(entry.second).name) == "U"; });
  if (!chosen) read_resistance_as_conductance(campaign);
  FORCEGATE_CHECK_OK(check_outputs_alike(campaign));
  return campaign;
}

}  // namespace forcegate
