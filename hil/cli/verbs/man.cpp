#include <nlohmann/json.hpp>

#include "hil/cli/command.h"
#include "hil/cli/help.h"

namespace forcegate {
namespace {

Result<int> run(const Invocation& in) {
  const std::string page = man_page(Registry<Command>::instance().all(), FORCEGATE_VERSION);
  in.console().print(page);
  in.console().print_json(nlohmann::ordered_json{{"format", 1}, {"page", page}}.dump(2));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "man",
    .group = "House",
    .summary = "manual page of the whole program in roff",
    .description = "Prints the manual page forcegate(1), made from the same table as --help.",
    .examples = {{"forcegate man | man -l -", "Read it now:"},
                 {"forcegate man > ~/.local/share/man/man1/forcegate.1", "Install it for yourself:"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
