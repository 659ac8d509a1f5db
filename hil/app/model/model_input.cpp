#include "hil/app/model/model_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <tuple>

#include "hil/base/some_of.h"
#include "hil/base/text.h"
#include "hil/trace/channels.h"
#include "hil/trace/column_map.h"
#include "hil/trace/columns.h"
#include "hil/trace/divider.h"
#include "hil/trace/set_earlier.h"

#include "hil/diagnose/candidates/user_candidates.h"

namespace forcegate {

Result<Model> load_model(const std::string& name) {
  if (name.empty()) return library_model("flexiforce");
  const std::vector<std::string> known = library_model_names();
  if (std::find(known.begin(), known.end(), name) != known.end()) return library_model(name);
  Result<Model> model = read_model(name);
  constexpr std::array kRecordings = {".csv", ".tsv", ".txt", ".lvm", ".mat", ".h5", ".hdf5", ".fgj"};
  const std::string ending = ascii_lower(std::filesystem::path(name).extension().string());
  std::error_code unknown;
  if (!model && std::ranges::find(kRecordings, ending) != kRecordings.end() && std::filesystem::exists(name, unknown))
    return fail(ErrorCode::usage, "this is a recording and no model file", name,
                "a model file is TOML, as forcegate add -o and forcegate fit -o write it; the models that come with the program are " + join(known, " and "));
  return model;
}

std::string note_of_another_unit(const Model& model, const Campaign& campaign) {
  return fmt::format("the model takes an output in {}, and these records hold it in {}: what the file says as written means nothing here, only what is refitted does",
                     model.output_unit, output_unit(campaign));
}

Result<Model> load_model(const CampaignRequest& request, Campaign& campaign) {
  if (!request.model.empty()) {
    FORCEGATE_TRY(Model model, load_model(request.model));
    const std::vector<std::string> known = library_model_names();
    if (output_unit(campaign) != model.output_unit && std::ranges::find(known, request.model) == known.end()) campaign.notes.push_back(note_of_another_unit(model, campaign));
    return model;
  }
  const std::string name = library_model_of(campaign.sensor);
  if (name != "flexiforce")
    campaign.notes.push_back("sensor \"" + campaign.sensor + "\": the model is " + name + " (--model flexiforce for the other one)");
  return library_model(name);
}

namespace {

// Who maps the output onto the force, or onto a name that means nothing, has no output left: "" where no map does so.
std::string mapped_away(const std::vector<std::string>& words, const std::string& wanted) {
  const auto name_of = [](const std::string& column) { return known_name(meaning_of_target(column).name); };
  const Result<ColumnMap> maps = parse_column_map(words);
  if (!maps) return {};
  for (const auto& [from, to] : *maps) {
    const std::string map = "--map " + shell_quoted(from + "=" + to), meant = wanted == "U" ? "the output is U_V" : "the force is F_ref_N";
    const ColumnMeaning meaning = meaning_of_target(to);
    if (!meaning.is_clock && meaning.unit.symbol.empty() && to != "unused" && known_channel(name_of(to)) == nullptr)
      return "\"" + to + "\" of " + map + " is no name that means anything here: " + meant + " (docs/campaign.md lists the names)";
    if (name_of(from) == wanted && name_of(to) != wanted) return map + " made another thing of it: take that out, or map another column";
  }
  return {};
}

// Whether the reader took numbers of the column for an overload and left them out.
bool is_overload(const Campaign& campaign, const std::string& header) {
  return std::ranges::any_of(campaign.notes, [&](const std::string& note) {
    return note.find("column \"" + header + "\": ") != std::string::npos && note.find(kOverloadsLeftOut) != std::string::npos;
  });
}

// One record without numbers among others is left out; where all are, the column says nothing, which is no word on force or output.
Result<void> check_holds_numbers(const Campaign& campaign) {
  for (const auto& [name, what] : {std::pair{"F_ref", "the force"}, std::pair{"U", "the output"}}) {
    const auto holds_none = [&name = name](const Record& record) {
      const Channel* channel = record.trace.find(name);
      return channel != nullptr && std::ranges::none_of(channel->value, [](double v) { return std::isfinite(v); });
    };
    if (campaign.records.empty() || !std::ranges::all_of(campaign.records, holds_none)) continue;
    const Record& first = campaign.records.front();
    const std::string header = written_header(*first.trace.find(name), first.headers);
    const std::size_t others = campaign.records.size() - 1;
    if (is_overload(campaign, header))
      return fail(ErrorCode::parse,
                  fmt::format("column \"{}\" holds no number below 9.9e37 in any of {} rows, and it is {}: from there on a number is an instrument's overload (SCPI), and counts as missing",
                              header, first.trace.size(), what),
                  first.place_of_header(), "was the instrument in its range, and is the number what the instrument wrote? --map NAME=" + std::string(name == std::string_view("U") ? "U_V" : "F_ref_N") + " names another column");
    return fail(ErrorCode::parse,
                "column \"" + header + "\" holds no number in any of " + std::to_string(first.trace.size()) + " rows, and it is " + what +
                    (others > 0 ? fmt::format(", as in {} other record{}", others, others > 1 ? "s" : "") : ""),
                first.place_of_header(),
                "is the instrument connected, and was its column exported? --map NAME=" + std::string(name == std::string_view("U") ? "U_V" : "F_ref_N") +
                    " names another column" +
                    (name == std::string_view("U") ? "" : "; --map " + shell_quoted(header + "=unused") + " leaves it out, and of an output alone forcegate diagnose tells the drift"));
  }
  return {};
}

}  // namespace

Result<Campaign> load_recordings(const CampaignRequest& request) {
  CampaignOptions options;
  options.assumed_rate_Hz = request.assumed_rate_Hz;
  options.threads = request.threads;
  FORCEGATE_TRY(options.column_map, parse_column_map(request.maps));
  FORCEGATE_TRY(Campaign campaign, read_campaign(request.campaign, options));
  FORCEGATE_CHECK_OK(check_holds_numbers(campaign));
  if (!request.divider.empty()) {
    FORCEGATE_TRY(const Divider divider, parse_divider(request.divider));
    FORCEGATE_CHECK_OK(read_divider(campaign, divider));
  }
  FORCEGATE_CHECK_OK(set_output_earlier(campaign, request.late_s));
  return campaign;
}

Result<Campaign> load_campaign(const CampaignRequest& request) {
  FORCEGATE_TRY(Campaign campaign, load_recordings(request));
  FORCEGATE_CHECK_OK(check_channels(campaign, request.maps));
  return campaign;
}

namespace {

// Columns of text stand in no trace; the notes of the record tell of them.
std::string left_out_columns(const Campaign& campaign, const Record& record) {
  std::string out;
  for (const std::string& note : campaign.notes)
    if (note.starts_with(record.name + ": column ") && note.find(" holds text and was left out") != std::string::npos) out += "; " + note.substr(record.name.size() + 2);
  return out;
}

}  // namespace

Result<void> check_channels(const Campaign& campaign, const std::vector<std::string>& maps) {
  for (const Record& record : campaign.records)
    for (const auto& [name, what, unit] :
         {std::tuple{"F_ref", "reference force", "N"}, std::tuple{"U", "output", "V"}}) {
      if (record.trace.find(name)) continue;
      std::vector<std::string> columns;
      std::string in_grams;
      const std::string of_text = left_out_columns(campaign, record), away = mapped_away(maps, name);
      for (const Channel& c : record.trace.channels) {
        columns.push_back(written_header(c, record.headers));
        // a weight in grams: "g" may also be an acceleration, and is no unit here
        if (std::string_view(name) == "F_ref" && c.unit.empty() &&
            (c.name == "g" || c.name.ends_with("_g") || c.name.ends_with("(g)") || c.name.ends_with("[g]")) && in_grams.empty())
          in_grams = c.name;
      }
      const std::string nothing_left = of_text.empty() ? no_column_left_advice(record.trace) : "";
      return fail(ErrorCode::parse, std::string("no column is the ") + what + ": there are " + some_columns(columns) + of_text,
                  record.place_of_header(),
                  !away.empty() ? away
                  : of_text.find(" is a meter over its range") != std::string::npos
                      ? "empty the cells where the meter is over its range: they are missing values, or a conductance of 0"
                  : !in_grams.empty() ? "if " + in_grams + " is a weight in grams: --map " + shell_quoted(in_grams + "=F_ref_gf")
                                      : (nothing_left.empty() ? "name one, for instance " + column_map_advice(record.trace, name, unit, record.headers) : nothing_left) +
                                            (std::string_view(name) == "F_ref" && record.trace.find("U") != nullptr ? "; of an output alone forcegate diagnose tells the drift" : ""));
    }
  return {};
}

PlacesOf::PlacesOf(const Campaign& campaign, const std::filesystem::path& given) {
  constexpr std::string_view kDays = "if it counts days";
  for (const Record& record : campaign.records) {
    file_[record.name] = record.place();
    for (const std::string& note : campaign.notes)
      if (const std::size_t at = note.find(kDays); at != std::string::npos && note.starts_with(record.name + ": the clock ")) days_[record.place()] = note.substr(at);
  }
  file_.try_emplace(campaign.name, given.string());
}

Error PlacesOf::with_file(Error error) const {
  if (const auto file = file_.find(error.where); file != file_.end()) error.where = file->second;
  // days read as seconds are samples beyond any rate, and always too few
  if (const auto days = days_.find(error.where); days != days_.end() && error.text.starts_with("the record has only "))
    error.hint = "its clock was taken for seconds; " + days->second + "; of seconds " + error.hint;
  return error;
}

diagnose::EngineOptions engine_options(const Model& model, unsigned threads) {
  diagnose::EngineOptions out;
  out.law = model.law;
  out.model_name = model.name;
  out.in_model = model.effect_names();
  out.model_effects = model.effects;
  out.user_effects = model.user_effects;
  for (const UserEffect& effect : model.user_effects)
    if (diagnose::is_fitted(effect)) out.in_model.push_back(effect.name);
  out.threads = threads;
  return out;
}

}  // namespace forcegate
