// Any bytes as campaign.json beside one sound record.

#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "hil/trace/campaign.h"

namespace {

const std::filesystem::path& folder() {
  static const std::filesystem::path path = [] {
    auto p =
        std::filesystem::temp_directory_path() / ("forcegate_fuzz_campaign_" + std::to_string(::getpid()));
    std::filesystem::create_directories(p);
    std::ofstream(p / "r.csv") << "t_s,F_ref_N,U_V\n0,1,2\n0.1,2,3\n";
    std::atexit([] { std::filesystem::remove_all(folder()); });
    return p;
  }();
  return path;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::ofstream(folder() / "campaign.json", std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  const auto campaign = forcegate::read_campaign(folder());
  if (!campaign) {
    if (campaign.error().text.empty()) std::abort();
  } else if (campaign->records.empty()) {
    std::abort();
  }
  return 0;
}
