#include "hil/app/recording/recover.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "hil/base/plain_number.h"
#include "hil/base/text.h"
#include "hil/cli/command.h"
#include "hil/cli/parse.h"

namespace forcegate {
namespace {

Result<int> run(const Invocation& in) {
  const RecoverRequest request{in.text("JOURNAL"), in.text("out"), in.flag("force")};
  FORCEGATE_TRY(const Recovered done, recover(request));
  const JournalReport& r = done.report;
  Console& console = in.console();
  console.print(fmt::format("{}, {} up to {} s{}", counted(r.frames, "frame"), counted(r.samples, "sample"), shortest(r.last_s),
                            r.raw_frames > 0 ? ", " + counted(r.raw_frames, "raw frame") : ""));
  console.print(r.closed ? "the recording had ended properly"
                         : "the recording was cut off; all whole frames are saved");
  if (r.bytes_skipped > 0)
    console.print(
        fmt::format("{} in {} were left out", counted(r.bytes_skipped, "byte"), counted(r.damaged_places, "damaged place")));
  if (r.rows_dropped > 0)
    console.print(counted(r.rows_dropped, "sample") + " whose time ran backwards " + (r.rows_dropped == 1 ? "was" : "were") + " left out");
  console.print("written to " + done.output.string());
  console.print_json(nlohmann::ordered_json{
      {"format", 1},
      {"journal", printable_utf8(in.text("JOURNAL"))},
      {"output", printable_utf8(done.output.string())},
      {"frames", r.frames},
      {"samples", r.samples},
      {"raw_frames", r.raw_frames},
      {"bytes_skipped", r.bytes_skipped},
      {"damaged_places", r.damaged_places},
      {"rows_dropped", r.rows_dropped},
      {"last_s", r.last_s},
      {"closed",
       r.closed}}.dump(2));
  console.next("forcegate convert " + file_quoted(done.output.string()) + " out.csv");
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "recover",
    .group = "Traces",
    .summary = "the trace of a recording that was cut off",
    .description =
        "While it records, Forcegate appends to a journal; the HDF5 file is made when the recording ends. After a "
        "crash, a power cut or a full disk this verb makes it from the journal: every frame whose checksum is right is "
        "saved, damaged stretches are skipped and counted. The journal stays as it is.",
    .positionals = {{.name = "JOURNAL", .doc = "Journal of the recording (.fgj).", .names = Names::input}},
    .options =
        {{.name = "out",
          .value_name = "FILE",
          .doc = "HDF5 file to write; else the journal's name with .h5.",
          .letter = 'o',
          .names = Names::file},
         {.name = "force", .value_name = "", .doc = "Replace the output if it exists.", .letter = 'f'}},
    .examples = {{"forcegate recover case_03.fgj", "After the machine lost power during case_03:"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
