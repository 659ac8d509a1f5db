#pragma once
// Pieces of HTML that the pages of the diagnosis share.

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

#include "hil/diagnose/diagnosis.h"
#include "hil/report/figures/figure.h"
#include "hil/report/record_pictures.h"

namespace forcegate::parts {

/// Escaped by the caller where it is shown: "12.3 mV".
std::string in_unit(double value, const std::string& unit);

/// Two values that are compared, in one unit: that of the smaller unless the larger would have more than four digits before its point.
std::pair<std::string, std::string> in_one_unit(double a, double b, const std::string& unit);

/// Errors of one sentence and the floor below it in one unit: that of the two errors where the floor reads well in it, else that of the
/// text's error line; where neither does, the floor has a unit of its own.
struct ErrorTexts {
  std::string before, after, floor;
};
ErrorTexts in_one_unit(double before, double after, double floor, const std::string& unit);

/// The error of one law for all records before and after, where the records differ from it far beyond their noise, or it rises; escaped by the
/// caller: "; with one gain, offset and decay for all records 236 mV falls to 65 mV", "" otherwise.
std::string one_law_sentence(const Diagnosis& diagnosis);

/// The figure with its summary as caption, after `more`; "" for a figure without a panel.
std::string picture(const figures::Figure& figure, std::string_view more = {});

/// Heads of columns of numbers begin with '#'.
std::string table_start(const std::string& caption, std::initializer_list<std::string_view> heads);
inline constexpr std::string_view kTableEnd = "</tbody></table></div>\n";
std::string cell(const std::string& html, bool number = false);

/// Level of the records, courses of an output without an input.
std::string between_records(const RecordPictures& pictures);

/// At most four pictures of what a claim does.
std::string evidence(const Finding& finding, JudgedBy judged_by);

}  // namespace forcegate::parts
