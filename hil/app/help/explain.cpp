#include "hil/app/help/explain.h"

#include <algorithm>
#include <iterator>

#include "hil/base/text.h"
#include "hil/model/effect.h"

namespace forcegate {

const std::vector<Explanation>& explanations() {
  static const std::vector<Explanation> kWords = {
      {"ACCEPT", "decision", "Every required check ran on a sound rig and passed.", "Ship the build."},
      {"REJECT", "decision", "A required check failed beyond its uncertainty while the rig was sound.",
       "Read the first failing check in the report; it names the quantity, the value, the limit and its source."},
      {"NO-DECISION", "decision",
       "Something required could not be judged: it did not run, it was inconclusive, or the rig was at fault. It is "
       "never an accept.",
       "The reason names who must act; repeat the run when they have. A limit that is undecided for its uncertainty alone wants more data: "
       "[rule] looks, longer records or more specimens in the plan (docs/plan.md)."},
      {"pass", "verdict", "The value is inside its limit by at least its expanded uncertainty U; its k is that of the plan's rule (2, with three looks 2.43).",
       "Nothing."},
      {"marginal", "verdict",
       "The value is inside its limit, but by less than its expanded uncertainty U.",
       "Under the rule 'guarded', which is the default, no ACCEPT: NO-DECISION, exit 3. Under 'simple' it counts as passed. "
       "Take more cycles, or more looks, to shrink the uncertainty."},
      {"fail", "verdict",
       "The value is outside its limit by more than its uncertainty (Holm at 1 % over the required checks).",
       "Look at the picture of the case; the reproduce line in the report repeats exactly this run."},
      {"inconclusive", "verdict",
       "The value is outside its limit, but not by more than its uncertainty, and the plan's cap of extra cycles is "
       "used up.",
       "Take longer records, more specimens, or a reference with a smaller uncertainty."},
      {"rig_error", "verdict", "The rig failed its own self-check, so the build cannot be blamed or praised.",
       "Mend what the self-check names (zero, noise, spring witness, motor, link, clock), then repeat."},
      {"not_run", "verdict", "The check was not made: its data, its golden trace or its method is missing.",
       "The evidence sentence says what is missing. A required check that did not run prevents an ACCEPT."},
      {"waived", "verdict",
       "A person has taken responsibility for this check, with a name and a date of expiry.",
       "Remove the waiver from the plan when its reason is gone."},
      {"known", "diagnosis",
       "An effect of the library explains what the model leaves, and records that were left out say so too.",
       "Add it and see whether the error falls.\n  forcegate add EFFECT --fit CAMPAIGN -o better.toml\n  forcegate history better.toml --on CAMPAIGN"},
      {"unknown", "diagnosis",
       "Structure remains that no effect of the library explains; the answer names the quantities that it depends on.",
       "Look at the map of that quantity (--html). An equation of your own can be a candidate: make a model file, "
       "write an [[effect]] into it (docs/diagnosis.md), and add it.\n"
       "  forcegate fit CAMPAIGN -o model.toml\n  forcegate add NAME --model model.toml --fit CAMPAIGN -o better.toml"},
      {"not separable", "diagnosis",
       "Several effects leave the same signature on these records; none of them is claimed.",
       "forcegate next CAMPAIGN says which record parts them."},
      {"none", "diagnosis",
       "What is left is what noise and steps of the instruments may leave, but for what the verdict names beside it: an effect that is suspected and not claimed, "
       "a record far above its noise. It says nothing about effects that the records do not excite.",
       "The notes say from which size on an effect between records would show. What the records did not play they cannot show: "
       "forcegate plan campaign lists what a whole campaign plays."},
      {"drift", "diagnosis",
       "The output changes with time while no recorded input moves. Without an input nobody can tell sensor, chamber and instrument apart.",
       "Record the force beside the output (columns t_s, F_ref_N, U_V), with a rest and a load in the same recording, and diagnose again."},
      {"sensor", "side", "What was found is in the specimen: a model can take it, a compensator may undo it.",
       "Take it into the model where that has a place for it; else exchange the sensor or let it rest.\n  forcegate add EFFECT --fit CAMPAIGN -o better.toml"},
      {"rig", "side", "What was found is in the motor, wheel, trolley or spring: the sensor saw a force that differs from the command.",
       "Mend the bench and record again: the model of the sensor must not learn it. forcegate bench selfcheck says whether it is fit."},
      {"reference", "side", "What was found is in the reference force: it drifts, is late or scatters, and the sensor may be sound.",
       "Unload and zero the reference, check its calibration date and filter, and record again."},
      {"instrument", "side", "What was found is in converter, amplifier, clock or mains: raw samples show it whatever the sensor does.",
       "Mend what the evidence names (range, earth, clock, cable) and record again; samples that it spoilt were set aside."},
      {"no gain", "header", "On recorded voltages the error of the force is larger with the header of forcegate export than with the law alone, or as large.",
       "Leave the header out where most records are worse: firmware with the law alone is the better one on this sensor. What a record tells of "
       "the effect may differ from record to record (forcegate compare CAMPAIGN shows it), or a firmware may not know what the effect "
       "needs (it tracks the lowest force itself, and it begins where it is switched on). "
       "Where the warning names a few records, their gain, zero or decay is their own, "
       "and undoing an effect enlarges what they are off; the others tell what the header is worth. "
       "Records that repeat one another, before and after, tell whether the effect is the sensor's own: forcegate plan campaign lists them."},
      {"not undone", "header", "The header of forcegate export gives another force than the model's own inverse does.",
       "Do not build it in. Where the output of the model falls or stands still while the force rises there is no inverse: export a model without that effect, "
       "or with another form of it (forcegate explain EFFECT lists the forms)."},
      {"none", "who must act", "Nobody: the decision is ACCEPT.", "Nothing."},
      {"firmware", "who must act", "The author of the build.",
       "Mend the build; the report shows where it departs."},
      {"sensor", "who must act", "The specimen under the indenter.",
       "Exchange the sensor, or let it rest for two hours."},
      {"rig", "who must act", "The keeper of the bench: motor, wheel, trolley or spring.",
       "Run the self-check alone, then repeat."},
      {"reference", "who must act", "The keeper of the ATI reference.",
       "Unload it, zero it, check overload and calibration date."},
      {"link", "who must act", "The connection between harness and board.",
       "Check cable, baud rate and frame losses."},
      {"calibration", "who must act", "Whoever provides the calibration of the specimen.",
       "Judge at level identified, or repeat the static sweeps."},
      {"user", "who must act", "Whoever wrote the command line, plan or bench file.",
       "Follow the help line."},
      {"recording", "who must act", "Whoever made the recording.",
       "Record the profile again, whole; played again, the same file says the same."},
      {"harness", "who must act", "The authors of Forcegate.",
       "Report it with the command line and the folder of the run."},
      {"0", "exit code", "ACCEPT, or the verb did what it was asked.", "Nothing."},
      {"1", "exit code", "REJECT: the firmware failed a required check on a sound rig, crashed or hung.",
       "See: forcegate explain REJECT."},
      {"2", "exit code", "The command line, a plan, a bench file or a data file is wrong.",
       "Follow the help line."},
      {"3", "exit code",
       "NO-DECISION: something required could not be judged, it did not run, its uncertainty reaches over the limit, or too little was played. It is never an accept. "
       "Other verbs: a limit that the rig cannot resolve, a comparison with open points.",
       "The first line names the reason and who must act; a retry of the same says the same. More of it: forcegate explain NO-DECISION."},
      {"4", "exit code", "The rig misbehaved.", "Retry; the only code after which that makes sense."},
      {"5", "exit code", "A safety limit parked the rig and the cause is undecided.",
       "A person must look at the bench before anything moves again."},
      {"6", "exit code", "A defect of Forcegate itself.", "Report it with the command line."},
      {"130", "exit code", "Interrupted by Ctrl-C, SIGTERM or SIGHUP; the rig is parked.",
       "forcegate recover makes a trace from the journal of the interrupted record."},
  };
  static const std::vector<Explanation> kAll = [] {
    std::vector<Explanation> all = kWords;
    all.insert(all.end(), figure_explanations().begin(), figure_explanations().end());
    return all;
  }();
  return kAll;
}

namespace {

std::string parameters_of(const std::vector<ParameterSpec>& specs) {
  std::vector<std::string> out;
  for (const ParameterSpec& p : specs) out.push_back(p.unit == "1" || p.unit.empty() ? p.name : p.name + " in " + p.unit);
  return join(out, ", ");
}

std::string form_in_words(const EffectForm& form) {
  return form.name + ": " + parameters_of(form.strength) + (form.shape.empty() ? "" : " | " + parameters_of(form.shape)) +
         (form.beside.empty() ? "" : " (where the model has " + form.beside + ")");
}

// What a person writes into a model file, or meets there after `add`.
std::string forms_of(const EffectKind& effect) {
  std::string out = "Forms, with their strengths and, behind |, shapes:";
  for (const EffectForm& form : effect.forms) out += "\n  " + form_in_words(form);
  return out;
}

}  // namespace

Explanation explanation_of(const EffectKind& effect) {
  std::string meaning = effect.summary + ".";
  if (!effect.equation.empty()) meaning += "\n" + effect.equation + (effect.source.empty() ? "" : "  (" + effect.source + ")");
  if (effect.channel != EffectChannel::raw) meaning += "\n" + forms_of(effect);
  std::string todo;
  if (!effect.look_alikes.empty()) todo = "It can look like " + join(effect.look_alikes, ", ") + "; what parts them: ";
  todo += effect.separates + ".";
  if (effect.channel == EffectChannel::output) todo += " It is taken into a model by\n  forcegate add " + effect.name + " --fit CAMPAIGN -o better.toml";
  return {effect.name, "effect", meaning, todo};
}

std::vector<Explanation> find_explanations(std::string_view term) {
  std::vector<Explanation> out;
  // Tables write "rig error" and "not run".
  const auto plain = [](std::string_view text) {
    std::string lower = ascii_lower(text);
    std::ranges::replace(lower, '_', ' ');
    return lower;
  };
  std::ranges::copy_if(explanations(), std::back_inserter(out), [&](const Explanation& e) { return plain(e.term) == plain(term); });
  const std::string check(term.substr(0, term.find('/')));  // of a case: promise_maxima/CASE
  std::ranges::copy_if(check_explanations(), std::back_inserter(out), [&](const Explanation& e) { return e.term == ascii_lower(check); });
  for (const EffectKind& effect : EffectRegistry::instance().all())
    if (effect.name == ascii_lower(term)) out.push_back(explanation_of(effect));
  for (const EffectKind& effect : EffectRegistry::instance().all())
    for (const EffectForm& form : effect.forms)
      if (plain(form.name) == plain(term) && form.name != effect.name)
        out.push_back({form.name, "form", "A form of the effect " + effect.name + ", with its strengths and, behind |, shapes:\n  " + form_in_words(form),
                       "Forms of one effect are one cause: the ranking names the one that predicts held-out records best. forcegate explain " + effect.name + " tells all of them."});
  return out;
}

}  // namespace forcegate
