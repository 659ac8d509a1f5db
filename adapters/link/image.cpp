#include "adapters/link/image.h"

#include <elf.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "hil/base/read_file.h"
#include "hil/base/text.h"

namespace forcegate::link {
namespace {

#if defined(__x86_64__)
constexpr unsigned kHostMachine = EM_X86_64;
#elif defined(__aarch64__)
constexpr unsigned kHostMachine = EM_AARCH64;
#else
constexpr unsigned kHostMachine = EM_NONE;
#endif

Unexpected refuse(const std::filesystem::path& path, const std::string& what) {
  return fail(ErrorCode::usage, what, printable_utf8(path.string()),
              "give a firmware image: a shared object of the native port or a Cortex-M ELF of the block or "
              "uart port");
}

std::string token(const std::string& bytes, std::size_t& at) {
  std::string word;
  while (at < bytes.size() && word.size() < 40) {
    const char c = bytes[at];
    if (!((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-')) break;
    word.push_back(c);
    ++at;
  }
  return word;
}

// After the marker `key`, wherever it stands in the file.
std::string marker(const std::string& bytes, std::string_view key) {
  std::size_t at = bytes.find(key);
  if (at == std::string::npos) return {};
  at += key.size();
  return token(bytes, at);
}

// Flash and RAM of the sections that are loaded (ELF32, little-endian). A broken table counts as nothing.
void add_sizes(const std::string& bytes, Image& image) {
  Elf32_Ehdr head;
  std::memcpy(&head, bytes.data(), sizeof head);
  for (unsigned i = 0; i < head.e_shnum; ++i) {
    const std::size_t at = static_cast<std::size_t>(head.e_shoff) + i * sizeof(Elf32_Shdr);
    if (at + sizeof(Elf32_Shdr) > bytes.size()) return;
    Elf32_Shdr section;
    std::memcpy(&section, bytes.data() + at, sizeof section);
    if ((section.sh_flags & SHF_ALLOC) == 0) continue;
    if (section.sh_type != SHT_NOBITS) image.flash_bytes += section.sh_size;
    if (section.sh_type == SHT_NOBITS || (section.sh_flags & SHF_WRITE) != 0)
      image.ram_bytes += section.sh_size;
  }
}

// Bytes that head, section table and loaded segments of an ELF file need.
template <class Head, class Segment>
std::uint64_t bytes_needed(const std::string& bytes) {
  Head head;
  if (bytes.size() < sizeof head) return sizeof head;
  std::memcpy(&head, bytes.data(), sizeof head);
  std::uint64_t end = std::uint64_t{head.e_shoff} + std::uint64_t{head.e_shnum} * head.e_shentsize;
  for (std::uint64_t i = 0; i < head.e_phnum; ++i) {
    const std::uint64_t at = std::uint64_t{head.e_phoff} + i * sizeof(Segment);
    if (at > bytes.size() || bytes.size() - at < sizeof(Segment)) return std::max(end, at + sizeof(Segment));
    Segment segment;
    std::memcpy(&segment, bytes.data() + at, sizeof segment);
    if (segment.p_type == PT_LOAD) end = std::max(end, std::uint64_t{segment.p_offset} + segment.p_filesz);
  }
  return end;
}

std::string damage_of(const std::string& bytes, std::uint64_t needed) {
  if (needed <= bytes.size()) return {};
  return "the firmware file is cut short or damaged: it has " + std::to_string(bytes.size()) + " bytes, its tables speak of " + std::to_string(needed);
}

// A position-independent program is a shared object too, but one that no loader takes into another program.
bool is_program(const std::string& bytes) {
  const auto read = [&](std::uint64_t at, auto& into) {
    if (at > bytes.size() || bytes.size() - at < sizeof into) return false;
    std::memcpy(&into, bytes.data() + at, sizeof into);
    return true;
  };
  Elf64_Ehdr head;
  if (!read(0, head)) return false;
  for (std::uint64_t i = 0; i < head.e_phnum; ++i) {
    Elf64_Phdr segment;
    if (!read(head.e_phoff + i * sizeof segment, segment)) return false;
    if (segment.p_type != PT_DYNAMIC) continue;
    Elf64_Dyn entry;
    for (std::uint64_t k = 0; k < segment.p_filesz / sizeof entry && read(segment.p_offset + k * sizeof entry, entry); ++k) {
      if (entry.d_tag == DT_FLAGS_1) return (entry.d_un.d_val & DF_1_PIE) != 0;
    }
  }
  return false;
}

}  // namespace

Result<void> check_build_id(const Image& image, const std::string& announced, const std::string& where) {
  if (announced.size() != 40 || announced.find_first_not_of("0123456789abcdef") != std::string::npos)
    return fail(ErrorCode::firmware, "the image announces '" + printable_utf8(announced) + "' as its build id, not 40 hex digits", where, "docs/protocol.md");
  if (image.build_id.empty() || image.build_id == announced) return {};
  return fail(ErrorCode::firmware,
              "another build answers: the image announces " + announced.substr(0, 12) + ", the file is " +
                  image.build_id.substr(0, 12),
              where, "flash the file that is to be judged");
}

Result<void> check_whole(const Image& image, const std::string& where) {
  if (image.damage.empty()) return {};
  return fail(ErrorCode::usage, image.damage, where, "build or copy it again");
}

Result<Image> inspect_image(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return refuse(path, "there is no such firmware file");
  if (!std::filesystem::is_regular_file(path, ignored))
    return refuse(path, "the firmware image is not a file");
  const auto read = read_file(path);
  if (!read) return refuse(path, "the firmware file cannot be read");
  const std::string& bytes = *read;
  if (bytes.size() < 52 || bytes.compare(0, 4, "\177ELF") != 0)
    return refuse(path, "the firmware file is not an ELF file");
  const auto half = [&](std::size_t i) {
    return static_cast<unsigned>(static_cast<unsigned char>(bytes[i])) |
           static_cast<unsigned>(static_cast<unsigned char>(bytes[i + 1])) << 8;
  };
  const unsigned type = half(16), machine = half(18);
  Image image;
  image.build_id = marker(bytes, "forcegate-build:");
  if (bytes[EI_CLASS] == ELFCLASS64 && machine == kHostMachine && type == ET_DYN) {
    image.damage = damage_of(bytes, bytes_needed<Elf64_Ehdr, Elf64_Phdr>(bytes));
    if (is_program(bytes))
      return fail(ErrorCode::usage, "this is a program and no firmware image", printable_utf8(path.string()),
                  "the native lane wants a shared object built with rigs/firmware/ports/native.h");
    image.kind = ImageKind::host_shared_object;
    image.port = "native";
    image.board = "native";
    return image;
  }
  if (bytes[EI_CLASS] != ELFCLASS32 || machine != EM_ARM || type != ET_EXEC)
    return refuse(path, "the ELF file is neither a shared object of this machine nor an ARM executable");
  image.damage = damage_of(bytes, bytes_needed<Elf32_Ehdr, Elf32_Phdr>(bytes));
  static constexpr char kMarker[] = "forcegate-port:";
  std::size_t at = bytes.find(kMarker);
  if (at != std::string::npos) {
    at += sizeof kMarker - 1;
    image.port = token(bytes, at);
    if (at < bytes.size() && bytes[at] == ':') image.board = token(bytes, ++at);
  }
  image.ticks = marker(bytes, "forcegate-tick:") == "1";
  add_sizes(bytes, image);
  return image;
}

}  // namespace forcegate::link
