#include "hil/app/model/simulate.h"

#include <fmt/format.h>

#include <cmath>

#include "hil/app/files/write_file.h"
#include "hil/app/model/clean_input.h"
#include "hil/base/plain_number.h"

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

}  // namespace

Result<Simulation> simulate_request(const CampaignRequest& request, const std::filesystem::path& folder, const std::atomic<bool>* interrupted) {
  FORCEGATE_TRY(Campaign campaign, load_campaign(request));
  FORCEGATE_TRY(const Model model, load_model(request, campaign));
  Simulation out;
  out.unit = output_unit(campaign);
  FORCEGATE_TRY(CampaignInput rows, clean_input(std::move(campaign), request.threads));
  for (RecordInput& r : rows.records) set_decay(r, model.law);
  const CampaignInFrame input(model.frame, std::move(rows));
  NewFiles files;
  files.about_to_make(folder);
  FORCEGATE_CHECK_OK(make_folder(folder));
  for (const RecordInput& r : input.input().records) {
    if (interrupted != nullptr && *interrupted) return fail(ErrorCode::cancelled, "interrupted: what was written is taken back", folder.string());
    FORCEGATE_TRY(const std::vector<double> U, model_output_V(model, input, r));
    std::string text = "t_s,F_ref_N,U_V,U_model_V\n";
    double square = 0.0;
    std::size_t counted = 0;
    for (std::size_t i = 0; i < r.rows(); ++i) {
      // a row without a sample of force or output, or with one that is none of the sensor's, has no error; its model is what the force before it makes of it
      if (r.ok[i] == 0) {
        text += fmt::format("{:.6g},,,{:.6g}\n", r.t_s[i], U[i]);
        continue;
      }
      text += fmt::format("{:.6g},{:.6g},{:.6g},{:.6g}\n", r.t_s[i], r.F_N[i], r.U_V[i], U[i]);
      square += (r.U_V[i] - U[i]) * (r.U_V[i] - U[i]);
      ++counted;
    }
    const auto file = folder / (r.name + ".csv");
    files.about_to_make(file);
    FORCEGATE_CHECK_OK(write_file_atomically(file, text));
    out.items.push_back({r.name, file, r.rows(), r.row_step_s, r.fast_t_s.size() > r.rows(),
                         std::sqrt(square / static_cast<double>(std::max<std::size_t>(1, counted)))});
  }
  files.keep();
  return out;
}

std::string simulation_text(const Simulation& s) {
  const PrintedUnit unit = printed_unit(s.unit);
  std::string out;
  for (const Simulation::Item& item : s.items)
    out += fmt::format("{}: {} rows{}, model against measurement {} {} RMS\n", item.file.string(), item.rows,
                       item.is_thinned ? fmt::format(" (means of {:.3g} ms)", 1e3 * item.row_s) : "", plain_number(unit.factor * item.rmse_V), unit.name);
  return out;
}

}  // namespace forcegate
