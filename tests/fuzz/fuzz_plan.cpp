// Plans from anywhere: the reader must answer with a plan or an error that has a text, never crash.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "hil/gate/plan.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto plan = forcegate::parse_plan({reinterpret_cast<const char*>(data), size}, "plan.toml");
  if (!plan && plan.error().text.empty()) std::abort();
  if (plan && (plan->cases.empty() || plan->panel.empty())) std::abort();
  return 0;
}
