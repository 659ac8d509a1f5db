#include "hil/app/characterize/recordings.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>

#include "hil/characterize/recording.h"

namespace forcegate {

namespace fs = std::filesystem;
using characterize::SensorStudy;
using characterize::SessionSheet;

namespace {

bool is_static(const SessionSheet& sheet) { return sheet.find("static.gain") != nullptr; }
bool is_identified(const SessionSheet& sheet) { return sheet.find("identified.b") != nullptr && sheet.find("identified.q") != nullptr; }

// The last `parts` of a path.
fs::path tail(const fs::path& path, std::ptrdiff_t parts) {
  fs::path out;
  for (auto at = std::prev(path.end(), parts); at != path.end(); ++at) out /= *at;
  return out;
}

void note_what_calibrations_lack(SensorStudy& study) {
  const auto slow = std::ranges::count_if(study.sheets, is_static), cyclic = std::ranges::count_if(study.sheets, is_identified);
  if (cyclic == 0 || sheet_of_both(study)) return;
  const std::string why =
      slow == 0 ? "no calibration file is written, since no slow recording tells gain and offset: add one of this sensor, --record FILE"
                : fmt::format("b and c/a are in no calibration file: with {} slow and {} cyclic recordings nothing says which are of one sensor; give one of each", slow, cyclic);
  std::ranges::find_if(study.sheets, is_identified)->notes.push_back(why);
}

}  // namespace

std::string name_of_recording(const fs::path& path, const std::vector<fs::path>& all) {
  const fs::path whole = fs::absolute(path).lexically_normal();
  const std::ptrdiff_t parts = std::distance(whole.begin(), whole.end());
  for (std::ptrdiff_t n = 1; n < parts; ++n) {
    const auto has_the_same = [&](const fs::path& other) {
      const fs::path of_it = fs::absolute(other).lexically_normal();
      return of_it != whole && std::distance(of_it.begin(), of_it.end()) >= n && tail(of_it, n) == tail(whole, n);
    };
    if (std::ranges::none_of(all, has_the_same)) return tail(whole, n).string();
  }
  return whole.string();
}

Result<SensorStudy> study_recordings(const CharacterizeRequest& request, const characterize::StudyPlan& plan, characterize::BenchProgress& progress) {
  SensorStudy study;
  study.sensor = request.sensors.size() == 1 ? request.sensors.front() : "recording";
  study.of_recordings = true;
  std::map<std::string, std::size_t> sheet_of;  // by what the recording holds
  for (const fs::path& path : request.recordings) {
    auto options = request.rig_options;
    options["record"] = path.string();
    FORCEGATE_TRY(const auto rig, make_rig(request.rig, options));
    // a copy is no second session: its spread of 0 would be told for that of the sensor
    const RigInfo info = rig->info();
    if (const auto digest = info.details.find("record_sha256"); digest != info.details.end()) {
      const auto [known, is_new] = sheet_of.emplace(digest->second, study.sheets.size());
      if (!is_new) {
        study.sheets[known->second].notes.push_back(path.filename().string() + " is the same recording: it is counted once");
        continue;
      }
    }
    const std::string name = name_of_recording(path, request.recordings);
    Result<SessionSheet> made = characterize::characterize_recording(*rig, name, progress);
    if (!made && made.error().where == name) made.error().where = path.string();
    FORCEGATE_TRY(SessionSheet sheet, std::move(made));
    study.rig_time_s += static_cast<double>(sheet.samples) / rig->info().rate_Hz;
    study.samples += sheet.samples;
    study.sheets.push_back(std::move(sheet));
  }
  note_what_calibrations_lack(study);
  characterize::summarise(study, plan);
  return study;
}

std::optional<SessionSheet> sheet_of_both(const SensorStudy& study) {
  if (!study.of_recordings || study.sheets.size() != 2) return std::nullopt;
  const auto slow = std::ranges::find_if(study.sheets, is_static), cyclic = std::ranges::find_if(study.sheets, is_identified);
  if (slow == study.sheets.end() || cyclic == study.sheets.end()) return std::nullopt;
  SessionSheet out = *slow;
  out.specimen = slow->specimen + " and " + cyclic->specimen;
  out.calibration.b_scale = cyclic->calibration.b_scale;
  out.calibration.q_scale = cyclic->calibration.q_scale;
  out.calibration.level = CalibrationLevel::identified;
  return out;
}

}  // namespace forcegate
