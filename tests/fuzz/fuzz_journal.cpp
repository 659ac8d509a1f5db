// Any bytes as a journal; half of the inputs get a sound header before them, so that the frames are reached.

#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "hil/trace/journal.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path path = [] {
    std::atexit([] { std::filesystem::remove(path); });
    return std::filesystem::temp_directory_path() / ("forcegate_fuzz_" + std::to_string(::getpid()) + ".fgj");
  }();
  if (size == 0) return 0;
  const bool with_header = data[0] % 2 == 0;
  std::filesystem::remove(path);
  if (with_header) {
    const forcegate::JournalHeader header{
        "fuzz", {{"rig", 1000.0}}, {{"U", "V", "voltage", forcegate::SampleType::f32, 0}}, {}};
    if (!forcegate::JournalWriter::create(path, header)) std::abort();
  }
  std::ofstream(path, std::ios::binary | std::ios::app)
      .write(reinterpret_cast<const char*>(data + 1), static_cast<std::streamsize>(size - 1));
  const auto file = forcegate::read_journal_trace(path);
  if (!file) {
    if (with_header || file.error().text.empty()) std::abort();  // a sound header is always enough
    return 0;
  }
  for (const auto& channel : file->trace.channels)
    if (channel.value.size() != file->trace.time_bases.at(channel.time_base).t_s.size()) std::abort();
  return 0;
}
