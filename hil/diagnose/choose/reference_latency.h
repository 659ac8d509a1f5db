#pragma once
// A reference that reads the force a few milliseconds late does what such instruments do: the output then leads F_ref. It is
// carried along as a nuisance and never claimed.

#include <string>
#include <vector>

#include "hil/diagnose/choose/screen.h"

namespace forcegate::diagnose {

/// The effect whose leads are forgiven.
inline constexpr const char* kLatencyEffect = "delay";
/// By which the reference may be late, s: 12 ms, or what a declared low-pass of it is late by beyond the one pole that the output is behind too: a fourth
/// order (Butterworth) has 2.6 / (2 pi f) and leaves 1.6 of them.
double reference_latency_s(const CampaignInput& input);
/// Between two samples of the fastest record; 0 where nothing was sampled.
double shortest_sample_s(const CampaignInput& input);
/// By which two instruments may be out of step, s: 12 ms, or half a sample of the fastest record where samples are further apart. A shift by less
/// mixes neighbouring samples of the reference, and averages its noise as much whichever way it goes.
double allowed_latency_s(const CampaignInput& input);
/// Milliseconds between two instruments are no matter in a recording of another machine whose rows are further apart than this, s.
inline constexpr double kStepsTellNoLag_s = 0.05;
/// What is said where a lead is carried along.
std::string latency_note(const CampaignInput& input);

/// Shift in time that an effect of time comes to, s, never negative; 0 for a skew, which has none.
double shift_s(const ResidualChannel& channel, const FamilyScore& family);

/// By which the output is late altogether, s, by all delays, lags and RCs (at mid load) of a fit together; negative: it leads.
double net_shift_s(const ResidualChannel& channel, const MixedFit& fit);

/// Lead of the output that explains half as much as `family` does or more, s; 0 where none does. A reference behind a pole makes the output answer to
/// the rate, whatever effect is chosen for it.
double rival_lead_s(const ResidualChannel& channel, const ScreenResult& result, const FamilyScore& family);

/// The best variant is a lead that a reference may have of its own, which is late by `latest_s` at most.
bool is_reference_latency(const ResidualChannel& channel, const FamilyScore& family, double latest_s);

/// Such a lead explains nearly all that the best family does, or takes most of an error (a fast record's) of which that one takes little.
bool is_nearly_latency(const ResidualChannel& channel, const ScreenResult& result, double latest_s);

/// Of the leads that may be forgiven, s.
inline constexpr double kLongestLead_s = 0.03;

/// A lead of the output of less than `longest_s`.
bool is_allowed_lead(const Candidate& candidate, double longest_s = kLongestLead_s);

/// Adds the columns of all leads up to `longest_s`: together they span a shift and a first-order lag of the reference alike.
void add_leads(const ResidualChannel& channel, std::vector<int>& columns, double longest_s = kLongestLead_s);

/// Strengths of the leads among `columns` in `fit`, one for every column of S.
Eigen::VectorXd strengths_of_leads(const ResidualChannel& channel, const std::vector<int>& columns, const MixedFit& fit);

/// Takes S c off the output: rows and Gram matrices. With -c it is put back.
void take_off_output(ResidualChannel& channel, const Eigen::VectorXd& c);

/// Whether a lead depends on the load: beside all plain leads that a late reference may have, the family still gains far more than chance.
bool depends_on_load(const ResidualChannel& channel, const std::vector<int>& present, const MixedFit& base, const FamilyScore& family);

/// The base, or the base beside a lead where the records show one that the reference explains, with a note: what a diagnosis carries
/// along is no failure of the model either.
MixedFit forgive_late_reference(const Workspace& workspace, MixedFit base, std::vector<std::string>& notes);

}  // namespace forcegate::diagnose
