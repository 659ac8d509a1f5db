// Lane "native": the firmware as a shared object in this process (C interface: rigs/firmware/ports/native.h).
// The object keeps its state in static memory and may crash or hang: run one case per worker process.

#include <dlfcn.h>
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <limits>
#include <optional>

#include "adapters/link/fenced_block.h"
#include "adapters/link/image.h"
#include "hil/base/text.h"
#include "hil/interface/dut.h"
#include "hil/interface/firmware_guard.h"
#include "hil/interface/unanswered.h"

namespace forcegate {
namespace {

constexpr std::uint32_t kAbi = 1;
constexpr std::uint32_t kHeapSettled = 20000;  // buffers made at first use are no growth
constexpr std::size_t kLongestWhat = 200;
constexpr std::int32_t kBadCalibration = 1, kBadIndex = 2;

struct NativeCalibration {
  float gain_N_per_V, offset_N, v_range_V, b_scale, q_scale;
  std::uint32_t adc_bits;
  char id[16];
};
static_assert(sizeof(NativeCalibration) == 40);

struct NativeInfo {
  std::uint32_t nonce;
  std::uint16_t protocol_major, protocol_minor;
  std::uint32_t rate_Hz;
  NativeCalibration calibration;
  char board[24], build_id[40], algorithm_id[32];
};
static_assert(sizeof(NativeInfo) == 148);

template <std::size_t n>
std::string text_of(const char (&field)[n]) {
  return printable_utf8(std::string(field, strnlen(field, n)));
}

NativeCalibration to_native(const Calibration& c) {
  NativeCalibration out{static_cast<float>(c.gain_N_per_V),
                        static_cast<float>(c.offset_N),
                        static_cast<float>(c.v_range_V),
                        static_cast<float>(c.b_scale),
                        static_cast<float>(c.q_scale),
                        static_cast<std::uint32_t>(c.adc_bits),
                        {}};
  std::memcpy(out.id, c.id.data(), std::min(c.id.size(), sizeof out.id));
  return out;
}

// Calls the image with the marker set. What leaves it by an exception is caught before the marker is taken away, or the end of the process would be charged
// to the harness. Returns what the exception says; nullopt: it came back.
template <class Call>
std::optional<std::string> thrown_in(const InFirmware&, const Call& call) {
  try {
    call();
    return std::nullopt;
  } catch (const std::exception& e) {
    return printable_utf8(std::string(e.what(), strnlen(e.what(), kLongestWhat)));
  } catch (...) {
    return "not a std::exception";
  }
}

class NativeDut final : public Dut {
 public:
  ~NativeDut() override { unload(); }

  Result<DutInfo> open(const DutSession& session) override {
    unload();
    counters_ = {};
    heap_growth_ = std::numeric_limits<double>::quiet_NaN();
    where_ = printable_utf8(session.image.string());
    FORCEGATE_TRY(const link::Image image, link::inspect_image(session.image));
    if (image.kind != link::ImageKind::host_shared_object)
      return fail(ErrorCode::usage, "the native lane wants a shared object", where_,
                  "use --lane block or --lane uart");
    FORCEGATE_CHECK_OK(link::check_whole(image, where_));
    const std::string path = std::filesystem::absolute(session.image).string();
    {
      const InFirmware marker(FirmwareStage::opening);  // constructors of the object may run
      handle_ = open_object(path);
    }
    if (handle_ == nullptr) return fail(ErrorCode::firmware, "the image cannot be loaded: " + printable_utf8(dlerror()), where_);
    if (!load("forcegate_native_abi", abi_) || !load("forcegate_native_open", open_) ||
        !load("forcegate_native_process", process_) || !load("forcegate_native_close", close_))
      return fail(ErrorCode::usage, "the shared object does not export the functions of the native port",
                  where_, "build it with rigs/firmware/ports/native.h");
    image_ = image;
    return greet(session);
  }

  Result<DutInfo> restart(const DutSession& session) override {
    if (handle_ == nullptr) return open(session);
    counters_.samples = 0;
    return greet(session);
  }

  Result<void> process(std::uint32_t first_index, std::span<const std::uint16_t> adc,
                       std::span<float> force_N, std::span<std::uint8_t> flags) override {
    if (process_ == nullptr) return fail(ErrorCode::internal, "the native lane is not open", where_);
    std::int32_t status = 0;
    const std::span<std::uint16_t> own_adc = adc_.make(adc.size());
    const std::span<float> own_N = force_.make(adc.size());
    const std::span<std::uint8_t> own_flags = flags_.make(adc.size());
    if (own_adc.data() == nullptr || own_N.data() == nullptr || own_flags.data() == nullptr)
      return fail(ErrorCode::io, "there is no memory for a block of " + std::to_string(adc.size()) + " samples", where_);
    std::copy(adc.begin(), adc.end(), own_adc.begin());
    mark_unanswered(own_N, own_flags);
    // Asking costs a microsecond: too much for the ten samples of a control period.
    const bool watch_heap = first_index >= kHeapSettled && adc.size() >= 256;
    const std::int64_t before = watch_heap ? heap_bytes() : 0;
    const auto thrown = thrown_in(InFirmware(first_index, static_cast<std::uint32_t>(adc.size())), [&] {
      status = process_(first_index, static_cast<std::uint32_t>(adc.size()), own_adc.data(), own_N.data(), own_flags.data());
    });
    if (thrown) return threw("in the block of " + std::to_string(adc.size()) + " samples from sample " + std::to_string(first_index) + " on", *thrown);
    std::copy(own_N.begin(), own_N.end(), force_N.begin());
    std::copy(own_flags.begin(), own_flags.end(), flags.begin());
    if (!std::equal(adc.begin(), adc.end(), own_adc.begin())) {
      const auto changed = std::mismatch(adc.begin(), adc.end(), own_adc.begin());
      return fail(ErrorCode::firmware,
                  "the image writes into the codes that it is given, first at sample " + std::to_string(first_index + static_cast<std::size_t>(changed.first - adc.begin())), where_,
                  "they are const in rigs/firmware/ports/native.h; filter or scale a copy of them");
    }
    if (!adc_.marks_hold() || !force_.marks_hold() || !flags_.marks_hold())
      return fail(ErrorCode::firmware,
                  "the image writes beyond its block of " + std::to_string(adc.size()) + " samples from sample " + std::to_string(first_index) + " on", where_,
                  "what lies there on a board is other data");
    if (watch_heap)
      heap_growth_ =
          (std::isnan(heap_growth_) ? 0.0 : heap_growth_) + static_cast<double>(heap_bytes() - before);
    if (status != 0)
      return fail(ErrorCode::firmware,
                  status == kBadIndex
                      ? "the image expected another sample index than " + std::to_string(first_index)
                      : "the image answers status " + std::to_string(status),
                  where_);
    if (const Unanswered left = count_unanswered(force_N, flags); left.samples > 0)
      return fail(ErrorCode::firmware,
                  "the image leaves " + std::to_string(left.samples) + " of " + std::to_string(adc.size()) +
                      " samples without force or flags (eight at once are none), the first at sample " +
                      std::to_string(first_index + left.first) + ": stale output is never judged",
                  where_);
    counters_.samples += adc.size();
    return {};
  }

  Result<DutCounters> close() override {
    unload();
    return counters_;
  }

  DutResources resources() const override {
    DutResources r;
    r.heap_growth_bytes = heap_growth_;
    return r;
  }

 private:
  Result<DutInfo> greet(const DutSession& session) {
    const NativeCalibration calibration = to_native(session.calibration);
    NativeInfo info{};
    std::int32_t status = 0;
    std::uint32_t abi = 0;
    const auto thrown = thrown_in(InFirmware(FirmwareStage::opening), [&] {
      abi = abi_();
      if (abi == kAbi) status = open_(session.nonce, &calibration, &info);
    });
    if (thrown) return threw("when it is opened", *thrown);
    if (abi != kAbi)
      return fail(ErrorCode::firmware,
                  "the image speaks version " + std::to_string(abi) + " of the native interface, not 1",
                  where_);
    if (status == kBadCalibration)
      return fail(ErrorCode::firmware,
                  "the image refuses the calibration '" + printable_utf8(session.calibration.id) + "'",
                  where_);
    if (status != 0)
      return fail(ErrorCode::firmware, "the image refuses to open: status " + std::to_string(status), where_);
    FORCEGATE_CHECK_OK(check_echo({info.protocol_major, info.nonce,
                                   std::memcmp(&info.calibration, &calibration, sizeof calibration) == 0,
                                   static_cast<double>(info.rate_Hz)},
                                  session, "the image", where_));
    FORCEGATE_CHECK_OK(link::check_build_id(image_, text_of(info.build_id), where_));
    return DutInfo{info.protocol_major,
                   info.protocol_minor,
                   text_of(info.board),
                   text_of(info.build_id),
                   text_of(info.algorithm_id),
                   info.nonce,
                   static_cast<int>(calibration.adc_bits),
                   static_cast<double>(info.rate_Hz)};
  }

  Unexpected threw(const std::string& when, const std::string& what) const {
    return fail(ErrorCode::firmware, "the image throws a C++ exception " + when + ": " + what, where_,
                "catch it inside: the functions of rigs/firmware/ports/native.h are C, and their callers know no exceptions");
  }

  // Constructors and destructors of the image run below the dynamic loader, which no exception may cross: noexcept ends the process there and then.
  static void* open_object(const std::string& path) noexcept { return dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL); }
  void close_object() const noexcept {
    if (close_ != nullptr) close_();
    dlclose(handle_);
  }

  static std::int64_t heap_bytes() {
    const struct mallinfo2 info = mallinfo2();
    return static_cast<std::int64_t>(info.uordblks + info.hblkhd);
  }

  template <class Function>
  bool load(const char* name, Function& function) {
    function = reinterpret_cast<Function>(dlsym(handle_, name));
    return function != nullptr;
  }

  void unload() {
    if (handle_ == nullptr) return;
    const InFirmware marker(FirmwareStage::closing, static_cast<std::uint32_t>(counters_.samples));
    close_object();
    handle_ = nullptr;
    abi_ = nullptr;
    open_ = nullptr;
    process_ = nullptr;
    close_ = nullptr;
  }

  FencedBlock<std::uint16_t> adc_;  // a copy: what the image is judged by stays out of its reach
  FencedBlock<float> force_;
  FencedBlock<std::uint8_t> flags_;
  link::Image image_;
  void* handle_ = nullptr;
  std::uint32_t (*abi_)() = nullptr;
  std::int32_t (*open_)(std::uint32_t, const NativeCalibration*, NativeInfo*) = nullptr;
  std::int32_t (*process_)(std::uint32_t, std::uint32_t, const std::uint16_t*, float*,
                           std::uint8_t*) = nullptr;
  void (*close_)() = nullptr;
  DutCounters counters_;
  double heap_growth_ = std::numeric_limits<double>::quiet_NaN();
  std::string where_;
};

const Registration<LaneKind> kRegistered{{
    "native",
    "The firmware built for this machine, a shared object in a watched worker process. Open and closed loop.",
    [](const std::filesystem::path& path) {
      const auto image = link::inspect_image(path);
      return image && image->port == "native";
    },
    [](const std::map<std::string, std::string>& options) -> Result<std::unique_ptr<Dut>> {
      if (!options.empty())
        return fail(ErrorCode::usage, "the native lane has no option '" + printable_utf8(options.begin()->first) + "'", "--lane-option", "it takes none");
      return std::make_unique<NativeDut>();
    },
}};

}  // namespace
}  // namespace forcegate
