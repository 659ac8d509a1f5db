#pragma once
// S7: what a choice leaves of the output: what is noise, what is structure without a name, what it depends on.

#include "hil/diagnose/answer/residual_map.h"
#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

struct Structure {
  double rms = 0.0;         ///< RMS of what is smoother than noise, share of the span
  double share = 0.0;       ///< of the residual's mean square
  std::size_t records = 0;  ///< records that show it
  std::size_t of_records = 0;
};

/// Structure left in a residual (rows of every record): mean squares above the known noise that hang together over rows.
Structure structure_of(const ResidualChannel& channel, const std::vector<std::vector<double>>& residual);

struct RecordAbove {
  std::size_t record = 0;  ///< of the workspace's input
  double times = 0.0;      ///< RMS of what is left over that of what the instruments may leave
  double rms = 0.0;        ///< of what is left, share of the span
};

/// What a choice leaves of the output, beside what its instruments may.
struct Remainder {
  std::vector<std::vector<double>> of_claimed;  ///< residual of the chosen variants alone, per record, in the output's unit
  std::vector<ResidualMap> maps;                ///< of the residual of all forms of the chosen families
  std::vector<char> of_hum;                     ///< 1: what is left in this record is hum (hil/diagnose/raw/folded_hum.h)
  double noise_rms = 0.0;                       ///< what the instruments may leave, share of the span
  double structure_rms = 0.0;                   ///< smoother than noise, share of the span
  double explained = 1.0;     ///< share of what the noise does not explain that all forms of the chosen families take
  bool smooth = false;        ///< visible beside the noise, large enough to matter and not one record's whim
  bool coloured = false;      ///< but noise that hangs together over time
  std::vector<RecordAbove> records_far_above;  ///< of which all forms leave more than 2.5 times what the instruments may, the farthest first
  bool far_above = false;     ///< so are all records together, or the typical one; or two with 5 times
  /// One record, no part of a single recording, stands so far above that all do, by a hundredth of the span; or six times above, by 0.3 % of the span
  bool one_far_off = false;
  bool beside_claims = false;  ///< structure remains beside what would be claimed

  bool structured() const { return smooth && !coloured; }
  /// More than one record's whim, or one that is far off.
  bool leaves_far_more() const { return records_far_above.size() > 1 || one_far_off; }
};

Remainder remainder_of(const Workspace& workspace, const Selection& selection, unsigned threads);

/// Whether the law of `fit`, each record with its own gain, zero and decay, explains a tenth of the output's variance about one zero, or the
/// output does not move. Otherwise nothing can be said to be missing, nor that nothing is: noise about a zero is what its mean leaves.
bool follows_force(const ResidualChannel& output, const MixedFit& fit);

/// Groups of coordinates that the residual depends on, at most three; "time" when nothing else explains it.
std::vector<std::string> depends_on(const std::vector<ResidualMap>& maps);

}  // namespace forcegate::diagnose
