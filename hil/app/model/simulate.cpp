#include "hil/app/model/simulate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/app/files/own_file.h"
#include "hil/app/files/write_file.h"
#include "hil/app/model/clean_input.h"
#include "hil/base/plain_number.h"
#include "hil/trace/columns.h"

namespace forcegate {

namespace {

// What a run that does not end has made; what was there before it stays.
class NewFiles {
 public:
  ~NewFiles() {
    std::error_code ignored;
    if (!kept_)
      for (auto made = made_.rbegin(); made != made_.rend(); ++made) std::filesystem::remove(*made, ignored);  // a folder only where it is empty
  }
  void about_to_make(const std::filesystem::path& path) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) made_.push_back(path);
  }
  void keep() { kept_ = true; }

 private:
  std::vector<std::filesystem::path> made_;
  bool kept_ = false;
};

// A header that reads back as what it was; a bare ratio has none.
struct OutputColumn {
  explicit OutputColumn(const std::string& unit) : name(unit == "1" ? "pct" : unit), factor(unit == "1" ? 100.0 : 1.0) {}
  std::string name;
  double factor;
};

// Where a state of an equation runs away, the numbers stay numbers for a while.
std::string far_off_note(const RecordInput& r, const std::vector<double>& U, const std::string& unit) {
  constexpr double kFar = 1e3;
  double largest = 0.0;
  for (std::size_t i = 0; i < r.rows(); ++i)
    if (r.ok[i] != 0) largest = std::max(largest, std::fabs(r.U_V[i]));
  const auto far = std::ranges::find_if(U, [&](double u) { return std::fabs(u) > kFar * largest; });
  if (!(largest > 0.0) || far == U.end()) return {};
  return fmt::format("{}: the model is at {:.3g} {} from {:.4g} s on, and the recorded output stays within {:.3g}: a state of it may run away (the sign and size of its time constants)",
                     r.name, *far, unit, r.t_s[static_cast<std::size_t>(far - U.begin())], largest);
}

}  // namespace

Result<Simulation> simulate_request(const CampaignRequest& request, const std::filesystem::path& folder, const std::atomic<bool>* interrupted, bool replaces) {
  FORCEGATE_TRY(Campaign campaign, load_campaign(request));
  FORCEGATE_TRY(const Model model, request.model.empty() ? load_model(request, campaign) : load_model(request.model));
  Simulation out;
  out.unit = output_unit(campaign);
  out.model_unit = model.output_unit;
  out.notes = campaign.notes;
  if (!out.is_comparable())
    out.notes.push_back("the model gives an output in " + out.model_unit + ", and these records hold it in " + out.unit +
                        ": the two columns cannot be compared, and no error is told; forcegate fit CAMPAIGN -o FILE makes a model in " + out.unit);
  const OutputColumn measured(out.unit), modelled(out.model_unit);
  FORCEGATE_TRY(CampaignInput rows, clean_input(std::move(campaign), request.threads));
  if (std::string note = model.law.decays ? note_of_assumed_cycles(rows.records) : std::string(); !note.empty()) out.notes.push_back(std::move(note));
  for (RecordInput& r : rows.records) set_decay(r, model.law);
  const CampaignInFrame input(model.frame, std::move(rows));
  NewFiles files;
  files.about_to_make(folder);
  FORCEGATE_CHECK_OK(make_folder(folder));
  for (const RecordInput& r : input.input().records) {
    if (interrupted != nullptr && *interrupted) return fail(ErrorCode::cancelled, "interrupted: what was written is taken back", folder.string());
    FORCEGATE_TRY(const std::vector<double> U, model_output_V(model, input, r));
    std::string text = "t_s,F_ref_N," + header_of("U", measured.name) + "," + header_of("U_model", modelled.name) + "\n";
    double square = 0.0;
    std::size_t counted = 0;
    for (std::size_t i = 0; i < r.rows(); ++i) {
      // a row without a sample of force or output, or with one that is none of the sensor's, has no error; its model is what the force before it makes of it
      if (r.ok[i] == 0) {
        text += fmt::format("{:.6g},,,{:.6g}\n", r.t_s[i], modelled.factor * U[i]);
        continue;
      }
      text += fmt::format("{:.6g},{:.6g},{:.6g},{:.6g}\n", r.t_s[i], r.F_N[i], measured.factor * r.U_V[i], modelled.factor * U[i]);
      square += (r.U_V[i] - U[i]) * (r.U_V[i] - U[i]);
      ++counted;
    }
    const auto file = folder / (r.name + ".csv");
    if (!replaces) FORCEGATE_CHECK_OK(check_own_file(file, kMarkOfSimulation));
    files.about_to_make(file);
    FORCEGATE_CHECK_OK(write_file_atomically(file, text));
    Simulation::Item item{r.name, file, r.rows(), r.row_step_s, r.fast_t_s.size() > r.rows(), std::nullopt};
    std::string far_off = out.is_comparable() ? far_off_note(r, U, out.unit) : std::string();
    if (!far_off.empty()) out.notes.push_back(std::move(far_off));
    if (out.is_comparable() && std::isfinite(square)) item.rmse_V = std::sqrt(square / static_cast<double>(std::max<std::size_t>(1, counted)));
    out.items.push_back(std::move(item));
  }
  files.keep();
  return out;
}

std::string simulation_text(const Simulation& s) {
  const PrintedUnit unit = printed_unit(s.unit);
  std::string out;
  for (const Simulation::Item& item : s.items)
    out += fmt::format("{}: {} rows{}{}\n", item.file.string(), item.rows,
                       item.is_thinned ? fmt::format(" (means of {:.3g} ms)", 1e3 * item.row_s) : "",
                       item.rmse_V ? ", model against measurement " + plain_number(unit.factor * *item.rmse_V) + " " + unit.name + " RMS" : "");
  return out;
}

}  // namespace forcegate
