#pragma once
// The pictures of one case. Numbers beside them come from the checks, never from these decimated curves.

#include "hil/interface/run_result.h"
#include "hil/report/figures/figure.h"

namespace forcegate {

/// One signal minus another, on the first one's instants; the other is interpolated where its clock differs.
PlotTrace difference(const PlotTrace& actual, const PlotTrace& expected);

/// The trace of that name, nullptr when there is none or it is empty.
const PlotTrace* find_trace(const std::vector<PlotTrace>& traces, std::string_view name);

/// Chosen cycles: set-point, ATI and firmware over time, error strip with the same time axis. No panels when
/// the case has no window.
figures::Figure window_figure(const CaseResult& result);

/// Whole record: lines for slow profiles, envelopes of the cycles for fast ones, error below.
figures::Figure overview_figure(const CaseResult& result);

/// Maxima and minima over time, the raw sensor's maxima with the fitted eq. (3), and the relative error of
/// each extremum.
figures::Figure decay_figure(const CaseResult& result);

/// The series "levels" of a loading, nullptr when there is none.
const ExtremaSeries* levels_of(const CaseResult& result);

/// Error of firmware and conductance model over the weights, level by level. No panels without the series "levels".
figures::Figure levels_figure(const CaseResult& result);

/// Error over force in the window as a density, coloured by loading direction.
figures::Figure loop_figure(const CaseResult& result);

/// value / limit of every check that has a limit, one row a check id, one mark a case.
figures::Figure ratio_figure(const RunResult& result);

}  // namespace forcegate
