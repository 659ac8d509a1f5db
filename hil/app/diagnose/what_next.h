#pragma once
// What to do after an answer of the diagnosis. The verbs ask here, so that no chain of last lines comes back to where it was without
// having learnt something:
//
//   diagnose -> add -> history -> diagnose (the better model) -> ... -> export      while something is found
//   diagnose -> next -> next --run -> diagnose                                      while effects compete
//   diagnose -> diagnose --html -> explain                                          for what no command can mend
//   diagnose -> export (several records), or fit -> export (one)                    when nothing is missing
//   diagnose -> diagnose --html -> next -> record                                   when an effect is suspected beside that
//   diagnose -> diagnose --html -> record                                           when held-out records gain nothing by what is claimed

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hil/app/export/export.h"
#include "hil/app/model/model_input.h"

namespace forcegate {

enum class Step {
  align,       ///< set the output earlier by what it is late behind the model's lag
  add,         ///< take the effect into the model
  experiment,  ///< ask which record parts what competes
  page,        ///< look at the pictures
  fit,         ///< keep the law's own numbers in a model file
  compensate,  ///< put the model into firmware
  record,      ///< the records do not show it: what else to play
  explain,     ///< nothing is left that a command could do: what the answer means
};

struct WhatNext {
  Step step = Step::explain;
  std::string word;  ///< the effect to add, or the word to explain
  double late_s = 0.0;  ///< by which the output is to be set earlier
};

/// Where the user stands.
struct Standing {
  bool page = false;        ///< the pictures were asked for already
  bool model_file = false;  ///< the model is a file of the user's own
  bool experiment = false;  ///< what to measure next was asked for already
  std::vector<std::string> in_model{};   ///< effects that the model has
  /// Whether export takes the model, of one that comes with the program: refitted on the campaign. Asked only where it decides; empty: no.
  std::function<bool()> is_exportable{};
};

WhatNext after_diagnosis(const Diagnosis& diagnosis, const Standing& standing);

/// "--map time=t_us" where a clock without a unit was taken for seconds that are hardly meant: what would be built on it waits. "": none was.
std::string map_of_doubtful_clock(const Diagnosis& diagnosis);

/// Whether this answer would have the effect added: where `add` has just refused it, the chain would go round.
bool leads_to_add(const Diagnosis& diagnosis, const std::string& effect);

/// A plan that comes with the program and plays what would part the rivals, or settle the suspicion, of this answer; "": none does.
std::string plan_that_settles(const Diagnosis& diagnosis);

/// True for a name of the models that come with the program, and for "".
bool is_shipped_model(const std::string& model);

/// How `forcegate export` takes this model: asked of export itself, nothing is written. nullopt: it refuses.
struct ExportOffer {
  /// With one law for all records the effects are of no use for those left out, so that there is no --fit: a header of the model as it stands may make the
  /// force worse, and --check tells.
  bool check = false;
  bool refit = false;  ///< --fit CAMPAIGN: the campaign has records enough for one law for all of them
  bool plan = true;    ///< false: --plan none, because there is no plan whose calibration could be taken back
  double rate_Hz = 0.0;  ///< --rate: no plan says what the firmware runs at, and the records have another rate than the header would; 0: as it is
};
std::optional<ExportOffer> export_offer(const std::string& model, const CampaignRequest* campaign);

/// "better.toml", or the first of better2.toml, better3.toml ... after the file that the model was read from: a step is not written over
/// the one before it.
std::string better_model_name(const std::string& model);

}  // namespace forcegate
