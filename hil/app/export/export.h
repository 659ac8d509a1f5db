#pragma once
// `forcegate export`: a fitted model as a C header for firmware.

#include <filesystem>
#include <optional>
#include <string>

#include "hil/app/export/compensator_check.h"
#include "hil/app/export/self_check.h"
#include "hil/app/model/model_input.h"
#include "hil/diagnose/refit/one_law.h"

namespace forcegate {

struct ExportRequest {
  std::string model;             ///< library name or file
  std::filesystem::path header;  ///< to write; empty: none
  double rate_Hz = 1000.0;
  std::string plan = "smoke";            ///< whose calibration is taken back; "none"
  std::optional<CampaignRequest> fit;    ///< refit one law for all records of this campaign first
  std::filesystem::path fitted;          ///< model file to write after the refit; empty: none
  std::optional<CampaignRequest> check;  ///< campaign to replay
  double reference_temperature_C = kMissing;  ///< where a thermal effect is zero, for a model that does not say
};

struct ExportResult {
  double rate_Hz = 1000.0;       ///< samples a second that the header is made for
  double recorded_Hz = 0.0;      ///< of the records of --fit and --check; 0: none, or no one rate
  std::string input_unit = "V";  ///< of what the header takes
  std::string input;             ///< in words, where it is no voltage
  std::filesystem::path header;
  Compensator compensator;
  CalibrationMap calibration;
  std::optional<diagnose::OneLawFit> fit;
  SelfCheck self;
  std::optional<CompensatorCheck> check;
  std::vector<std::string> notes;  ///< what the header takes for granted, one sentence each
};

Result<ExportResult> export_model(const ExportRequest& request);
/// Of a header that undoes something: what gains_nothing() says of its check; "" otherwise.
std::string nothing_gained(const ExportResult& result);
std::string export_text(const ExportResult& result, bool notes = true);
std::string export_json(const ExportResult& result);

}  // namespace forcegate
