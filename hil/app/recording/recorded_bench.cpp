#include "hil/app/recording/recorded_bench.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "hil/base/read_file.h"
#include "hil/base/text.h"
#include "hil/interface/rig.h"
#include "hil/interface/sealed_setting.h"

namespace forcegate {
namespace {

using Json = nlohmann::json;
using Settings = std::map<std::string, std::string>;

constexpr const char* kNone = "none";

std::optional<std::string> specimen_of(const Json& campaign) {
  constexpr std::string_view kBefore = ", specimen ";
  const std::string sensor = campaign.value("sensor", Json()).is_string() ? campaign["sensor"].get<std::string>() : "";
  const std::size_t at = sensor.rfind(kBefore);
  if (at == std::string::npos) return std::nullopt;
  return sensor.substr(at + kBefore.size());
}

std::optional<double> number_of(const Json& with, const char* name) {
  const Json value = with.value(name, Json());
  return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
}

std::optional<std::uint64_t> count_of(const Json& with, const char* name) {
  const Json value = with.value(name, Json());
  return value.is_number_unsigned() ? std::optional(value.get<std::uint64_t>()) : std::nullopt;
}

std::optional<Settings> settings_of(const Json& with) {
  const Json value = with.value("rig_options", Json());
  if (!value.is_object()) return std::nullopt;
  Settings out;
  for (const auto& [name, text] : value.items())
    if (text.is_string()) out[name] = text.get<std::string>();
  return out;
}

std::string count_text(const std::optional<std::uint64_t>& value) { return value ? std::to_string(*value) : kNone; }
std::string rate_text(const std::optional<double>& value) { return (value ? shortest(*value) : std::string(kNone)) + std::string(" Hz"); }
std::string told(const Settings& settings, const std::string& name) { return settings.contains(name) ? printable_utf8(settings.at(name)) : kNone; }

}  // namespace

std::string there_and_asked(const std::string& what, const std::string& there, const std::string& asked) {
  return fmt::format("{} {} there, {} asked", what, there, asked);
}

std::optional<RecordedBench> recorded_bench(std::string_view description) {
  const Json campaign = Json::parse(description, nullptr, false, true);
  const Json with = campaign.is_object() ? campaign.value("recorded_with", Json()) : Json();
  if (!with.is_object()) return std::nullopt;
  RecordedBench out;
  const Json rig = with.value("rig", Json());
  out.rig = rig.is_string() ? rig.get<std::string>() : kNone;
  out.rig = out.rig.substr(0, out.rig.find('/'));
  if (const Json id = with.value("rig_id", Json()); id.is_string()) out.rig_id = id.get<std::string>();
  out.specimen = specimen_of(campaign);
  out.seed = count_of(with, "seed"), out.session = count_of(with, "session");
  out.rate_Hz = number_of(with, "rate_Hz"), out.rig_rate_Hz = number_of(with, "rig_rate_Hz");
  out.settings = settings_of(with);
  return out;
}

std::optional<RecordedBench> recorded_bench_of(const std::filesystem::path& campaign) {
  std::error_code unknown;
  const bool is_folder = std::filesystem::is_directory(campaign, unknown);
  if (!is_folder && campaign.extension() != ".json") return std::nullopt;
  const auto text = read_file(is_folder ? campaign / "campaign.json" : campaign);
  return text ? recorded_bench(*text) : std::nullopt;
}

Result<std::vector<std::string>> differences(const RecordedBench& there, const RecordingBench& asked) {
  std::vector<std::string> out;
  const auto compare = [&](const std::string& what, const std::string& of_there, const std::string& of_asked) {
    if (of_there != of_asked) out.push_back(there_and_asked(what, of_there, of_asked));
  };
  compare("rig", printable_utf8(there.rig), printable_utf8(asked.rig));
  compare("specimen", printable_utf8(there.specimen.value_or(kNone)), printable_utf8(asked.specimen));
  compare("seed", count_text(there.seed), count_text(asked.seed));
  compare("session", count_text(there.session), count_text(asked.session));
  compare("rate", rate_text(there.rate_Hz), rate_text(there.rig_rate_Hz.value_or(0.0) > 0.0 ? rate_of_rows(*there.rig_rate_Hz, asked.rate_Hz) : asked.rate_Hz));
  if (there.rig_id && there.rig == asked.rig) {
    FORCEGATE_TRY(const auto rig, make_rig(asked.rig, asked.rig_options));
    compare("bench", printable_utf8(*there.rig_id), printable_utf8(rig->info().id));
  }
  if (!there.settings || there.rig != asked.rig) return out;
  // an option that is given as it would be anyway is no difference, one that is not known yet has the value of all time
  FORCEGATE_TRY(const auto then, make_rig(there.rig, *there.settings));
  FORCEGATE_TRY(const auto now, make_rig(asked.rig, asked.rig_options));
  const Settings of_there = then->settings(), of_asked = now->settings();
  Settings every = of_there;
  every.insert(of_asked.begin(), of_asked.end());
  for (const auto& [name, value] : every) {
    const std::string there_is = told(of_there, name), asked_is = told(of_asked, name);
    if (there_is != asked_is && there_is.starts_with(kSealedSetting))
      out.push_back("rig option " + name + " another there");
    else
      compare("rig option " + name, there_is, asked_is);
  }
  return out;
}

Result<BenchToGoOn> bench_to_go_on(const std::filesystem::path& campaign, const GivenBench& given) {
  BenchToGoOn out;
  RecordingBench& bench = out.bench;
  bench.rig = given.rig;
  const std::optional<RecordedBench> there = recorded_bench_of(campaign);
  const bool same_rig = there && there->rig == given.rig;
  if (there && !same_rig && given.rig != "replay")
    return fail(ErrorCode::usage, "the campaign was recorded otherwise: " + there_and_asked("rig", printable_utf8(there->rig), printable_utf8(given.rig)), campaign.string(),
                std::string(there->rig == "bench" ? "give its bench file with --rig FILE" : "give the rig of the campaign with --rig " + printable_utf8(there->rig)) +
                    ": another rig holds another sensor; recordings of this sensor that were made elsewhere are given with --rig replay --record FILE");
  if (same_rig) {
    out.known = there->settings.has_value();
    bench.rig_options = there->settings.value_or(Settings{});
    bench.specimen = there->specimen.value_or(bench.specimen);
    bench.seed = there->seed.value_or(bench.seed), bench.session = there->session.value_or(bench.session);
    bench.rate_Hz = there->rate_Hz.value_or(bench.rate_Hz);
  }
  bench.specimen = given.specimen.value_or(bench.specimen), bench.seed = given.seed.value_or(bench.seed);
  for (const auto& [name, value] : given.rig_options) bench.rig_options[name] = value;
  if (!same_rig) return out;
  FORCEGATE_TRY(const std::vector<std::string> differs, differences(*there, bench));
  if (differs.empty()) return out;
  if (differs.front().starts_with("bench "))
    return fail(ErrorCode::usage, "the campaign was recorded otherwise: " + join(differs, "; "), campaign.string(), "give the bench file of the bench that recorded it with --rig FILE");
  return fail(ErrorCode::usage, "the campaign was recorded otherwise: " + join(differs, "; "), campaign.string(),
              "leave --specimen, --seed and --rig-option out: what its campaign.json says is taken");
}

}  // namespace forcegate
