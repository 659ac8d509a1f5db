#include <fcntl.h>
#include <libdeflate.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <span>

#include "hil/base/output_path.h"
#include "hil/trace/hdf5_handle.h"
#include "hil/trace/hdf5_io.h"
#include "hil/trace/missing_count.h"

namespace forcegate {
namespace {

constexpr hsize_t kChunkSamples = 65536;

hid_t file_type(SampleType type) {
  switch (type) {
    case SampleType::f64: return H5T_IEEE_F64LE;
    case SampleType::f32: return H5T_IEEE_F32LE;
    case SampleType::i32: return H5T_STD_I32LE;
    case SampleType::u16: return H5T_STD_U16LE;
    case SampleType::u8: return H5T_STD_U8LE;
  }
  return H5T_IEEE_F64LE;
}

/// Of an object that keeps no time of its own: the same samples are the same bytes.
Hdf5Handle timeless(hid_t what) {
  Hdf5Handle properties(H5Pcreate(what), H5Pclose);
  H5Pset_obj_track_times(properties, 0);
  return properties;
}

bool put_text(hid_t object, const std::string& name, const std::string& text) {
  Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose), space(H5Screate(H5S_SCALAR), H5Sclose);
  H5Tset_size(type, std::max<std::size_t>(1, text.size()));
  H5Tset_cset(type, H5T_CSET_UTF8);
  if (text.size() <= 32768) {
    Hdf5Handle attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    return attribute.good() && H5Awrite(attribute, type, text.empty() ? "\0" : text.data()) >= 0;
  }
  Hdf5Handle data(H5Dcreate2(object, name.c_str(), type, space, H5P_DEFAULT, timeless(H5P_DATASET_CREATE), H5P_DEFAULT),
                  H5Dclose);
  return data.good() && H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) >= 0;
}

template <class T>
bool put_number(hid_t object, const char* name, T value, hid_t on_disk, hid_t in_memory) {
  Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  Hdf5Handle attribute(H5Acreate2(object, name, on_disk, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  return attribute.good() && H5Awrite(attribute, in_memory, &value) >= 0;
}
bool put_double(hid_t object, const char* name, double value) {
  return put_number(object, name, value, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE);
}
bool put_int(hid_t object, const char* name, std::int32_t value) {
  return put_number(object, name, value, H5T_STD_I32LE, H5T_NATIVE_INT32);
}

static_assert(std::endian::native == std::endian::little, "chunks go to disk as they lie in memory");

/// What HDF5's filters shuffle and deflate (level 1) make of a chunk, at several times their speed: the bytes of all
/// values by significance, then libdeflate. Any HDF5 reads them.
class ChunkPacker {
 public:
  ChunkPacker() : deflate_(libdeflate_alloc_compressor(1)) {}
  ~ChunkPacker() { libdeflate_free_compressor(deflate_); }
  ChunkPacker(const ChunkPacker&) = delete;
  ChunkPacker& operator=(const ChunkPacker&) = delete;

  /// Valid until the next call; empty when there is no memory.
  std::span<const char> pack(const std::vector<char>& chunk, std::size_t bytes_of_value) {
    if (deflate_ == nullptr) return {};
    const std::size_t n = chunk.size() / bytes_of_value;
    shuffled_.resize(chunk.size());
    for (std::size_t k = 0; k < bytes_of_value; ++k)
      for (std::size_t i = 0; i < n; ++i) shuffled_[k * n + i] = chunk[i * bytes_of_value + k];
    packed_.resize(libdeflate_zlib_compress_bound(deflate_, shuffled_.size()));
    const std::size_t size = libdeflate_zlib_compress(deflate_, shuffled_.data(), shuffled_.size(),
                                                      packed_.data(), packed_.size());
    return {packed_.data(), size};
  }

 private:
  libdeflate_compressor* deflate_;
  std::vector<char> shuffled_, packed_;
};

/// A growing one-dimensional dataset that is written in whole chunks.
struct Column {
  ChunkPacker* packer;
  Hdf5Handle data{};
  SampleType type = SampleType::f64;
  std::vector<char> pending{};
  hsize_t written = 0;

  bool create(hid_t group, const std::string& name, SampleType kind) {
    type = kind;
    const hsize_t none = 0, unlimited = H5S_UNLIMITED, chunk = kChunkSamples;
    Hdf5Handle space(H5Screate_simple(1, &none, &unlimited), H5Sclose);
    const Hdf5Handle properties = timeless(H5P_DATASET_CREATE);
    H5Pset_chunk(properties, 1, &chunk);
    H5Pset_shuffle(properties);
    H5Pset_deflate(properties, 1);
    data = Hdf5Handle(
        H5Dcreate2(group, name.c_str(), file_type(type), space, H5P_DEFAULT, properties, H5P_DEFAULT),
        H5Dclose);
    return data.good();
  }

  bool append(const void* values, std::size_t n) {
    const char* bytes = static_cast<const char*>(values);
    const std::size_t chunk = kChunkSamples * size_of(type);
    std::size_t left = n * size_of(type);
    while (left > 0) {
      const std::size_t take = std::min(left, chunk - pending.size());
      pending.insert(pending.end(), bytes, bytes + take);
      bytes += take;
      left -= take;
      if (pending.size() == chunk && !flush()) return false;
    }
    return true;
  }

  /// Whole chunks, and once at the end what is left: a chunk on disk has its full length.
  bool flush() {
    const hsize_t n = pending.size() / size_of(type), total = written + n;
    if (n == 0) return true;
    if (H5Dset_extent(data, &total) < 0) return false;
    pending.resize(kChunkSamples * size_of(type));
    const std::span<const char> packed = packer->pack(pending, size_of(type));
    if (packed.empty() || H5Dwrite_chunk(data, H5P_DEFAULT, 0, &written, packed.size(), packed.data()) < 0)
      return false;
    written = total;
    pending.clear();
    return true;
  }
};

std::string link_name(std::string name) {
  std::replace(name.begin(), name.end(), '/', '_');
  return name.empty() || name == "." || name == ".." ? "channel_" + name : name;
}

}  // namespace

struct Hdf5Writer::Impl {
  std::filesystem::path path, temporary;
  Hdf5Handle file, time_group, channel_group, raw_group;
  std::vector<TimeBaseSpec> bases;
  std::vector<ChannelSpec> specs;
  std::vector<std::vector<Gap>> gaps;
  std::vector<bool> invented;
  ChunkPacker packer;
  std::vector<Column> times, columns;

  ~Impl() {
    if (temporary.empty()) return;
    const Hdf5Lock lock;
    times.clear();
    columns.clear();
    time_group.reset();
    channel_group.reset();
    raw_group.reset();
    file.reset();
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
  }

  Unexpected error(const char* what) const {
    return fail(ErrorCode::io, what, path.string(), "is the disk full, and may the folder be written to?");
  }

  bool create_all() {
    file = Hdf5Handle(H5Fcreate(temporary.c_str(), H5F_ACC_TRUNC, timeless(H5P_FILE_CREATE), H5P_DEFAULT), H5Fclose);
    if (!file.good() || !put_int(file, "format", kTraceFormat) || !put_text(file, "kind", "forcegate trace"))
      return false;
    const auto group = [&](const char* name) {
      return Hdf5Handle(H5Gcreate2(file, name, H5P_DEFAULT, timeless(H5P_GROUP_CREATE), H5P_DEFAULT), H5Gclose);
    };
    time_group = group("time");
    channel_group = group("channels");
    raw_group = group("raw");
    if (!time_group.good() || !channel_group.good() || !raw_group.good()) return false;
    for (std::size_t k = 0; k < bases.size(); ++k)
      if (!times.emplace_back(Column{.packer = &packer})
               .create(time_group, std::to_string(k), SampleType::f64) ||
          !put_text(times[k].data, "device", bases[k].device) || !put_text(times[k].data, "unit", "s"))
        return false;
    for (std::size_t c = 0; c < specs.size(); ++c) {
      const ChannelSpec& s = specs[c];
      Column& column = columns.emplace_back(Column{.packer = &packer});
      if (!column.create(is_counts(s.type) ? raw_group : channel_group, link_name(s.name), s.type))
        return false;
      if (!put_text(column.data, "name", s.name) || !put_text(column.data, "unit", s.unit) ||
          !put_text(column.data, "quantity", s.quantity) ||
          !put_int(column.data, "time_base", static_cast<std::int32_t>(s.time_base)) ||
          !put_int(column.data, "order", static_cast<std::int32_t>(c)) ||
          (s.type == SampleType::i32 && !put_int(column.data, "missing", kMissingCount)))
        return false;
    }
    return true;
  }

  bool finish(const std::string& name, const std::map<std::string, std::string>& provenance) {
    for (std::size_t k = 0; k < times.size(); ++k) {
      if (!times[k].flush() || !put_double(times[k].data, "nominal_rate_Hz", bases[k].nominal_rate_Hz) ||
          !put_int(times[k].data, "invented", invented[k]))
        return false;
      if (gaps[k].empty()) continue;
      Column table{.packer = &packer};
      if (!table.create(time_group, std::to_string(k) + "_gaps", SampleType::f64)) return false;
      for (const Gap& g : gaps[k]) {
        const double row[3] = {static_cast<double>(g.index), g.from_s, g.to_s};
        if (!table.append(row, 3)) return false;
      }
      if (!table.flush()) return false;
    }
    for (Column& c : columns)
      if (!c.flush()) return false;
    if (!put_text(file, "name", name)) return false;
    Hdf5Handle meta(H5Gcreate2(file, "meta", H5P_DEFAULT, timeless(H5P_GROUP_CREATE), H5P_DEFAULT), H5Gclose);
    for (const auto& [key, value] : provenance)
      if (!put_text(meta, link_name(key), value)) return false;
    meta.reset();
    times.clear();
    columns.clear();
    time_group.reset();
    channel_group.reset();
    raw_group.reset();
    return H5Fflush(file, H5F_SCOPE_GLOBAL) >= 0 && file.reset();
  }
};

Hdf5Writer::Hdf5Writer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Hdf5Writer::~Hdf5Writer() = default;
Hdf5Writer::Hdf5Writer(Hdf5Writer&&) noexcept = default;
Hdf5Writer& Hdf5Writer::operator=(Hdf5Writer&&) noexcept = default;

Result<Hdf5Writer> Hdf5Writer::create(const std::filesystem::path& path,
                                      const std::vector<TimeBaseSpec>& time_bases,
                                      const std::vector<ChannelSpec>& channels) {
  const Hdf5Lock lock;
  auto impl = std::make_unique<Impl>();
  FORCEGATE_TRY(impl->path, output_path(path));
  impl->temporary = impl->path.string() + ".part";
  impl->bases = time_bases;
  impl->specs = channels;
  impl->gaps.resize(time_bases.size());
  impl->invented.resize(time_bases.size());
  if (!impl->create_all()) return impl->error("the HDF5 file cannot be created");
  return Hdf5Writer(std::move(impl));
}

Result<void> Hdf5Writer::append_time(std::size_t time_base, std::span<const double> t_s) {
  const Hdf5Lock lock;
  if (!impl_->times.at(time_base).append(t_s.data(), t_s.size()))
    return impl_->error("the HDF5 file cannot be written");
  return {};
}

Result<void> Hdf5Writer::append(std::size_t channel, const ColumnView& values) {
  const Hdf5Lock lock;
  Column& column = impl_->columns.at(channel);
  assert(column.type == values.type);
  if (!column.append(values.data, values.n)) return impl_->error("the HDF5 file cannot be written");
  return {};
}

void Hdf5Writer::describe(std::size_t time_base, double nominal_rate_Hz, const std::vector<Gap>& gaps,
                          bool invented) {
  impl_->bases.at(time_base).nominal_rate_Hz = nominal_rate_Hz;
  impl_->gaps.at(time_base) = gaps;
  impl_->invented.at(time_base) = invented;
}

Result<void> Hdf5Writer::close(const std::string& name,
                               const std::map<std::string, std::string>& provenance) {
  const Hdf5Lock lock;
  if (!impl_->finish(name, provenance)) return impl_->error("the HDF5 file cannot be completed");
  const int descriptor = ::open(impl_->temporary.c_str(), O_RDONLY | O_CLOEXEC);
  const bool durable = descriptor >= 0 && ::fsync(descriptor) == 0;
  if (descriptor >= 0) ::close(descriptor);
  if (!durable || std::rename(impl_->temporary.c_str(), impl_->path.c_str()) != 0)
    return impl_->error("the HDF5 file cannot be completed");
  impl_->temporary.clear();
  return {};
}

Result<void> write_hdf5(const Trace& trace, const std::filesystem::path& path) {
  std::vector<TimeBaseSpec> bases;
  for (const TimeBase& b : trace.time_bases) bases.push_back({b.device, b.nominal_rate_Hz});
  std::vector<ChannelSpec> specs;
  std::vector<ColumnView> columns;
  for (const Channel& c : trace.channels) {
    const bool counts_only = c.quantity == "code" && !c.raw.empty();
    if (!counts_only) {
      specs.push_back({c.name, c.unit, c.quantity, SampleType::f64, c.time_base});
      columns.emplace_back(c.value);
    }
    if (c.raw.empty()) continue;
    specs.push_back({c.name, "counts", "code", SampleType::i32, c.time_base});
    columns.emplace_back(c.raw);
  }
  FORCEGATE_TRY(Hdf5Writer writer, Hdf5Writer::create(path, bases, specs));
  for (std::size_t k = 0; k < bases.size(); ++k) {
    const TimeBase& b = trace.time_bases[k];
    FORCEGATE_CHECK_OK(writer.append_time(k, b.t_s));
    writer.describe(k, b.nominal_rate_Hz, b.gaps, b.invented);
  }
  for (std::size_t c = 0; c < specs.size(); ++c) FORCEGATE_CHECK_OK(writer.append(c, columns[c]));
  return writer.close(trace.name, trace.provenance);
}

}  // namespace forcegate
