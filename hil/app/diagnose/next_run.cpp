#include "hil/app/diagnose/next_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "hil/app/diagnose/campaign_copy.h"
#include "hil/app/diagnose/force_character.h"
#include "hil/app/files/write_file.h"
#include "hil/app/mystery/mystery.h"
#include "hil/base/plain_number.h"
#include "hil/base/slug.h"
#include "hil/base/text.h"
#include "hil/diagnose/next/rival_odds.h"
#include "hil/trace/csv.h"

namespace forcegate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Result<fs::path> write_profile(const ExperimentSegment& s, const fs::path& folder, std::size_t number) {
  std::string text = "t_s,F_ref_N\n";
  for (std::size_t i = 0; i < s.t_s.size(); ++i)
    fmt::format_to(std::back_inserter(text), "{:.4f},{:.5f}\n", s.t_s[i], s.force_N[i]);
  const fs::path path = folder / profile_name(s, number);
  FORCEGATE_CHECK_OK(write_file_atomically(path, text));
  return path;
}

struct Recording {
  fs::path path;
  ForceCharacter character;
  bool used = false;
};

std::string difference(const Recording& nearest, const ExperimentSegment& asked) {
  return "the nearest, " + nearest.path.filename().string() + ", has " + described(nearest.character) + "; asked for are " + described(character_of(asked.t_s, asked.force_N));
}

Result<std::vector<Recording>> read_recordings(const std::vector<fs::path>& paths) {
  std::vector<Recording> out;
  for (const fs::path& path : paths) {
    FORCEGATE_TRY(const TraceFile file, read_csv(path));
    const Channel* F = file.trace.find("F_ref");
    if (F == nullptr)
      return fail(ErrorCode::config, "the recording has no reference force", path.string(),
                  "name its column F_ref_N");
    out.push_back({path, character_of(file.trace.time_bases[F->time_base].t_s, F->value), false});
  }
  return out;
}

// Appends a recorded file to the description of the campaign.
Result<void> append_recording(const fs::path& source, const fs::path& folder, const std::string& kind) {
  std::error_code error;
  const fs::path target = folder / source.filename();
  if (!fs::equivalent(source, target, error)) {  // who saved it in the new folder has put it in its place
    if (fs::exists(target, error))
      return fail(ErrorCode::usage, "there is such a record already", target.string(), "rename the recording");
    fs::copy_file(source, target, error);
    if (error)
      return fail(ErrorCode::io, "the recording cannot be copied: " + error.message(), target.string());
  }
  std::ifstream file(folder / "campaign.json", std::ios::binary);
  Json json = Json::parse(file, nullptr, false, true);
  if (json.is_discarded())
    return fail(ErrorCode::parse, "the campaign's description cannot be read",
                (folder / "campaign.json").string());
  json["records"].push_back({{"file", source.filename().string()}, {"kind", kind}});
  return write_file_atomically(folder / "campaign.json", json.dump(1) + "\n");
}

// What was played is declared as little as the records before it: a kind would make the others those of a bench that is known.
Result<void> drop_kinds(const fs::path& folder) {
  const fs::path path = folder / "campaign.json";
  std::ifstream file(path, std::ios::binary);
  Json json = Json::parse(file, nullptr, false, true);
  if (json.is_discarded()) return fail(ErrorCode::parse, "the campaign's description cannot be read", path.string());
  for (Json& record : json["records"]) record.erase("kind");
  return write_file_atomically(path, json.dump(1) + "\n");
}

bool is_replay(const NextRunRequest& request) { return request.bench.rig == "replay"; }

// What a rig or a mystery's bench has to play.
struct ToPlay {
  std::vector<ProfileToRecord> on_rig;
  std::vector<MysterySegment> on_mystery;
};

// The recording that is most like the segment becomes a record of the campaign; false: none is like it.
Result<bool> take_recording(const ExperimentSegment& segment, const fs::path& profile, std::vector<Recording>& recordings, NextRunResult& out, SegmentOdds& odds) {
  constexpr double kAlike = 2.0;
  const ForceCharacter wanted = character_of(segment.t_s, segment.force_N);
  Recording* best = nullptr;
  for (Recording& r : recordings)
    if (!r.used && (best == nullptr || distance(r.character, wanted) < distance(best->character, wanted))) best = &r;
  if (best == nullptr || distance(best->character, wanted) > kAlike) {
    out.skipped.push_back(segment.name + ": none of the recordings is like it; the force to play is " + profile.string() + (best == nullptr ? "" : "; " + difference(*best, segment)));
    return false;
  }
  best->used = true;
  FORCEGATE_CHECK_OK(append_recording(best->path, out.folder, segment.kind));
  odds.file = best->path.filename().string();
  return true;
}

// Writes every segment's force, and deals the segments out; those that cannot be had go to `skipped`.
Result<ToPlay> deal_segments(const NextRunRequest& request, bool sealed, std::vector<Recording> recordings, NextRunResult& out) {
  ToPlay to_play;
  for (std::size_t k = 0; k < out.planned.segments.size(); ++k) {
    const ExperimentSegment& s = out.planned.segments[k];
    FORCEGATE_TRY(const fs::path profile, write_profile(s, out.folder, k + 1));
    SegmentOdds odds;
    odds.segment = s.name;
    odds.rivals = s.separates;
    if (is_replay(request)) {
      FORCEGATE_TRY(const bool taken, take_recording(s, profile, recordings, out, odds));
      if (!taken) continue;
    } else if (s.heats) {
      out.skipped.push_back(s.name + ": this rig cannot heat");
      continue;
    } else if (sealed) {
      to_play.on_mystery.push_back({slug(s.name), s.kind, s.t_s, s.force_N, s.f_min_Hz});
    } else {
      ProfileToRecord p;
      p.name = slug(s.name);
      p.stimulus.name = "replay";
      p.stimulus.texts["path"] = profile.string();
      to_play.on_rig.push_back(std::move(p));
    }
    out.segments.push_back(std::move(odds));
  }
  return to_play;
}

Result<void> play(const RecordingBench& bench, const ClaimedFolder& folder, const ToPlay& to_play, const RecordingProgress& progress, const std::atomic<bool>* cancelled,
                  NextRunResult& out) {
  if (!to_play.on_rig.empty()) {
    const auto of_playing = [&](double fraction, std::string_view now) {
      if (progress) progress(0.2 + 0.5 * fraction, now);
    };
    FORCEGATE_TRY(const std::vector<RecordedFile> files, record_profiles(bench, to_play.on_rig, folder, of_playing, cancelled));
    for (std::size_t k = 0; k < files.size(); ++k) out.segments[k].file = files[k].file;
  }
  if (!to_play.on_mystery.empty()) {
    FORCEGATE_TRY(const std::vector<std::string> files, play_on_mystery(out.folder, to_play.on_mystery));
    for (std::size_t k = 0; k < files.size(); ++k) out.segments[k].file = files[k];
  }
  return {};
}

void tell_odds(NextRunResult& out) {
  constexpr std::string_view kBetween = " / ";
  for (SegmentOdds& odds : out.segments) {
    const std::size_t at = odds.rivals.find(kBetween);
    const std::string first = odds.rivals.substr(0, at),
                      second = at == std::string::npos ? "" : odds.rivals.substr(at + kBetween.size());
    for (const ExperimentSegment& s : out.planned.segments)
      if (s.name == odds.segment) odds.expected = s.odds_after, odds.stated = s.odds_stated;
    if (const auto before = diagnose::rival_odds(out.before, first, second)) odds.log_before = before->log_odds;
    const auto now = diagnose::rival_odds_as(odds.stated, out.after, first, second);
    if (!now) continue;
    odds.log_after = now->log_odds;
    odds.leads = now->log_odds >= 0.0 ? first : second;
  }
}

// The sensor of a mystery is the one that its seal holds: another one that was asked for would not be played on.
Result<void> check_nothing_is_asked_of(const fs::path& mystery, const std::vector<std::string>& named) {
  if (named.empty()) return {};
  return fail(ErrorCode::usage, join(named, ", ") + ": a mystery is played on its own sensor, which lies sealed beside it, and on no other", mystery.string(),
              "leave out " + join(named, ", ") + "; recordings that were made elsewhere are given with --rig replay --record FILE");
}

}  // namespace

fs::path next_folder(const fs::path& campaign) {
  const fs::path from = campaign.filename().empty() ? campaign.parent_path() : campaign;
  return from.parent_path() / (from.stem().string() + "-next");
}

Result<std::vector<fs::path>> write_profiles(const NextExperiment& planned, const fs::path& folder) {
  FORCEGATE_CHECK_OK(check_new(folder, {}));
  std::vector<fs::path> out;
  for (std::size_t k = 0; k < planned.segments.size(); ++k) {
    FORCEGATE_TRY(fs::path path, write_profile(planned.segments[k], folder, k + 1));
    out.push_back(std::move(path));
  }
  return out;
}

bool is_playable(const NextExperiment& planned) {
  return std::ranges::any_of(planned.segments, [](const ExperimentSegment& s) { return !s.heats; });
}

Result<NextRunResult> next_run(const NextRunRequest& request, const RecordingProgress& progress, const std::atomic<bool>* cancelled) {
  NextRunResult out;
  std::error_code error;
  const bool on_rig = !is_replay(request), sealed = on_rig && is_mystery(request.campaign.campaign);
  if (sealed) FORCEGATE_CHECK_OK(check_nothing_is_asked_of(request.campaign.campaign, request.named));
  FORCEGATE_TRY(const BenchToGoOn to_go_on, bench_to_go_on(request.campaign.campaign, request.bench));
  if (progress) progress(0.0, "diagnosing what there is");
  FORCEGATE_TRY(out.before, diagnose_request(request.campaign));
  out.planned = out.before.next_experiment;
  if (out.planned.segments.empty()) return out;
  fs::path from = request.campaign.campaign;
  if (from.filename().empty()) from = from.parent_path();
  out.folder = !request.output.empty() ? request.output : next_folder(from);
  FORCEGATE_TRY(std::vector<Recording> recordings, read_recordings(request.recorded));
  FORCEGATE_TRY(const ClaimedFolder folder, ClaimedFolder::take(out.folder));
  FORCEGATE_CHECK_OK(check_new(out.folder, request.recorded));
  CampaignCopy copy(out.folder, !on_rig || !folder.is_new());
  FORCEGATE_CHECK_OK(copy_campaign(from, out.folder));
  FORCEGATE_TRY(const ToPlay to_play, deal_segments(request, sealed, std::move(recordings), out));
  out.on_stock_sensor = !to_play.on_rig.empty() && request.bench.rig == "emulated" && !to_go_on.known;
  FORCEGATE_CHECK_OK(play(to_go_on.bench, folder, to_play, progress, cancelled, out));
  if (out.segments.empty())
    return fail(ErrorCode::usage, "none of the segments can be played here: " + out.skipped.front(),
                on_rig ? from.string() : request.recorded.front().string(), "record one of them and give it with --record");
  if (on_rig) copy.keep();  // what was played is worth more than a second try
  if (std::ranges::all_of(out.before.records, [](const RecordError& r) { return r.kind.empty(); })) FORCEGATE_CHECK_OK(drop_kinds(out.folder));
  if (progress) progress(0.8, "diagnosing again");
  CampaignRequest again = request.campaign;
  again.campaign = out.folder;
  auto after = diagnose_request(again);
  if (!after) {
    if (on_rig) after.error().hint += (after.error().hint.empty() ? "" : "; ") + std::string("what was recorded is in ") + out.folder.string();
    return tl::unexpected(std::move(after).error());
  }
  out.after = std::move(*after);
  copy.keep();
  tell_odds(out);
  return out;
}

std::string next_run_text(const NextRunResult& r) {
  std::string out;
  if (r.on_stock_sensor)
    out += "the emulated rig holds a sensor of its own: what follows means something only where the first records were played on it too;\n"
           "for records of a bench give yours with --rig replay --record FILE\n";
  for (const SegmentOdds& s : r.segments)
    out += fmt::format("played {:<38} {}\n  {}: odds {} to 1 before{}, {} to 1 expected, {}\n", s.segment, s.file, s.rivals,
                       odds_text(std::exp(std::fabs(s.log_before))), s.stated ? "" : " by the evidence", odds_text(s.expected),
                       s.log_after ? fmt::format("{} to 1 now for {}", odds_text(std::exp(std::fabs(*s.log_after))), s.leads)
                                   : "both are found now");
  for (const std::string& s : r.skipped) out += "left out " + s + "\n";
  const auto claims = [](const Diagnosis& d) {
    std::string text = to_string(d.verdict);
    for (const Finding& f : d.findings)
      if (f.claimed()) text += fmt::format(", {} ({})", f.effect, probability_text(f.probability));
    return text;
  };
  out += "before: " + claims(r.before) + "\nnow:    " + claims(r.after) + "\n";
  return out + diagnosis_text(r.after);
}

std::string next_run_json(const NextRunResult& r) {
  Json segments = Json::array();
  for (const SegmentOdds& s : r.segments)
    segments.push_back({{"segment", s.segment},
                        {"file", s.file},
                        {"rivals", s.rivals},
                        {"log_odds_before", s.log_before},
                        {"odds_expected", s.expected},
                        {"odds_from", s.stated ? "probability" : "evidence"},
                        {"log_odds_after", s.log_after ? Json(*s.log_after) : Json(nullptr)},
                        {"leads", s.leads}});
  const Json out = {{"format", 1},
                    {"folder", r.folder.string()},
                    {"segments", segments},
                    {"skipped", r.skipped},
                    {"on_stock_sensor", r.on_stock_sensor},
                    {"before", Json::parse(to_json(r.before))},
                    {"after", Json::parse(to_json(r.after))}};
  return out.dump(2) + "\n";
}

}  // namespace forcegate
