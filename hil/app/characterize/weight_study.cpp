#include "hil/app/characterize/weight_study.h"

#include "hil/app/files/claimed_folder.h"
#include "hil/app/files/find_plan.h"
#include "hil/app/files/own_file.h"
#include "hil/app/files/write_file.h"
#include "hil/report/capacitance/network_header.h"
#include "hil/report/capacitance/weight_figures.h"
#include "hil/report/capacitance/weight_json.h"
#include "hil/report/capacitance/weight_page.h"

namespace forcegate {

Result<bool> is_weight_study(const CharacterizeRequest& request) {
  if (!request.recordings.empty()) return false;
  FORCEGATE_TRY(const std::filesystem::path path, find_plan(request.plan));
  FORCEGATE_TRY(const std::string kind, characterize::plan_kind(path));
  return kind == "capacitance";
}

Result<MadeWeightStudy> weight_study_request(const CharacterizeRequest& request,
                                             const std::function<void(double, std::string_view)>& progress,
                                             const std::atomic<bool>* cancelled) {
  if (!request.specimens.empty() || request.sessions || !request.golden.empty())
    return fail(ErrorCode::usage,
                "a plan of conductance and capacitance knows no specimens, sessions or golden traces", {},
                "leave --specimen, --sessions and --golden out");
  if (request.sensors != CharacterizeRequest{}.sensors)
    return fail(ErrorCode::usage, "the sensors of a plan of conductance and capacitance are those of its packs", "--sensor", "leave it out");
  FORCEGATE_TRY(const std::filesystem::path path, find_plan(request.plan));
  characterize::WeightStudyRequest study;
  FORCEGATE_TRY(study.plan, characterize::read_weight_plan(path));
  if (request.seed) study.plan.seed = *request.seed;
  const std::string bench = request.rig == "emulated" ? "dead_weight" : request.rig;
  study.make_bench = [&] { return make_weight_bench(bench, request.rig_options); };
  study.threads = request.threads;
  study.progress = progress;
  study.cancelled = cancelled;
  FORCEGATE_TRY(const ClaimedFolder folder, ClaimedFolder::take(request.output));
  if (!request.output.empty() && !request.overwrite) {
    FORCEGATE_CHECK_OK(check_own_file(request.output / "capacitance.json", "\"kind\": \"capacitance\""));
    FORCEGATE_CHECK_OK(check_own_file(request.output / "networks.h", "written by `forcegate characterize"));
    FORCEGATE_CHECK_OK(check_own_file(request.output / "sheet-capacitance.html", kMarkOfPage));
  }
  MadeWeightStudy made;
  FORCEGATE_TRY(made.study, characterize::run_weight_study(study));
  made.summary = characterize::summarise(made.study);
  const auto pictures = weight_figures(made.study);
  const auto write = [&](const std::filesystem::path& file, const std::string& text) -> Result<void> {
    FORCEGATE_CHECK_OK(write_file_atomically(file, text));
    made.files.push_back(file);
    return {};
  };
  if (!request.output.empty()) {
    FORCEGATE_CHECK_OK(write(request.output / "capacitance.json", weight_json(made.study, made.summary)));
    FORCEGATE_CHECK_OK(write(request.output / "networks.h", network_header(made.study)));
    FORCEGATE_CHECK_OK(write(request.output / "sheet-capacitance.html",
                             weight_sheet_html(made.study, made.summary, pictures, request.command_line)));
  }
  if (!request.paper.empty()) {
    for (const PaperPicture& p : pictures)
      FORCEGATE_CHECK_OK(write(request.paper / "pictures" / "paper-capacitance" / p.file,
                               p.figure.svg(figures::Figure::Target::standalone)));
    FORCEGATE_CHECK_OK(write(request.paper / "paper-capacitance.md",
                             weight_markdown(made.study, made.summary, pictures, request.command_line,
                                             "pictures/paper-capacitance")));
  }
  return made;
}

}  // namespace forcegate
